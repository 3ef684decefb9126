// What is seen of an answer: figures, charts, the machine; beside it the last settings', pale.

let shown = null; // the last answer that has figures
let ghost = null; // what it is compared with where that is the last settings
let charts = {};
let machine = null;
const HEADLINE = [
  "isothermal_efficiency", "isentropic_efficiency", "volumetric_efficiency", "output_power", "shaft_power", "cooling_capacity", "cop",
  "gas_mass_flow", "discharge_temperature", "specific_power", "oil_ratio",
];
const MOST_HEADLINES = 8;

function aboutOf(name) {
  return figureTable.get(name);
}

function headlineNames() {
  const there = shown ? shown.performance : {};
  return HEADLINE.filter((name) => Number.isFinite(there[name]) && aboutOf(name)).slice(0, MOST_HEADLINES);
}

function compared() {
  const which = document.getElementById("compared").value;
  if (which === "none") return null;
  if (which === "last") return ghost;
  const pinned = pins.find((each) => String(each.number) === which);
  return pinned ? pinned.answer : null;
}

// Take an answer: draw it, or say why there is nothing to draw and leave what there was.
function take(answer) {
  const usable = answer.kind === "solved" && answer.status !== "failed" && answer.traces.angle;
  statusIs(answer.status, answer.status.replace("_", " "));
  complain(answer.status === "ok" ? "" : answer.message);
  markFaults(answer.faults);
  const warned = document.getElementById("warnings");
  warned.textContent = (answer.warnings || []).join("\n");
  warned.hidden = !warned.textContent;
  document.body.classList.toggle("old", !usable);
  if (answer.machine) setMachine(answer.machine);
  if (answer.texts) document.getElementById("shell").textContent = answer.texts.shell;
  if (!usable) return;
  shown = answer;
  showHalves();
  drawAnswer();
}

function setMachine(doc) {
  machine.set(doc);
  const slider = document.getElementById("angle");
  slider.max = String(doc.life);
  angleNow = angleNow === null ? Math.round(0.56 * doc.life) : Math.min(angleNow, doc.life);
  document.getElementById("machine-words").textContent = [
    doc.kind === "rotors" && doc.sketch ? "A sketch, as the scene states volumes and areas by laws, without a profile." : "",
    doc.kind === "rotors" ? "The male rotor is at the top, seen from the high-pressure side. " : "",
    doc.kind === "none" ? "There is no drawing of this kind of machine." : `Arrows: flow through ports (blue in, orange out)${doc.kind === "rotors" ? ` and over the male crests (red, drawn ${LEAKS_LARGER} times larger)` : ""}; their area shows the flow.`,
  ].join(" ");
}

function drawAnswer() {
  if (!shown) return;
  drawHeadline();
  drawLoop();
  drawTemperatures();
  drawFlows();
  drawWaterfall();
  drawOther();
  drawSweep();
  moveAngle();
  later("figures", 150, fillFigures);
}

function drawHeadline() {
  const names = headlineNames();
  const list = document.getElementById("headline");
  if (list.dataset.names !== names.join()) {
    list.dataset.names = names.join();
    list.replaceChildren(...names.map(aboutOf).map(({ words, about }) => made("div", {},
      made("dt", { title: about }, words), made("dd", {}, made("span", {}), " ", made("small", {})), made("dd", { className: "change" }))));
  }
  const other = compared();
  names.forEach((name, i) => {
    const [value, unit] = headlineText(aboutOf(name), shown.performance[name]);
    const [number, small] = list.children[i].querySelectorAll("span, small");
    number.textContent = value;
    small.textContent = unit;
    list.children[i].querySelector(".change").textContent = (other && changeOf(name, other)) || "\u00a0";
  });
}

