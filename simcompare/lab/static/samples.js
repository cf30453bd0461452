// runs beside the page: hands on what the microphone gives, as it is
const BLOCK = 2048;

class Samples extends AudioWorkletProcessor {
  constructor() {
    super();
    this.block = new Float32Array(BLOCK);
    this.filled = 0;
    this.next = null;
    this.lost = 0;
  }
  process([[channel]]) {
    if (!channel) return true;
    this.lost += currentFrame - (this.next ?? currentFrame);
    this.next = currentFrame + channel.length;
    this.block.set(channel, this.filled);
    this.filled += channel.length;
    if (this.filled === BLOCK) {
      this.port.postMessage({ block: this.block, lost: this.lost }, [this.block.buffer]);
      this.block = new Float32Array(BLOCK);
      this.filled = 0;
    }
    return true;
  }
}

registerProcessor("samples", Samples);
