// The websocket: opened again for as long as the page is there.

const RETRY_ms = [250, 500, 1000, 2000];

export class Link {
  // on: functions open(), close(), text(object), samples(ArrayBuffer)
  constructor(on) {
    this.on = on;
    this.tries = 0;
    this.open();
  }

  open() {
    const url = new URL("socket", location.href);
    url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
    url.hash = "";
    const socket = new WebSocket(url);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.tries = 0;
      this.on.open();
    };
    socket.onmessage = ({ data }) => {
      if (typeof data === "string") this.on.text(JSON.parse(data));
      else this.on.samples(data);
    };
    socket.onclose = () => {
      this.on.close();
      setTimeout(() => this.open(), RETRY_ms[Math.min(this.tries++, RETRY_ms.length - 1)]);
    };
    this.socket = socket;
  }

  // Whether it could be handed over.
  send(object) {
    if (this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(object));
    return true;
  }
}
