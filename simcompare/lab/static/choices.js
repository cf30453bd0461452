// what can be chosen in a scenario: parameters, engines, levels, engines' own values
import { byId, make, tick, ticked } from "/static/parts.js";
import { BY_HAND } from "/static/pictures.js";
import { Slider } from "/static/slider.js";
import { words } from "/static/words.js";

// parameters on the first screen
const FIRST = 2;

export class Choices {
  constructor(changed) {
    Object.assign(this, { changed, sliders: [], hands: new Map() });
    byId("preset").addEventListener("change", () => this.preset(byId("preset").value, true));
    ["engines", "levels"].forEach((id) => byId(id).addEventListener("change", () => changed()));
  }
  show(scenario) {
    this.scenario = scenario;
    this.sliders = scenario.parameters.filter((one) => Number.isFinite(one.min) && Number.isFinite(one.max)).map((one) => new Slider(one, () => this.changed()));
    const boxes = this.sliders.map((one) => one.box);
    byId("parameters").replaceChildren(...boxes.slice(0, FIRST));
    byId("more-parameters").replaceChildren(...boxes.slice(FIRST));
    this.offer("preset", [new Option(words("drop.no_preset"), ""), ...scenario.presets.map((one) => new Option(one.name.replaceAll("_", " "), one.name))]);
    byId("preset").disabled = !scenario.presets.length;
    this.fill("engines", scenario.engines.map((one) => this.engine(one)));
    this.fill("levels", scenario.levels.map((one) => tick("checkbox", "level", one.name, `${one.name}: ${one.text}`, { checked: ["default", "tuned"].includes(one.name) })));
    this.hands.clear();
    byId("contact-values").replaceChildren(...scenario.engines.filter((one) => one.contact?.length && !one.missing).map((one) => this.hand(one)));
    this.preset("");
  }
  offer(id, options) { byId(id).replaceChildren(...options); }
  fill(id, labels) { byId(id).replaceChildren(byId(id).querySelector("legend"), ...labels); }
  engine({ name, missing }) {
    const label = tick("checkbox", "engine", name, name, { checked: !missing, disabled: Boolean(missing) });
    if (missing) label.append(make("span", { className: "small", textContent: ` ${missing}` }));
    return label;
  }
  // an engine's own values; they count from the first touch until they are put back
  hand({ name, contact }) {
    const use = tick("checkbox", "hand", name, words("hand.use", { engine: name }));
    const comes = (one) => (one.tuned === null || one.tuned === one.value ? one.text : `${one.text} ${words("hand.comes", { value: one.value, unit: one.unit === "1" ? "" : one.unit }).trim()}.`);
    const sliders = contact.map((one) => new Slider({ ...one, text: comes(one) }, () => {
      use.firstChild.checked = true;
      this.changed(BY_HAND);
    }));
    use.firstChild.addEventListener("change", () => this.changed());
    this.hands.set(name, { use: use.firstChild, sliders });
    return make("details", {}, make("summary", { textContent: name }), use, ...sliders.map((one) => one.box));
  }
  /** Takes a named set of parameters. */
  preset(name, isByHand = false) {
    const found = this.scenario.presets.find((one) => one.name === name);
    byId("preset").value = found ? name : "";
    byId("preset-text").textContent = found ? found.text : "";
    this.sliders.forEach((one) => one.put(found?.set[one.name] ?? one.start));
    if (isByHand) this.changed();
  }
  get parameters() { return Object.fromEntries(this.sliders.filter((one) => one.value !== one.start).map((one) => [one.name, one.value])); }
  get engines() { return ticked(byId("engines")); }
  get levels() { return ticked(byId("levels")); }
  /** Engine -> its values, where the user set them. */
  get contact() {
    const used = [...this.hands].filter(([, one]) => one.use.checked);
    return Object.fromEntries(used.map(([name, one]) => [name, Object.fromEntries(one.sliders.filter((slider, i) => !i || slider.value !== slider.start).map((slider) => [slider.name, slider.value]))]));
  }
  /** What a job needs to know of the choices. */
  get wish() {
    return { scenario: this.scenario.name, engines: this.engines, levels: this.levels, parameters: this.parameters, contact: this.contact };
  }
  /** Takes values of parameters, such as those of a real ball. */
  take(values) { this.sliders.filter((one) => one.name in values).forEach((one) => one.put(Math.min(Math.max(values[one.name], one.min), one.max))); }
  /** Puts fitted values into an engine's sliders. */
  takeOver(engine, values) {
    const hand = this.hands.get(engine);
    if (!hand) return;
    hand.sliders.forEach((one) => one.put(values[one.name] ?? one.start));
  }
}
