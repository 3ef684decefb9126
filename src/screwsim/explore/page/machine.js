// The machine at work: a side view and a section of the rotors, or a cylinder; every chamber has its colour, and arrows
// whose area is the flow go through its ports and leaks.

const LAND = [4, 9]; // degrees that a lobe's crest takes to each side: male, female
const SLICES = 60;
const LEAKS_LARGER = 5; // times are leaks drawn larger than what goes through ports
const RADIANS = Math.PI / 180;

class Machine {
  constructor(side, section) {
    this.side = document.getElementById(side);
    this.section = document.getElementById(section);
    for (const canvas of [this.side, this.section]) new ResizeObserver(() => { fitted(canvas); this.again(); }).observe(canvas);
  }

  set(doc) {
    this.doc = doc;
    this.paths = doc.kind === "rotors" ? [new Path2D(doc.male), new Path2D(doc.female)] : [];
    this.section.hidden = doc.kind !== "rotors";
    document.getElementById("cut").hidden = doc.kind !== "rotors";
    this.side.hidden = doc.kind === "none";
    document.getElementById("drawings").classList.toggle("one", doc.kind !== "rotors");
  }

  // answer: what is shown; angle: of the followed chamber; by: the trace that colours; z: where the section is
  show(answer, angle, by, z) {
    [this.answer, this.angle, this.by, this.z] = [answer, angle, by, z];
    this.again();
  }

  again() {
    if (!this.doc || !this.answer || !this.answer.traces.angle) return;
    this.values = this.answer.traces[this.by] || this.answer.traces.pressure;
    this.range = rangeOf(this.answer, this.by, this.values);
    if (this.doc.kind === "rotors") {
      this.drawSide();
      this.drawSection();
    } else if (this.doc.kind === "cylinder") {
      this.drawCylinder();
    }
  }

  at(name, angle) {
    const values = this.answer.traces[name];
    return values ? interpolated(this.answer.traces.angle, values, angle) : 0;
  }

  tint(angle) {
    return ramp(this.part(interpolated(this.answer.traces.angle, this.values, angle)));
  }

  // Where a value lies between the ends of the colours: pressures by equal ratios.
  part(value) {
    const log = this.by === "pressure";
    return shareOf(this.range, log, log ? Math.max(value, this.range[0]) : value);
  }

  // Where the followed chamber and those before and behind it are in their lives, in degrees.
  lives(angle) {
    const { life, pitch, chambers } = this.doc;
    return Array.from({ length: chambers }, (_, i) => (angle + i * pitch) % life);
  }

  turned(angle) {
    return this.doc.backwards ? this.doc.life - angle : angle;
  }

  // The colour of a groove that its rotor brings to the end of its life at a section within psi degrees (below 0).
  grooveTint(psi, z) {
    const { start, wrap, life } = this.doc;
    const place = psi - start + wrap * z;
    if (place < 0 || place > life) return ramp(0);
    return this.tint(this.turned(place));
  }

  drawSection() {
    const { doc, z } = this;
    const pen = cleared(this.section);
    const [width, height] = [this.section.clientWidth, this.section.clientHeight];
    const scale = Math.min(width / (doc.R1 + doc.A + doc.R2), (height - 26) / (2 * Math.max(doc.R1, doc.R2))) * 0.97;
    pen.save();
    pen.translate(0.5 * (width - scale * (doc.A + doc.R2 - doc.R1)), 0.5 * (height - 26));
    pen.scale(scale, -scale);
    const psi = doc.start + this.turned(this.angle) - doc.wrap * z;
    const [male, female] = doc.lobes;
    this.grooves(pen, 0, doc.R1, male, (turn) => [-turn - 180 / male, 1], psi, z);
    this.grooves(pen, doc.A, doc.R2, female, (turn) => [180 + doc.k * turn, doc.k], psi, z);
    pen.lineWidth = 1.2 / scale;
    pen.strokeStyle = palette.text;
    this.rotor(pen, 0, this.paths[0], -psi);
    this.rotor(pen, doc.A, this.paths[1], doc.k * psi);
    pen.restore();
    this.legend(pen, width, height);
  }

