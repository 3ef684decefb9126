// The chosen figure over the axes of the sweep: curves or a map, through the case that is picked.

const MOST_CURVES = 12;
const MOST_POINTS = 3000; // of one drawing: a browser stays quick
const HAS_OPTIMUM = /(_efficiency|^cop)$/;
const ARC = 31; // points that draw the parabola of an optimum
const FINE = 41; // places along an axis of a map: straight lines between few values make corners
const choice = {};

function numericAxes(least) {
  return data.axes.map((axis, i) => i).filter((i) => data.axes[i].values && sizeOf(i) >= least);
}

// Axes of words, as of fluids: a curve over one of them is points without lines.
function wordAxes() {
  return data.axes.map((axis, i) => i).filter((i) => data.axes[i].texts && !data.axes[i].joined && sizeOf(i) > 1);
}

function overWords() {
  return !choice.xFigure && Boolean(data.axes[choice.along].texts);
}

function placesAlong(i) {
  return data.axes[i].values || data.axes[i].texts;
}

function fillControls() {
  const { start } = data;
  const [figure, over, curves, view] = ["figure", "over", "curves", "view"].map((id) => document.getElementById(id));
  const design = data.columns.length > 0;
  const named = (figures) => figures.map(({ label, name }) => new Option(label, name));
  const ofAxes = (axes) => axes.map((i) => new Option(data.axes[i].label, String(i)));
  const all = [...data.columns, ...data.figures];
  figure.append(...named(data.figures));
  over.append(...(design ? [] : ofAxes([...numericAxes(2), ...wordAxes()])), ...named(all));
  curves.append(new Option("nothing", ""), ...(design ? named(all) : ofAxes([...data.axes.keys()].filter((i) => sizeOf(i) > 1))));
  figure.value = start.figure || data.figures[0].name;
  over.value = start.x === null ? (data.columns[0] || data.figures[0]).name : String(start.x);
  curves.value = start.curves === null ? (data.columns[1] || { name: "" }).name : String(start.curves);
  document.getElementById("curves-word").textContent = design ? "coloured by" : "curves by";
  view.closest("label").hidden = design || numericAxes(3).length < 2;
  for (const select of [figure, over, curves, view]) select.addEventListener("change", drawOverview);
}

function readControls() {
  for (const id of ["figure", "over", "curves", "view"]) choice[id] = document.getElementById(id).value;
  choice.figure = figureNamed(choice.figure);
  choice.xFigure = figureNamed(choice.over) || null;
  choice.tint = data.columns.length ? figureNamed(choice.curves) || null : null;
  choice.by = choice.curves === "" || data.columns.length ? null : Number(choice.curves);
  choice.along = choice.xFigure ? longestAxis(choice.by) : Number(choice.over);
  if (choice.by === choice.along) choice.by = null;
}

function longestAxis(but) {
  const axes = data.axes.map((axis, i) => i).filter((i) => i !== but);
  return axes.reduce((best, i) => (sizeOf(i) > sizeOf(best) ? i : best), axes.length ? axes[0] : 0);
}

// Cases along an axis, through the picked case, at one place of the axis that tells the curves apart.
function casesAlong(along, by, place) {
  const places = placesOf(picked);
  if (by !== null) places[by] = place;
  return Array.from({ length: sizeOf(along) }, (_, k) => caseOf(places.map((p, i) => (i === along ? k : p))));
}

function curveAt(place) {
  const cases = casesAlong(choice.along, choice.by, place);
  const points = cases.map((number, k) => ({
    number,
    x: choice.xFigure ? drawnValue(choice.xFigure, number) : placesAlong(choice.along)[k],
    y: drawnValue(choice.figure, number),
  }));
  const there = points.filter((point) => point.x !== null && point.y !== null);
  return choice.xFigure || overWords() ? there : there.sort((a, b) => a.x - b.x);
}

function curvePlaces() {
  if (choice.by === null) return [0];
  const count = sizeOf(choice.by);
  const stride = Math.ceil(count / MOST_CURVES);
  const mine = placesOf(picked)[choice.by];
  return Array.from({ length: count }, (_, i) => i).filter((i) => i % stride === mine % stride);
}

