// The guided session: its steps, what it says, what it asks. Who holds control leads it.
import { $, make, setText } from "./dom.js";

const READ_ms = 1000;
const PAGES = {
  "report.html": "Report",
  "before_after.html": "Before and after",
  "tuned/report.html": "What was tuned",
};

export class Guide {
  constructor(send) {
    this.send = send;
    this.isThere = false;
    this.refused = "";
    this.asked_ms = -Infinity;
    this.number = null; // of the question that is shown
    this.shown = ""; // steps and pages
    $("guide-go").addEventListener("click", () => this.begin());
    $("guide-leave").addEventListener("click", () => this.order({ leave: true }));
    $("guide-yes").addEventListener("click", () => this.answer(true));
    $("guide-no").addEventListener("click", () => this.answer(false));
  }

  describe(hello) {
    this.isThere = hello.has_guide;
    $("guide").hidden = !this.isThere;
    this.enable(false);
  }

  order(order) {
    this.refused = "";
    this.send({ do: "guide", order });
  }

  begin() {
    const from = $("guide-from").value;
    $("guide-from").value = ""; // once: what is done after it is not done again
    this.order({ begin: from || null, is_one: $("guide-one").checked });
  }

  answer(isYes) {
    if (this.number !== null) this.order({ answer: isYes, of: this.number });
  }

  // Of a note that is about it: why it was not obeyed.
  hear(note) {
    if (note.of !== "guide") return false;
    this.refused = note.text;
    return true;
  }

  show(state, isMine) {
    if (!this.isThere || !state.guide) return;
    const guide = state.guide;
    const next = guide.steps.find((one) => one.line === "");
    this.showSteps(guide, next);
    setText($("guide-says"), guide.says);
    this.ask(guide.asks);
    this.showEnd(guide);
    setText($("guide-go"), guide.steps.some((one) => one.line !== "") ? "Go on" : "Begin");
    this.enable(isMine, guide, next, state.job);
  }

  showSteps(guide, next) {
    const key = JSON.stringify([guide.steps, guide.pages, guide.is_at_work]);
    if (key === this.shown) return;
    this.shown = key;
    const isNow = (one) => guide.is_at_work && one === next;
    $("guide-steps").replaceChildren(...guide.steps.map((one) => make("li",
      { className: isNow(one) ? "now" : one.line ? "done" : "" },
      make("b", { textContent: one.title }), ` ${isNow(one) ? "under way" : one.line || "to do"}`)));
    for (const item of $("guide-steps").querySelectorAll(".now")) item.setAttribute("aria-current", "step");
    const from = $("guide-from").value;
    const done = guide.steps.filter((one) => one.line !== "");
    $("guide-from").replaceChildren(new Option("where it is", ""), ...done.map((one) => new Option(one.title, one.name)));
    if (done.some((one) => one.name === from)) $("guide-from").value = from;
    $("guide-pages").replaceChildren(...guide.pages.map((name) => make("li", {},
      make("a", { href: `commission/${name}`, target: "_blank", rel: "noopener", textContent: PAGES[name] }))));
  }

  ask(asks) {
    const number = asks ? asks.number : null;
    if (number === this.number) return;
    this.number = number;
    this.asked_ms = performance.now();
    $("guide-question").hidden = asks === null;
    if (asks === null) return;
    $("guide-question").classList.toggle("hazard", asks.is_hazard);
    setText($("guide-text"), `${asks.text}.`);
    setText($("guide-yes"), asks.is_hazard ? "Yes, current may flow" : "Done");
    $("guide-no").hidden = !asks.is_hazard;
  }

  showEnd(guide) {
    const trouble = this.refused || guide.trouble;
    const ended = trouble ? { is_ok: false, text: trouble } : guide.is_at_work ? null : guide.ended;
    $("guide-ended").className = ended && !ended.is_ok ? "bad" : "good";
    setText($("guide-ended"), ended ? ended.text : guide.is_leaving && guide.is_at_work ? "leaving ..." : "");
  }

  // Without a guide: all of it is off.
  enable(isMine, guide = null, next = null, job = "") {
    const isAtWork = guide !== null && guide.is_at_work;
    const mayBegin = Boolean(isMine) && guide !== null && !isAtWork && !job;
    $("guide-go").disabled = !mayBegin || (!next && !$("guide-from").value);
    $("guide-from").disabled = $("guide-one").disabled = !mayBegin;
    $("guide-leave").disabled = !(isMine && isAtWork && !guide.is_leaving);
    // A second click, or a key that is held, answers nothing that nobody has read.
    const isRead = performance.now() - this.asked_ms > READ_ms;
    $("guide-yes").disabled = $("guide-no").disabled = !(isMine && isAtWork && isRead);
  }
}
