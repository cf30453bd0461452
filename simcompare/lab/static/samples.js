// runs beside the page: hands on what the microphone gives, as it is
const BLOCK = 2048;

class Samples extends AudioWorkletProcessor {
  constructor() {
    super();
    this.block = new Float32Array(BLOCK);
    this.filled = 0;
    this.next = currentFrame;
    this.lost = 0;
  }
  process([[channel]]) {
    this.lost += Math.max(currentFrame - this.next, 0);
    if (!channel) {
      this.next = currentFrame;
      return true;
    }
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
