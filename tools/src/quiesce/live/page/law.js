// The table that the law uses, as the controller has it: the surface of its rules with the point at which
// it works, or its pulses with the frequency that it reports.
import { $ } from "./dom.js";

const HEIGHT_px = 300;
const LEFT_px = 62;
const BELOW_px = 40;
const EDGE_px = 22;
const TICKS = 6;
const HALF_CYCLE_deg = 180;

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const shown = (value) => String(Number(value.toPrecision(3)));

// Place of the value between its neighbours: index of the lower one, and how far beyond.
function between(values, value) {
  const last = values.length - 1;
  const at = Math.min(last - 1, Math.max(0, values.findLastIndex((one) => one <= value)));
  return [at, Math.min(1, Math.max(0, (value - values[at]) / (values[at + 1] - values[at])))];
}

function surfaceAt({ freq_Hz, accel_m_s2, current_A }, freq, accel) {
  const [i, s] = between(freq_Hz, freq);
  const [j, t] = between(accel_m_s2, accel);
  const row = (k) => current_A[k][i] + (current_A[k][i + 1] - current_A[k][i]) * s;
  return row(j) + (row(j + 1) - row(j)) * t;
}

// Of a setting's rows at a frequency: centre, width, level. Centres go the shorter way round.
function pulseAt(rows, freq) {
  const [i, s] = between(rows.map((one) => one[0]), freq);
  const [centre, wide, level] = [1, 2, 3].map((k) => {
    const apart = rows[i + 1][k] - rows[i][k];
    return rows[i][k] + (k === 1 ? apart - HALF_CYCLE_deg * Math.round(apart / HALF_CYCLE_deg) : apart) * s;
  });
  return [(centre + HALF_CYCLE_deg) % HALF_CYCLE_deg, wide, level];
}

export class Law {
  constructor(send) {
    this.view = null;
    this.here = {}; // what the controller reports
    $("law-fetch").addEventListener("click", () => {
      this.say(true, "On its way ...");
      send({ do: "law" });
    });
    $("law-setting").addEventListener("change", () => this.draw());
    new ResizeObserver(() => this.draw()).observe($("law"));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
  }

  say(isOk, text) {
    $("law-said").className = isOk ? "" : "bad";
    $("law-said").textContent = text;
  }

  enable(can) {
    $("law-fetch").disabled = !can;
  }

  // Whether the note is about it.
  hear({ is_ok, text, of }) {
    if (of !== "law") return false;
    if (!is_ok) this.say(false, text);
    return true;
  }

  describe(view) {
    this.view = view;
    const settings = Object.keys(view?.pulses?.settings ?? {});
    $("law-which").hidden = settings.length === 0;
    $("law-setting").replaceChildren(...settings.map((name) => new Option(name, name)));
    $("law-picture").hidden = !view?.surface && !view?.pulses;
    if (view) {
      const what = $("law-picture").hidden ? ": there is no picture of this kind" : "";
      this.say(true, `${view.kind} ${view.crc}, as the controller had it at ${new Date().toLocaleTimeString()}${what}.`);
    }
    this.draw();
  }

  // controller: of the state.
  show({ freq_Hz, rms_m_s2, freq_is_valid }) {
    const here = { freq_Hz: freq_is_valid ? freq_Hz : null, rms_m_s2 };
    if (here.freq_Hz === this.here.freq_Hz && here.rms_m_s2 === this.here.rms_m_s2) return;
    this.here = here;
    this.draw();
  }

  draw() {
    const canvas = $("law-picture");
    if (canvas.hidden || !this.view) return;
    const width = canvas.clientWidth;
    if (!width) return;
    canvas.width = width * devicePixelRatio;
    canvas.height = HEIGHT_px * devicePixelRatio;
    canvas.style.height = `${HEIGHT_px}px`;
    const context = canvas.getContext("2d");
    context.scale(devicePixelRatio, devicePixelRatio);
    context.font = "13px system-ui, sans-serif";
    const text = this.view.surface ? this.drawSurface(context, width) : this.drawPulses(context, width);
    if ($("law-here").textContent !== text) $("law-here").textContent = text;
    canvas.setAttribute("aria-label", `the law's table, ${this.view.kind}; ${text}`);
  }

