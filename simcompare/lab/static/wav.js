// a WAV file of one channel, 16 bits a sample
const HEAD = 44, BYTES = 2, FULL = 32767;

/** Blocks of samples from -1 to 1 as a file. */
export function wav(blocks, rate_hz) {
  const count = blocks.reduce((sum, one) => sum + one.length, 0), size = BYTES * count;
  const view = new DataView(new ArrayBuffer(HEAD + size));
  const text = (place, letters) => [...letters].forEach((one, i) => view.setUint8(place + i, one.charCodeAt(0)));
  text(0, "RIFF");
  view.setUint32(4, HEAD - 8 + size, true);
  text(8, "WAVEfmt ");
  view.setUint32(16, 16, true);
  view.setUint16(20, 1, true);
  view.setUint16(22, 1, true);
  view.setUint32(24, rate_hz, true);
  view.setUint32(28, BYTES * rate_hz, true);
  view.setUint16(32, BYTES, true);
  view.setUint16(34, 8 * BYTES, true);
  text(36, "data");
  view.setUint32(40, size, true);
  let place = HEAD;
  for (const block of blocks) {
    for (const one of block) {
      view.setInt16(place, Math.round(FULL * Math.min(Math.max(one, -1), 1)), true);
      place += BYTES;
    }
  }
  return new Blob([view], { type: "audio/wav" });
}
