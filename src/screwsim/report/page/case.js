// One case: its figures with their errors, its cycle, its ledger.

let picked = 0;

function fillPicker() {
  document.getElementById("picker").append(...data.axes.map((axis, i) => {
    const last = sizeOf(i) - 1;
    const field = axis.joined
      ? made("input", { type: "number", min: "0", max: String(last), step: "1" })
      : made("select", {}, ...placesAlong(i).map((_, place) => new Option(nameOf(i, place), String(place))));
    field.addEventListener("change", () => {
      const places = placesOf(picked);
      places[i] = Math.min(Math.max(Math.round(Number(field.value)) || 0, 0), last);
      pick(caseOf(places));
    });
    return made("label", {}, `${axis.label} `, field);
  }));
}

function pick(number) {
  picked = number;
  if (data.axes.length) {
    const selects = document.querySelectorAll("#picker select, #picker input");
    placesOf(number).forEach((place, i) => { selects[i].value = String(place); });
    document.getElementById("case-words").textContent = `${caseWords(number)}: ${statusOf(number)}`;
    showText("case-warnings", data.warnings[number]);
    drawOverview();
  }
  drawCase();
}

function drawCase() {
  showText("case-message", data.messages[picked]);
  fillFigures();
  document.getElementById("balance").textContent = balanceWords();
  if (data.cycle) drawCycle();
  if (data.ledger) drawLedger();
  markCut();
}

function showText(id, text) {
  const place = document.getElementById(id);
  place.textContent = text || "";
  place.hidden = !text;
}

// Tables that are wider than the screen say so.
function markCut() {
  for (const each of document.querySelectorAll(".scroll")) each.classList.toggle("cut", each.scrollWidth > each.clientWidth + 1);
}

function fillFigures() {
  const rows = data.figures.filter((figure) => Number.isFinite(figure.read[picked])).map((figure) => {
    const [number, unit] = written(figure, figure.read[picked]);
    const half = data.inputs ? [[figure.half ? halfText(figure, figure.read[picked], figure.half[picked]) : "", "n"]] : [];
    return tableRow(figure.words, [[number, "n"], ...half, [unit, ""], [figure.error ? small(figure.error[picked]) : "", "n"]]);
  });
  document.querySelector("#figures tbody").replaceChildren(...rows);
  if (data.inputs) fillContributors();
}

// Which inputs make the most of some figures of the picked case.
function fillContributors() {
  const { names, figures, lost } = data.inputs;
  const lines = figures.flatMap((figure) => {
    const own = names.map((name, i) => ({ name, share: figure.shares[picked * names.length + i] }));
    const most = own.filter(({ share }) => share >= 0.01).sort((a, b) => b.share - a.share).slice(0, 3);
    const shares = most.map(({ name, share }) => `${name} ${Math.round(100 * share)}%`).join(", ");
    return most.length ? [made("li", {}, `${figure.words}: ${shares}`)] : [];
  });
  const without = names.filter((name, i) => lost && lost[picked * names.length + i]);
  if (without.length) lines.push(made("li", {}, lostWords(without)));
  document.getElementById("contributors").replaceChildren(...lines);
}

// Inputs without a derivative in this case; named as in the report's own text.
function lostWords(names) {
  const told = names.length <= 3 ? names.join(", ") : `${names.length} inputs`;
  return `All without ${told}, whose part is unknown: the intervals are too small.`;
}

function balanceWords() {
  const found = residuals(["mass", "energy", "entropy", "oil_mass"], (name) => data.balance[name] && data.balance[name][picked]);
  const bound = data.balance.bound ? ` (bound ${small(data.balance.bound[picked])})` : "";
  return found && `Residuals of this case: ${found}${bound}.`;
}

function drawCycle() {
  const { cycle } = data;
  const there = traceOf(cycle.traces.pressure, picked).some((value) => value !== null);
  for (const id of ["loop", "temperatures", "flows"]) document.getElementById(id).hidden = !there;
  document.getElementById("traces-note").textContent = there ? tracesWords() : "No cycle is stored for this case.";
  if (!there) return;
  drawLoop();
  drawTemperatures();
  drawFlows();
}

