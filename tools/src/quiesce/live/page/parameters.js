// Parameters with unit, range, default; edits are applied together.
import { $ } from "./dom.js";

const textOf = (parameter, value) => (parameter.labels ? (parameter.labels[value] ?? String(value)) : String(value));

function rangeOf({ labels, choices, min, max }) {
  if (labels) return labels.join(", ");
  return choices ? choices.join(", ") : `${min} .. ${max}`;
}

// A choice where there are few values, else a number.
function inputOf(parameter) {
  const choices = parameter.labels ?? parameter.choices?.map(String);
  const input = document.createElement(choices ? "select" : "input");
  if (choices) {
    for (const choice of choices) input.add(new Option(choice, choice));
  } else {
    Object.assign(input, { type: "number", step: 1, min: parameter.min, max: parameter.max, required: true });
  }
  input.setAttribute("aria-label", parameter.unit === "-" ? parameter.name : `${parameter.name} in ${parameter.unit}`);
  input.disabled = true;
  return input;
}

export class Parameters {
  constructor(send) {
    this.send = send;
    this.rows = [];
    this.canChange = false;
    $("apply").addEventListener("click", () => this.apply());
    $("discard").addEventListener("click", () => this.discard());
    $("save").addEventListener("click", () => send({ do: "save" }));
    $("revert").addEventListener("click", () => send({ do: "revert" }));
    $("find").addEventListener("input", () => this.filter());
    $("changed").addEventListener("change", () => this.filter());
  }

  describe(parameters) {
    this.rows = parameters.map((parameter) => this.rowOf(parameter));
    $("rows").replaceChildren(...this.rows.map((row) => row.place));
  }

  rowOf(parameter) {
    const place = document.createElement("div");
    place.className = "row";
    const name = document.createElement("div");
    name.append(Object.assign(document.createElement("code"), { textContent: parameter.name }));
    name.append(Object.assign(document.createElement("small"), { textContent: parameter.help }));
    const input = inputOf(parameter);
    const range = document.createElement("div");
    const unit = parameter.unit === "-" ? "" : ` ${parameter.unit}`;
    range.textContent = `${rangeOf(parameter)}${unit}; default ${textOf(parameter, parameter.default)}`;
    const mark = document.createElement("div");
    mark.className = "mark";
    place.append(name, input, range, mark);
    const row = { parameter, place, input, mark, value: null };
    input.addEventListener("input", () => this.mark(row));
    return row;
  }

  // values: in effect; before: what 'revert' goes back to. Edits that are under way stay.
  set(values, before) {
    this.before = before.is_saved ? "last save" : "server's start";
    $("revert").textContent = `Revert to the ${this.before}`;
    this.rows.forEach((row, i) => {
      const isEdited = this.isEdited(row);
      row.value = values[i] ?? null;
      row.before = before.values[i] ?? null;
      if (row.value !== null && !isEdited) row.input.value = textOf(row.parameter, row.value);
      this.mark(row);
    });
    this.filter();
    this.enable(this.canChange);
  }

  enable(canChange) {
    this.canChange = canChange;
    for (const row of this.rows) row.input.disabled = !canChange || row.value === null;
    this.enableButtons();
  }

  isEdited({ parameter, input, value }) {
    return value !== null && input.value !== textOf(parameter, value);
  }

  mark(row) {
    const words = [];
    if (this.isEdited(row)) words.push(row.input.checkValidity() ? `edited, in effect ${textOf(row.parameter, row.value)}` : "out of its range");
    if (row.value !== null && row.value !== row.parameter.default) words.push("differs from its default");
    if (row.value !== row.before) words.push(`${textOf(row.parameter, row.before)} at the ${this.before}`);
    row.mark.textContent = words.join("; ");
    row.place.classList.toggle("edited", this.isEdited(row));
    this.enableButtons();
  }

  enableButtons() {
    const edited = this.rows.filter((row) => this.isEdited(row));
    const areValid = edited.every((row) => row.input.checkValidity());
    $("apply").disabled = !this.canChange || !edited.length || !areValid;
    $("discard").disabled = !edited.length;
    $("save").disabled = !this.canChange;
    $("revert").disabled = !this.canChange || this.rows.every((row) => row.value === row.before);
  }

  filter() {
    const word = $("find").value.trim().toLowerCase();
    const isOnlyChanged = $("changed").checked;
    for (const { place, parameter, value } of this.rows) {
      const isFound = parameter.name.toLowerCase().includes(word) || parameter.help.toLowerCase().includes(word);
      place.hidden = !isFound || (isOnlyChanged && (value === null || value === parameter.default));
    }
  }

  apply() {
    const edited = this.rows.filter((row) => this.isEdited(row));
    this.send({ do: "set", settings: Object.fromEntries(edited.map((row) => [row.parameter.name, row.input.value])) });
  }

  discard() {
    for (const row of this.rows.filter((one) => this.isEdited(one))) {
      row.input.value = textOf(row.parameter, row.value);
      this.mark(row);
    }
  }
}
