// Points beside the settings: a small sweep as a curve, and what each slider does, as the colour of its track.

const COUNT = 21; // of a small sweep
const STEP = 0.03; // of a slider's travel: how far what it does is looked at
const SLOW = 250; // [ms] from point to point of the small sweep, beyond which sliders are not coloured
const FULL_TINT = 0.15; // of a figure over the whole travel: from here on the track has its full colour

let sweep = { id: 0, x: [], y: [], before: null };
let around = { id: 0, entries: [], values: [], left: -1 }; // left: points without an answer yet

function fillSweepChoices() {
  const [figure, over, coloured] = ["figure", "over", "coloured"].map((id) => document.getElementById(id));
  const names = Object.keys(shown.performance).filter((name) => Number.isFinite(shown.performance[name]) && aboutOf(name));
  const live = liveNumbers().map(({ control, effect }) => [control.path, `${effect ? `${effect.words}: ` : ""}${control.words}`]);
  refill(figure, names.map((name) => [name, aboutOf(name).words]), headlineNames()[0]);
  refill(over, live, "oil_supply.ratio");
  refill(coloured, [["", "nothing"], ...names.map((name) => [name, aboutOf(name).words])], headlineNames()[0]);
}

// Fill a select; `first` is chosen at first, `otherwise` where what was chosen is not there any more.
function refill(select, entries, first, otherwise) {
  const text = entries.map(([value]) => value).join();
  if (select.dataset.entries === text) return;
  const before = select.dataset.entries === undefined ? select.value || first : select.value;
  select.dataset.entries = text;
  select.replaceChildren(...entries.map(([value, words]) => new Option(words, value)));
  const values = entries.map(([value]) => value);
  select.value = values.includes(before) ? before : otherwise ?? values[0] ?? "";
}

// Ask for the curve and the colours, when the hand rests.
function askAround() {
  if (!shown) return;
  fillSweepChoices();
  askSweep();
}

function askSweep() {
  const control = controlOf(document.getElementById("over").value);
  if (!control) return;
  const { low, high, log } = control;
  let x = Array.from({ length: COUNT }, (_, i) => between([low, high], log, i / (COUNT - 1)));
  if (control.kind === "count") x = [...new Set(x.map(Math.round))];
  const before = sweep.control === control ? sweep : null;
  sweep = { control, x, all: x.map(() => ({})), begun: performance.now(), before: before && { x: before.x, all: before.all } };
  sweep.id = askBeside("curve", x.map((value) => [control.path, asSet(control, value)]));
  drawSweep();
}

// When the small sweep has shown that points cost little: by derivatives where the server has a worker for them.
function askColours() {
  for (const entry of built) {
    entry.slopes = undefined;
    if (entry.range) bare(entry);
  }
  showHalves();
  around = { id: 0, entries: [], values: [], left: 0 };
  if (!document.getElementById("coloured").value || !(sweep.pace <= SLOW)) return; // no pace yet: at the sweep's end
  const entries = liveNumbers().filter(({ control }) => control.kind === "number");
  if (data.slopes) around = { id: askBeside("slopes"), entries, values: [], left: 1 };
  else askDifferences(entries);
}

function askDifferences(entries) {
  const points = entries.flatMap(({ control }) => {
    const place = placeOf(control, numberNow(control)) / STEPS;
    return [Math.max(place - STEP, 0), Math.min(place + STEP, 1)].map((share) => [control.path, asSet(control, valueAt(control, STEPS * share))]);
  });
  around = { entries, values: points.map(() => null), left: points.length };
  around.id = askBeside("around", points.slice(0, 200));
}

// Numbers without a derivative, as of a cycle that cannot be linearised, are looked at by differences.
function receiveSlopes(head) {
  if (head.id !== around.id) return;
  const slopes = head.slopes || {};
  showHalves(head.halves, head.lost);
  for (const entry of around.entries) entry.slopes = slopes[entry.control.path];
  const bare = around.entries.filter((entry) => !entry.slopes);
  around.left = 0;
  colourAll();
  if (bare.length) askDifferences(bare);
}

