// The page: what comes over the link goes to its parts.
import { Charts } from "./charts.js";
import { $ } from "./dom.js";
import { Guide } from "./guide.js";
import { Law } from "./law.js";
import { Link } from "./link.js";
import { Parameters } from "./parameters.js";
import { Rig } from "./rig.js";
import { Recorder } from "./recorder.js";
import { Samples, decode } from "./samples.js";
import { Spectrum } from "./spectrum.js";
import * as status from "./status.js";
import { Stop } from "./stop.js";
import { Tables } from "./tables.js";

const SILENT_ms = 1000; // 25 packets are due in it
const LOOK_ms = 250;
const ACCEL = ["accel_scale_nm_s2", "accel_offset_counts", "accel_polarity"];

let hello = null;
let values = []; // of the parameters
let shown = []; // numbers of series
let heard = "";
let isChosen = false; // by the person who looks
let packet_ms = -Infinity;
let isNew = false;

const samples = new Samples();
const charts = new Charts($("charts"), samples);
const stop = new Stop($("stop"), $("stop-said"), (object) => link.send(object));
const parameters = new Parameters(send);
const rig = new Rig(send);
const guide = new Guide(send);
const recorder = new Recorder(send, factorOf);
const spectrum = new Spectrum(send, factorOf);
const tables = new Tables(send);
const law = new Law(send);
const link = new Link({ open: () => {}, close: lost, text: heardText, samples: heardSamples });

function send(object) {
  if (!link.send(object)) say(false, "No connection to the server.");
}

function say(isOk, text) {
  $("said").className = isOk ? "good" : "bad";
  $("said").textContent = text;
}

function heardText(message) {
  if (message.hello) greet(message.hello);
  if (message.state) showState(message.state);
  if (message.parameters) {
    values = message.parameters.values;
    parameters.set(values, message.parameters.before);
    if (shown.length) showCharts();
  }
  if (message.spectrum) spectrum.show(message.spectrum);
  if (message.law !== undefined) law.describe(message.law);
  if (message.note && ![tables, law, guide].some((one) => one.hear(message.note))) say(message.note.is_ok, message.note.text);
}

function greet(said) {
  hello = said;
  samples.restart();
  heard = "";
  status.makeLamps(hello.faults);
  parameters.describe(hello.parameters);
  rig.describe(hello);
  guide.describe(hello);
  if (isChosen) link.send({ do: "show", series: shown });
}

function showState(state) {
  stop.server(state.stop);
  status.showBus(status.busText(state.bus));
  status.showController(state);
  status.showFaults(state);
  status.showFirstFault(state.first_fault, state.later_faults);
  const isMine = status.showControl(state, hello.viewer);
  parameters.enable(isMine && !state.job);
  rig.show(state, values, isMine);
  guide.show(state, isMine);
  recorder.show(state, isMine);
  tables.enable(isMine && !state.job);
  law.enable(isMine && !state.job);
  law.show(state.controller);
  if (state.job && !state.guide?.is_at_work) say(true, `${state.job} is under way ...`);
  if (heard !== String(state.heard)) {
    heard = String(state.heard);
    offer(state.heard, state.preferred);
  }
}

// The signals that the bus carries, to choose from.
function offer(ids, preferred) {
  if (!isChosen) shown = preferred;
  const carried = hello.series.filter((one) => ids.includes(one.frame_id));
  const boxes = carried.map((one) => {
    const label = document.createElement("label");
    const box = Object.assign(document.createElement("input"), { type: "checkbox", checked: shown.includes(one.number) });
    box.addEventListener("change", () => choose(one.number, box));
    const words = `${one.title} (${one.message})`;
    label.append(box, ` ${words}`);
    return label;
  });
  $("choose").replaceChildren(...boxes);
  recorder.offer(carried);
  spectrum.offer(carried);
  showCharts();
}

function choose(number, box) {
  if (box.checked && shown.length === hello.most_series) {
    box.checked = false;
    $("choose-said").textContent = "Eight are shown; take one away first.";
    return;
  }
  $("choose-said").textContent = "Up to eight.";
  show(box.checked ? [...shown, number] : shown.filter((one) => one !== number));
}

function show(numbers) {
  isChosen = true;
  for (const number of numbers.filter((one) => !shown.includes(one))) samples.resume(hello.series[number].frame_id);
  shown = numbers;
  link.send({ do: "show", series: shown });
  showCharts();
}

function showCharts() {
  charts.show(shown.map((number) => hello.series[number]), factorOf);
}

// Counts of the tracked accelerometer are an acceleration once its parameters are known.
function factorOf(series) {
  if (series.signal !== "accel_counts" || !values.length) return { scale: series.scale, offset: 0, unit: series.unit };
  const [scale_nm_s2, offset_counts, polarity] = ACCEL.map((name) => values[hello.parameters.findIndex((one) => one.name === name)]);
  const scale = scale_nm_s2 * 1e-9 * polarity;
  return { scale, offset: -offset_counts * scale, unit: "m/s2" };
}

function heardSamples(buffer) {
  const packet = decode(buffer);
  if (packet === null) return;
  samples.add(packet);
  packet_ms = performance.now();
  isNew = true;
}

function lost() {
  status.showBus(["NO CONNECTION to the server, trying again. What is shown is old.", true]);
  parameters.enable(false);
  rig.enable(false);
  guide.enable(false);
  tables.lost();
  law.enable(false);
  recorder.show(null, false);
  $("take").disabled = $("release").disabled = true;
}

function draw() {
  if (isNew) {
    isNew = false;
    charts.draw();
  }
  requestAnimationFrame(draw);
}

function look() {
  const silent_ms = performance.now() - packet_ms;
  if (hello && silent_ms > SILENT_ms) {
    status.showBus([`NOTHING from the server for ${status.age(silent_ms / 1000)}. What is shown is old.`, true]);
  }
  charts.tell();
  $("counts").textContent = `${samples.drawn} samples drawn, ${samples.lost} lost on the way here`;
}

$("take").addEventListener("click", () => send({ do: "take" }));
$("release").addEventListener("click", () => send({ do: "release" }));
$("window").addEventListener("change", (event) => { charts.window_s = Number(event.target.value); });
$("hold").addEventListener("click", ({ target }) => {
  charts.isHeld = !charts.isHeld;
  target.setAttribute("aria-pressed", String(charts.isHeld));
});
setInterval(look, LOOK_ms);
requestAnimationFrame(draw);

// For measurements (`./tools/benchmark live`).
globalThis.quiesceLive = { samples, show, series: () => hello?.series ?? [] };
