// a slider with its number beside it, its bounds and its unit
import { make } from "/static/parts.js";
import { quantity, words } from "/static/words.js";

const STEPS = 400, DIGITS = 3;
// what spans more than so many times its least value is spread by powers
const WIDE = 500;
let count = 0;

const rounded = (value) => Number(value.toPrecision(DIGITS));

export class Slider {
  constructor(parameter, changed) {
    const { name, text = "", min, max } = parameter, unit = parameter.unit === "1" ? "" : parameter.unit ?? "";
    const isWide = parameter.log ?? (min > 0 && max / min >= WIDE);
    Object.assign(this, { name, min, max, unit, changed, isWide, start: parameter.tuned ?? parameter.value });
    const id = `slider-${(count += 1)}`;
    this.number = make("input", { type: "number", id, step: "any", min, max });
    this.range = make("input", { type: "range", min: 0, max: STEPS, step: 1 });
    this.range.setAttribute("aria-label", quantity(name, unit));
    this.wrong = make("span", { className: "wrong", hidden: true, id: `${id}-wrong` });
    this.number.setAttribute("aria-describedby", this.wrong.id);
    this.wrong.setAttribute("role", "alert");
    const bounds = make("p", { className: "small" }, make("span", { textContent: `${min} ${unit}` }), make("span", { textContent: `${max} ${unit}` }));
    this.box = make("div", { className: "slider" },
      make("div", { className: "top" }, make("label", { htmlFor: id, textContent: quantity(name, unit) }), make("span", {}, this.number, ` ${unit}`)),
      this.range, bounds, this.wrong, make("p", { className: "small what", textContent: text }));
    this.range.addEventListener("input", () => this.put(this.valueAt(Number(this.range.value)), true));
    this.number.addEventListener("input", () => this.typed());
    this.put(this.start);
  }
  valueAt(place) {
    const part = place / STEPS;
    const exact = this.isWide ? this.min * (this.max / this.min) ** part : this.min + part * (this.max - this.min);
    return Math.min(Math.max(rounded(exact), this.min), this.max);
  }
  placeOf(value) {
    const part = this.isWide ? Math.log(value / this.min) / Math.log(this.max / this.min) : (value - this.min) / (this.max - this.min);
    return Math.round(STEPS * part);
  }
  /** Takes a value; by the hand of the user where it is one. */
  put(value, isByHand = false) {
    this.value = value;
    this.number.value = value;
    this.show(isByHand);
  }
  typed() {
    const value = this.number.valueAsNumber, isGood = value >= this.min && value <= this.max;
    this.number.setAttribute("aria-invalid", String(!isGood));
    this.wrong.hidden = isGood;
    this.wrong.textContent = isGood ? "" : words("drop.bounds", { min: this.min, max: this.max, unit: this.unit });
    if (!isGood) return;
    this.value = value;
    this.show(true);
  }
  show(isByHand) {
    this.number.removeAttribute("aria-invalid");
    this.wrong.hidden = true;
    this.range.value = this.placeOf(this.value);
    this.range.setAttribute("aria-valuetext", `${this.value} ${this.unit}`);
    if (isByHand) this.changed(this);
  }
}
