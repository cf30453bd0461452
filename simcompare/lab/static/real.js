// a real ball: record or send it, see its impacts, fit all engines to it
import { byId, links, make, say, table } from "/static/parts.js";
import { BY_HAND, bounces, levelName } from "/static/pictures.js";
import { Recorder } from "/static/recorder.js";
import { get, job, post, Refused, upload } from "/static/server.js";
import { Scale } from "/static/video.js";
import { Waveform } from "/static/waveform.js";
import { words } from "/static/words.js";

const FITTED = "fitted";
const misfit = (scores, name, level) => scores.find((one) => one.source === name && one.level === level)?.misfit_mm;
const KINDS = { audio: "sound", video: "video" };
const kindOf = (file) => KINDS[file.type.split("/")[0]] ?? "table";

const short = (value) => (typeof value === "number" ? String(Number(value.toPrecision(3))) : "–");
const four = (value) => (typeof value === "number" ? String(Number(value.toPrecision(4))) : "–");
const told = (values) => Object.entries(values).map(([name, value]) => `${name} ${four(value)}`).join(", ");

// how far the student's hand was: from the ball, and from the values that fit
function studentTable({ student: rows, scores }) {
  if (!rows?.length) return [];
  const unit = (one) => (one.unit === "1" ? "" : one.unit), off = (name, level) => short(misfit(scores, name, level));
  const names = [...new Set(rows.map((one) => one.engine))];
  const said = names.map((engine) => words("hand.far_mm", { engine, yours: off(engine, BY_HAND), fitted: off(engine, FITTED) }));
  return [...said.map((textContent) => make("p", { textContent })), table({ title: words("hand.far"), head: [words("drop.engine"), words("hand.value"), words("hand.yours"), words("hand.fitted")], rows: rows.map((one) => [one.engine, one.name, `${four(one.yours)} ${unit(one)}`, `${four(one.fitted)} ${unit(one)}`]) })];
}

