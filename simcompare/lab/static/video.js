// two points in the first picture of a video, and how far apart they are
import { byId } from "/static/parts.js";

// by an arrow key, in pixels of the picture; with shift
const STEP = 1, WIDE_STEP = 10;
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

export class Scale {
  constructor(taken) {
    this.image = byId("frame");
    this.buttons = [...document.querySelectorAll(".mark")];
    this.image.addEventListener("click", (event) => this.click(event));
    this.buttons.forEach((one, i) => {
      one.addEventListener("keydown", (event) => this.key(event, i));
      one.addEventListener("pointerdown", () => { this.next = i; });
    });
    byId("scale-form").addEventListener("submit", (event) => {
      event.preventDefault();
      taken({ points: this.points, metres: byId("metres").valueAsNumber });
    });
  }
  show({ frame, width, height }) {
    this.image.src = frame;
    Object.assign(this, { width, height, next: 0, points: [[0.5 * width, 0.25 * height], [0.5 * width, 0.75 * height]] });
    byId("scale").hidden = false;
    this.place();
  }
  hide() { byId("scale").hidden = true; }
  click({ offsetX, offsetY }) {
    this.points[this.next] = [offsetX / this.image.clientWidth * this.width, offsetY / this.image.clientHeight * this.height];
    this.next = 1 - this.next;
    this.place();
  }
  key(event, i) {
    const way = ARROWS[event.key];
    if (!way) return;
    event.preventDefault();
    const step = event.shiftKey ? WIDE_STEP : STEP, most = [this.width, this.height];
    this.points[i] = this.points[i].map((one, axis) => Math.min(Math.max(one + step * way[axis], 0), most[axis]));
    this.place();
  }
  place() {
    this.buttons.forEach((one, i) => {
      const [x, y] = this.points[i];
      Object.assign(one.style, { left: `${100 * x / this.width}%`, top: `${100 * y / this.height}%` });
    });
  }
}
