// Where the shaft power goes: the steps of the ledger's waterfall.

const LEAST = 1e-3; // of the shaft power: smaller entries of the ledger are drawn as one

// The exergy that is spent: the shaft power, or of an expander that which the gas gives.
function spent(ledger) {
  return ledger.shaft_power > 0 ? ledger.shaft_power : -ledger.gas_exergy_rise;
}

function waterfallSteps(ledger) {
  const least = LEAST * spent(ledger);
  const losses = ledger.entries.filter((entry) => Number.isFinite(entry.exergy_destroyed));
  const large = losses.filter((entry) => Math.abs(entry.exergy_destroyed) >= least);
  const rest = losses.filter((entry) => !large.includes(entry));
  const others = rest.reduce((sum, entry) => sum + entry.exergy_destroyed, 0);
  const loss = (words, power) => ({ words, power, tint: power >= 0 ? "c2" : "c4" });
  const ends = ledger.shaft_power > 0
    ? [{ words: "shaft power", power: ledger.shaft_power, tint: "c0", total: true }, { words: "exergy rise of the gas", power: ledger.gas_exergy_rise, tint: "c1", total: true }]
    : [{ words: "exergy given by the gas", power: -ledger.gas_exergy_rise, tint: "c1", total: true }, { words: "power at the shaft", power: -ledger.shaft_power, tint: "c0", total: true }];
  const steps = [
    ends[0],
    ...large.map((entry) => loss(entry.words, entry.exergy_destroyed)),
    ...(Math.abs(others) >= least ? [loss(`others (${rest.length})`, others)] : []),
    ...(Math.abs(ledger.oil_exergy_rise) >= least ? [{ words: "exergy rise of the oil", power: ledger.oil_exergy_rise, tint: "c3" }] : []),
    ends[1],
  ];
  let left = 0; // where a bar ends, the next one begins
  for (const step of steps) {
    step.start = step.total ? 0 : left - step.power;
    left = step.total ? step.power : step.start;
  }
  return steps;
}