export class Real {
  constructor(group, drop) {
    Object.assign(this, { group, drop, recorder: null, recording: null });
    this.waveform = new Waveform(byId("wave"), byId("impacts"), () => this.tell());
    this.scale = new Scale((scale) => this.try(() => this.measure(scale)));
    byId("record").addEventListener("click", () => (this.recorder ? this.recorder.end?.("stopped") : this.try(() => this.record())));
    byId("file").addEventListener("change", () => byId("file").files.length && this.try(() => this.file(byId("file").files[0])));
    // the same file can be sent again, such as where the first time the lab did not answer
    byId("file").addEventListener("click", () => { byId("file").value = ""; });
    byId("own").addEventListener("change", () => byId("own").value && this.try(() => this.again(byId("own").value)));
    byId("fit-for-me").addEventListener("click", () => this.fitForMe());
    byId("fit").addEventListener("click", () => this.try(() => this.fit(), byId("fit")));
  }
  /** Does something; a button waits until it is done, and what goes wrong stands in a box. */
  async try(work, button = {}, box = byId("real-faults")) {
    say(box, []);
    button.disabled = true;
    try {
      await work();
    } catch (error) {
      if (!(error instanceof Refused)) console.error(error);
      this.state("");
      say(box, error.faults ?? [words("page.broken", { reason: error.message })]);
    } finally {
      button.disabled = false;
    }
  }
  state(text) { byId("real-state").textContent = text; }
  async record() {
    this.recorder = new Recorder({ level: (peak, time_s) => this.level(peak, time_s), told: (text) => { byId("granted").textContent = text; }, began: () => this.listening(true) });
    // the browser may ask its user first: nobody listens yet
    this.state(words("real.opening"));
    try {
      const { blob, reason, lost_s } = await this.recorder.start();
      this.listening(false);
      await this.send(`${words("real.recording")}.wav`, "sound", blob, [words(`real.ended_${reason}`), ...(lost_s ? [words("real.lost", { lost: lost_s.toFixed(3) })] : [])]);
    } finally {
      this.listening(false);
      this.recorder = null;
    }
  }
  listening(isOn) {
    byId("record").textContent = words(isOn ? "real.stop" : "real.record");
    byId("record").setAttribute("aria-pressed", String(isOn));
    document.querySelector(".meter").hidden = !isOn;
    if (isOn) this.state(words("real.listening"));
  }
  // the ear hears powers: a meter in decibels, from -60 to 0
  level(peak, time_s) {
    byId("level").value = Math.min(Math.max(1 + Math.log10(peak + 1e-9) / 3, 0), 1);
    byId("elapsed").textContent = `${time_s.toFixed(1)} s`;
  }
  file(file) { return this.send(file.name, kindOf(file), file); }
  async send(name, kind, blob, notes = []) {
    this.forget();
    this.state(words("real.sending"));
    await this.show(await upload(this.group(), name, kind, blob), notes);
  }
  // what was sent before is no longer what the page speaks of
  forget() {
    this.recording = this.drop.heard = null;
    byId("heard").hidden = true;
    this.scale.hide();
  }
  async again(id) { await this.show(await get(`/api/recordings/${encodeURIComponent(this.group())}/${encodeURIComponent(id)}`)); }
  /** Shows a fit that was stored, with its recording. */
  async reopen({ id, recording }) {
    const group = this.group(), of = encodeURIComponent(group);
    const [heard, { request, result }] = await Promise.all([get(`/api/recordings/${of}/${recording}`), get(`/api/results/${of}/${id}`)]);
    const { scenario, engines, contact = {}, struck = [] } = request;
    if (this.drop.choices.scenario.name !== scenario) await this.drop.open(scenario);
    await this.show(heard, [], false);
    struck.filter((i) => !this.waveform.struck.has(i)).forEach((i) => this.waveform.strike(i));
    await this.fitted({ ...result, id }, { group, recording, scenario, engines, contact, struck });
    byId("real").scrollIntoView();
  }
  async measure(scale) {
    this.state(words("real.sending"));
    await this.show({ ...this.recording, ...await post(`/api/recordings/${this.recording.id}/scale?group=${encodeURIComponent(this.group())}`, scale), frame: null });
  }
  async show(recording, notes = [], isDropped = true) {
    this.recording = recording;
    this.drop.heard = recording.drop ? recording : null;
    const { impacts = [], drop, frame } = recording, count = impacts.length;
    if (frame) this.scale.show(recording);
    else this.scale.hide();
    byId("heard").hidden = !count && !drop;
    byId("fitted").hidden = true;
    this.state([...notes, ...(frame ? [] : [count || !drop ? words("real.heard", { count }) : words("real.of_bounces", { count: drop.count })]), ...(recording.notes ?? [])].join(" "));
    if (!count && !drop) return;
    await this.waveform.show(recording);
    this.tell(drop?.middle);
    if (!drop || !isDropped) return;
    byId("real-state").append(` ${words("real.taken")}`);
    await this.drop.hear(recording);
  }
  // how the ball bounces: as the lab found it, or after a strike by the impacts that are left
  tell(found = this.middle()) {
    byId("fit").disabled = !found;
    byId("restitution").textContent = found ? words("real.restitution", { value: found.toFixed(4) }) : words("real.too_few");
  }
  middle() {
    const kept = this.recording.impacts.filter((_, i) => !this.waveform.struck.has(i));
    const spans = kept.slice(1).map((one, i) => one.time_s - kept[i].time_s);
    const ratios = spans.slice(1).map((one, i) => one / spans[i]).sort((a, b) => a - b);
    return (ratios[Math.floor((ratios.length - 1) / 2)] + ratios[Math.ceil((ratios.length - 1) / 2)]) / 2;
  }
  async fit(published = null) {
    this.state(words("real.fitting"));
    if (!published && !this.drop.choices.scenario.can_fit) await this.drop.hear(this.recording);
    const { engines, contact, scenario } = this.drop.choices.wish, group = this.group();
    const source = published ? { published: published.name } : { recording: this.recording.id, struck: this.recording.wave ? [...this.waveform.struck] : [] };
    const asked = { group, scenario, engines, contact, ...source, still: !Replay.draws };
    let begin;
    const result = await job({ ...asked, kind: "fit" }, ({ state, place }) => {
      if (state === "waiting") return this.state(words("drop.waiting", { place }));
      begin ??= Date.now();
      this.state(words("real.fitting_since", { time: Math.round((Date.now() - begin) / 1000) }));
    });
    this.state((result.notes ?? []).join(" "));
    await (published ? this.seen(result, asked) : this.fitted(result, asked));
    return result;
  }
  async fitted(result, asked) {
    byId("fitted").hidden = false;
    byId("fit-answer").textContent = result.sentence;
    say(byId("real-faults"), result.missing ?? []);
    await bounces(byId("bounces"), result.bounces);
    byId("fit-table").replaceChildren(this.table(result));
    byId("student").replaceChildren(...studentTable(result));
    byId("files").replaceChildren(...links(asked.group, result.files));
    byId("home").replaceChildren(...["script", "report"].map((kind) => this.home(kind, { ...asked, kind, result: result.id })));
    await this.seen(result, asked);
  }
  async seen(result, asked) {
    this.drop.choices.take(result.parameters);
    this.drop.level = result.engines[0]?.level ?? "";
    await this.drop.show(result, { isPlayed: false, job: { ...asked, result: result.id, parameters: result.parameters } });
    document.dispatchEvent(new Event("stored"));
  }
  // each engine's values, and how far it was off before and after
  table({ engines, scores }) {
    const levels = [...new Set(scores.map((one) => one.level))];
    return table({
      title: words("real.table"), head: [words("drop.engine"), words("real.values"), ...levels.map((one) => `${levelName(one)} (mm)`)],
      rows: engines.map((one) => [one.name, told(one.values), ...levels.map((level) => short(misfit(scores, one.name, level)))]),
    });
  }
  // makes a file that can be taken home
  home(kind, asked) {
    const button = make("button", { type: "button", textContent: words(`real.make_${kind}`) });
    button.addEventListener("click", () => this.try(async () => {
      const { files, missing = [] } = await job(asked);
      byId("files").append(...links(asked.group, files), ...missing.map((textContent) => make("li", { textContent })));
      document.dispatchEvent(new Event("stored"));
    }, button));
    return button;
  }
  /** Fits to the recording, and tells how far the student's hand was. */
  fitForMe() {
    const box = byId("hand-result");
    const published = this.drop.published.chosen;
    if (!this.recording && !published) say(box, [words("hand.no_recording")]);
    else if (!Object.keys(this.drop.choices.contact).length) say(box, [words("hand.no_hand")]);
    else this.try(async () => {
      say(box, [words("real.fitting")]);
      const result = await this.fit(published);
      box.replaceChildren(...studentTable(result));
      say(byId("drop-faults"), result.missing ?? []);
      result.engines.forEach((one) => this.drop.choices.takeOver(one.name, one.values));
    }, byId("fit-for-me"), box);
  }
  /** The recordings that the group has already. */
  offer(recordings) {
    byId("own").replaceChildren(new Option(words("real.choose"), ""), ...recordings.map((one) => new Option(one.name, one.id)));
    byId("own").closest("p").hidden = !recordings.length;
  }
}
