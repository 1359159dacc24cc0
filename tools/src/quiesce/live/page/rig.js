// The rig in the computer (`--sim`): what shakes it, control on and off, faults, and what vibrates with and without.
// Who holds control moves it; the others see it move.
import { $, make } from "./dom.js";

const SEND_ms = 100; // while a slider is moved
const STEPS = 1000; // of a slider
const FAULT_s = 1;
const RESET_s = 0.1; // as long as an operator lets the enable go to acknowledge

// What shakes it, and what of that can be set: [key, words, unit, least, most, at first]. Of those in DRIVE the rig's
// amplitude is the drive of its shaker.
const KINDS = {
  sine: [["freq_Hz", "Frequency", "Hz", 0.5, 50, 10]],
  chirp: [["freq_Hz", "From", "Hz", 0.5, 50, 5], ["end_freq_Hz", "To", "Hz", 0.5, 50, 25], ["duration_s", "In", "s", 1, 300, 30]],
  random: [["low_Hz", "From", "Hz", 0.5, 50, 4], ["high_Hz", "To", "Hz", 1, 100, 22], ["drive_rms_V", "RMS of the drive", "V", 0.001, 1, 0.05]],
  record: [["gain", "Strength", "times as recorded", 0.001, 2, 0.05], ["time_scale", "Speed", "times as recorded", 0.2, 20, 5]],
  impulse: [["impulse_N_s", "Impulse", "N s", 0.0001, 1, 0.005]],
};
const WORDS = { sine: "sine", chirp: "sweep", random: "random", record: "recorded ground motion", impulse: "knock" };
const DRIVE = ["sine", "chirp"];
const FIXED = { random: { duration_s: 60 }, impulse: { pulse_s: 0.01 } };

// A slider, logarithmic from least to most, and the number itself, which may be beyond its ends.
class Dial {
  constructor(id, words, unit, least, most, value, changed) {
    this.least = least;
    this.ratio = most / least;
    this.slider = make("input", { type: "range", min: 0, max: STEPS, step: 1, id });
    this.number = make("input", { type: "number", min: 0, step: "any", required: true });
    this.number.setAttribute("aria-label", `${words} in ${unit}, as a number`);
    this.place = make("div", { className: "number" },
      make("label", { htmlFor: id, textContent: `${words}, ${unit}` }), this.slider, this.number);
    this.slider.addEventListener("input", () => {
      this.number.value = Number((this.least * this.ratio ** (this.slider.value / STEPS)).toPrecision(3));
      this.speak();
      changed(false);
    });
    this.slider.addEventListener("change", () => changed(true));
    this.number.addEventListener("change", () => {
      this.follow();
      if (this.number.checkValidity()) changed(true);
    });
    this.unit = unit;
    this.set(value);
  }

  get value() { return Number(this.number.value); }
  get isValid() { return this.number.checkValidity(); }

  set(value) {
    this.number.value = value;
    this.follow();
  }

  follow() {
    this.slider.value = Math.round(STEPS * Math.log(Math.max(this.value, this.least) / this.least) / Math.log(this.ratio));
    this.speak();
  }

  speak() { this.slider.setAttribute("aria-valuetext", `${this.number.value} ${this.unit}`); }
}

export class Rig {
  constructor(send) {
    this.send = send;
    this.isThere = false;
    this.sent_ms = -Infinity;
    this.waiting = 0;
  }

  // hello.rig: null where a controller on a bus is watched.
  describe(hello) {
    this.isThere = hello.rig !== null;
    $("rig").hidden = !this.isThere;
    if (!this.isThere) return;
    this.about = hello.rig;
    this.law = hello.parameters.find((one) => one.name === "law");
    this.lawIndex = hello.parameters.indexOf(this.law);
    $("rig-what").textContent = `${this.about.plant}, ${this.about.tick_rate_Hz} ticks a second, controller: ${this.about.target}. Other programs join its bus with ${this.about.bus}`;
    $("rig-panel").replaceChildren(this.comparison(), this.excitation(), this.disturbances());
    this.enable(false);
  }