function tracesWords() {
  const { cycle } = data;
  const off = (name) => `${general(cycle.off[name], 2)} ${cycle.traces[name].unit.replace("°C", "K")}`;
  return `${cycle.angle.length} of ${cycle.points} angles are kept on this page; straight lines between them deviate by at most `
    + `${off("pressure")} and ${off("gas_temperature")} in any case. The file has all.`;
}

function marksOf() {
  const { marks } = data.cycle;
  return Object.entries(marks.length > 1 ? marks[picked] : marks[0]);
}

function lineTrace(x, y, name, tint, dash, hover) {
  return { type: "scatter", mode: "lines", x, y, name, line: { color: tint, dash, width: 2, simplify: false }, hovertemplate: `${hover}<extra>${name}</extra>` };
}

function at(angles, values, angle) {
  const k = Math.max(1, angles.findIndex((each) => each >= angle));
  const share = (angle - angles[k - 1]) / (angles[k] - angles[k - 1]);
  return values[k - 1] + share * (values[k] - values[k - 1]);
}

// Height and name of each line's pressure.
function pressureLevels() {
  const lines = ["suction", "discharge"].map((name) => [figureNamed(`${name}_pressure`), name]);
  return lines.filter(([figure]) => figure && Number.isFinite(figure.read[picked])).map(([figure, name]) => [figure.read[picked] * figure.factor, name]);
}

function drawLoop() {
  const { angle, traces, top } = data.cycle;
  const [V, p] = [traceOf(traces.volume, picked), traceOf(traces.pressure, picked)];
  const loop = { ...lineTrace(V, p, "p–V", colour("c1"), "solid", "%{x:.4~g}, %{y:.4~g}, %{customdata}°"), customdata: angle.map((each) => general(each, 4)) };
  const places = marksOf().map(([name, where]) => ({ x: at(angle, V, where), y: at(angle, p, where), text: `${name}, ${general(where, 4)}°` }));
  const marks = scatter("markers", places, {
    hoverinfo: "skip", marker: { symbol: "circle-open", size: 9, color: colour("c1"), line: { width: 2 } },
  });
  const levels = pressureLevels();
  const names = levels.map((level) => levelName(...level));
  const target = document.getElementById("loop");
  Plotly.react(target, [loop, marks], layout({
    xaxis: { ...axisLook(traces.volume.label, false), rangemode: "tozero" },
    yaxis: { ...axisLook(traces.pressure.label, false), range: [0, top[picked]] },
    margin: { l: 54, r: 74, t: 30, b: 46 },
    shapes: levels.map(([height]) => levelLine(height)),
    annotations: names,
    showlegend: false,
  }), CONFIG).then(() => Plotly.relayout(target, { annotations: [...names, ...clearNames(target, V, p, places, levels.map(([height]) => height))] }));
}

// Names of points where they cover neither the curve nor level lines nor each other; a name without such a place is left out.
function clearNames(target, x, y, places, levels) {
  const { xaxis, yaxis } = target._fullLayout;
  const pixel = (a, b) => [xaxis.l2p(a), yaxis.l2p(b)];
  const path = dense(x.map((each, i) => pixel(each, y[i])).filter((each) => each.every(Number.isFinite)));
  const boxes = [
    ...places.map((place) => around(...pixel(place.x, place.y), 6, 6)),
    ...levels.map((level) => [0, xaxis._length, yaxis.l2p(level) - 2, yaxis.l2p(level) + 2]),
  ];
  const found = [];
  for (const { x: a, y: b, text } of places) {
    const [left, top] = pixel(a, b);
    const half = [3.4 * text.length + 6, 11];
    const free = OFFSETS.map(([dx, dy]) => [Math.sign(dx) * (Math.abs(dx) + half[0]), dy]).find(([dx, dy]) => {
      const box = around(left + dx, top + dy, ...half);
      return box[0] > 0 && box[1] < xaxis._length && box[2] > 0 && box[3] < yaxis._length
        && !path.some(([u, v]) => inBox(box, u, v)) && !boxes.some((other) => overlap(box, other));
    });
    if (!free) continue;
    boxes.push(around(left + free[0], top + free[1], ...half));
    found.push({
      x: a, y: b, text, ax: free[0], ay: free[1], arrowhead: 0, arrowwidth: 1, arrowcolor: colour("soft"), standoff: 5,
    });
  }
  return found;
}

