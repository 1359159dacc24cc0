// STOP. Works in every state of the page: over the websocket, beside it by HTTP until the server has it, again and
// again while there is no server, and says what has become of it.

const RETRY_ms = 250;
const ANSWER_ms = 300; // of the server, to what went over the websocket
const SWITCH = "Use the emergency stop's own switch.";

export class Stop {
  constructor(button, said, send) {
    this.button = button;
    this.said = said;
    this.send = send; // over the websocket; false where there is none
    this.isWanted = false; // pressed, and the server has not said that it has it
    this.tries = 0;
    button.addEventListener("click", () => this.press());
    // Before anything else on the page gets the key.
    addEventListener("keydown", (event) => {
      if (event.key !== "Escape" || event.repeat) return;
      event.preventDefault();
      this.press();
    }, { capture: true });
  }

  press() {
    this.tries = 0;
    const isSent = this.send({ do: "stop" });
    this.tell("pressed", "STOP: sending ...");
    if (this.isWanted) return;
    this.isWanted = true;
    setTimeout(() => this.insist(), isSent ? ANSWER_ms : 0);
  }

  async insist() {
    while (this.isWanted) {
      try {
        const answer = await fetch("stop", { method: "POST", signal: AbortSignal.timeout(2000) });
        if (answer.ok) {
          this.server(await answer.json());
          return;
        }
      } catch {
        // Told below, and tried again.
      }
      this.tries++;
      this.tell("bad", `STOP NOT SENT: no connection to the server. Trying again (${this.tries}). ${SWITCH}`);
      await new Promise((done) => setTimeout(done, RETRY_ms));
      this.send({ do: "stop" });
    }
  }

  // What the server says of it, with each state.
  server(stop) {
    if (stop.state !== "idle") this.isWanted = false;
    if (stop.state === "confirmed") {
      this.tell("confirmed", "Stopped: the controller reports fault ESTOP.");
    } else if (stop.state === "pressed" && stop.waited_s < 1) {
      this.tell("pressed", "STOP: waiting for the controller ...");
    } else if (stop.state === "pressed") {
      const how = stop.is_sent ? "sent, and sent again" : "not sent, the bus is lost; sent when it is back";
      this.tell("bad", `STOP NOT CONFIRMED (${how}). ${SWITCH}`);
    } else if (!this.isWanted) {
      this.tell("", "");
    }
  }

  tell(kind, text) {
    this.button.dataset.state = kind;
    this.said.className = kind;
    if (this.said.textContent !== text) this.said.textContent = text;
  }
}
