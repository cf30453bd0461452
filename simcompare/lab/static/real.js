// a real ball: record or send it, see its impacts, fit all engines to it
import { byId, links, make, say, table } from "/static/parts.js";
import { bounces } from "/static/pictures.js";
import { Recorder } from "/static/recorder.js";
import { get, job, post, Refused, upload } from "/static/server.js";
import { Scale } from "/static/video.js";
import { Waveform } from "/static/waveform.js";
import { words } from "/static/words.js";

const KINDS = { audio: "sound", video: "video" };
const kindOf = (file) => KINDS[file.type.split("/")[0]] ?? "table";

export class Real {
  constructor(group, drop) {
    Object.assign(this, { group, drop, recorder: null, recording: null });
    this.waveform = new Waveform(byId("wave"), byId("impacts"), () => this.tell());
    this.scale = new Scale((scale) => this.try(() => this.measure(scale)));
    byId("record").addEventListener("click", () => (this.recorder ? this.recorder.end?.("stopped") : this.try(() => this.record())));
    byId("file").addEventListener("change", () => byId("file").files.length && this.try(() => this.file(byId("file").files[0])));
    byId("own").addEventListener("change", () => byId("own").value && this.try(() => this.again(byId("own").value)));
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
    this.state([...notes, words("real.heard", { count: impacts.length }), ...(recording.notes ?? [])].join(" "));
    if (!impacts.length) return;
    this.drop.recording = recording.id;
    await this.waveform.show({ wave: recording.wave, impacts });
    this.tell();
  }
  // the restitution of the impacts that are left, at once
  tell() {
    const kept = this.recording.impacts.filter((_, i) => !this.waveform.struck.has(i));
    const spans = kept.slice(1).map((one, i) => one.time_s - kept[i].time_s);
    const each = spans.slice(1).map((one, i) => one / spans[i]).sort((a, b) => a - b);
    byId("fit").disabled = each.length < 1;
    const middle = each.length ? (each[Math.floor((each.length - 1) / 2)] + each[Math.ceil((each.length - 1) / 2)]) / 2 : NaN;
    byId("restitution").textContent = each.length ? words("real.restitution", { value: middle.toFixed(4), count: each.length }) : words("real.too_few");
  }
  async fit() {
    this.state(words("real.fitting"));
    const { engines, contact, scenario } = this.drop.choices.wish;
    const result = await job({ kind: "fit", group: this.group(), recording: this.recording.id, scenario, engines, contact, struck: [...this.waveform.struck] }, ({ progress }) => this.state(words("real.fitting_part", { percent: Math.round(100 * (progress ?? 0)) })));
    this.state("");
    await this.fitted(result);
  }
  async fitted(result) {
    byId("fitted").hidden = false;
    byId("fit-answer").textContent = result.sentence;
    const found = result.bounces;
    byId("bounces").parentElement.hidden = !found;
    if (found) await bounces(byId("bounces"), { ...found, engines: found.engines.map((one) => ({ ...one, isAfter: one.level !== "default" })) }, result.y_label);
    const values = (all) => Object.entries(all).map(([name, value]) => `${name.replaceAll("_", " ")} ${typeof value === "number" ? Number(value.toPrecision(5)) : value}`).join(", ");
    byId("fit-table").replaceChildren(table({ title: words("real.table"), head: [words("drop.engine"), words("real.values"), words("real.misfit")], rows: result.engines.map((one) => [one.name, values(one.values), typeof one.misfit === "number" ? String(Number(one.misfit.toPrecision(3))) : one.misfit]) }));
    this.student(result.student ?? []);
    byId("files").replaceChildren(...links(result.files ?? []));
    document.dispatchEvent(new Event("stored"));
  }
  // how far the student's hand was
  student(rows) {
    byId("student").replaceChildren(...(rows.length ? [table({ title: words("hand.far"), head: [words("drop.engine"), words("hand.value"), words("hand.yours"), words("hand.fitted")], rows: rows.map((one) => [one.engine, one.name.replaceAll("_", " "), `${one.yours} ${one.unit ?? ""}`, `${one.fitted} ${one.unit ?? ""}`]) })] : []));
  }
  /** The recordings that the group has already. */
  offer(recordings) {
    byId("own").replaceChildren(new Option(words("real.choose"), ""), ...recordings.map((one) => new Option(one.name, one.id)));
    byId("own").closest("p").hidden = !recordings.length;
  }
}
