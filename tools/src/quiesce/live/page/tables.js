// Tables into the controller: a file in parts, and what became of it.
import { $ } from "./dom.js";

const PART_BYTES = 2700;
const MOST_PARTS = 64;

function base64Of(bytes) {
  return btoa(String.fromCharCode(...bytes));
}

// As the server takes names: of letters, digits, '.', '_' and '-'.
function nameOf(file) {
  const name = file.name.replace(/[^A-Za-z0-9._-]/g, "_").slice(-64).replace(/^[^A-Za-z0-9]+/, "");
  return name || "table";
}

export class Tables {
  constructor(send) {
    this.send = send;
    this.isWaiting = false; // for the word about what was sent
    $("table-load").addEventListener("click", () => this.load());
  }

  say(isOk, text) {
    $("table-said").className = isOk ? "good" : "bad";
    $("table-said").textContent = text;
  }

  enable(can) {
    $("table-file").disabled = $("table-load").disabled = !can;
  }

  async load() {
    const file = $("table-file").files[0];
    if (!file) return this.say(false, "Choose a file first.");
    const parts = Math.max(1, Math.ceil(file.size / PART_BYTES));
    if (parts > MOST_PARTS) return this.say(false, `${file.name} has ${file.size} bytes; at most ${PART_BYTES * MOST_PARTS} are taken.`);
    const bytes = new Uint8Array(await file.arrayBuffer());
    this.say(true, `${file.name} is on its way ...`);
    this.isWaiting = true;
    for (let part = 0; part < parts; part++) {
      const data = base64Of(bytes.subarray(part * PART_BYTES, (part + 1) * PART_BYTES));
      this.send({ do: "table", kind: $("table-kind").value, name: nameOf(file), part, parts, data });
    }
  }

  lost() {
    if (this.isWaiting) this.say(false, "The connection was lost; load it again.");
    this.isWaiting = false;
    this.enable(false);
  }

  // Whether the note is about the table.
  hear({ is_ok, text, of }) {
    if (of !== "table") return false;
    this.isWaiting = false;
    this.say(is_ok, text);
    return true;
  }
}
