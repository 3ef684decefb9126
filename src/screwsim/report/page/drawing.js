// Look of the drawings: colours of the page's theme, axes, curves told apart without colour.

const INFERNO = ["#000004", "#1b0c41", "#4a0c6b", "#781c6d", "#a52c60", "#cf4446", "#ed6925", "#fb9b06", "#f7d13d", "#fcffa4"];
const OWN = 6; // colours of the theme
const DASHES = ["solid", "dash", "dashdot", "dot", "longdash", "longdashdot"];
const CONFIG = {
  responsive: true,
  displaylogo: false,
  modeBarButtons: [["toImage"], ["zoom2d", "pan2d"], ["zoomIn2d", "zoomOut2d", "resetScale2d"]],
};

// Colour of one of several ordered curves: those of the theme as long as they last, then a scale of even lightness; the
// ends that the page's own colour would swallow are left out.
function ordered(index, count) {
  if (count < 2) return colour("c1");
  if (count <= OWN) return colour(`c${index}`);
  return mixed(INFERNO, (isDark() ? 0.3 : 0.05) + ((isDark() ? 0.69 : 0.75) * index) / (count - 1));
}

// What Plotly draws of points {x, y}.
function scatter(mode, points, more) {
  return { type: "scatter", mode, x: points.map(({ x }) => x), y: points.map(({ y }) => y), ...more };
}

// The colours of a figure's values, and the bar that tells them.
function colourScale(figure) {
  return {
    colorscale: VIRIDIS.map((tint, i) => [i / (VIRIDIS.length - 1), tint]),
    colorbar: { title: { text: figure.label, side: "right" }, thickness: 14 },
  };
}

function isLog(values) {
  const there = values.filter((value) => value !== null);
  return there.length > 1 && Math.min(...there) > 0 && Math.max(...there) > 8 * Math.min(...there);
}

function axisLook(title, log) {
  const look = {
    title: { text: title, standoff: 8 },
    type: log ? "log" : "linear",
    color: colour("text"),
    gridcolor: colour("line"),
    zerolinecolor: colour("line"),
    linecolor: colour("soft"),
    ticks: "outside",
    tickcolor: colour("soft"),
    automargin: true,
    hoverformat: ".5~g",
    exponentformat: "none",
  };
  return log ? { ...look, ...plainTicks() } : look;
}

// Ticks of a logarithmic axis at 1, 2 and 5 times powers of ten, in plain numbers.
function plainTicks() {
  const powers = Array.from({ length: 25 }, (_, i) => i - 12);
  const values = powers.flatMap((power) => [1, 2, 5].map((first) => Number(`${first}e${power}`)));
  return { tickmode: "array", tickvals: values, ticktext: values.map((value) => general(value, 4)) };
}

function layout(more) {
  const narrow = window.innerWidth < 640;
  return {
    paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: "rgba(0,0,0,0)",
    font: { family: "inherit", size: narrow ? 12 : 13, color: colour("text") },
    margin: { l: 54, r: 14, t: 30, b: 46 },
    hovermode: "closest",
    hoverlabel: { bgcolor: colour("panel"), bordercolor: colour("soft"), font: { color: colour("text") } },
    modebar: { bgcolor: "rgba(0,0,0,0)", color: colour("soft"), activecolor: colour("accent") },
    legend: narrow ? below() : {},
    dragmode: narrow ? false : "zoom",
    ...more,
  };
}

// A legend below the drawing.
function below() {
  return { orientation: "h", yref: "container", y: 0, yanchor: "bottom", x: 0, font: { size: 12 }, title: { side: "top" } };
}

// A dashed line across the drawing at a height, and its name at the right.
function levelLine(height) {
  return { type: "line", xref: "paper", x0: 0, x1: 1, y0: height, y1: height, layer: "below", line: { color: colour("soft"), width: 1, dash: "dash" } };
}

function levelName(height, name) {
  return {
    xref: "paper", x: 1.005, y: height, text: name, showarrow: false, xanchor: "left", yanchor: "middle", font: { size: 12, color: colour("soft") },
  };
}
