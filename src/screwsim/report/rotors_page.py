"""A page with the meshing rotors under sliders of angle and section: one file, nothing loaded from elsewhere."""

from __future__ import annotations

import json
import math
from html import escape

import numpy as np

from screwsim.machine.profile_law import Laid
from screwsim.machine.rotors.pair import Array, outlines

MM, DEG = 1e3, 180.0 / math.pi
FINE = 4e-3  # [mm] how far a drawn outline may lie from the rotor's


def thinned(x: Array, y: Array, off: float) -> list[int]:
    """Return the indices of points such that no point lies farther from the polygon of the kept ones than `off`."""
    keep, todo = {0, len(x) - 1}, [(0, len(x) - 1)]
    while todo:
        first, last = todo.pop()
        if last - first < 2:
            continue
        dx, dy = x[last] - x[first], y[last] - y[first]
        px, py = x[first + 1 : last] - x[first], y[first + 1 : last] - y[first]
        length = math.hypot(dx, dy)
        away = np.abs(px * dy - py * dx) / length if length > 1e-9 else np.hypot(px, py)
        worst = int(np.argmax(away))
        if away[worst] > off:
            middle = first + 1 + worst
            keep.add(middle)
            todo += [(first, middle), (middle, last)]
    return sorted(keep)


def _path(x: Array, y: Array) -> str:
    index = thinned(MM * x, MM * y, FINE)
    return "M" + "L".join(f"{MM * x[i]:.2f},{MM * y[i]:.2f}" for i in index) + "Z"


def _curve(angle: Array, value: Array, factor: float) -> list[list[float]]:
    x, y = DEG * angle, factor * value
    return [[round(float(x[i]), 2), float(f"{y[i]:.4g}")] for i in thinned(x, y / y.max() * x.max(), 0.3)]


def page(laid: Laid, title: str) -> str:
    """Return the HTML text of the page."""
    rotors, pair = laid.rotors, laid.rotors.pair
    male, female = outlines(pair, rotors.chain)
    chain = rotors.chain
    index = thinned(MM * chain.x, MM * chain.y, FINE)
    data = {
        "A": MM * pair.centre_distance,
        "R1": MM * pair.male_radius,
        "R2": MM * pair.female_radius,
        "H": [MM * value for value in pair.cusp],
        "k": pair.k,
        "pitch": DEG * pair.pitch,
        "wrap": DEG * rotors.wrap,
        "start": DEG * (rotors.start - laid.born),
        "life": DEG * laid.life,
        "born": DEG * laid.born,
        "closes": DEG * laid.injection,
        "opens": DEG * laid.opens,
        "ends": DEG * laid.ends,
        "chain": [[round(v, 3) for v in (DEG * chain.psi[i], MM * chain.x[i], MM * chain.y[i])] for i in index],
        "volume": _curve(laid.volume.angle, laid.volume.value, 1e6),
        "suction": _curve(laid.suction.angle, laid.suction.value, 1e4),
        "discharge": _curve(laid.discharge.angle, laid.discharge.value, 1e4),
    }
    text = _PAGE.replace("@TITLE@", escape(title or "Rotors")).replace("@MALE@", _path(*male))
    return text.replace("@FEMALE@", _path(*female)).replace("@DATA@", json.dumps(data))


