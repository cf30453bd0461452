// a recording with the impacts in it; each can be struck out by a click or by its box
import { byId, make, tick } from "/static/parts.js";
import { draw } from "/static/pictures.js";
import { words } from "/static/words.js";

const SOUND = "#56789b", KEPT = "#d55e00", STRUCK = "#767676";

export class Waveform {
  constructor(plot, list, changed) {
    Object.assign(this, { plot, list, changed });
  }
  show({ wave, curve, impacts, drop }) {
    // of a film the height is shown instead of the sound
    const seen = curve && { t: curve.t, low: curve.t.map(() => 0), high: curve.y };
    Object.assign(this, { wave: wave ?? seen, isFilm: Boolean(curve), impacts, struck: new Set(drop?.left_out) });
    byId("wave-figure").hidden = this.list.hidden = !impacts.length;
    byId("wave-how").textContent = words(wave ? "real.wave_how" : "real.track_how");
    const boxes = impacts.map((one, i) => {
      const text = words("real.impact", { number: i + 1, time: one.time_s.toFixed(3) });
      if (!wave) return make("span", { textContent: text });
      const label = tick("checkbox", "impact", i, text, { checked: !this.struck.has(i) });
      label.firstChild.addEventListener("change", () => this.strike(i));
      return label;
    });
    this.list.replaceChildren(this.list.querySelector("legend"), ...boxes);
    return this.draw().then(() => {
      this.plot.removeAllListeners("plotly_click");
      if (wave) this.plot.on("plotly_click", ({ points }) => points[0].data.name === words("real.impacts") && this.strike(points[0].pointIndex));
    });
  }
  strike(i) {
    if (!this.struck.delete(i)) this.struck.add(i);
    this.list.querySelectorAll("input")[i].checked = !this.struck.has(i);
    this.draw();
    this.changed();
  }
  draw() {
    const { wave, impacts } = this, top = wave ? Math.max(...wave.high, 1e-6) : 1;
    const colours = impacts.map((_, i) => (this.struck.has(i) ? STRUCK : KEPT));
    const sound = wave ? [
      { type: "scatter", mode: "lines", x: wave.t, y: wave.low, line: { color: SOUND, width: 1 }, hoverinfo: "skip" },
      { type: "scatter", mode: "lines", x: wave.t, y: wave.high, line: { color: SOUND, width: 1 }, fill: "tonexty", fillcolor: SOUND, hoverinfo: "skip" },
    ] : [];
    const marks = {
      type: "scatter", mode: "markers+text", name: words("real.impacts"), x: impacts.map((one) => one.time_s), y: impacts.map(() => 1.18 * top),
      text: impacts.map((_, i) => String(i + 1)), textposition: "top center", cliponaxis: false,
      marker: { size: 14, color: colours, symbol: impacts.map((_, i) => (this.struck.has(i) ? "x" : "triangle-down")) }, hovertemplate: "%{x:.4f} s<extra></extra>",
    };
    const least = wave ? Math.min(...wave.low, -1e-6) : 0;
    const lines = impacts.map((one, i) => ({ type: "line", y0: least, y1: 1.1 * top, x0: one.time_s, x1: one.time_s, line: { color: colours[i], width: 1.5, dash: this.struck.has(i) ? "dot" : "solid" } }));
    return draw(this.plot, [...sound, marks], words("drop.time"), "", {
      showlegend: false, shapes: lines, hovermode: "closest", hoverdistance: 30,
      yaxis: { title: { text: this.isFilm ? words("real.height") : "" }, range: [least, 1.5 * top], showticklabels: this.isFilm, automargin: true, fixedrange: true, gridcolor: "#fff", zerolinecolor: "#fff" },
    });
  }
}