function headlineText(about, value) {
  if (about.kelvin) return [(value - 273.15).toFixed(1).replace(/^-(?=[0.]+$)/, ""), "°C"];
  const [, factor, unit] = scaleOf(about, value);
  const scaled = value * factor;
  const digits = 3 - Math.floor(Math.log10(Math.abs(scaled) || 1));
  return [digits > 8 || digits < -1 ? general(scaled, 4) : scaled.toFixed(Math.max(digits, 0)), unit];
}

// By how much a figure is another: percents in points, temperatures in K, all else in percent of it.
function changeOf(name, other) {
  const [now, before] = [shown.performance[name], other.performance[name]];
  if (!Number.isFinite(now) || !Number.isFinite(before) || now === before) return "";
  const about = aboutOf(name);
  const signed = (value, unit) => (Math.abs(value) < 5e-3 ? "" : `${value > 0 ? "+" : "−"}${changeText(Math.abs(value))}${unit}`);
  if (about.kelvin) return signed(now - before, " K");
  if (about.scales[0][2] === "%") return signed(100 * (now - before), " points");
  return before === 0 ? "" : signed((100 * (now - before)) / Math.abs(before), " %");
}

function pair(make) {
  const other = compared();
  return [...(other && other.traces ? make(other, true) : []), ...make(shown, false)];
}

function angleAxis(answer) {
  const angle = answer.traces.angle;
  const end = angle[angle.length - 1];
  const step = (end > 400 ? 120 : 60) * (window.innerWidth < 640 ? 2 : 1);
  const ticks = Array.from({ length: Math.floor(end / step + 1e-9) + 1 }, (_, i) => i * step);
  return { label: data.machine.kind === "cylinder" ? "crank angle (°)" : "male-rotor angle (°)", range: [angle[0], end], ticks };
}

// The highest pressure but for a spike over few degrees, as the dead volume's at the end of a life.
function topOf(answer) {
  const sorted = Float32Array.from(answer.traces.pressure).sort();
  const usual = Math.max(sorted[Math.floor(0.97 * (sorted.length - 1))], ...answer.levels.map(([value]) => value));
  const peak = sorted[sorted.length - 1];
  return peak > 1.6 * usual ? 1.25 * usual : 1.06 * Math.max(peak, usual);
}

function drawLoop() {
  const isLog = document.getElementById("log").checked;
  const answers = [shown, compared()].filter((each) => each && each.traces);
  const top = Math.max(...answers.map(topOf));
  const widest = Math.max(...answers.map((each) => extent([each.traces.volume])[1]));
  const least = Math.min(...answers.map((each) => extent([each.traces.pressure])[0]));
  charts.loop.show({
    curves: pair((answer, pale) => [{ x: answer.traces.volume, y: answer.traces.pressure, tint: "c1", name: "pressure", pale }]),
    x: { label: "chamber volume (cm³)", log: isLog, range: isLog ? [0.02 * widest, 1.05 * widest] : [0, 1.05 * widest] },
    y: { label: "pressure (bar)", log: isLog, range: isLog ? [0.9 * least, 1.15 * top] : [0, top] },
    levels: shown.levels,
  });
}

// Draw curves over the angle, [trace, words, tint, dash] each; `seen` gives the values of a curve that must be in sight.
function drawOverAngle(chart, traces, label, seen = (curve) => curve.y) {
  const there = traces.filter(([name]) => shown.traces[name]);
  const curves = pair((answer, pale) => there.filter(([name]) => answer.traces[name])
    .map(([name, words, tint, dash]) => ({ x: answer.traces.angle, y: answer.traces[name], tint, dash, name: words, pale })));
  chart.show({ curves, x: angleAxis(shown), y: { label, range: roomy(extent(curves.map(seen))) } });
}

function drawTemperatures() {
  const traces = [["gas_temperature", "gas", "c1", 0], ["oil_temperature", "oil", "c3", 1]];
  drawOverAngle(charts.temperatures, traces, "temperature (°C)", whileThereIsGas);
}

