"use strict";
// Numbers as people write them.

// A number as %.Ng of C writes it: 0.00123, 1.2346e+05.
function general(value, digits) {
  if (!Number.isFinite(value)) return "";
  if (value === 0) return "0";
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
  const power = Number(exponent);
  if (power < -4 || power >= digits) {
    const sign = power < 0 ? "-" : "+";
    return `${trimmed(mantissa)}e${sign}${String(Math.abs(power)).padStart(2, "0")}`;
  }
  return trimmed(value.toFixed(digits - 1 - power));
}

function trimmed(text) {
  return text.includes(".") ? text.replace(/0+$/, "").replace(/\.$/, "") : text;
}

// A residue or an error as %.1e of C writes it.
function small(value) {
  if (!Number.isFinite(value)) return "";
  const [mantissa, exponent] = value.toExponential(1).split("e");
  const power = Number(exponent);
  return `${mantissa}e${power < 0 ? "-" : "+"}${String(Math.abs(power)).padStart(2, "0")}`;
}

// A figure [SI] as number and unit, like the table of `screwsim run`.
function written(figure, value) {
  if (figure.kelvin) return [value.toFixed(2), `K (${(value - 273.15).toFixed(2).replace(/^-(?=[0.]+$)/, "")} °C)`];
  const [, factor, unit] = figure.scales.find(([least]) => Math.abs(value) >= least);
  return [general(value * factor, 5), unit];
}
