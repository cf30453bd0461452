// balls that others measured: engines are held against one of them before a ball is recorded
import { byId } from "/static/parts.js";
import { quantity, words } from "/static/words.js";

export class Published {
  constructor(choices, changed) {
    Object.assign(this, { choices, tables: [] });
    byId("published").addEventListener("change", () => {
      this.choose(byId("published").value);
      changed();
    });
  }
  show(tables = []) {
    this.tables = tables;
    byId("published").replaceChildren(new Option(words("drop.published_none"), ""), ...tables.map((one) => new Option(one.title, one.name)));
    byId("against").hidden = !tables.length;
    this.choose("");
  }
  /** Takes the conditions under which a ball was measured. */
  choose(name) {
    const found = this.tables.find((one) => one.name === name);
    byId("published").value = found ? name : "";
    byId("published-text").textContent = found ? `${found.text} ${this.at(found)}` : "";
    if (!found) return;
    this.choices.preset(found.preset);
    this.choices.take(found.parameters);
  }
  at({ parameters }) {
    const told = this.sliders(parameters).map(({ name, unit }) => `${quantity(name, unit)} ${parameters[name]} ${unit}`.trim());
    return words("drop.published_at", { values: told.join(", ") });
  }
  sliders(parameters) { return this.choices.sliders.filter((one) => one.name in parameters); }
  /** The chosen table, as long as the conditions are those under which it was measured. */
  get chosen() {
    const found = this.tables.find((one) => one.name === byId("published").value);
    return found && this.sliders(found.parameters).every((one) => one.value === found.parameters[one.name]) ? found : null;
  }
}