  // Sectors of one bore, each in the colour of the chamber whose groove it is; in the mesh the old one is above.
  grooves(pen, x, radius, lobes, place, psi, z) {
    const half = 180 / lobes;
    const [, k] = place(0);
    const turn = 360 / k; // of the male rotor, after which the groove comes again
    const first = ((psi % (half * 2 / k)) - half * 2 / k) % (half * 2 / k);
    for (let i = 0; i < lobes; i += 1) {
      const here = first - (i * 2 * half) / k;
      const [middle] = place(here);
      for (const [which, lower] of [[here, false], [here - turn, true]]) {
        const meshes = here > -2 * half / k;
        if (lower && !meshes) continue;
        pen.save();
        if (meshes) clipHalf(pen, x, radius, lower);
        pen.fillStyle = this.grooveTint(which, z);
        pen.beginPath();
        pen.moveTo(x, 0);
        pen.arc(x, 0, radius, (middle - half) * RADIANS, (middle + half) * RADIANS);
        pen.fill();
        pen.restore();
      }
    }
  }

  rotor(pen, x, path, turn) {
    pen.save();
    pen.translate(x, 0);
    pen.rotate(turn * RADIANS);
    pen.fillStyle = palette.panel;
    pen.fill(path);
    pen.stroke(path);
    pen.restore();
  }

  // Seen from the high-pressure side: male rotor above, inlet at the left; hidden surfaces are not drawn.
  drawSide() {
    const { doc } = this;
    const pen = cleared(this.side);
    const [width, height] = [this.side.clientWidth, this.side.clientHeight];
    const tall = doc.R1 + doc.A + doc.R2;
    const scale = Math.min((width - 190) / doc.length, (height - 20) / tall);
    const [left, top] = [0.5 * (width - scale * doc.length), 0.5 * (height - scale * tall)];
    const frame = { x: (z) => left + scale * doc.length * z, y: (across) => top + scale * (across + doc.R1), scale };
    const seen = [Math.acos(Math.min(doc.H[0] / doc.R1, 1)) / RADIANS, 180 - Math.acos(Math.min((doc.A - doc.H[0]) / doc.R2, 1)) / RADIANS];
    this.barrel(pen, frame, 0, doc.R1, [seen[0], 180]);
    this.barrel(pen, frame, doc.A, doc.R2, [0, seen[1]]);
    const [male, female] = doc.lobes;
    const lives = this.lives(this.angle);
    for (const life of lives) {
      pen.fillStyle = this.tint(life);
      const psi = doc.start + this.turned(life);
      this.strip(pen, frame, 0, doc.R1, (z) => -(psi - doc.wrap * z) - 180 / male, 180 / male - LAND[0], [seen[0], 180]);
      this.strip(pen, frame, doc.A, doc.R2, (z) => 180 + doc.k * (psi - doc.wrap * z), 180 / female - LAND[1], [0, seen[1]]);
    }
    this.shade(pen, frame, -doc.R1, doc.H[0]);
    this.shade(pen, frame, doc.H[0], doc.A + doc.R2);
    this.sideArrows(pen, frame, lives, seen);
    write(pen, doc.backwards ? "outlet" : "inlet", frame.x(0) - 52, frame.y(-doc.R1), "soft", "right", "top");
    write(pen, doc.backwards ? "inlet" : "outlet", frame.x(1) + 52, frame.y(-doc.R1), "soft", "left", "top");
  }

  barrel(pen, frame, axis, radius, [low, high]) {
    const [a, b] = [low, high].map((angle) => frame.y(axis + radius * Math.cos(angle * RADIANS)));
    pen.fillStyle = palette.line;
    pen.fillRect(frame.x(0), Math.min(a, b), frame.x(1) - frame.x(0), Math.abs(b - a));
  }

