// Begin: build, listen, open the line; and what happens when a setting changes.

let data = null;
let figureTable = new Map();
let rests = null; // timer of the hand that rests
let moved = false; // since it rested
const timers = new Map();

const RESTS = 500; // [ms] after which a change has lasted

function later(name, wait, act) {
  if (timers.has(name)) return;
  timers.set(name, setTimeout(() => { timers.delete(name); act(); }, wait));
}

function say(text) {
  document.getElementById("spoken").textContent = text;
}

function complain(text) {
  const fault = document.getElementById("fault");
  fault.hidden = !text;
  if (fault.textContent !== (text || "")) fault.textContent = text || "";
}

function statusIs(kind, words) {
  const status = document.getElementById("status");
  status.className = `status ${kind.replace("_", "-")}`;
  status.textContent = words;
}

// What is compiled behind the page, while the old answer stays.
function busy(text) {
  const box = document.getElementById("busy");
  box.hidden = !text || text.startsWith("compiled");
  if (document.getElementById("note").textContent !== text) document.getElementById("note").textContent = text;
  const last = /the last one took ([\d.]+) s/.exec(text);
  const bar = document.getElementById("progress");
  clearInterval(bar.timer);
  bar.removeAttribute("value");
  if (box.hidden || !last) return;
  const begun = performance.now();
  const whole = 1e3 * Math.max(Number(last[1]), 1);
  bar.timer = setInterval(() => { bar.value = Math.min((performance.now() - begun) / whole, 0.98); }, 100);
}

// A setting has changed: ask at once; when the hand rests, keep the address and look around.
function changed() {
  const when = performance.now();
  if (!moved) {
    moved = true;
    ghost = shown;
  }
  around.id = 0; // derivatives that are under way belong to the settings before
  ask(when);
  clearTimeout(rests);
  rests = setTimeout(rest, RESTS);
}

function rest() {
  if (!isOpen() || sent.size || undrawn) { // the line is not open yet, or not all is answered and drawn
    rests = setTimeout(rest, RESTS);
    return;
  }
  moved = false;
  writeHash();
  remember();
  askAround();
  speak();
}

function speak() {
  if (!shown) return;
  for (const chart of Object.values(charts)) chart.describe();
  const words = headlineNames().slice(0, 4).map((name) => `${aboutOf(name).words} ${headlineText(aboutOf(name), shown.performance[name]).join(" ")}`);
  const fault = document.getElementById("fault");
  say(fault.hidden ? `${document.getElementById("status").textContent}: ${words.join(", ")}` : "");
}

// ---- play -------------------------------------------------------------------------------------------------------

let playing = false;
let lastFrame = 0;

function play(on) {
  playing = on;
  const button = document.getElementById("play");
  button.textContent = on ? "Pause" : "Play";
  button.setAttribute("aria-pressed", String(on));
  lastFrame = 0;
  if (on) requestAnimationFrame(frame);
}

function frame(now) {
  if (!playing) return;
  if (lastFrame && machine.doc) {
    const seconds = Number(document.getElementById("pace").value);
    angleNow = (angleNow + (360 * Math.min(now - lastFrame, 100)) / (1e3 * seconds)) % machine.doc.life;
    moveAngle();
  }
  lastFrame = now;
  requestAnimationFrame(frame);
}

function scrub(angle) {
  play(false);
  angleNow = Math.min(Math.max(angle, 0), machine.doc.life);
  moveAngle();
}

// The angle of the point of the p–V curve that is nearest to a place.
function nearestAngle(chart, x, y) {
  const { angle, volume, pressure } = shown.traces;
  let [best, found] = [Infinity, 0];
  for (let i = 0; i < angle.length; i += 1) {
    const off = (chart.X(volume[i]) - x) ** 2 + (chart.Y(pressure[i]) - y) ** 2;
    if (off < best) [best, found] = [off, angle[i]];
  }
  return found;
}

// ---- begin ------------------------------------------------------------------------------------------------------

function listen() {
  const on = (id, event, act) => document.getElementById(id).addEventListener(event, act);
  on("undo", "click", undo);
  on("pin", "click", pin);
  on("save", "click", save);
  on("play", "click", () => play(!playing));
  on("angle", "input", (event) => scrub(Number(event.target.value)));
  for (const id of ["z", "chambers"]) on(id, "input", moveAngle);
  for (const id of ["log", "compared", "paths", "trace"]) on(id, "change", drawAnswer);
  on("figure", "change", drawSweep);
  on("over", "change", askSweep);
  on("coloured", "change", askColours);
  for (const button of document.querySelectorAll("[data-copy]")) button.addEventListener("click", () => copy(button.dataset.copy));
  for (const form of document.querySelectorAll("[data-make]")) {
    form.action = `make/${form.dataset.make}${location.search}`;
    form.addEventListener("submit", () => { form.settings.value = JSON.stringify(settings); });
  }
  charts.loop.whenDragged((x, y) => shown && scrub(nearestAngle(charts.loop, x, y)));
  for (const name of ["temperatures", "flows", "other"]) charts[name].whenDragged((x) => shown && scrub(charts[name].valueX(x)));
  window.addEventListener("hashchange", () => {
    if (location.hash.slice(1) === own) return;
    put(fromHash());
    fillControls();
    changed();
  });
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { readPalette(); drawAnswer(); });
  new ResizeObserver(([entry]) => {
    document.documentElement.style.setProperty("--under", `${Math.ceil(entry.borderBoxSize[0].blockSize) + 12}px`);
  }).observe(document.querySelector("header"));
}

function begin() {
  data = JSON.parse(document.getElementById("document").textContent);
  figureTable = new Map(data.figures.map((each) => [each.name, each]));
  readPalette();
  charts = {
    loop: new Chart("loop", "Pressure over chamber volume"),
    temperatures: new Chart("temperatures", "Temperatures over the angle"),
    flows: new Chart("flows", "Mass flows into the chamber over the angle"),
    other: new Chart("other", "A further curve over the angle"),
    sweep: new Chart("sweep", "A figure over one setting"),
    waterfall: new Waterfall("waterfall", "Where the shaft power goes"),
  };
  machine = new Machine("side", "section");
  buildControls();
  put(fromHash());
  own = location.hash.slice(1);
  fillControls();
  setMachine(data.machine);
  if (window.innerWidth < 640) document.getElementById("settings").open = false;
  listen();
  rests = setTimeout(rest, RESTS);
  openLine();
  if (!window.matchMedia("(prefers-reduced-motion: reduce)").matches) play(true);
  document.documentElement.dataset.ready = "yes";
}

begin();
