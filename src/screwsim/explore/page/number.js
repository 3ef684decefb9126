// Values of controls: places on a slider, texts of a scene, and back.

const STEPS = 1000; // of a slider

// The value at a share of a range, by equal ratios where `log`; and the share at which a value lies.
function between([low, high], log, share) {
  return log ? low * (high / low) ** share : low + (high - low) * share;
}

function shareOf([low, high], log, value) {
  return log ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
}

function placeOf({ low, high, log }, value) {
  return Math.round(STEPS * Math.min(Math.max(shareOf([low, high], log, value), 0), 1));
}

// The number at a place of a slider, to four digits, or a whole one.
function valueAt(control, place) {
  const { low, high, log } = control;
  const value = between([low, high], log, place / STEPS);
  if (control.kind === "count") return Math.round(value);
  const step = log ? Math.abs(value) : (high - low) / 10;
  const digits = Math.min(Math.max(3 - Math.floor(Math.log10(step || 1)), 0), 12);
  return Math.min(Math.max(Number(value.toFixed(digits)), low), high);
}

// A number as the scene has it: with its unit, where it has one.
function asSet(control, value) {
  if (control.kind === "choice") return value;
  return control.unit ? `${value} ${control.unit}` : value;
}

// The number of what a scene has, in the unit of the control; NaN where it is another unit, which only an address can have.
function asNumber(control, set) {
  if (typeof set === "number") return set;
  const [, number, unit] = /^\s*([-+0-9.eE]+)\s*(.*?)\s*$/.exec(String(set)) || [];
  return number !== undefined && unit === control.unit ? Number(number) : NaN;
}

function extent(list) {
  let [low, high] = [Infinity, -Infinity];
  for (const values of list) {
    for (const value of values) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return [low, high];
}

// Ticks at 1, 2 or 5 times a power of ten, about so many.
function ticksOf(low, high, count) {
  const rough = (high - low) / Math.max(count, 1);
  if (!(rough > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((each) => each * power).find((each) => each >= rough * 0.999);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1) found.push(k * step);
  return found;
}

function logTicksOf(low, high) {
  const found = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += 1) {
    for (const first of [1, 2, 5]) {
      const tick = Number(`${first}e${power}`);
      if (tick >= low * 0.999 && tick <= high * 1.001) found.push(tick);
    }
  }
  return found.length > 1 ? found : ticksOf(low, high, 4).filter((tick) => tick > 0);
}

function plain(value) {
  return general(value, 4).replace("-", "\u2212");
}

// The size of a change: two digits, from ten on a whole number.
function changeText(size) {
  return size < 9.95 ? general(size, 2) : size.toFixed(0);
}