// The top of a curve: a parabola in ln x through the highest point and its neighbours, with its course between them;
// null unless it is inside.
function optimumOf(points) {
  const sorted = [...points].sort((a, b) => a.x - b.x);
  const best = sorted.reduce((top, point, i) => (point.y > sorted[top].y ? i : top), 0);
  if (best === 0 || best === sorted.length - 1) return null;
  const near = sorted.slice(best - 1, best + 2);
  const log = near.every((point) => point.x > 0);
  const u = near.map((point) => (log ? Math.log(point.x) : point.x));
  const v = near.map((point) => point.y);
  if (u[1] <= u[0] || u[2] <= u[1]) return null;
  const [left, right] = [(v[1] - v[0]) / (u[1] - u[0]), (v[2] - v[1]) / (u[2] - u[1])];
  const curvature = (right - left) / (u[2] - u[0]);
  if (curvature >= 0) return { ...near[1], arc: near };
  const slope = (left * (u[2] - u[1]) + right * (u[1] - u[0])) / (u[2] - u[0]);
  const step = -slope / (2 * curvature);
  const at = (way) => ({ x: log ? Math.exp(u[1] + way) : u[1] + way, y: v[1] + slope * way + curvature * way * way });
  return { ...at(step), arc: Array.from({ length: ARC }, (_, i) => at(u[0] - u[1] + ((u[2] - u[0]) * i) / (ARC - 1))) };
}

function drawOverview() {
  readControls();
  const map = choice.view === "map" && mapAxes();
  const notes = [];
  const [traces, look] = data.columns.length ? pointsDrawing(notes) : map ? mapDrawing(...map, notes) : curvesDrawing(notes);
  const target = document.getElementById("overview");
  for (const id of ["over", "curves"]) document.getElementById(id).disabled = Boolean(map);
  document.getElementById("overview-note").textContent = notes.join(" ");
  Plotly.react(target, [...traces, pickedMark(map)], layout(look), CONFIG);
  if (!target.listening) {
    target.on("plotly_click", (event) => pickPoint(event.points));
    target.listening = true;
  }
}

function pickPoint(points) {
  const point = points.find((each) => Number.isInteger(each.customdata));
  if (point) pick(point.customdata);
}

function curvesDrawing(notes) {
  const places = curvePlaces();
  const traces = [];
  const optima = [];
  const marked = !overWords() && data.axes[choice.along].chosen && HAS_OPTIMUM.test(choice.figure.name);
  places.forEach((place, i) => {
    const points = curveAt(place);
    const name = choice.by === null ? "" : nameOf(choice.by, place);
    traces.push(curveTrace(points, name, ordered(i, places.length), DASHES[i % DASHES.length]));
    if (overWords()) Object.assign(traces.at(-1), { mode: "markers" });
    const best = marked && points.length > 2 ? optimumOf(points) : null;
    if (best) optima.push({ ...best, tint: ordered(i, places.length) });
  });
  if (optima.length) {
    notes.push("○ top of a parabola (thin) through three points.");
    traces.push(...optima.map(({ arc, tint }) => scatter("lines", arc, { hoverinfo: "skip", showlegend: false, line: { color: tint, width: 1 } })));
    traces.push(scatter("markers", optima, {
      name: "optimum",
      hovertemplate: "optimum: %{x:.3~g}, %{y:.4~g}<extra></extra>",
      marker: { symbol: "circle-open", size: 12, color: colour("text"), line: { width: 2 } },
    }));
  }
  const bands = overWords() ? [] : traces.slice(0, places.length).map(bandTrace).filter((band) => band);
  if (bands.length) notes.push("Band: 95 % interval from the tolerances of the inputs alone.");
  const all = traces.flatMap((trace) => trace.x);
  const xLog = choice.xFigure ? isLog(all) : data.axes[choice.along].log;
  const xTitle = choice.xFigure ? choice.xFigure.label : data.axes[choice.along].label;
  if (choice.by !== null && places.length < sizeOf(choice.by)) notes.push(`${places.length} of ${sizeOf(choice.by)} curves are drawn.`);
  fixedWords(notes, [choice.along, choice.by]);
  leftOut(notes, places.length * sizeOf(choice.along), traces.slice(0, places.length));
  return [[...bands, ...traces], {
    xaxis: overWords() ? categories(xTitle) : axisLook(xTitle, xLog),
    yaxis: axisLook(choice.figure.label, false),
    showlegend: choice.by !== null,
    legend: { ...below(), title: { text: choice.by === null ? "" : data.axes[choice.by].label, side: "top" } },
  }];
}

// The look of an axis of words, all of them in their order.
function categories(title) {
  return { ...axisLook(title, false), type: "category", categoryorder: "array", categoryarray: placesAlong(choice.along) };
}