  // Places of values in the picture; the axes with their numbers.
  axes(context, width, [left, right], [low, high], names) {
    const x = (value) => LEFT_px + ((value - left) / (right - left)) * (width - LEFT_px - EDGE_px);
    const y = (value) => HEIGHT_px - BELOW_px - ((value - low) / (high - low)) * (HEIGHT_px - BELOW_px - EDGE_px);
    context.fillStyle = css("--text");
    context.textAlign = "center";
    for (let k = 0; k <= TICKS; k++) {
      const value = left + ((right - left) * k) / TICKS;
      context.fillText(shown(value), x(value), HEIGHT_px - BELOW_px + 16);
    }
    context.fillText(names[0], (LEFT_px + width) / 2, HEIGHT_px - 6);
    context.textAlign = "right";
    for (let k = 0; k <= TICKS; k++) {
      const value = low + ((high - low) * k) / TICKS;
      context.fillText(shown(value), LEFT_px - 6, y(value) + 4);
    }
    context.save();
    context.translate(12, (HEIGHT_px - BELOW_px) / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    context.fillText(names[1], 0, 0);
    context.restore();
    return [x, y];
  }

  drawSurface(context, width) {
    const { freq_Hz, accel_m_s2, current_A } = this.view.surface;
    const ends = (values) => [values[0], values.at(-1)];
    const [x, y] = this.axes(context, width, ends(freq_Hz), ends(accel_m_s2), ["Hz", "m/s2 RMS"]);
    const most = Math.max(...current_A.flat(), 1e-9);
    context.fillStyle = css("--series0");
    const [columns, rows] = [freq_Hz.map((one) => Math.round(x(one))), accel_m_s2.map((one) => Math.round(y(one)))];
    for (let j = 0; j + 1 < accel_m_s2.length; j++) {
      for (let i = 0; i + 1 < freq_Hz.length; i++) {
        context.globalAlpha = 0.04 + 0.96 * (current_A[j][i] + current_A[j + 1][i + 1]) / (2 * most);
        context.fillRect(columns[i], rows[j + 1], columns[i + 1] - columns[i], rows[j] - rows[j + 1]);
      }
    }
    context.globalAlpha = 1;
    const dark = `Darkest: ${shown(most)} A.`;
    const { freq_Hz: freq, rms_m_s2: accel } = this.here;
    if (freq === null || accel === null || freq === undefined) return `${dark} The controller reports no frequency.`;
    this.cross(context, x(Math.min(freq_Hz.at(-1), Math.max(freq_Hz[0], freq))), y(Math.min(accel_m_s2.at(-1), Math.max(accel_m_s2[0], accel))), width);
    return `${dark} At ${freq.toFixed(2)} Hz and ${shown(accel)} m/s2 RMS it says ${shown(surfaceAt(this.view.surface, freq, accel))} A.`;
  }

  drawPulses(context, width) {
    const { settings, unlock_A } = this.view.pulses;
    const rows = settings[$("law-setting").value] ?? [];
    const freqs = rows.map((one) => one[0]);
    const [x, y] = this.axes(context, width, [freqs[0], freqs.at(-1)], [0, HALF_CYCLE_deg], ["Hz", "degrees of half a cycle"]);
    const most = Math.max(...rows.map((one) => one[3]), 1e-9);
    context.fillStyle = css("--series0");
    rows.forEach(([freq, centre, wide, level], i) => {
      const left = i ? (freqs[i - 1] + freq) / 2 : freq;
      const right = i + 1 < rows.length ? (freqs[i + 1] + freq) / 2 : freq;
      context.globalAlpha = 0.1 + (0.9 * level) / most;
      // The half cycle after this one is the same: what passes an end comes in at the other.
      for (const turn of [-HALF_CYCLE_deg, 0, HALF_CYCLE_deg]) {
        const from = Math.max(0, centre - wide / 2 + turn);
        const to = Math.min(HALF_CYCLE_deg, centre + wide / 2 + turn);
        const [at, wide_px] = [Math.round(x(left)), Math.round(x(right)) - Math.round(x(left))];
        if (to > from) context.fillRect(at, y(to), wide_px, y(from) - y(to));
      }
    });
    context.globalAlpha = 1;
    const held = `Darkest: ${shown(most)} A. Without a lock: ${shown(unlock_A)} A.`;
    const freq = this.here.freq_Hz;
    if (freq === null || freq === undefined) return `${held} The controller reports no frequency.`;
    const [centre, wide, level] = pulseAt(rows, freq);
    this.cross(context, x(Math.min(freqs.at(-1), Math.max(freqs[0], freq))), y(centre), width);
    return `${held} At ${freq.toFixed(2)} Hz: ${shown(level)} A for ${wide.toFixed(0)} degrees around ${centre.toFixed(0)}.`;
  }

  cross(context, at, up, width) {
    context.strokeStyle = css("--bad");
    context.lineWidth = 2;
    context.setLineDash([6, 4]);
    context.beginPath();
    context.moveTo(at, EDGE_px);
    context.lineTo(at, HEIGHT_px - BELOW_px);
    context.moveTo(LEFT_px, up);
    context.lineTo(width - EDGE_px, up);
    context.stroke();
    context.setLineDash([]);
    context.beginPath();
    context.arc(at, up, 5, 0, 2 * Math.PI);
    context.stroke();
  }
}
