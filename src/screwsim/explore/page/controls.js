// The fields: built from the scene's own description, filled from the settings.

const TYPES = 250; // [ms] after which a number that is typed is whole

const FITS = 8; // characters in the field of a number

let built = []; // {control, effect, row, field, range, select}
let byPath = new Map();
let typing = 0; // timer of a number that is being typed,
let typed = null; // and what is done with it

function takeTyped() {
  clearTimeout(typing);
  [typing, typed] = [0, typed && typed()];
}

function controlOf(path) {
  const entry = byPath.get(path);
  return entry && entry.control;
}

function buildControls() {
  const form = document.getElementById("controls");
  form.noValidate = true;
  form.addEventListener("submit", (event) => event.preventDefault());
  for (const group of data.groups) form.append(groupOf(group.words, group.controls, group.name === "operation" || group.name === "oil_supply"));
  const effects = foldOf("Effects", true);
  for (const effect of [...data.effects].sort((a, b) => Number(b.on) - Number(a.on))) effects.append(effectOf(effect));
  form.append(effects);
  const presets = document.getElementById("presets");
  presets.append(new Option("choose …", ""), new Option("as in the scene", "0"), ...data.presets.map((each, i) => new Option(each.words, String(i + 1))));
  presets.addEventListener("change", () => {
    if (presets.value === "") return;
    put(presets.value === "0" ? { set: {}, effects: {} } : data.presets[Number(presets.value) - 1]);
    presets.value = "";
    fillControls();
    changed();
  });
}

function foldOf(words, open) {
  return made("details", { open }, made("summary", {}, made("h3", {}, words)));
}

// Numbers that the scene leaves open stand below the others, in a fold of their own.
function groupOf(words, controls, open) {
  const fold = foldOf(words, open);
  const left = controls.filter((control) => control.value === null && !control.needed);
  fold.append(...controls.filter((each) => !left.includes(each)).map((control) => rowOf(control)));
  if (left.length) {
    const more = foldOf(`${left.length} not set`, false);
    more.append(...left.map((control) => rowOf(control)));
    fold.append(more);
  }
  return fold;
}

function effectOf(effect) {
  const input = made("input", { type: "checkbox", role: "switch", id: `effect-${effect.name}` });
  const fields = foldOf(`parameters of ${effect.words}`, false);
  fields.classList.add("fields");
  fields.querySelector("h3").textContent = "parameters";
  fields.querySelector("summary").setAttribute("aria-label", `parameters of ${effect.words}`);
  fields.append(...effect.controls.map((control) => rowOf(control, effect)));
  input.addEventListener("change", () => {
    if (input.checked === effect.on) delete settings.effects[effect.name];
    else settings.effects[effect.name] = input.checked;
    fields.open = input.checked && effect.controls.some((control) => control.needed && control.value === null);
    fillControls();
    changed();
  });
  Object.assign(effect, { input, fields });
  return made("div", {}, made("label", { className: "effect", title: effect.about }, input, effect.words), ...(effect.controls.length ? [fields] : []));
}

function rowOf(control, effect) {
  const id = `of-${control.path.replaceAll(".", "-")}`;
  const label = made("label", { htmlFor: id, title: `${control.path}: ${control.about}` }, control.words);
  if (control.tolerance) label.append(made("small", {}, ` ${control.tolerance}${control.tolerance.startsWith("±") ? ` ${unitWords(control.unit)}` : ""}`));
  const back = made("button", { type: "button", "aria-label": `reset ${control.words} to the scene's value` }, "↺");
  back.addEventListener("click", () => { delete settings.set[control.path]; fillControls(); changed(); });
  const entry = { control, effect };
  const parts = control.kind === "choice" ? choiceOf(entry, id) : numberOf(entry, id);
  const row = made("div", { className: "control" }, label, made("div", { className: "value" }, ...parts, back), ...(entry.range ? [entry.range] : []));
  entry.row = row;
  built.push(entry);
  byPath.set(control.path, entry);
  return row;
}

function choiceOf(entry, id) {
  const { control } = entry;
  const select = made("select", { id });
  if (control.value === null) select.append(new Option("–", ""));
  select.append(...control.options.map((option) => new Option(option.replaceAll("_", " "), option)));
  select.addEventListener("change", () => setTo(control, select.value === "" ? undefined : select.value));
  entry.select = select;
  return [select];
}