// Temperatures but for those of next to nothing: what is left in the dead volume is heated and cooled far.
function whileThereIsGas(curve) {
  const { volume } = (curve.pale ? compared() : shown).traces;
  const most = extent([volume])[1];
  return curve.y.filter((_, i) => volume[i] > 0.03 * most);
}

function roomy([low, high]) {
  if (!(high > low)) return Number.isFinite(low) ? [low - 1, low + 1] : [0, 1];
  return [low - 0.05 * (high - low), high + 0.08 * (high - low)];
}

function pathsOf(answer) {
  const which = document.getElementById("paths").value;
  const names = Object.keys(answer.traces).filter((name) => name.startsWith("mass_flow_"));
  const isGap = (name) => /_(leading|trailing)$/.test(name);
  const chosen = names.filter((name) => which === "all" || isGap(name) === (which === "gaps"));
  return chosen.length ? chosen : names;
}

function drawFlows() {
  const words = (name) => name.replace("mass_flow_", "").replace(/_(leading|trailing)$/, ", $1").replaceAll("_", " ");
  const names = pathsOf(shown);
  const kindOf = (name) => words(name).split(",")[0];
  const kinds = [...new Set(names.map(kindOf))];
  const traces = names.map((name) => [name, words(name), `c${kinds.indexOf(kindOf(name)) % 6}`, name.endsWith("_trailing") ? 1 : 0]);
  drawOverAngle(charts.flows, traces, "mass flow (g/s)");
}

// Curves that only some scenes have: torque, valve lifts, temperatures of walls …
function drawOther() {
  const known = new Set(["angle", "volume", "pressure", "gas_temperature", "oil_temperature"]);
  const names = Object.keys(shown.traces).filter((name) => !known.has(name) && !name.startsWith("mass_flow_"));
  const section = document.getElementById("more");
  section.hidden = !names.length;
  if (!names.length) return;
  const select = document.getElementById("trace");
  const usual = names.find((name) => name.includes("torque"));
  refill(select, names.map((name) => [name, name.replaceAll("_", " ")]), usual || names[0], usual);
  const name = select.value;
  const units = shown.units[name].replace("N m", "N m").replace("kg s-1", "g/s");
  drawOverAngle(charts.other, [[name, name.replaceAll("_", " "), "c4", 0]], units === "1" ? "" : `(${units})`);
}

function drawWaterfall() {
  const rows = shown.ledger && spent(shown.ledger) > 0 ? waterfallSteps(shown.ledger).length : 0;
  charts.waterfall.box.style.height = rows > 13 ? `${1.2 * rows + 0.5}rem` : "";
  charts.waterfall.show(shown.ledger && spent(shown.ledger) > 0 ? { ledger: shown.ledger, other: (compared() || {}).ledger } : null);
}

// The waterfall draws bars where a chart draws curves.
class Waterfall extends Chart {
  draw() {
    const { content, width, height } = this;
    const pen = this.below.getContext("2d");
    pen.clearRect(0, 0, width, height);
    if (!content || width < 50) return;
    const steps = waterfallSteps(content.ledger);
    const whole = spent(content.ledger);
    const before = content.other && spent(content.other) > 0 ? waterfallSteps(content.other) : [];
    const scale = Math.max(whole, ...before.map((step) => step.power), 1e-9);
    const unit = scale >= 1e3 ? [1e-3, "kW"] : [1, "W"];
    const left = Math.min(0.46 * width, 190);
    const row = Math.min((height - 6) / steps.length, 26);
    pen.font = FONT;
    const told = (step) => `${plain(step.power * unit[0])} ${unit[1]}, ${((100 * step.power) / whole).toFixed(1)} %`;
    const room = 8 + Math.max(...steps.map((step) => pen.measureText(told(step)).width)); // behind the longest bar
    const X = (power) => left + ((width - left - room) * power) / scale;
    steps.forEach((step, i) => {
      const { start } = step;
      const y = 4 + i * row;
      const old = before.find((each) => each.words === step.words);
      if (old) { pen.fillStyle = palette.line; pen.fillRect(X(start), y + row - 7, X(start + old.power) - X(start), 4); }
      pen.fillStyle = palette[step.tint];
      pen.fillRect(X(Math.min(start, start + step.power)), y + 2, Math.max(X(Math.abs(step.power)) - left, 1), row - 10);
      write(pen, step.words, left - 8, y + 0.4 * row, "text", "right", "middle", left - 12);
      write(pen, told(step), X(Math.max(start, start + step.power)) + 5, y + 0.4 * row, "text", "left");
    });
    this.below.setAttribute("aria-label", `${this.words}: ${steps.map((step) => `${step.words} ${plain(step.power * unit[0])} ${unit[1]}`).join(", ")}`);
  }

