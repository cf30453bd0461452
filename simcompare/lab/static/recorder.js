// the microphone as an instrument: its samples as they are, at the rate that the browser tells
import { Refused } from "/static/server.js";
import { wav } from "/static/wav.js";
import { words } from "/static/words.js";

const RAW = { echoCancellation: false, noiseSuppression: false, autoGainControl: false };
// an impact is so many times louder than the quiet between impacts, and at least so loud
const LOUDER = 6, LEAST = 0.01;
// the end: so long nothing was heard after two impacts; nothing at all; in any case
const SILENT_S = 2.5, NOTHING_S = 20, LONGEST_S = 60;

const REASONS = { NotAllowedError: "denied", SecurityError: "denied", NotFoundError: "no_microphone", NotReadableError: "in_use" };

async function open() {
  if (!navigator.mediaDevices?.getUserMedia) throw new Refused([words("microphone.insecure")]);
  try {
    return await navigator.mediaDevices.getUserMedia({ audio: { ...RAW, channelCount: 1 } });
  } catch (error) {
    throw new Refused([words(`microphone.${REASONS[error.name] ?? "failed"}`, { reason: error.message })]);
  }
}

/** What the browser really granted, as a sentence. */
function granted(track, rate_hz) {
  const settings = track.getSettings();
  const on = Object.keys(RAW).filter((key) => settings[key]), unknown = Object.keys(RAW).filter((key) => settings[key] === undefined);
  const named = (keys) => keys.map((key) => words(`microphone.${key}`)).join(", ");
  return [
    words("microphone.rate", { rate: rate_hz, device: track.label || words("microphone.unnamed") }),
    on.length ? words("microphone.shaped", { what: named(on) }) : unknown.length ? words("microphone.unknown", { what: named(unknown) }) : words("microphone.raw"),
  ].join(" ");
}

/** Listens for impacts: tells when it is quiet again after them. */
class Listener {
  constructor(rate_hz) {
    Object.assign(this, { rate_hz, floor: null, heard: 0, last_s: 0, time_s: 0, loud: false });
  }
  take(block) {
    const peak = block.reduce((most, one) => Math.max(most, Math.abs(one)), 0);
    this.time_s += block.length / this.rate_hz;
    // the floor falls at once and rises slowly
    this.floor = this.floor === null ? peak : Math.min(peak, this.floor * 1.02 + 1e-6);
    const isLoud = peak > Math.max(LEAST, LOUDER * this.floor);
    if (isLoud) this.last_s = this.time_s;
    if (isLoud && !this.loud) this.heard += 1;
    this.loud = isLoud;
    return peak;
  }
  get ended() {
    if (this.time_s > LONGEST_S) return "longest";
    if (this.heard < 2) return this.time_s > NOTHING_S ? "nothing" : "";
    return this.time_s - this.last_s > SILENT_S ? "silence" : "";
  }
}

/** Records until it is quiet again; `end` ends it earlier. */
export class Recorder {
  constructor({ level, told, began }) {
    Object.assign(this, { level, told, began, blocks: [], lost: 0 });
  }
  async start() {
    const stream = await open(), context = new AudioContext({ latencyHint: "playback" });
    try {
      return await this.listen(stream, context);
    } finally {
      stream.getTracks().forEach((one) => one.stop());
      await context.close();
    }
  }
  async listen(stream, context) {
    await context.resume();
    await context.audioWorklet.addModule("/static/samples.js");
    const rate_hz = context.sampleRate, [track] = stream.getAudioTracks();
    this.told(granted(track, rate_hz));
    const source = context.createMediaStreamSource(stream), node = new AudioWorkletNode(context, "samples", { numberOfOutputs: 1, channelCount: 1, channelCountMode: "explicit" });
    const listener = new Listener(rate_hz);
    const done = new Promise((resolve) => { this.end = resolve; });
    track.addEventListener("ended", () => this.end("stopped"));
    node.port.onmessage = ({ data }) => {
      this.blocks.push(data.block);
      this.lost = data.lost;
      this.level(listener.take(data.block), listener.time_s);
      if (listener.ended) this.end(listener.ended);
    };
    // the worklet runs only while it leads somewhere; it gives silence
    source.connect(node).connect(context.destination);
    this.began();
    const reason = await done;
    node.port.onmessage = null;
    if (reason === "nothing") throw new Refused([words("microphone.nothing")]);
    return { blob: wav(this.blocks, rate_hz), reason, lost_s: this.lost / rate_hz };
  }
}
