// The settings: what is changed of the scene, its address, its history, and the pinned cases.

const settings = { set: {}, effects: {} };
let past = []; // settings before each change that lasted
let pins = [];

function copied(which = settings) {
  return { set: { ...which.set }, effects: { ...which.effects } };
}

function same(one, other) {
  return JSON.stringify(one) === JSON.stringify(other);
}

function put(which) {
  settings.set = { ...which.set };
  settings.effects = { ...which.effects };
}

// operation.speed=3000%20rpm&effects.tip_leakage=off, as `--set` has it
function asHash() {
  const parts = [
    ...Object.entries(settings.effects).map(([name, on]) => [`effects.${name}`, on ? "on" : "off"]),
    ...Object.entries(settings.set).map(([path, value]) => [path, value === null ? "null" : String(value)]),
  ];
  return parts.map((part) => part.map(encodeURIComponent).join("=")).join("&");
}

function fromHash() {
  const found = { set: {}, effects: {} };
  for (const part of location.hash.slice(1).split("&").filter((each) => each)) {
    let [path, text] = part.split("=");
    try {
      [path, text] = [decodeURIComponent(path), decodeURIComponent(text || "")];
    } catch {
      continue;
    }
    const effect = data.effects.find((each) => `effects.${each.name}` === path);
    if (effect && (text === "on" || text === "off")) {
      if ((text === "on") !== effect.on) found.effects[effect.name] = text === "on";
    } else if (controlOf(path)) {
      found.set[path] = readBack(controlOf(path), text);
    }
  }
  return found;
}

function readBack(control, text) {
  if (text === "null") return null;
  return control.kind === "choice" || control.unit ? text : Number(text);
}

let own = ""; // the address as this page wrote it

function writeHash() {
  own = asHash();
  const address = own ? `#${own}` : location.pathname + location.search;
  if (location.hash.slice(1) !== own) window.history.replaceState(null, "", address);
}

// Settings that lasted for a while can be gone back to.
function remember() {
  const last = past.at(-1);
  if (last && same(last, settings)) return;
  past.push(copied());
  if (past.length > 100) past = past.slice(-100);
  document.getElementById("undo").disabled = past.length < 2;
}

function undo() {
  if (past.length && same(past.at(-1), settings)) past.pop();
  const before = past.pop();
  if (!before) return;
  put(before);
  fillControls();
  changed();
}

function changeWords(which) {
  const sets = Object.entries(which.set).map(([path, value]) => {
    const control = controlOf(path);
    const effect = path.startsWith("effects.") ? `${path.split(".")[1].replaceAll("_", " ")} ` : "";
    return `${effect}${control ? control.words : path} ${value}`;
  });
  const switched = Object.entries(which.effects).map(([name, on]) => `${on ? "with" : "without"} ${name.replaceAll("_", " ")}`);
  return [...switched, ...sets].join(", ") || "as in the scene";
}

// ---- pinned cases ----------------------------------------------------------------------------------------------

function pin() {
  if (!shown) return;
  pins.push({ number: pins.length ? pins.at(-1).number + 1 : 1, settings: copied(shown.settings), answer: shown });
  fillPins();
  say(`pinned as ${pins.at(-1).number}`);
}

function fillPins() {
  const table = document.getElementById("pins");
  table.hidden = !pins.length;
  const names = headlineNames();
  const heads = ["", "settings", ...names.map((name) => aboutOf(name).words), "status", ""];
  table.replaceChildren(tableHead(heads), made("tbody", {}, ...pins.map((each) => pinRow(each, names))));
  const pinned = pins.map(({ number }) => [String(number), `pinned case ${number}`]);
  refill(document.getElementById("compared"), [["last", "the last settings"], ["none", "nothing"], ...pinned], "last");
}

function pinRow(each, names) {
  const cell = (className, ...content) => made("td", { className }, ...content);
  const figures = names.map((name) => {
    const value = each.answer.performance[name];
    return cell("n", Number.isFinite(value) ? written(aboutOf(name), value).join(" ") : "–");
  });
  const button = (words, onclick) => made("button", { type: "button", "aria-label": `${words} pinned case ${each.number}`, onclick }, words);
  const show = button("Show", () => { put(each.settings); fillControls(); changed(); });
  const remove = button("Remove", () => { pins = pins.filter((other) => other !== each); fillPins(); drawAnswer(); });
  return made("tr", {}, cell("n", String(each.number)), cell("wrap", changeWords(each.settings)), ...figures,
    cell(undefined, each.answer.status.replace("_", " ")), cell(undefined, show, " ", remove, " "));
}

// ---- taken along -----------------------------------------------------------------------------------------------

async function copy(what) {
  const text = what === "address" ? location.href : shown && shown.texts ? shown.texts[what] : "";
  if (!text) return;
  try {
    await navigator.clipboard.writeText(text);
    say("copied");
  } catch {
    window.prompt("Copy this:", text);
  }
}

function save() {
  if (!shown || !shown.texts) return;
  const link = made("a", { href: URL.createObjectURL(new Blob([shown.texts.yaml], { type: "application/yaml" })), download: "explored.yaml" });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