  // Control on and off, the law, what that does.
  comparison() {
    this.control = make("button", { type: "button", id: "rig-control" });
    this.control.addEventListener("click", () => this.order({ control: !this.isOn }));
    this.laws = make("select", { id: "rig-law" }, ...this.law.labels.map((label) => new Option(label, label)));
    this.laws.addEventListener("change", () => this.send({ do: "set", settings: { law: this.laws.value } }));
    this.hint = make("small", {});
    this.figures = Object.fromEntries(["off", "on", "ratio"].map((row) => [row, [make("td", {}), make("td", {})]]));
    const rowOf = (words, cells) => make("tr", {}, make("th", { scope: "row", textContent: words }), ...cells);
    const head = make("tr", {}, make("td", {}), make("th", { scope: "col", textContent: "displacement, \u00b5m" }),
      make("th", { scope: "col", textContent: "acceleration, m/s\u00b2" }));
    const table = make("table", {}, make("caption", { textContent: `RMS of ${this.about.window_s} s` }), head,
      rowOf("control off", this.figures.off), rowOf("control on", this.figures.on), rowOf("on / off", this.figures.ratio));
    return make("fieldset", {}, make("legend", { textContent: "Control" }), make("p", { className: "tools" }, this.control,
      make("label", {}, "Law ", this.laws)), this.hint, table);
  }

  excitation() {
    this.kinds = make("select", { id: "rig-kind" }, ...Object.keys(KINDS).filter((kind) => this.canPlay(kind))
      .map((kind) => new Option(WORDS[kind], kind)));
    this.kinds.addEventListener("change", () => this.choose());
    this.records = make("select", { id: "rig-record" }, ...this.about.records.map((name, i) => new Option(name, i)));
    this.records.addEventListener("change", () => this.play());
    this.recordPlace = make("label", {}, "Record ", this.records);
    this.again = make("button", { type: "button", textContent: "Play" });
    this.again.addEventListener("click", () => this.play());
    this.drive = new Dial("rig-drive", "Drive of the shaker", "V", 0.001, Math.max(1, 10 * this.about.shaker.drive_V),
      this.about.shaker.drive_V || 0.1, (isLast) => this.soon(isLast, () => this.order({ drive_V: this.drive.value })));
    this.still = make("button", { type: "button", textContent: "Stand still" });
    this.still.addEventListener("click", () => this.order({ drive_V: 0, excite: { kind: "sine", freq_Hz: this.about.shaker.ref_freq_Hz } }));
    this.dials = {};
    this.dialPlace = make("div", {});
    const box = make("fieldset", {}, make("legend", { textContent: "What shakes it" }),
      make("p", { className: "tools" }, make("label", {}, "Kind ", this.kinds), this.again, this.still), this.recordPlace,
      this.dialPlace, this.drive.place);
    this.showDials();
    this.playing = make("p", {});
    box.append(this.playing);
    return box;
  }

  canPlay(kind) {
    return kind !== "record" || (this.about.has_base && this.about.records.length > 0);
  }

  disturbances() {
    this.seconds = new Dial("rig-seconds", "They last", "s", 0.01, 60, FAULT_s, () => {});
    this.faults = this.about.faults.filter((kind) => kind !== "fault_reset" && kind !== "disable").map((kind) => {
      const button = make("button", { type: "button", textContent: kind.replaceAll("_", " ") });
      button.dataset.kind = kind;
      button.addEventListener("click", () => this.order({ fault: { kind, duration_s: this.seconds.value } }));
      return button;
    });
    this.clear = make("button", { type: "button", textContent: "End them" });
    this.clear.addEventListener("click", () => this.order({ clear_faults: true }));
    this.acknowledge = make("button", { type: "button", textContent: "Acknowledge a latched fault" });
    this.acknowledge.addEventListener("click", () => this.order({ fault: { kind: "fault_reset", duration_s: RESET_s } }));
    this.pace = make("p", {});
    return make("fieldset", {}, make("legend", { textContent: "Faults to inject" }), this.seconds.place,
      make("p", { className: "tools" }, ...this.faults), make("p", { className: "tools" }, this.clear, this.acknowledge), this.pace);
  }

