// the first screen: choose, drop, see
import { Choices } from "/static/choices.js";
import { Latest, settled } from "/static/latest.js";
import { byId, links, say, table, tick } from "/static/parts.js";
import { BY_HAND, curves, flights } from "/static/pictures.js";
import { Published } from "/static/published.js";
import { get, job, Refused } from "/static/server.js";
import { words } from "/static/words.js";

// a slider that moves is waited for; while it moves only the level that is looked at is run
const SETTLED_MS = 60, RESTED_MS = 600;
const isStill = () => matchMedia("(prefers-reduced-motion: reduce)").matches;

export class Drop {
  constructor(group) {
    Object.assign(this, { group, heard: null, level: "", isSame: false });
    this.replay = new Replay(byId("replay"));
    this.latest = new Latest((wish) => this.run(wish));
    const sketch = settled(() => this.ask(false, true), SETTLED_MS), whole = settled(() => this.ask(false), RESTED_MS);
    this.choices = new Choices((level = this.level) => {
      performance.mark("changed");
      this.level = level;
      sketch();
      whole();
    });
    this.published = new Published(this.choices, whole);
    byId("controls").addEventListener("submit", (event) => {
      event.preventDefault();
      performance.mark("changed");
      this.ask(!isStill());
    });
    byId("take-go").addEventListener("click", () => this.takeHome());
    byId("scenario").addEventListener("change", () => this.open(byId("scenario").value));
    byId("preset").addEventListener("change", () => this.address());
    byId("shown-level").addEventListener("change", (event) => this.look(event.target.value));
  }
  async start(scenario, preset) {
    const { scenarios: all } = await get("/api/scenarios");
    byId("scenario").replaceChildren(...all.map((one) => new Option(one.title, one.name)));
    const name = all.some((one) => one.name === scenario) ? scenario : byId("scenario").dataset.first ?? all[0].name;
    await this.open(name, preset);
    say(byId("notice"), !scenario || name === scenario ? [] : [words("drop.no_scenario", { name: scenario, names: all.map((one) => one.name).join(", ") })]);
  }
  /** What was recorded, where the scenario is that of a ball that is dropped. */
  get recording() { return this.choices.scenario?.can_fit ? this.heard?.id : undefined; }
  async open(name, preset = "") {
    byId("scenario").value = name;
    try {
      const scenario = { name, ...await get(`/api/scenarios/${encodeURIComponent(name)}`) };
      if (byId("scenario").value !== name) return; // another one was chosen since
      const isDrop = scenario.parameters.some((one) => one.name.startsWith("drop_"));
      byId("drop-head").textContent = isDrop ? words("drop.title") : scenario.title;
      byId("question").textContent = scenario.question;
      byId("go").textContent = words(isDrop ? "drop.go" : "drop.go_other");
      this.clear();
      this.isSame = false;
      this.choices.show(scenario);
      this.published.show(scenario.published);
      if (preset) this.choices.preset(preset);
      this.address();
      say(byId("drop-faults"), []);
      this.ask(false);
    } catch (error) {
      this.refuse(error);
    }
  }
  // nothing of another scenario stays in sight while the engines run
  clear() {
    byId("answer").textContent = "";
    byId("scores").replaceChildren();
    document.querySelector(".side").hidden = byId("take").hidden = byId("shown-level").hidden = true;
  }
  /** Takes what was recorded of a ball, and drops it as high in the engines. */
  async hear(recording) {
    this.heard = recording;
    if (!this.choices.scenario.can_fit) await this.open(byId("scenario").dataset.first);
    this.published.choose("");
    const { drop_height_m, middle } = recording.drop ?? {};
    this.choices.take({ ...(drop_height_m && { drop_height_m }), ...(middle && { restitution: middle }) });
    this.ask(false);
  }
  /** The address opens what is chosen now. */
  address() {
    const now = new URL(location);
    now.searchParams.set("scenario", this.choices.scenario.name);
    now.searchParams.delete("preset");
    if (byId("preset").value) now.searchParams.set("preset", byId("preset").value);
    history.replaceState(null, "", now);
  }
  ask(isPlayed, isSketch = false) {
    if (!performance.getEntriesByName("changed").length) performance.mark("changed");
    const wish = this.choices.wish, isHand = this.level === BY_HAND && Object.keys(wish.contact).length > 0;
    const isPart = isSketch && (isHand || wish.levels.includes(this.level));
    if (isPart) Object.assign(wish, isHand ? { levels: [] } : { levels: [this.level], contact: {} });
    if (!wish.engines.length) say(byId("drop-faults"), [words("drop.no_engine")]);
    else if (!wish.levels.length && !Object.keys(wish.contact).length) say(byId("drop-faults"), [words("drop.no_level")]);
    else this.latest.ask({ job: { kind: "run", group: this.group(), ...wish, ...this.beside, still: !Replay.draws }, isPlayed, isPart });
  }
  /** What the engines are held against: a published ball, or one that was recorded. */
  get beside() {
    const published = this.published.chosen;
    if (published) return { published: published.name };
    return this.recording ? { recording: this.recording } : {};
  }
  async run(wish) {
    document.body.setAttribute("aria-busy", "true");
    try {
      const result = await job(wish.job, (now) => this.wait(now));
      if (wish.job.scenario !== this.choices.scenario.name) return; // another one was opened since
      say(byId("drop-faults"), result.missing ?? []);
      await this.show(result, wish);
    } catch (error) {
      this.refuse(error);
    } finally {
      document.body.removeAttribute("aria-busy");
    }
  }
  wait({ state, place }) {
    if (state === "waiting" && place) byId("answer").textContent = words("drop.waiting", { place });
  }
  async show(result, { isPlayed, isPart, job: asked }) {
    this.result = result;
    document.querySelector(".side").hidden = false;
    if (isPart) return this.draw(result);
    byId("answer").textContent = result.sentence;
    this.tabs([...new Set(result.curves.map((one) => one.level).filter(Boolean))]);
    await this.draw(result);
    this.offer(asked);
    byId("scores").replaceChildren(...this.tables(result));
    if (isPlayed && result.replay && !this.replay.playing) this.replay.toggle();
  }
  async draw(result) {
    this.scene(result.replay);
    await this.look(this.level);
    performance.measure("from change to picture", "changed");
  }
  scene(replay) {
    byId("replay").hidden = !replay;
    if (!replay) return;
    this.replay.show(replay, this.isSame);
    this.isSame = true;
  }
  tabs(levels) {
    this.levels = levels;
    if (!levels.includes(this.level)) this.level = levels[0] ?? "";
    const box = byId("shown-level");
    box.hidden = levels.length < 2;
    const last = [...box.querySelectorAll("input")].map((one) => one.value);
    if (last.join() !== levels.join()) box.replaceChildren(box.querySelector("legend"), ...levels.map((one) => tick("radio", "shown-level", one, one, {})));
    box.querySelectorAll("input").forEach((one) => { one.checked = one.value === this.level; });
  }
  /** Shows one level, over time and in space. */
  look(level) {
    this.level = level;
    const list = this.replay.control("level"), place = this.levels.indexOf(level);
    if (place >= 0 && place < list.options.length && list.selectedIndex !== place) {
      list.selectedIndex = place;
      list.dispatchEvent(new Event("change"));
    }
    return curves(byId("curve"), this.result, level, this.recording && flights(this.heard));
  }
  tables({ table: values, scores }) {
    const found = [], { published } = this.asked ?? {};
    if (scores?.length) found.push(table({ title: words(published ? "drop.scores_published" : "drop.scores_own"), head: [words("drop.engine"), words("drop.level"), words("drop.score")], rows: scores.map((one) => [one.source, one.level, one.text]) }));
    if (values?.rows?.length) found.push(table(values));
    return found;
  }
  // what can be taken home: the script of an engine
  offer(asked) {
    this.asked = asked;
    const choice = byId("take-engine"), last = choice.value;
    const able = this.choices.scenario.engines.filter((one) => one.script && asked.engines.includes(one.name)).map((one) => one.name);
    byId("take").hidden = !able.length;
    if ([...choice.options].map((one) => one.value).join() === able.join()) return;
    choice.replaceChildren(...able.map((one) => new Option(one, one, false, one === last)));
  }
  async takeHome() {
    try {
      const { asked } = this, { files } = await job({ ...asked, kind: "script", engine: byId("take-engine").value });
      byId("taken").append(...links(asked.group, files));
      document.dispatchEvent(new Event("stored"));
    } catch (error) {
      this.refuse(error);
    }
  }
  refuse(error) {
    if (!(error instanceof Refused)) console.error(error);
    say(byId("drop-faults"), error.faults ?? [words("page.broken", { reason: error.message })]);
  }
}