  // A groove along the rotor, as far as it is seen.
  strip(pen, frame, axis, radius, middle, half, [low, high]) {
    const height = (angle) => frame.y(axis + radius * Math.cos(Math.min(Math.max(angle, low), high) * RADIANS));
    pen.beginPath();
    for (let i = 0; i <= SLICES; i += 1) pen.lineTo(frame.x(i / SLICES), height(middle(i / SLICES) - half));
    for (let i = SLICES; i >= 0; i -= 1) pen.lineTo(frame.x(i / SLICES), height(middle(i / SLICES) + half));
    pen.fill();
  }

  shade(pen, frame, low, high) {
    const fade = pen.createLinearGradient(0, frame.y(low), 0, frame.y(high));
    for (const [stop, dark] of [[0, 0.3], [0.3, 0], [0.7, 0], [1, 0.3]]) fade.addColorStop(stop, `rgba(0,0,0,${dark})`);
    pen.fillStyle = fade;
    pen.fillRect(frame.x(0), frame.y(low), frame.x(1) - frame.x(0), frame.y(high) - frame.y(low));
  }

  sideArrows(pen, frame, lives, seen) {
    const { doc } = this;
    const [male] = doc.lobes;
    const most = this.answer.mostFlow;
    for (const life of lives) {
      const psi = doc.start + this.turned(life);
      const height = (z) => {
        const angle = Math.min(Math.max(-(psi - doc.wrap * z) - 180 / male, seen[0]), 360 - seen[0]);
        return frame.y(doc.R1 * Math.cos(angle * RADIANS));
      };
      const [lower, upper] = portsOf(this.answer).map((names) => names.reduce((sum, name) => sum + this.at(name, life), 0));
      arrow(pen, frame.x(0), height(0), [1, 0], lower / most, inOrOut(lower), -1);
      arrow(pen, frame.x(1), height(1), [-1, 0], upper / most, inOrOut(upper), -1);
      const leak = leaksOf(this.answer, "leading").reduce((sum, name) => sum + this.at(name, life), 0);
      const crest = (z) => -(psi - doc.wrap * z) - 360 / male;
      const z = Math.min(Math.max((115 - crest(0)) / doc.wrap, 0.06), 0.94);
      const angle = crest(z);
      if (angle > seen[0] + 8 && angle < 172) {
        arrow(pen, frame.x(z), frame.y(doc.R1 * Math.cos(angle * RADIANS)), [0.4, -1], (LEAKS_LARGER * leak) / most, palette.c2);
      }
    }
  }

  drawCylinder() {
    const pen = cleared(this.side);
    const [width, height] = [this.side.clientWidth, this.side.clientHeight];
    const volume = this.answer.traces.volume;
    const part = interpolated(this.answer.traces.angle, volume, this.angle) / extent([volume])[1];
    const [wide, tall] = [Math.min(180, 0.5 * width), height - 70];
    const [left, top] = [0.5 * (width - wide), 40];
    pen.fillStyle = this.tint(this.angle);
    pen.fillRect(left, top, wide, tall * part * 0.7);
    pen.fillStyle = palette.panel;
    pen.strokeStyle = palette.text;
    pen.lineWidth = 1.5;
    pen.fillRect(left + 2, top + tall * part * 0.7, wide - 4, 0.22 * tall);
    pen.strokeRect(left + 2, top + tall * part * 0.7, wide - 4, 0.22 * tall);
    pen.beginPath();
    for (const [x, y] of [[left, top + tall], [left, top], [left + wide, top], [left + wide, top + tall]]) pen.lineTo(x, y);
    pen.stroke();
    const every = portsOf(this.answer).flat().map((name) => this.at(name, this.angle));
    every.forEach((flow, i) => {
      arrow(pen, left + ((i + 0.5) * wide) / every.length, top, [0, 1], flow / this.answer.mostFlow, inOrOut(flow), -1);
    });
    this.legend(pen, width, height);
  }