  choose() {
    this.showDials();
    this.play();
  }

  showDials() {
    const kind = this.kinds.value;
    this.dials = Object.fromEntries(KINDS[kind].map(([key, ...about]) => [key,
      new Dial(`rig-${key}`, ...about, (isLast) => this.soon(isLast, () => this.play()))]));
    this.dialPlace.replaceChildren(...Object.values(this.dials).map((dial) => dial.place));
    this.recordPlace.hidden = kind !== "record";
    this.drive.place.hidden = !DRIVE.includes(kind);
    this.again.hidden = kind === "sine";
    this.enable(this.isMine);
  }

  play() {
    const kind = this.kinds.value;
    const dials = Object.entries(this.dials);
    if (!dials.every(([, dial]) => dial.isValid)) return;
    const excite = { kind, ...FIXED[kind], ...Object.fromEntries(dials.map(([key, dial]) => [key, dial.value])) };
    if (kind === "record") excite.record = Number(this.records.value);
    this.order(DRIVE.includes(kind) ? { excite, drive_V: this.drive.value } : { excite });
  }

  // At most so often while a slider moves; its last place always.
  soon(isLast, act) {
    clearTimeout(this.waiting);
    const wait_ms = isLast ? 0 : Math.max(0, this.sent_ms + SEND_ms - performance.now());
    this.waiting = setTimeout(() => {
      this.sent_ms = performance.now();
      act();
    }, wait_ms);
  }

  order(order) { this.send({ do: "rig", order }); }

  // state.rig: of its newest tenth of a second. values: of the parameters.
  show(state, values, isMine) {
    if (!this.isThere || !state.rig || state.rig.control === undefined) return;
    const rig = state.rig;
    this.isOn = rig.control;
    this.control.textContent = this.isOn ? "Switch control off" : "Switch control on";
    this.control.setAttribute("aria-pressed", String(this.isOn));
    if (document.activeElement !== this.laws && values.length) this.laws.value = this.law.labels[values[this.lawIndex]];
    this.hint.textContent = this.isOn ? "Another law may be chosen while control is off." : "";
    this.showFigures(rig.vibration);
    this.playing.textContent = `Now: ${rig.excitation}${rig.freq_Hz > 0 ? `, at ${rig.freq_Hz.toFixed(2)} Hz` : ""}; drive ${rig.drive_V} V`;
    $("rig-halt").textContent = rig.halt ? `${rig.halt}. It stands still again, at rest.` : "";
    for (const button of this.faults) button.setAttribute("aria-pressed", String(rig.faults.includes(button.dataset.kind)));
    const { overruns, latest_us, lost_s } = rig.pace;
    this.pace.textContent = `${overruns} of ${rig.ticks} ticks began a tick late or more, the latest ${(latest_us / 1000).toFixed(1)} ms` +
      (lost_s > 0 ? `; ${lost_s.toFixed(1)} s were given up` : "; none is left out");
    this.enable(isMine && !state.job);
  }

  showFigures({ on, off }) {
    const put = (row, texts) => this.figures[row].forEach((cell, i) => { cell.textContent = texts[i]; });
    const texts = (rms) => (rms ? [rms.displacement_um.toPrecision(3), rms.accel_m_s2.toPrecision(3)] : ["\u2013", "\u2013"]);
    const percent = (a, b) => (b > 0 ? `${(100 * a / b).toFixed(1)} %` : "\u2013");
    put("off", texts(off));
    put("on", texts(on));
    put("ratio", on && off ? [percent(on.displacement_um, off.displacement_um), percent(on.accel_m_s2, off.accel_m_s2)] : ["\u2013", "\u2013"]);
  }

  enable(isMine) {
    this.isMine = Boolean(isMine);
    if (!this.isThere || !this.pace) return;
    for (const element of $("rig-panel").querySelectorAll("button, input, select")) element.disabled = !this.isMine;
    this.laws.disabled = !this.isMine || this.isOn;
  }
}
