// Samples as they come over the websocket (docs/reference/live-protocol.md), kept for the longest window.

const KIND = 1;
const VERSION = 1;
const HEAD_BYTES = 24;
const BLOCK_BYTES = 20;
const DRIFT_s = 4e-6; // that two clocks may part between two packets: 100 ppm
const SIZE = 65536; // samples of a message: a minute at 1 kHz

// A packet's blocks; null where it is none that this page understands.
export function decode(buffer) {
  const view = new DataView(buffer);
  if (view.byteLength < HEAD_BYTES || view.getUint8(0) !== KIND || view.getUint8(1) !== VERSION) return null;
  const packet = { number: view.getUint32(4, true), sent_s: view.getFloat64(8, true), blocks: [] };
  let at = HEAD_BYTES;
  const take = (type, length) => {
    const found = new type(buffer, at, length);
    at += found.byteLength;
    return found;
  };
  for (let left = view.getUint16(2, true); left > 0; left--) {
    const block = { id: view.getUint16(at, true), first: view.getUint32(at + 8, true) };
    const width = view.getUint16(at + 2, true);
    const length = view.getUint32(at + 4, true);
    block.start_s = view.getFloat64(at + 12, true);
    at += BLOCK_BYTES;
    block.series = take(Uint32Array, width);
    block.offsets_us = take(Int32Array, length);
    block.values = Array.from(block.series, () => take(Float32Array, length));
    packet.blocks.push(block);
  }
  return packet;
}

// The last samples of one series, with the times of their message.
class Track {
  constructor() {
    this.times_s = new Float64Array(SIZE);
    this.values = new Float32Array(SIZE);
    this.count = 0; // of all that ever came
    this.drawn = 0; // of them, when it was drawn last
  }

  add(block, values) {
    for (let i = 0; i < values.length; i++) {
      const at = this.count++ % SIZE;
      this.times_s[at] = block.start_s + block.offsets_us[i] * 1e-6;
      this.values[at] = values[i];
    }
  }

  get last() {
    return this.count ? this.values[(this.count - 1) % SIZE] : null;
  }

  // Number of the first kept sample that is not older.
  since(time_s) {
    let low = Math.max(0, this.count - SIZE);
    let high = this.count;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.times_s[middle % SIZE] < time_s) low = middle + 1;
      else high = middle;
    }
    return low;
  }
}

export class Samples {
  constructor() {
    this.tracks = new Map(); // by the number of the series
    this.lost = 0; // samples that the numbers say are missing
    this.ages_ms = new Uint32Array(2000); // how many samples were drawn how old; the last: older
    this.drawn = 0;
    this.restart();
  }

  // After a connection anew: the server begins with its history.
  restart() {
    this.tracks.clear();
    this.clockAhead_s = -Infinity; // of the server's clock
    this.expected = new Map(); // the next sample's number, by message
    this.packet = null;
  }

  add(packet) {
    if (this.packet !== null && packet.number !== (this.packet + 1) % 2 ** 32) this.lost++;
    this.packet = packet.number;
    const ahead_s = packet.sent_s - performance.now() / 1000;
    this.clockAhead_s = Math.max(this.clockAhead_s - DRIFT_s, ahead_s);
    for (const block of packet.blocks) {
      const expected = this.expected.get(block.id);
      if (expected !== undefined) this.lost += (block.first - expected + 2 ** 32) % 2 ** 32;
      this.expected.set(block.id, (block.first + block.offsets_us.length) % 2 ** 32);
      block.series.forEach((number, i) => this.track(number).add(block, block.values[i]));
    }
  }

  // A message that was not drawn: its numbers went on meanwhile.
  resume(id) {
    this.expected.delete(id);
  }

  track(number) {
    if (!this.tracks.has(number)) this.tracks.set(number, new Track());
    return this.tracks.get(number);
  }

  // The server's clock, as near as the quickest packet tells.
  now_s() {
    return this.clockAhead_s + performance.now() / 1000;
  }

  // What was drawn of a track, for the counts. Ages are of the browser's own clock: right where both are one.
  note(track) {
    const now_ms = performance.timeOrigin + performance.now();
    for (let i = Math.max(track.drawn, track.count - SIZE); i < track.count; i++) {
      const age_ms = now_ms - track.times_s[i % SIZE] * 1000;
      this.ages_ms[Math.min(Math.max(0, Math.round(age_ms)), this.ages_ms.length - 1)]++;
    }
    this.drawn += track.count - track.drawn;
    track.drawn = track.count;
  }
}

// Least and greatest of a track in each of so many columns of a window, two points a column, so that no sample is
// left out. undefined: none in that column, the line goes on; null: none for longer than gap_s.
export function columns(track, start_s, width_s, count, factor, gap_s = 1.0) {
  const out = new Array(2 * count).fill(undefined);
  let last = null; // the last column with a value
  for (let i = track.since(start_s); i < track.count; i++) {
    const column = Math.floor((track.times_s[i % SIZE] - start_s) / width_s);
    if (column >= count) break;
    const value = track.values[i % SIZE] * factor.scale + factor.offset;
    if (Number.isNaN(value)) continue;
    if (last !== null && (column - last) * width_s > gap_s) out.fill(null, 2 * last + 2, 2 * column);
    const at = 2 * column;
    out[at] = column === last ? Math.min(out[at], value) : value;
    out[at + 1] = column === last ? Math.max(out[at + 1], value) : value;
    last = column;
  }
  return out;
}