  legend(pen, width, height) {
    const [low, high] = this.range;
    const bar = { left: 0.25 * width, right: 0.75 * width, top: height - 16 };
    const fade = pen.createLinearGradient(bar.left, 0, bar.right, 0);
    for (let i = 0; i <= 8; i += 1) fade.addColorStop(i / 8, ramp(i / 8));
    pen.fillStyle = fade;
    pen.fillRect(bar.left, bar.top, bar.right - bar.left, 10);
    const middle = this.by === "pressure" ? Math.sqrt(low * high) : 0.5 * (low + high);
    write(pen, plain(low), bar.left - 5, bar.top + 5, "text", "right");
    write(pen, `${plain(high)} ${this.by === "pressure" ? "bar" : "°C"}`, bar.right + 5, bar.top + 5, "text", "left");
    write(pen, plain(middle), 0.5 * (bar.left + bar.right), bar.top - 1, "text", "center", "bottom");
  }
}

// From the lower line's to about the upper line's pressure: spikes at the end of a life have the last colour.
function rangeOf(answer, by, values) {
  const [low, high] = extent([values]);
  if (by !== "pressure") return [low, high];
  const lines = answer.levels.map(([value]) => value);
  return lines.length === 2 ? [Math.min(...lines), 1.05 * Math.max(...lines)] : [low, high];
}

function ramp(part) {
  return mixed(VIRIDIS, part);
}

// An arrow whose area is the flow over the largest, against its way where the flow is below zero. On that way it begins
// at a place (0), ends there (-1) or has its middle there.
function arrow(pen, x, y, [dx, dy], flow, tint, shift = -0.5) {
  const size = Math.min(Math.sqrt(Math.abs(flow)), 1.2);
  if (!(size > 0.04)) return;
  const long = 46 * size;
  const wide = 5 + 9 * size;
  pen.save();
  pen.translate(x, y);
  pen.rotate(Math.atan2(dy, dx) + (flow < 0 ? Math.PI : 0));
  pen.translate(long * (flow < 0 ? -1 - shift : shift), 0);
  pen.fillStyle = tint;
  pen.strokeStyle = palette.page;
  pen.lineWidth = 1;
  const [neck, shaft, barb] = [long - 0.6 * wide, 0.22 * wide, 0.6 * wide];
  pen.beginPath();
  for (const [u, v] of [[0, -shaft], [neck, -shaft], [neck, -barb], [long, 0], [neck, barb], [neck, shaft], [0, shaft]]) pen.lineTo(u, v);
  pen.closePath();
  pen.fill();
  pen.stroke();
  pen.restore();
}

function clipHalf(pen, x, radius, lower) {
  pen.beginPath();
  pen.rect(x - radius, lower ? -radius : 0, 2 * radius, radius);
  pen.clip();
}

function fitted(canvas) {
  const ratio = Math.min(window.devicePixelRatio || 1, 2);
  canvas.width = Math.round(canvas.clientWidth * ratio);
  canvas.height = Math.round(canvas.clientHeight * ratio);
}

function cleared(canvas) {
  const pen = canvas.getContext("2d");
  const ratio = canvas.clientWidth ? canvas.width / canvas.clientWidth : 1;
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
  return pen;
}

// Names of the flows through openings at the low-pressure end, and of those at the other: the discharge port's.
function portsOf(answer) {
  if (!answer.ports) {
    const names = Object.keys(answer.traces).filter((name) => name.startsWith("mass_flow_") && !/_(leading|trailing)$/.test(name));
    const upper = names.filter((name) => name.includes("discharge"));
    answer.ports = [names.filter((name) => !upper.includes(name)), upper];
  }
  return answer.ports;
}

function inOrOut(flow) {
  return flow > 0 ? palette.c5 : palette.c3;
}

function leaksOf(answer, side) {
  return Object.keys(answer.traces).filter((name) => name.startsWith("mass_flow_") && name.endsWith(`_${side}`));
}