_PAGE = """\
<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>@TITLE@</title>
<style>
:root { color-scheme: light dark; --page: #fff; --text: #111; --soft: #6e6e6e; --mark: #aaa; --male: #e4e4e4;
  --female: #f4efe6; --contact: #a01f62; --suction: #3b2a8c; --discharge: #c2561a; }
@media screen and (prefers-color-scheme: dark) { :root { --page: #14171b; --text: #e6e9ed; --soft: #a5aeb9;
  --mark: #6a7480; --male: #363d46; --female: #2a2620; --contact: #f08bbd; --suction: #a99cff; --discharge: #f2a06a; } }
body { background: var(--page); color: var(--text); font: 15px/1.4 system-ui, sans-serif; margin: 1em auto;
  max-width: 60em; padding: 0 1em; }
h1 { font-size: 1.2em; } svg { width: 100%; height: auto; display: block; }
label { display: grid; grid-template-columns: 17em 1fr; align-items: center; margin: .3em 0; }
input { width: 100%; } #graph text { font-size: 11px; fill: var(--text); }
@media (max-width: 40em) { label { grid-template-columns: 1fr; } #graph text { font-size: 18px; } }
p { margin: .4em 0; }
</style></head><body>
<h1>@TITLE@</h1>
<svg id="mesh" role="img" aria-label="section through both rotors"><g transform="scale(1,-1)">
<path id="bores" fill="none" stroke="var(--soft)" stroke-width="0.8"/>
<path id="male" d="@MALE@" fill="var(--male)" stroke="var(--text)" stroke-width="0.3"/>
<path id="female" d="@FEMALE@" fill="var(--female)" stroke="var(--text)" stroke-width="0.3"/>
<path id="line" fill="none" stroke="var(--contact)" stroke-width="0.4"/>
<g id="contacts" fill="var(--contact)"></g></g></svg>
<label><span id="phi-text"></span><input id="phi" type="range" min="0" step="0.5"></label>
<label><span id="z-text"></span><input id="z" type="range" min="0" max="1" step="0.01" value="0"></label>
<p id="state"></p>
<svg id="graph" viewBox="0 -22 720 232" role="img" aria-label="volume and port areas over the angle"></svg>
<p>Solid: volume of the chamber; dashed, violet: suction port; dotted, orange: discharge port, each over its largest
value. Red in the upper picture: where the rotors touch in this section, and the line on which they do.</p>
<script>
const d = @DATA@, at = id => document.getElementById(id), rad = Math.PI / 180;
const phi = at("phi"), z = at("z"), box = 1.04;
at("mesh").setAttribute("viewBox", [-box * d.R1, -box * Math.max(d.R1, d.R2),
  box * (d.R1 + d.R2) + d.A, 2 * box * Math.max(d.R1, d.R2)].join(" "));
at("bores").setAttribute("d", `M${d.H[0]},${d.H[1]}A${d.R1},${d.R1} 0 1 1 ${d.H[0]},${-d.H[1]}` +
  `A${d.R2},${d.R2} 0 1 1 ${d.H[0]},${d.H[1]}Z`);
at("line").setAttribute("d", "M" + d.chain.map(c => c[1] + "," + c[2]).join("L"));
phi.max = d.life; phi.value = d.closes;
const X = a => 40 + 660 * a / d.life, Y = v => 180 - 150 * v;
const top_of = c => Math.max(...c.map(p => p[1]));
const draw = (c, colour, dash) => `<polyline fill="none" stroke="var(--${colour})" stroke-width="1.5" ` +
  `stroke-dasharray="${dash}" points="` +
  c.map(p => X(p[0]) + "," + Y(p[1] / top_of(c))).join(" ") + `"/>`;
const mark = (a, text, y) => `<line x1="${X(a)}" x2="${X(a)}" y1="${y + 6}" y2="180" stroke="var(--mark)" ` +
  `stroke-dasharray="2 3"/><text x="${X(a)}" y="${y}" text-anchor="middle">${text} ${a.toFixed(1)}°</text>`;
let ticks = "";
for (let a = 0; a <= d.life; a += 90) ticks += `<text x="${X(a)}" y="198" text-anchor="middle">${a}°</text>`;
at("graph").innerHTML = `<line x1="40" x2="700" y1="180" y2="180" stroke="var(--text)"/>` + ticks +
  mark(d.born, "born", 18) + mark(d.closes, "closes", 18) + mark(d.opens, "opens", -4) +
  mark(d.ends, "ends", 18) + draw(d.suction, "suction", "7 3") +
  draw(d.discharge, "discharge", "2 2") + draw(d.volume, "text", "none") +
  `<line id="now" y1="26" y2="180" stroke="var(--contact)"/>`;
function volume(a) {
  const c = d.volume;
  for (let i = 1; i < c.length; i++)
    if (a <= c[i][0] && a >= c[i - 1][0])
      return c[i - 1][1] + (c[i][1] - c[i - 1][1]) * (a - c[i - 1][0]) / (c[i][0] - c[i - 1][0]);
  return 0;
}
function show() {
  const a = +phi.value, psi = d.start + a - d.wrap * z.value;
  at("male").setAttribute("transform", `rotate(${-psi})`);
  at("female").setAttribute("transform", `translate(${d.A},0) rotate(${d.k * psi})`);
  let dots = "";
  for (let i = 1; i < d.chain.length; i++) {
    const [p, x, y] = d.chain[i - 1], [q, u, v] = d.chain[i];
    const low = Math.min(p, q), n = Math.ceil((low - psi) / d.pitch), s = psi + n * d.pitch;
    if (s > Math.max(p, q)) continue;
    const part = q === p ? 0 : (s - p) / (q - p);
    dots += `<circle cx="${x + part * (u - x)}" cy="${y + part * (v - y)}" r="0.9"/>`;
  }
  at("contacts").innerHTML = dots;
  at("phi-text").textContent = `angle of the chamber ${a.toFixed(1)}°`;
  at("z-text").textContent = `section at z/L = ${(+z.value).toFixed(2)} from the inlet`;
  const now = a < d.born || a > d.ends ? "is idle" :
    a < d.closes ? "fills" : a < d.opens ? "is compressed" : "discharges";
  at("state").textContent = `The chamber ${now}; its volume is ${volume(a).toFixed(1)} cm³.`;
  at("now").setAttribute("x1", X(a)); at("now").setAttribute("x2", X(a));
}
phi.oninput = z.oninput = show; show();
</script></body></html>
"""
