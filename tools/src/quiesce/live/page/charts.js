// Strip charts: a panel for each unit, a line for each signal.
import { columns } from "./samples.js";

const HEIGHT_px = 190;
const COLUMN_px = 2;
const COLORS = 8;

const LEAST_SPAN = 0.02; // of the values: noise of a steady one does not fill the panel

function span(low, high) {
  if (low === null || high === null) return [0, 1];
  const middle = (low + high) / 2;
  const half = Math.max((high - low) / 2, Math.abs(middle) * LEAST_SPAN, 1e-6) * 1.05;
  return [middle - half, middle + half];
}

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export class Charts {
  constructor(place, samples) {
    this.place = place;
    this.samples = samples;
    this.panels = [];
    this.series = []; // nothing is shown yet
    this.factorOf = null;
    this.window_s = 10;
    this.isHeld = false;
    new ResizeObserver(() => this.fit()).observe(place);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.show(this.series, this.factorOf));
  }

  // series: as the server describes them; factorOf(one): scale, offset and unit of its values.
  show(series, factorOf) {
    this.series = series;
    this.factorOf = factorOf;
    for (const panel of this.panels) panel.plot.destroy();
    this.place.replaceChildren();
    const byUnit = Map.groupBy(series, (one) => factorOf(one).unit);
    this.panels = Array.from(byUnit, ([unit, members]) => this.panelOf(unit, members));
  }

  panelOf(unit, members) {
    const figure = document.createElement("figure");
    const legend = document.createElement("figcaption");
    const values = members.map((one) => {
      const key = document.createElement("span");
      key.className = `key color${this.colorOf(one)}`;
      const value = document.createElement("output");
      key.append(`${one.title} `, value);
      key.title = `${one.message}.${one.signal}`;
      legend.append(key);
      return value;
    });
    const canvas = document.createElement("div");
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `strip chart of ${members.map((one) => one.title).join(", ")}`);
    figure.append(legend, canvas);
    this.place.append(figure);
    const plot = new uPlot(this.optionsOf(unit, members), [[], ...members.map(() => [])], canvas);
    return { plot, members, values, factors: members.map(this.factorOf) };
  }

  colorOf(one) {
    return this.series.indexOf(one) % COLORS;
  }

  optionsOf(unit, members) {
    const axis = { stroke: css("--text"), grid: { stroke: css("--line"), width: 1 }, ticks: { stroke: css("--line") } };
    return {
      width: Math.max(200, this.place.clientWidth),
      height: HEIGHT_px,
      legend: { show: false },
      cursor: { show: false },
      scales: {
        x: { time: false, range: () => [-this.window_s, 0] },
        y: { range: (_, low, high) => span(low, high) },
      },
      axes: [
        { ...axis, values: (_, all) => all.map((one) => `${one} s`) },
        { ...axis, size: 62, label: unit || "1", labelSize: 18 },
      ],
      series: [
        {},
        ...members.map((one) => ({
          stroke: css(`--series${this.colorOf(one)}`),
          width: 1,
          points: { show: false },
        })),
      ],
    };
  }

  fit() {
    const width = Math.max(200, this.place.clientWidth);
    for (const { plot } of this.panels) {
      if (plot.width !== width) plot.setSize({ width, height: HEIGHT_px });
    }
  }

  draw() {
    if (this.isHeld) return;
    const count = Math.max(50, Math.floor(this.place.clientWidth / COLUMN_px));
    const width_s = this.window_s / count;
    // Columns stand at multiples of their width: what was drawn does not flicker.
    const end_s = Math.ceil(this.samples.now_s() / width_s) * width_s;
    const start_s = end_s - this.window_s;
    const times_s = Array.from({ length: 2 * count }, (_, i) => ((i + 0.5) * width_s) / 2 - this.window_s);
    for (const panel of this.panels) {
      const tracks = panel.members.map((one) => this.samples.track(one.number));
      const lines = tracks.map((one, i) => columns(one, start_s, width_s, count, panel.factors[i]));
      panel.plot.setData([times_s, ...lines]);
      for (const one of tracks) this.samples.note(one);
    }
  }

  // The newest values, less often than lines: nobody reads 25 a second.
  tell() {
    for (const { members, values, factors } of this.panels) {
      members.forEach((one, i) => {
        const last = this.samples.track(one.number).last;
        const value = last === null || Number.isNaN(last) ? "-" : (last * factors[i].scale + factors[i].offset).toPrecision(4);
        values[i].textContent = `${value} ${factors[i].unit}`;
      });
    }
  }
}