// What an arrow key adds: one in the second digit.
function stepOf(control) {
  if (control.kind === "count") return "1";
  const size = Math.abs(control.value ?? 0) || 0.5 * (control.high - control.low) || 1;
  return String(Number(`1e${Math.floor(Math.log10(size)) - 1}`));
}

function unitWords(unit) {
  return unit.replaceAll("^2", "²").replaceAll("^3", "³").replace("um", "µm").replace("degC", "°C").replace("deg", "°");
}

function numberOf(entry, id) {
  const { control } = entry;
  const field = made("input", { type: "number", id, step: stepOf(control) });
  if (control.value === null) field.placeholder = control.needed ? "needed" : "open";
  const range = made("input", { type: "range", min: "0", max: String(STEPS), step: "1", "aria-label": control.words, "data-path": control.path });
  field.addEventListener("input", () => {
    typed = () => setTo(control, Number.isFinite(field.valueAsNumber) ? field.valueAsNumber : undefined, field);
    clearTimeout(typing);
    typing = setTimeout(takeTyped, TYPES);
  });
  field.addEventListener("change", takeTyped); // Enter, or the field is left
  field.addEventListener("blur", () => fillRow(entry));
  range.addEventListener("input", () => setTo(control, valueAt(control, Number(range.value)), range));
  Object.assign(entry, { field, range });
  return [field, made("span", {}, unitWords(control.unit))];
}

// Change one value; undefined: as the scene says.
function setTo(control, value, by) {
  if (value === undefined || value === control.value) delete settings.set[control.path];
  else settings.set[control.path] = asSet(control, value);
  const { effect } = byPath.get(control.path);
  fillRow(byPath.get(control.path), by);
  if (!effect || isOn(effect)) changed();
}

function isOn(effect) {
  return settings.effects[effect.name] ?? effect.on;
}

function fillControls() {
  for (const effect of data.effects) {
    effect.input.checked = isOn(effect);
    effect.fields.hidden = !isOn(effect);
  }
  for (const entry of built) fillRow(entry);
}

function fillRow(entry, by) {
  const { control, row } = entry;
  const changedHere = control.path in settings.set;
  row.classList.toggle("changed", changedHere);
  if (entry.select) {
    entry.select.value = changedHere ? settings.set[control.path] : control.value ?? "";
    return;
  }
  const value = changedHere ? asNumber(control, settings.set[control.path]) : control.value;
  if (entry.field !== by) showNumber(entry.field, value);
  if (value !== null && (value < control.low || value > control.high)) {
    control.low = Math.min(control.low, value);
    control.high = Math.max(control.high, value);
    if (control.low <= 0) control.log = false;
  }
  if (entry.range !== by) entry.range.value = String(value === null ? placeOf(control, control.low) : placeOf(control, value));
  entry.range.setAttribute("aria-valuetext", value === null ? "not set" : `${value} ${control.unit}`);
}

// A number in its field: of a long one so many digits as fit, and all of them in its title.
function showNumber(field, value) {
  const text = value === null || Number.isNaN(value) ? "" : String(value);
  field.value = text.length > FITS ? shortest(value) : text;
  field.title = field.value === text ? "" : text;
}

// The most digits that fit, with a power of ten where that leaves more of them.
function shortest(value) {
  for (let digits = FITS; digits > 1; digits -= 1) {
    const fixed = String(Number(value.toPrecision(digits)));
    const found = [fixed, value.toExponential(digits - 1).replace("e+", "e")].find((text) => text.length <= FITS);
    if (found) return found;
  }
  return value.toExponential(0).replace("e+", "e");
}

// Which field a fault is about, and all others are not.
function markFaults(faults) {
  for (const { row, field } of built) {
    row.classList.remove("wrong");
    if (field) field.removeAttribute("aria-invalid");
  }
  for (const [path] of faults || []) {
    const entry = byPath.get(path);
    if (!entry) continue;
    entry.row.classList.add("wrong");
    if (entry.field) entry.field.setAttribute("aria-invalid", "true");
    if (entry.effect) entry.effect.fields.open = true;
  }
}

// Numbers that count at present: those of the scene, and of effects that are on.
function liveNumbers() {
  return built.filter(({ control, effect, field }) => {
    if (!field || control.path.startsWith("numerics.")) return false;
    const there = control.path in settings.set || control.value !== null;
    return there && (!effect || isOn(effect));
  });
}

function numberNow(control) {
  return control.path in settings.set ? asNumber(control, settings.set[control.path]) : control.value;
}