// Over its whole way, relative to the figure, by the slope at this point.
function colourAll() {
  const name = document.getElementById("coloured").value;
  for (const { control, slopes, range } of built.filter((each) => each.slopes)) {
    const way = control.size * (control.log ? numberNow(control) * Math.log(control.high / control.low) : control.high - control.low);
    colourTrack({ range }, name, (slopes[name] * way) / Math.abs(shown.performance[name]), "");
  }
}

function receivePoint(head) {
  if (head.lane === "curve" && head.id === sweep.id) {
    sweep.all[head.index] = head.status === "ok" ? head.performance : {};
    later("sweep", 30, drawSweep);
    if (head.index === sweep.x.length - 1) {
      sweep.pace = (performance.now() - sweep.begun) / sweep.x.length;
      askColours();
    }
  } else if (head.lane === "around" && head.id === around.id) {
    around.values[head.index] = head.status === "ok" ? head.performance : null;
    around.left -= 1;
    if (head.index % 2) colourByDifference(head.index >> 1);
  }
}

function colourByDifference(index) {
  const entry = around.entries[index];
  const [low, high] = [around.values[2 * index], around.values[2 * index + 1]];
  const name = document.getElementById("coloured").value;
  const [a, b, now] = [low, high, shown.performance].map((each) => (each ? each[name] : NaN));
  if (entry) colourTrack(entry, name, (b - a) / (2 * STEP) / Math.abs(now), ", by a difference");
}

// effect: the change of the figure over the slider's whole way, relative, as if it went on as here.
function colourTrack(entry, name, effect, how) {
  if (!Number.isFinite(effect)) {
    bare(entry);
    return;
  }
  const strong = Math.min(Math.abs(effect) / FULL_TINT, 1);
  const tint = (part) => `color-mix(in srgb, var(--${part}) ${Math.round(100 * strong)}%, var(--line))`;
  const [from, to] = effect > 0 ? [tint("c3"), tint("c4")] : [tint("c4"), tint("c3")];
  entry.range.style.setProperty("--track", `linear-gradient(to right, ${from}, ${to})`);
  const words = `moving it to the right ${effect > 0 ? "raises" : "lowers"} ${aboutOf(name).words}: ${changeText(Math.abs(effect) * 100)} % over the full range, by the slope here${how}`;
  entry.range.title = words;
  entry.range.setAttribute("aria-description", words);
}

function bare(entry) {
  entry.range.style.removeProperty("--track");
  entry.range.removeAttribute("aria-description");
  entry.range.title = "";
}

function drawSweep() {
  if (!sweep.control || !shown) return;
  const name = document.getElementById("figure").value;
  const about = aboutOf(name);
  if (!about) return;
  const values = (all) => all.map((each) => (Number.isFinite(each[name]) ? each[name] : NaN));
  const drawn = [sweep.before, sweep].filter((each) => each).map((each) => ({ x: each.x, y: values(each.all), pale: each !== sweep }));
  const now = shown.performance[name];
  const finite = drawn.flatMap((each) => each.y).concat([now]).filter(Number.isFinite);
  if (!finite.length) return;
  const [, factor, unit] = about.kelvin ? [0, 1, "°C"] : scaleOf(about, Math.max(...finite.map(Math.abs)));
  const shift = about.kelvin ? -273.15 : 0;
  const { control } = sweep;
  charts.sweep.show({
    curves: drawn.map((each) => ({ ...each, y: each.y.map((value) => value * factor + shift), tint: "c2", points: !each.pale })),
    x: { label: `${control.words}${control.unit ? ` (${unitWords(control.unit)})` : ""}`, range: [control.low, control.high], log: control.log },
    y: { label: `${about.words}${unit ? ` (${unit})` : ""}`, range: roomy(extent([finite.map((value) => value * factor + shift)])) },
  });
  const here = numberNow(control);
  charts.sweep.move({ points: here === null ? [] : [[here, now * factor + shift, 5, "accent"]] });
}
