// Data of the page: unpacking, cases and their places on the axes.

async function inflated(id) {
  const stream = new Blob([bytes(document.getElementById(id).textContent)]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).text();
}

function bytes(text) {
  const letters = atob(text);
  const found = new Uint8Array(letters.length); // filled in a loop: a function for each letter takes a quarter of a second
  for (let i = 0; i < letters.length; i += 1) found[i] = letters.charCodeAt(i);
  return found.buffer;
}

function floats(text) {
  return new Float32Array(bytes(text));
}

// A trace of one case in shown units; null where it has no value.
function traceOf(trace, number) {
  if (!trace.read) trace.read = [floats(trace.low), floats(trace.span), new Uint16Array(bytes(trace.steps))];
  const [low, span, steps] = trace.read;
  const points = steps.length / low.length;
  const part = steps.subarray(number * points, (number + 1) * points);
  return Array.from(part, (step) => (step === 65535 ? null : low[number] + (span[number] * step) / 65534));
}

// Places of a case on the axes, the last axis fastest; and the case of places.
function placesOf(number) {
  const places = [];
  for (let i = data.axes.length - 1; i >= 0; i -= 1) {
    places[i] = number % sizeOf(i);
    number = Math.floor(number / sizeOf(i));
  }
  return places;
}

function caseOf(places) {
  return places.reduce((number, place, i) => number * sizeOf(i) + place, 0);
}

function sizeOf(i) {
  return (data.axes[i].values || data.axes[i].texts).length;
}

// One value of an axis, in words.
function inWords(axis, place) {
  if (axis.joined) return `${axis.texts[place]}: ${axis.joined.map((each) => `${each.words} ${inWords(each, place)}`).join(", ")}`;
  if (axis.texts) return axis.texts[place];
  return `${general(axis.values[place], 4)}${axis.unit ? ` ${axis.unit}` : ""}`;
}

function caseWords(number) {
  return placesOf(number).map((place, i) => `${data.axes[i].words} ${inWords(data.axes[i], place)}`).join(", ");
}

function statusOf(number) {
  const status = (data.statuses[data.statusCodes[number]] || "not computed").replace("_", " ");
  return data.warnings[number] ? `${status}, with warnings` : status;
}

function figureNamed(name) {
  return [...data.figures, ...data.columns].find((figure) => figure.name === name);
}

// What varies in a design, as figures of each case: joined quantities, and axes of numbers.
function columnsOf() {
  if (!data.axes.some((axis) => axis.joined)) return [];
  const cases = Array.from(data.statusCodes.keys());
  return data.axes.flatMap((axis, i) => (axis.joined || [axis]).filter((each) => each.values).map((each, k) => ({
    name: `column_${i}_${k}`, label: each.label, unit: each.unit, factor: 1, offset: 0,
    read: cases.map((number) => each.values[placesOf(number)[i]]),
  })));
}

// A figure of one case in the unit in which it is drawn; null where there is none.
function drawnValue(figure, number) {
  const value = figure.read[number];
  if (!Number.isFinite(value) || data.statusCodes[number] === 2) return null;
  return value * figure.factor + figure.offset;
}

function unpack(text) {
  const found = JSON.parse(text);
  found.statusCodes = new Int8Array(bytes(found.status));
  for (const figure of found.figures) {
    figure.read = floats(figure.values);
    figure.error = figure.errors ? floats(figure.errors) : null;
    figure.half = figure.halves ? floats(figure.halves) : null;
  }
  const read = (holder) => Object.keys(holder).forEach((name) => { if (name !== "words") holder[name] = floats(holder[name]); });
  for (const figure of found.inputs ? found.inputs.figures : []) figure.shares = floats(figure.shares);
  if (found.inputs && found.inputs.lost) found.inputs.lost = new Int8Array(bytes(found.inputs.lost));
  read(found.balance);
  for (const part of found.cycle ? [found.cycle, found.cycle.flows] : []) {
    if (part) part.angle = Array.from(floats(part.angle));
  }
  if (found.ledger) [found.ledger.totals, ...found.ledger.entries].forEach(read);
  return found;
}