const OFFSETS = [12, 20, 28, 38, 50, 65, 80, 100, 125, 150].flatMap((d) => [
  [d, -d], [-d, -d], [d, 0], [-d, 0], [0, -d - 8], [0, d + 8], [d, d], [-d, d], [12, -d], [-12, -d], [12, d], [-12, d],
]);

function around(x, y, halfWidth, halfHeight) {
  return [x - halfWidth, x + halfWidth, y - halfHeight, y + halfHeight];
}

function inBox([left, right, top, bottom], x, y) {
  return x > left - 3 && x < right + 3 && y > top - 2 && y < bottom + 2;
}

function overlap(a, b) {
  return a[0] < b[1] && b[0] < a[1] && a[2] < b[3] && b[2] < a[3];
}

// Points of a polyline about every other pixel.
function dense(points) {
  return points.flatMap(([x, y], i) => {
    if (i === 0) return [[x, y]];
    const [u, v] = points[i - 1];
    const count = Math.min(Math.ceil(Math.hypot(x - u, y - v) / 2), 2000) || 1;
    return Array.from({ length: count }, (_, k) => [u + ((x - u) * (k + 1)) / count, v + ((y - v) * (k + 1)) / count]);
  });
}

// Draw curves over the angle, with lines and names at the marked angles.
function drawOverAngle(id, drawn, title, legend) {
  const { angle, angle_label: label } = data.cycle;
  Plotly.react(id, drawn, layout({
    xaxis: { ...axisLook(label, false), dtick: window.innerWidth < 640 ? 180 : 120, range: [angle[0], angle.at(-1)] },
    yaxis: axisLook(title, false),
    shapes: marksOf().map(([, where]) => ({
      type: "line", x0: where, x1: where, yref: "paper", y0: 0, y1: 1, line: { color: colour("soft"), width: 1, dash: "dot" },
    })),
    annotations: marksOf().map(([name, where]) => ({
      x: where, xanchor: "right", xshift: -3, yref: "paper", y: 1, yanchor: "top", text: name, showarrow: false, font: { size: 12, color: colour("soft") },
    })),
    ...legend,
  }), CONFIG);
}

function drawTemperatures() {
  const { angle, traces } = data.cycle;
  const names = [["gas_temperature", "gas", "c1", "solid"], ["oil_temperature", "oil", "c3", "dash"]].filter(([name]) => traces[name]);
  const drawn = names.map(([name, words, tint, dash]) => lineTrace(angle, traceOf(traces[name], picked), words, colour(tint), dash, "%{x:.4~g}°, %{y:.5~g} °C"));
  const legend = { x: 0, xanchor: "left", y: 1, yanchor: "bottom", orientation: "h" };
  drawOverAngle("temperatures", drawn, traces.gas_temperature.label, { showlegend: drawn.length > 1, legend });
}

function drawFlows() {
  const { flows } = data.cycle;
  document.getElementById("flows").hidden = !flows;
  document.getElementById("flows-note").textContent = flows
    ? "Positive into the chamber. Click a name to show or hide its curve." : "With so many cases the page keeps no flows; the file has them.";
  if (!flows) return;
  const paths = Object.entries(flows.paths);
  const hidden = (words) => (words.endsWith("port") && paths.length > 2 ? "legendonly" : true);
  const drawn = paths.flatMap(([words, sides], i) => Object.entries(sides).map(([side, name], j) => {
    const values = traceOf(flows.traces[name], picked);
    const label = side ? `${words}, ${side}` : words;
    return { ...lineTrace(flows.angle, values, label, ordered(i, paths.length), DASHES[j], "%{x:.4~g}°, %{y:.4~g} g/s"), visible: hidden(words) };
  }));
  drawOverAngle("flows", drawn, `mass flow (${Object.values(flows.traces)[0].unit})`, { showlegend: true, legend: below() });
}

