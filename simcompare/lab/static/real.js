// a real ball: record or send it, see its impacts, fit all engines to it
import { byId, links, make, say, table } from "/static/parts.js";
import { bounces, levelName } from "/static/pictures.js";
import { Recorder } from "/static/recorder.js";
import { get, job, post, Refused, upload } from "/static/server.js";
import { Scale } from "/static/video.js";
import { Waveform } from "/static/waveform.js";
import { words } from "/static/words.js";

const KINDS = { audio: "sound", video: "video" };
const kindOf = (file) => KINDS[file.type.split("/")[0]] ?? "table";

const short = (value) => (typeof value === "number" ? String(Number(value.toPrecision(3))) : "–");
const told = (values) => Object.entries(values).map(([name, value]) => `${name} ${Number(value.toPrecision(4))}`).join(", ");

// how far the student's hand was
function studentTable(rows) {
  if (!rows?.length) return [];
  const unit = (one) => (one.unit === "1" ? "" : one.unit);
  return [table({ title: words("hand.far"), head: [words("drop.engine"), words("hand.value"), words("hand.yours"), words("hand.fitted")], rows: rows.map((one) => [one.engine, one.name, `${one.yours} ${unit(one)}`, `${one.fitted ?? "–"} ${unit(one)}`]) })];
}

export class Real {
  constructor(group, drop) {
    Object.assign(this, { group, drop, recorder: null, recording: null });
    this.waveform = new Waveform(byId("wave"), byId("impacts"), () => this.tell());
    this.scale = new Scale((scale) => this.try(() => this.measure(scale)));
    byId("record").addEventListener("click", () => (this.recorder ? this.recorder.end?.("stopped") : this.try(() => this.record())));
    byId("file").addEventListener("change", () => byId("file").files.length && this.try(() => this.file(byId("file").files[0])));
    byId("own").addEventListener("change", () => byId("own").value && this.try(() => this.again(byId("own").value)));
    byId("fit-for-me").addEventListener("click", () => this.fitForMe());
    byId("fit").addEventListener("click", () => this.try(() => this.fit()));
  }
  async try(work) {
    say(byId("real-faults"), []);
    try {
      await work();
    } catch (error) {
      if (!(error instanceof Refused)) console.error(error);
      this.state("");
      say(byId("real-faults"), error.faults ?? [words("page.broken", { reason: error.message })]);
    }
  }
  state(text) { byId("real-state").textContent = text; }
  async record() {
    this.recorder = new Recorder({ level: (peak, time_s) => this.level(peak, time_s), told: (text) => { byId("granted").textContent = text; } });
    this.listening(true);
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
    this.state(words("real.sending"));
    await this.show(await upload(this.group(), name, kind, blob), notes);
  }
  async again(id) { await this.show(await get(`/api/recordings/${encodeURIComponent(this.group())}/${encodeURIComponent(id)}`)); }
  async measure(scale) {
    this.state(words("real.sending"));
    await this.show({ ...this.recording, ...await post(`/api/recordings/${this.recording.id}/scale?group=${encodeURIComponent(this.group())}`, scale), frame: null });
  }
  async show(recording, notes = []) {
    this.recording = recording;
    const { impacts = [], faults = [], frame } = recording;
    say(byId("real-faults"), faults);
    if (frame) this.scale.show(recording);
    else this.scale.hide();
    byId("heard").hidden = !impacts.length;
    byId("fitted").hidden = true;
    this.state([...notes, ...(frame ? [] : [words("real.heard", { count: impacts.length })]), ...(recording.notes ?? [])].join(" "));
    if (!impacts.length) return;
    this.drop.recording = recording.id;
    this.drop.published.choose("");
    await this.waveform.show(recording);
    this.tell(recording.drop?.middle);
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
    const { engines, contact, scenario } = this.drop.choices.wish, group = this.group();
    const source = published ? { published: published.name } : { recording: this.recording.id, struck: [...this.waveform.struck] };
    const asked = { group, scenario, engines, contact, ...source };
    const result = await job({ ...asked, kind: "fit" }, ({ progress }) => this.state(words("real.fitting_part", { percent: Math.round(100 * (progress ?? 0)) })));
    this.state("");
    await (published ? this.seen(result, asked) : this.fitted(result, asked));
    return result;
  }
  async fitted(result, asked) {
    byId("fitted").hidden = false;
    byId("fit-answer").textContent = result.sentence;
    say(byId("real-faults"), [...(result.notes ?? []), ...(result.missing ?? [])]);
    await bounces(byId("bounces"), result.bounces);
    byId("fit-table").replaceChildren(this.table(result));
    byId("student").replaceChildren(...studentTable(result.student));
    byId("files").replaceChildren(...links(asked.group, result.files));
    byId("home").replaceChildren(...["script", "report"].map((kind) => this.home(kind, { ...asked, kind, result: result.id })));
    await this.seen(result, asked);
  }
  async seen(result, asked) {
    this.drop.choices.take(result.parameters);
    this.drop.level = result.engines[0]?.level ?? "";
    await this.drop.show({ ...result, scores: [] }, { isPlayed: false, job: { ...asked, result: result.id, parameters: result.parameters } });
    document.dispatchEvent(new Event("stored"));
  }
  // each engine's values, and how far it was off before and after
  table({ engines, scores }) {
    const levels = [...new Set(scores.map((one) => one.level))];
    const off = (name, level) => scores.find((one) => one.source === name && one.level === level)?.misfit_mm;
    return table({
      title: words("real.table"), head: [words("drop.engine"), words("real.values"), ...levels.map((one) => `${levelName(one)} (mm)`)],
      rows: engines.map((one) => [one.name, told(one.values), ...levels.map((level) => short(off(one.name, level)))]),
    });
  }
  // makes a file that can be taken home
  home(kind, asked) {
    const button = make("button", { type: "button", textContent: words(`real.make_${kind}`) });
    button.addEventListener("click", () => this.try(async () => {
      button.disabled = true;
      try {
        const { files, missing = [] } = await job(asked);
        byId("files").append(...links(asked.group, files));
        say(byId("real-faults"), missing);
        document.dispatchEvent(new Event("stored"));
      } finally {
        button.disabled = false;
      }
    }));
    return button;
  }
  /** Fits to the recording, and tells how far the student's hand was. */
  fitForMe() {
    const box = byId("hand-result");
    const published = this.drop.published.chosen;
    if (!this.drop.recording && !published) box.replaceChildren(words("hand.no_recording"));
    else if (!Object.keys(this.drop.choices.contact).length) box.replaceChildren(words("hand.no_hand"));
    else this.try(async () => {
      box.replaceChildren(words("real.fitting"));
      const result = await this.fit(published);
      box.replaceChildren(...studentTable(result.student));
      say(byId("drop-faults"), result.missing ?? []);
      result.engines.forEach((one) => this.drop.choices.takeOver(one.name, one.values));
    });
  }
  /** The recordings that the group has already. */
  offer(recordings) {
    byId("own").replaceChildren(new Option(words("real.choose"), ""), ...recordings.map((one) => new Option(one.name, one.id)));
    byId("own").closest("p").hidden = !recordings.length;
  }
}