  move() {}
}

function fillFigures() {
  if (!shown) return;
  const other = compared();
  const names = Object.keys(shown.performance).filter((name) => Number.isFinite(shown.performance[name]) && aboutOf(name));
  const rows = names.map((name) => {
    const [value, unit] = written(aboutOf(name), shown.performance[name]);
    const half = halves ? [[halfOf(name), "n"]] : [];
    const row = tableRow(aboutOf(name).words, [[value, "n"], ...half, [unit, ""], [other ? changeOf(name, other) : "", "n"], [small(shown.error[name] ?? NaN), "n"]]);
    row.firstChild.title = aboutOf(name).about;
    return row;
  });
  document.querySelector("#figures tbody").replaceChildren(...rows);
  const found = residuals(["mass", "energy", "entropy"], (name) => shown.balance[name]);
  document.getElementById("balance").textContent = `Residuals: ${found} (bound ${small(shown.balance.bound)}).`;
}

// What the tolerances of the inputs make of the figures; found with the derivatives, when the hand rests.
let halves = null;

function showHalves(found = {}, lost = []) {
  if (!halves && !Object.keys(found).length) return;
  halves = Object.keys(found).length ? found : null;
  document.getElementById("by-inputs").hidden = !halves;
  const without = lost.length ? ` Without ${lost.join(", ")}: no derivative here.` : "";
  document.getElementById("by-inputs-words").textContent = halves ? `by inputs: half of the 95 % interval, linear, from the tolerances of the inputs alone; the model error is separate.${without}` : "";
  fillFigures();
}

function halfOf(name) {
  const value = shown.performance[name];
  return halves[name] <= 1e-6 * Math.abs(value) ? "" : halfText(aboutOf(name), value, halves[name]);
}

// ---- the angle --------------------------------------------------------------------------------------------------

let angleNow = null;

function moveAngle() {
  if (!shown || !machine.doc) return;
  const { angle, volume, pressure, gas_temperature: T } = shown.traces;
  const at = (values) => interpolated(angle, values, angleNow);
  const points = machine.lives(angleNow).map((life, i) => [interpolated(angle, volume, life), interpolated(angle, pressure, life), i ? 3 : 6, i ? "soft" : "accent"]);
  charts.loop.move({ points: points.reverse(), words: `${Math.round(angleNow)}°: ${plain(at(pressure))} bar, ${plain(at(volume))} cm³` });
  charts.temperatures.move({ x: angleNow, words: `${plain(at(T))} °C` });
  charts.flows.move({ x: angleNow });
  if (charts.other.content) charts.other.move({ x: angleNow, words: plain(at(shown.traces[document.getElementById("trace").value] || volume)) });
  const slider = document.getElementById("angle");
  slider.value = String(angleNow);
  slider.setAttribute("aria-valuetext", `${Math.round(angleNow)} degrees, ${plain(at(pressure))} bar`);
  document.getElementById("angle-text").textContent = `${Math.round(angleNow)}°`;
  machine.show(shown, angleNow, document.getElementById("chambers").value, Number(document.getElementById("z").value));
}