// The name of a curve below the heading that has the unit.
function nameOf(i, place) {
  return data.axes[i].texts ? data.axes[i].texts[place] : general(data.axes[i].values[place], 4);
}

function curveTrace(points, name, tint, dash) {
  return scatter("lines+markers", points, {
    name,
    customdata: points.map((point) => point.number),
    text: points.map((point) => caseWords(point.number)),
    hovertemplate: `%{text}<br>%{y:.5~g} ${choice.figure.unit}<extra></extra>`,
    line: { color: tint, dash, width: 2 },
    marker: { color: tint, size: points.map((p) => (data.warnings[p.number] ? 10 : 6)), symbol: points.map((p) => symbolOf(p.number)) },
  });
}

// The area between the ends of the interval that the inputs' tolerances make of a curve; null without one.
function bandTrace(curve) {
  const half = choice.figure.half && curve.customdata.map((number) => choice.figure.half[number] * choice.figure.factor);
  const there = half ? half.map((each, i) => i).filter((i) => Number.isFinite(half[i])) : [];
  if (there.length < 2) return null;
  const [upper, lower] = [1, -1].map((sign) => there.map((i) => ({ x: curve.x[i], y: curve.y[i] + sign * half[i] })));
  return scatter("lines", [...upper, ...lower.reverse()], {
    fill: "toself", fillcolor: faded(curve.line.color), line: { width: 0 }, hoverinfo: "skip", showlegend: false,
  });
}

// A colour, #rrggbb or rgb(…), through which others are seen.
function faded(tint) {
  const parts = tint.startsWith("#") ? [1, 3, 5].map((i) => parseInt(tint.slice(i, i + 2), 16)) : tint.match(/\d+/g).slice(0, 3);
  return `rgba(${parts.join(",")},0.16)`;
}

function symbolOf(number) {
  if (data.statusCodes[number] !== 0) return "x";
  return data.warnings[number] ? "triangle-up" : "circle";
}

// A point a case of a design, coloured by another quantity.
function pointsDrawing(notes) {
  const cases = thinned(Array.from(data.statusCodes.keys()), notes);
  const points = cases.map((number) => ({ number, x: drawnValue(choice.xFigure, number), y: drawnValue(choice.figure, number) }))
    .filter((point) => point.x !== null && point.y !== null);
  const trace = { ...curveTrace(points, "cases", colour("c1"), "solid"), mode: "markers" };
  if (choice.tint) {
    trace.marker = {
      ...trace.marker,
      size: 8,
      color: points.map((point) => drawnValue(choice.tint, point.number)),
      ...colourScale(choice.tint),
      line: { color: colour("soft"), width: 0.5 },
    };
  }
  leftOut(notes, cases.length, [trace]);
  return [[trace], {
    xaxis: axisLook(choice.xFigure.label, isLog(trace.x)), yaxis: axisLook(choice.figure.label, false), showlegend: false,
  }];
}

// Which axes span the map: the chosen one and that of the curves, else the first two of numbers.
function mapAxes() {
  const able = numericAxes(3);
  const wanted = [choice.xFigure ? null : choice.along, choice.by].filter((i) => able.includes(i));
  const pair = [...new Set([...wanted, ...able])].slice(0, 2);
  return pair.length === 2 ? pair : null;
}

function mapDrawing(across, up, notes) {
  const [x, y] = [data.axes[across], data.axes[up]];
  const rows = y.values.map((_, row) => casesAlong(across, up, row));
  const z = rows.map((row) => row.map((number) => drawnValue(choice.figure, number)));
  const dots = thinned(rows.flat().filter((number) => drawnValue(choice.figure, number) !== null), notes);
  fixedWords(notes, [across, up]);
  const contours = {
    type: "contour",
    ...refined(x, y, z),
    ...colourScale(choice.figure),
    ncontours: 18,
    line: { color: "rgba(0,0,0,0.55)", width: 0.7 },
    hoverinfo: "skip",
  };
  const placed = dots.map(placesOf).map((places) => ({ x: x.values[places[across]], y: y.values[places[up]] }));
  const points = scatter("markers", placed, {
    customdata: dots,
    text: dots.map((number) => `${caseWords(number)}<br>${general(drawnValue(choice.figure, number), 5)} ${choice.figure.unit}`),
    hovertemplate: "%{text}<extra></extra>",
    marker: { size: 6, color: "rgba(255,255,255,0.75)", line: { color: "rgba(0,0,0,0.8)", width: 0.7 } },
    showlegend: false,
  });
  choice.map = [across, up];
  return [[contours, points], {
    xaxis: axisLook(x.label, x.log), yaxis: axisLook(y.label, y.log), showlegend: false,
  }];
}

