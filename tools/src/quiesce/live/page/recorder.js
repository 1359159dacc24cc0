// The recorder: what starts it, how it goes, markers, the files.
import { $ } from "./dom.js";

const LEVEL = "level"; // a signal passes it
const sizeOf = (bytes) => (bytes < 1e6 ? `${Math.ceil(bytes / 1000)} kB` : `${(bytes / 1e6).toFixed(1)} MB`);

function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

// What is under way.
function nowOf({ state, file, bytes, duration_s, markers }) {
  if (state === "idle") return "Nothing is recorded.";
  if (state === "armed") return "Waiting for the trigger.";
  const what = state === "ending" ? "Completing" : "Recording";
  const marked = markers === 1 ? "1 marker" : `${markers} markers`;
  return `${what} ${file}: ${duration_s.toFixed(1)} s, ${sizeOf(bytes)}, ${marked}`;
}

function linkOf({ name, bytes, duration_s }) {
  const item = document.createElement("li");
  const link = Object.assign(document.createElement("a"), { href: `recordings/${name}`, download: name, textContent: name });
  item.append(link, ` ${duration_s === null ? "" : `${duration_s.toFixed(1)} s, `}${sizeOf(bytes)}`);
  return item;
}

export class Recorder {
  // factorOf(series): scale, offset and unit of its values, as they are shown.
  constructor(send, factorOf) {
    this.send = send;
    this.factorOf = factorOf;
    this.series = [];
    this.key = "";
    $("record-on").addEventListener("change", () => this.choose());
    $("record-series").addEventListener("change", () => this.choose());
    $("record").addEventListener("click", () => this.begin());
    $("record-end").addEventListener("click", () => send({ do: "end_record" }));
    $("record-marker").addEventListener("submit", (event) => {
      event.preventDefault();
      this.mark();
    });
  }

  // Signals that the bus carries.
  offer(series) {
    const before = $("record-series").value;
    this.series = series;
    $("record-series").replaceChildren(...series.map((one) => new Option(`${one.title} (${one.message})`, one.number)));
    if (series.some((one) => String(one.number) === before)) $("record-series").value = before;
    this.choose();
  }

  get chosen() {
    return this.series.find((one) => String(one.number) === $("record-series").value);
  }

  choose() {
    $("record-level").hidden = $("record-on").value !== LEVEL;
    setText($("record-unit"), this.chosen ? this.factorOf(this.chosen).unit : "");
  }

  begin() {
    const level = $("record-on").value === LEVEL ? [$("record-series"), $("record-value")] : [];
    const fields = [$("record-before"), $("record-after"), ...level];
    if (!fields.every((one) => one.reportValidity())) return;
    this.send({
      do: "record",
      format: $("record-format").value,
      before_s: $("record-before").valueAsNumber,
      after_s: $("record-after").valueAsNumber,
      trigger: this.trigger(),
    });
  }

  // The level is one of the integers on the wire: polarity may turn it round.
  trigger() {
    const on = $("record-on").value;
    if (on !== LEVEL) return { on };
    const { scale, offset } = this.factorOf(this.chosen);
    const isAbove = ($("record-way").value === "above") === scale > 0;
    return { on, series: this.chosen.number, is_above: isAbove, level: ($("record-value").valueAsNumber - offset) / scale };
  }

  mark() {
    const text = $("record-text").value.trim();
    if (text) this.send({ do: "mark", text });
    $("record-text").value = "";
  }

  // state: as the server tells it; null: there is none.
  show(state, isMine) {
    const is = state?.recorder.state ?? "";
    $("record").disabled = !isMine || is !== "idle";
    $("record-end").disabled = !isMine || (is !== "armed" && is !== "recording");
    $("record-text").disabled = $("record-mark").disabled = is !== "recording";
    if (state === null) return;
    const { said, files, folder } = state.recorder;
    setText($("record-now"), nowOf(state.recorder));
    setText($("record-said"), said?.text ?? "");
    $("record-said").className = said?.is_ok === false ? "bad" : "good";
    const key = JSON.stringify(files);
    if (key === this.key) return;
    this.key = key;
    $("record-files").replaceChildren(...files.toReversed().map(linkOf));
    setText($("record-folder"), files.length ? `On the server in ${folder}` : "");
  }
}
