// State, faults, the first fault's freeze frame, who holds control.
import { $, setText } from "./dom.js";

const OLD_s = 1;

export const age = (age_s) => (age_s < OLD_s ? `${Math.round(age_s * 1000)} ms` : `${age_s.toFixed(1)} s`);

function element(name, text, className = "") {
  const made = document.createElement(name);
  made.textContent = text;
  made.className = className;
  return made;
}

// The line about the bus, and whether what is shown is old.
export function busText(bus) {
  if (!bus.is_up) return [`${bus.name}: BUS LOST (${bus.lost}), opening it again`, true];
  if (bus.status_age_s === null) return [`${bus.name}: no controller so far`, true];
  if (bus.status_age_s > OLD_s) return [`${bus.name}: NO STATUS for ${age(bus.status_age_s)}`, true];
  const times = bus.losses === 1 ? "once" : `${bus.losses} times`;
  return [`${bus.name}: newest sample ${age(bus.age_s)} old${bus.losses ? `, lost ${times}` : ""}`, false];
}

export function showBus([text, isBad]) {
  setText($("bus"), text);
  document.body.classList.toggle("stale", isBad);
}

const yes = (value) => (value === null || value === undefined ? "-" : value ? "yes" : "no");

export function showController(state) {
  const { controller: now, bus } = state;
  const facts = [
    ["state", now.state || "-"],
    ["fault", now.fault || "-"],
    ["operator's enable", yes(now.is_enabled)],
    ["emergency stop pressed", yes(now.is_estop)],
    ["frequency valid", yes(now.freq_is_valid)],
    ["lock", yes(now.lock_is_on)],
    ["faults since its start", now.fault_count ?? "-"],
    ["firmware", now.misunderstood || now.version || "-"],
    ["frames lost, wrong CRC, malformed", `${bus.frames_lost}, ${bus.wrong_crc}, ${bus.malformed}`],
  ];
  const list = $("facts");
  if (list.children.length !== 2 * facts.length) {
    list.replaceChildren(...facts.flatMap(([name]) => [element("dt", name), element("dd", "")]));
  }
  facts.forEach(([, value], i) => setText(list.children[2 * i + 1], String(value)));
  list.children[1].dataset.state = now.state;
}

export function makeLamps(faults) {
  $("lamps").replaceChildren(...faults.map((name) => {
    const lamp = element("li", "");
    lamp.dataset.fault = name;
    lamp.append(element("span", name.replaceAll("_", " ").toLowerCase()), element("small", "off"));
    return lamp;
  }));
}

export function showFaults(state) {
  for (const lamp of $("lamps").children) {
    const name = lamp.dataset.fault;
    const count = state.faults[name] ?? 0;
    const isOn = state.controller.fault === name;
    lamp.className = isOn ? "on" : count ? "was" : "";
    setText(lamp.lastChild, isOn ? "ON" : count ? `was on, ${count}x` : "off");
  }
}

export function showFirstFault(frame, later) {
  const key = JSON.stringify([frame, later]);
  const place = $("first-fault");
  if (place.dataset.key === key) return;
  place.dataset.key = key;
  if (frame === null) {
    place.replaceChildren("none"); // so far, or of a server that was started anew
    return;
  }
  const table = document.createElement("table");
  table.append(element("caption", `${frame.fault} in state ${frame.state_before}, when it was entered`));
  for (const [title, value, unit] of frame.values) {
    const row = table.insertRow();
    const head = element("th", title);
    head.scope = "row";
    row.append(head, element("td", `${value} ${unit}`));
  }
  place.replaceChildren(table, element("p", later ? `${later} later ones; 'quiesce can freeze' has the record` : ""));
}

export function showControl(state, me) {
  const isMine = state.holder === me;
  const who = isMine ? "You hold control." : state.holder === null ? "Nobody holds control." : `Viewer ${state.holder} holds control.`;
  const viewers = state.viewers === 1 ? "1 viewer" : `${state.viewers} viewers`;
  setText($("holder"), `${who} You are viewer ${me}; ${viewers}.`);
  $("take").disabled = isMine || state.holder !== null;
  $("release").disabled = !isMine;
  return isMine;
}
