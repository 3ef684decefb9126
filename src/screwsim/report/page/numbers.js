// Numbers as people write them.

// A number as %.Ng of C writes it: 0.00123, 1.2346e+05.
function general(value, digits) {
  if (!Number.isFinite(value)) return "";
  if (value === 0) return "0";
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
  const power = Number(exponent);
  if (power < -4 || power >= digits) return timesTen(trimmed(mantissa), power);
  return trimmed(value.toFixed(digits - 1 - power));
}

function trimmed(text) {
  return text.includes(".") ? text.replace(/0+$/, "").replace(/\.$/, "") : text;
}

function timesTen(mantissa, power) {
  return `${mantissa}e${power < 0 ? "-" : "+"}${String(Math.abs(power)).padStart(2, "0")}`;
}

// A residue or an error as %.1e of C writes it.
function small(value) {
  if (!Number.isFinite(value)) return "";
  const [mantissa, exponent] = value.toExponential(1).split("e");
  return timesTen(mantissa, Number(exponent));
}

// A figure [SI] as number and unit, like the table of `screwsim run`.
function written(figure, value) {
  if (figure.kelvin) return [value.toFixed(2), `K (${(value - 273.15).toFixed(2).replace(/^-(?=[0.]+$)/, "")} °C)`];
  const [, factor, unit] = scaleOf(figure, value);
  return [general(value * factor, 5), unit];
}

// From which size on, factor and unit of a figure's scale for a value.
function scaleOf(figure, value) {
  return figure.scales.find(([least]) => Math.abs(value) >= least);
}

// Half of an interval in the unit in which its value is written; empty where there is none.
function halfText(figure, value, half) {
  if (!Number.isFinite(half)) return "";
  return `± ${general(half * (figure.kelvin ? 1 : scaleOf(figure, value)[1]), 2)}`;
}

// Which balances have a residual, and how large it is.
function residuals(names, valueOf) {
  return names.filter((name) => Number.isFinite(valueOf(name))).map((name) => `${name.replace("_", " ")} ${small(valueOf(name))}`).join(", ");
}
