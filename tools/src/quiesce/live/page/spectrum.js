// Spectrum of an acceleration, as the server computes it, and below it the ones before: the waterfall.
import { $ } from "./dom.js";

const ACCELERATIONS = ["accel_counts", "sample_counts"];
const HEIGHT_px = 220;
const ROWS = 120; // of the waterfall
const COLUMNS = 480;
const RANGE = 1e3; // from the strongest to what is not seen any more: 60 dB
const LEAST_px = 200;

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// Red, green, blue of a colour of the style sheet.
function rgb(name) {
  const hex = css(name).slice(1);
  const digits = hex.length === 3 ? Array.from(hex, (one) => one + one) : hex.match(/../g);
  return digits.map((one) => parseInt(one, 16));
}

function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

export class Spectrum {
  // factorOf(series): scale, offset and unit of its values, as they are shown.
  constructor(send, factorOf) {
    this.send = send;
    this.factorOf = factorOf;
    this.series = [];
    this.rows = []; // the newest first
    this.plot = null;
    for (const id of ["spectrum-series", "spectrum-length", "spectrum-averages", "spectrum-most"]) {
      $(id).addEventListener("change", () => this.ask());
    }
    new ResizeObserver(() => this.fit()).observe($("spectrum-chart"));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.restart());
  }

  // Signals that the bus carries.
  offer(series) {
    const before = $("spectrum-series").value;
    this.series = series.filter((one) => ACCELERATIONS.includes(one.signal)).toReversed(); // raw samples before others
    $("spectrum-series").replaceChildren(...this.series.map((one) => new Option(`${one.title} (${one.message})`, one.number)));
    if (this.series.some((one) => String(one.number) === before)) $("spectrum-series").value = before;
    this.ask();
  }

  get chosen() {
    return this.series.find((one) => String(one.number) === $("spectrum-series").value);
  }

  ask() {
    this.restart();
    this.send({
      do: "spectrum",
      series: this.chosen?.number ?? null,
      length_s: Number($("spectrum-length").value),
      averages: Number($("spectrum-averages").value),
      most_Hz: Number($("spectrum-most").value),
    });
    setText($("spectrum-said"), this.chosen ? "Waiting for the first window ..." :
      "No acceleration comes on this bus: start the server with --raw.");
  }

  restart() {
    this.rows = [];
    this.plot?.destroy();
    this.plot = null;
    const canvas = $("spectrum-waterfall");
    canvas.getContext("2d").clearRect(0, 0, canvas.width, canvas.height);
  }

  // spectrum: as the server tells it (docs/reference/live-protocol.md).
  show(spectrum) {
    if (spectrum.series !== this.chosen?.number || !spectrum.used) return;
    const { scale, unit } = this.factorOf(this.chosen);
    const values = spectrum.rms.map((one) => one * Math.abs(scale));
    if (this.unit !== unit) this.restart();
    this.unit = unit;
    this.most_Hz = spectrum.most_Hz;
    this.freq_Hz = spectrum.freq_Hz;
    this.rows.unshift({ values, step_Hz: spectrum.step_Hz, freq_Hz: spectrum.freq_Hz });
    this.rows.length = Math.min(this.rows.length, ROWS);
    this.plot ??= new uPlot(this.options(), [[], []], $("spectrum-chart"));
    this.plot.setData([values.map((_, i) => i * spectrum.step_Hz), values.map((one) => one || null)]);
    this.pour();
    this.tell(spectrum, values);
  }

  tell({ step_Hz, rate_Hz, used, averages, freq_Hz }, values) {
    const peak = values.reduce((best, one, i) => (one > values[best] ? i : best), 0);
    const windows = used < averages ? `${used} of ${averages} windows` : averages === 1 ? "one window" : `mean power of ${averages} windows`;
    setText($("spectrum-peak"), `Strongest at ${(peak * step_Hz).toFixed(2)} Hz: ${values[peak].toPrecision(3)} ${this.unit} RMS; ` +
      `the controller reports ${freq_Hz === null ? "no frequency" : `${freq_Hz.toFixed(2)} Hz`}.`);
    setText($("spectrum-said"), `Hann, ${windows} of ${(1 / step_Hz).toPrecision(3)} s that overlap by half; a line every ${step_Hz.toPrecision(3)} Hz, ` +
      `of ${rate_Hz.toFixed(0)} samples a second. A sine stands as high as its RMS. Dashed: what the controller reports.`);
  }

  options() {
    const axis = { stroke: css("--text"), grid: { stroke: css("--line"), width: 1 }, ticks: { stroke: css("--line") } };
    return {
      width: this.width,
      height: HEIGHT_px,
      legend: { show: false },
      cursor: { show: false },
      scales: {
        x: { time: false, range: () => [0, this.most_Hz] },
        y: { distr: 3, range: (_, __, high) => [(high || 1) / RANGE, (high || 1) * 1.5] },
      },
      axes: [
        { ...axis, values: (_, all) => all.map((one) => `${one} Hz`) },
        { ...axis, size: 76, label: `${this.unit || "1"} RMS`, labelSize: 18 },
      ],
      series: [{}, { stroke: css("--series0"), width: 1, points: { show: false } }],
      hooks: { draw: [(plot) => this.mark(plot)] },
    };
  }

  // The frequency that the controller reports.
  mark(plot) {
    if (this.freq_Hz === null || this.freq_Hz > this.most_Hz) return;
    const at = plot.valToPos(this.freq_Hz, "x", true);
    const { ctx, bbox } = plot;
    ctx.save();
    ctx.strokeStyle = css("--bad");
    ctx.lineWidth = 2;
    ctx.setLineDash([6, 4]);
    ctx.beginPath();
    ctx.moveTo(at, bbox.top);
    ctx.lineTo(at, bbox.top + bbox.height);
    ctx.stroke();
    ctx.restore();
  }

  // The waterfall, a row for each spectrum, below the chart's own axis.
  pour() {
    const canvas = $("spectrum-waterfall");
    canvas.width = COLUMNS;
    canvas.height = ROWS;
    canvas.style.marginLeft = `${this.plot.bbox.left / devicePixelRatio}px`;
    canvas.style.width = `${this.plot.bbox.width / devicePixelRatio}px`;
    const context = canvas.getContext("2d");
    const image = context.createImageData(COLUMNS, ROWS);
    const [weak, strong, reported] = ["--card", "--text", "--bad"].map(rgb);
    const most = this.rows.reduce((high, { values }) => values.reduce((a, b) => Math.max(a, b), high), 0);
    this.rows.forEach(({ values, step_Hz, freq_Hz }, row) => {
      const marked = freq_Hz === null ? -1 : Math.floor((freq_Hz / this.most_Hz) * COLUMNS);
      for (let column = 0; column < COLUMNS; column++) {
        const value = values[Math.round(((column + 0.5) / COLUMNS) * this.most_Hz / step_Hz)] ?? 0;
        const share = most > 0 ? Math.min(1, Math.max(0, 1 + Math.log10(value / most) / Math.log10(RANGE))) : 0;
        const at = 4 * (row * COLUMNS + column);
        for (let i = 0; i < 3; i++) image.data[at + i] = column === marked ? reported[i] : weak[i] + (strong[i] - weak[i]) * share;
        image.data[at + 3] = 255;
      }
    });
    context.putImageData(image, 0, 0);
  }

  get width() {
    return Math.max(LEAST_px, $("spectrum-chart").clientWidth);
  }

  fit() {
    if (this.plot === null || this.plot.width === this.width) return;
    this.plot.setSize({ width: this.width, height: HEIGHT_px });
    this.pour();
  }
}
