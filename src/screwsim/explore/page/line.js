// The line to the server: settings go out with rising numbers, answers come back with the numbers that they answer.

let socket = null;
let waitFor = 500; // [ms] before the line is opened again
let number = 0;
let sent = new Map(); // number -> [when the change was made [ms], the settings]
let lineId = 0;
let machineKey = "";
let undrawn = 0; // answers that the next frame draws
const log = { sent: 0, answered: 0, order: true, ms: [], overtaken: 0 }; // for whoever wants to know how fast it is

function openLine() {
  const scheme = location.protocol === "https:" ? "wss" : "ws";
  socket = new WebSocket(`${scheme}://${location.host}/line${location.search}`);
  socket.binaryType = "arraybuffer";
  socket.addEventListener("open", () => {
    waitFor = 500;
    [number, sent] = [0, new Map()];
    [log.sent, log.answered] = [0, 0];
    ask(null);
  });
  socket.addEventListener("message", (event) => receive(event.data));
  socket.addEventListener("close", (event) => {
    busy("");
    const why = event.reason ? `: ${event.reason}` : "";
    statusIs("failed", "no connection");
    complain(`The connection to screwsim is closed${why}. Trying again; is the command still running?`);
    setTimeout(openLine, waitFor);
    waitFor = Math.min(2 * waitFor, 8000);
  });
}

function isOpen() {
  return socket && socket.readyState === WebSocket.OPEN;
}

// Ask for the settings as they are.
function ask(when = performance.now()) {
  if (!isOpen()) return;
  number += 1;
  log.sent = number;
  sent.set(number, [when, copied()]);
  socket.send(JSON.stringify({ kind: "point", number, machine: machineKey, changes: settings }));
}

// Ask for points beside the settings, [path, value] each, or without points for the derivatives of all figures, which
// are found beside all else; what was asked in that lane before is dropped.
function askBeside(lane, points) {
  if (!isOpen()) return 0;
  lineId += 1;
  socket.send(JSON.stringify({ kind: lane, id: lineId, points, changes: settings }));
  return lineId;
}

function receive(buffer) {
  const size = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, size)));
  if (head.kind === "note") busy(head.text);
  else if (head.lane === "slopes") receiveSlopes(head);
  else if (head.lane) receivePoint(head);
  else receiveAnswer(head, new Float32Array(buffer, 4 + size));
}

function receiveAnswer(head, floats) {
  if (head.first !== log.answered + 1 || head.number < head.first) log.order = false;
  log.overtaken += head.number - head.first;
  log.answered = head.number;
  const [begun, asked] = sent.get(head.number) || [null, copied()];
  for (let each = head.first; each <= head.number; each += 1) sent.delete(each);
  const answer = head.kind === "solved" ? unpackAnswer(head, floats) : head;
  answer.settings = asked;
  if (head.machine_key) machineKey = head.machine_key;
  busy("");
  undrawn += 1;
  requestAnimationFrame(() => {
    undrawn -= 1;
    take(answer);
    if (begun) {
      log.ms.push(performance.now() - begun);
      if (log.ms.length > 1000) log.ms.shift();
      document.getElementById("speed").textContent = `${Math.round(log.ms.at(-1))} ms from change to drawing`;
    }
  });
}

const SCALE = { pressure: [1e-5, 0], volume: [1e6, 0], gas_temperature: [1, -273.15], oil_temperature: [1, -273.15] };

// Traces in shown units: bar, cm³, °C, g/s.
function unpackAnswer(head, floats) {
  const answer = { ...head, traces: {}, units: {} };
  const points = head.traces.length ? floats.length / head.traces.length : 0;
  head.traces.forEach(([name, units], i) => {
    const values = floats.slice(i * points, (i + 1) * points);
    const [factor, offset] = SCALE[name] || (units === "kg s-1" ? [1e3, 0] : [1, 0]);
    if (factor !== 1 || offset) for (let k = 0; k < values.length; k += 1) values[k] = values[k] * factor + offset;
    answer.traces[name] = values;
    answer.units[name] = units;
  });
  for (const about of head.about) figureTable.set(about.name, about);
  const flows = Object.keys(answer.traces).filter((name) => name.startsWith("mass_flow_"));
  const [low, high] = flows.length ? extent(flows.map((name) => answer.traces[name])) : [0, 1];
  answer.mostFlow = Math.max(-low, high, 1e-12);
  answer.levels = [["suction_pressure", "suction"], ["discharge_pressure", "discharge"]]
    .filter(([name]) => Number.isFinite(head.performance[name])).map(([name, words]) => [head.performance[name] * 1e-5, words]);
  return answer;
}