function ledgerOf() {
  const { totals, entries } = data.ledger;
  const mine = entries.map((entry) => Object.fromEntries(Object.entries(entry).map(([name, value]) => [name, name === "words" ? value : value[picked]])));
  const found = Object.fromEntries(Object.entries(totals).map(([name, values]) => [name, values[picked]]));
  return { ...found, entries: mine.sort((a, b) => b.exergy_destroyed - a.exergy_destroyed) };
}

function drawLedger() {
  const ledger = ledgerOf();
  const whole = spent(ledger);
  const there = Number.isFinite(whole) && whole > 0;
  for (const id of ["ledger", "waterfall"]) document.getElementById(id).hidden = !there;
  document.getElementById("ledger-note").textContent = there ? "" : "This case has no ledger.";
  if (!there) return;
  const [, factor, unit] = data.watts.find(([least]) => whole >= least);
  fillLedger(ledger, factor, unit);
  drawWaterfall(ledger, factor, unit);
  const ambient = ledger.ambient_temperature;
  const back = ledger.entries.some((entry) => entry.exergy_destroyed < 0) ? " Below zero (green): recovers what other entries count as lost." : "";
  document.getElementById("ledger-note").textContent = `W/K: entropy generated; exergy at ${ambient.toFixed(2)} K (${(ambient - 273.15).toFixed(2)} °C).${back}`;
}

function fillLedger(ledger, factor, unit) {
  const heads = ["", unit, "%", "W/K", `moved ${unit}`, "kg/s"];
  const cells = (power, entry) => [
    [general(factor * power, 4), "n"],
    [((100 * power) / spent(ledger)).toFixed(2), "n"],
    [general(entry.entropy_generated, 3), "n"],
    [general(factor * entry.energy_moved, 3), "n"],
    [general(entry.gas_moved, 3), "n"],
  ];
  const line = (words, power, entry, total) => (Number.isFinite(power) ? [tableRow(words, cells(power, entry), total)] : []);
  const ends = ledger.shaft_power > 0
    ? [["total at the shaft", ledger.shaft_power], ["exergy rise of the gas", ledger.gas_exergy_rise]]
    : [["total given by the gas", -ledger.gas_exergy_rise], ["power at the shaft", -ledger.shaft_power]];
  document.getElementById("ledger").replaceChildren(tableHead(heads, "n"), made("tbody", {},
    ...line(...ends[0], {}, "total"),
    ...line(...ends[1], {}),
    ...line("exergy rise of the oil", ledger.oil_exergy_rise, {}),
    ...ledger.entries.flatMap((entry) => line(entry.words, entry.exergy_destroyed, entry)),
    ...line("residual", ledger.residue, {}),
  ));
}

function drawWaterfall(ledger, factor, unit) {
  const steps = waterfallSteps(ledger);
  const target = document.getElementById("waterfall");
  target.style.height = `${5 + 1.5 * steps.length}rem`;
  Plotly.react(target, [{
    type: "bar",
    orientation: "h",
    y: steps.map((step) => step.words),
    x: steps.map((step) => step.power * factor),
    base: steps.map((step) => step.start * factor),
    marker: { color: steps.map((step) => colour(step.tint)) },
    text: steps.map((step) => `${((100 * step.power) / spent(ledger)).toFixed(1)} %`),
    textposition: "none",
    hovertemplate: `%{y}: %{x:.4~g} ${unit}, %{text}<extra></extra>`,
  }], layout({
    xaxis: { ...axisLook(`exergy (${unit})`, false), rangemode: "tozero" },
    yaxis: { ...axisLook("", false), type: "category", autorange: "reversed", ticks: "", gridcolor: "rgba(0,0,0,0)" },
    showlegend: false,
  }), CONFIG);
}