// A map on more places, by cubic splines along both axes; one with gaps or with many values stays as it is.
function refined(x, y, z) {
  if (z.some((row) => row.some((value) => value === null)) || Math.max(x.values.length, y.values.length) > FINE) return { x: x.values, y: y.values, z };
  const [across, up] = [x, y].map((axis) => {
    const u = axis.values.map((value, i) => [axis.log ? Math.log(value) : value, i]).sort((a, b) => a[0] - b[0]);
    const from = u.map(([value]) => value);
    const places = Array.from({ length: FINE }, (_, k) => from[0] + ((from.at(-1) - from[0]) * k) / (FINE - 1));
    return { from, order: u.map(([, i]) => i), places, values: places.map((place) => (axis.log ? Math.exp(place) : place)) };
  });
  const rows = up.order.map((i) => splined(across.from, across.order.map((j) => z[i][j]), across.places));
  const columns = across.places.map((_, j) => splined(up.from, rows.map((row) => row[j]), up.places));
  return { x: across.values, y: up.values, z: up.places.map((_, i) => columns.map((column) => column[i])) };
}

// The natural cubic spline through (x, y) at some places.
function splined(x, y, places) {
  const n = x.length;
  const [bend, slack] = [new Array(n).fill(0), new Array(n).fill(0)];
  for (let i = 1; i < n - 1; i += 1) {
    const share = (x[i] - x[i - 1]) / (x[i + 1] - x[i - 1]);
    const pivot = share * bend[i - 1] + 2;
    const rise = (y[i + 1] - y[i]) / (x[i + 1] - x[i]) - (y[i] - y[i - 1]) / (x[i] - x[i - 1]);
    bend[i] = (share - 1) / pivot;
    slack[i] = ((6 * rise) / (x[i + 1] - x[i - 1]) - share * slack[i - 1]) / pivot;
  }
  for (let i = n - 2; i > 0; i -= 1) slack[i] += bend[i] * slack[i + 1];
  return places.map((place) => {
    const i = Math.min(Math.max(x.findIndex((each) => each >= place), 1), n - 1);
    const step = x[i] - x[i - 1];
    const [a, b] = [(x[i] - place) / step, (place - x[i - 1]) / step];
    return a * y[i - 1] + b * y[i] + (((a ** 3 - a) * slack[i - 1] + (b ** 3 - b) * slack[i]) * step ** 2) / 6;
  });
}

function thinned(cases, notes) {
  const stride = Math.ceil(cases.length / MOST_POINTS);
  if (stride < 2) return cases;
  notes.push(`One in ${stride} of ${cases.length} points is drawn; the selection below has all.`);
  return cases.filter((_, i) => i % stride === 0);
}

function fixedWords(notes, shown) {
  const places = placesOf(picked);
  const fixed = data.axes.map((axis, i) => i).filter((i) => !shown.includes(i) && sizeOf(i) > 1);
  if (fixed.length) notes.push(`At ${fixed.map((i) => `${data.axes[i].words} ${inWords(data.axes[i], places[i])}`).join(", ")}, as selected below.`);
}

function leftOut(notes, wanted, traces) {
  const missing = wanted - traces.reduce((sum, trace) => sum + trace.x.length, 0);
  if (missing) notes.push(`${missing} of ${wanted} cases have no value here.`);
  for (const [marker, words] of [["x", "× not closed"], ["triangle-up", "△ with warnings"]]) {
    const count = traces.flatMap((trace) => trace.marker.symbol).filter((symbol) => symbol === marker).length;
    if (count) notes.push(`${words} (${count}).`);
  }
}

function pickedMark(map) {
  const places = placesOf(picked);
  const x = map ? data.axes[map[0]].values[places[map[0]]]
    : choice.xFigure ? drawnValue(choice.xFigure, picked) : placesAlong(choice.along)[places[choice.along]];
  const y = map ? data.axes[map[1]].values[places[map[1]]] : drawnValue(choice.figure, picked);
  return scatter("markers", [{ x, y }], {
    name: "picked", hoverinfo: "skip", marker: { symbol: "diamond", size: 12, color: colour("c3"), line: { color: colour("page"), width: 1.5 } },
  });
}
