// curves over time, and bounces beside each other
import { words } from "/static/words.js";

const INK = "#1b1b1b", GRID = "#e3e3e3", FONT_PX = 14;
const MEASURED = "#000000", DEFAULT = "default";
/** The level of values that were set by hand. */
export const BY_HAND = "by hand";
const SIGNS = ["circle", "square", "diamond", "triangle-up", "cross", "x", "star", "triangle-down"];
const OPTIONS = { displaylogo: false, displayModeBar: false, responsive: true };

const axis = (text) => ({ title: { text }, gridcolor: GRID, zerolinecolor: GRID, automargin: true });

export function draw(box, data, x, y, more = {}) {
  // a long title stands in two lines: a phone's picture is low
  const title = y.replace(/^(.{8,}?) (?=.{0,20}$)/, "$1<br>");
  const layout = {
    font: { size: FONT_PX, color: INK, family: "system-ui, sans-serif" }, separators: ".",
    margin: { l: 60, r: 10, t: 8, b: 48 }, paper_bgcolor: "#fff", plot_bgcolor: "#fff",
    legend: { orientation: "h", x: 0, y: 1.02, yanchor: "bottom" }, xaxis: axis(x), yaxis: axis(title), ...more,
  };
  return Plotly.react(box, data, layout, OPTIONS);
}

const GRAVITY = 9.80665, POINTS = 24;
/** Height of a ball over time since it was let go, as the impacts of its recording tell it. */
export function flights({ impacts, drop }) {
  const { begin_s, drop_height_m: height } = drop ?? {};
  if (begin_s == null || !impacts.length) return null;
  const kept = impacts.filter((_, i) => !drop.left_out.includes(i)).map((one) => one.time_s - begin_s);
  const places = Array.from({ length: POINTS + 1 }, (_, i) => i / POINTS);
  const fall = places.map((part) => ({ t: part * kept[0], y: height * (1 - part ** 2) }));
  let last = Infinity;
  const found = kept.slice(1).flatMap((end, i) => {
    const start = kept[i], span = end - start, isOne = span < last;
    last = span;
    // a flight that is longer than the one before hides an impact that was not heard
    return isOne ? places.map((part) => ({ t: start + part * span, y: GRAVITY * span ** 2 * part * (1 - part) / 2 })) : [{ t: end, y: null }];
  });
  const all = [...fall, ...found];
  return { t: all.map((one) => one.t), y: all.map((one) => one.y) };
}

/** Every source over time at one level, and what was recorded; engines differ by dash as well as by colour. */
export function curves(box, { curves: all, y_label: label }, level, recorded) {
  const shown = all.filter((one) => !one.level || one.level === level);
  const data = shown.map((one) => ({
    type: "scatter", mode: "lines", name: one.source, x: one.t, y: one.y,
    line: { color: one.colour, width: one.level ? 2 : 4, dash: one.dash ?? "solid" },
  }));
  if (recorded) data.push({ type: "scatter", mode: "lines", name: words("real.measured"), x: recorded.t, y: recorded.y, line: { color: MEASURED, width: 2, dash: "dot" } });
  return draw(box, data, words("drop.time"), label);
}

/** A level as the page calls it. */
export const levelName = (level) => (level === DEFAULT ? words("real.before") : level === BY_HAND ? words("hand.yours") : words("real.after"));

/** Restitution of each bounce: measured, and every engine that bounces, before and after it was fitted. */
export function bounces(box, { numbers, measured, engines }) {
  const names = [...new Set(engines.map((one) => one.name))];
  const data = [
    { type: "scatter", mode: "lines+markers", name: words("real.measured"), x: numbers, y: measured, line: { color: MEASURED, width: 3 }, marker: { size: 11, symbol: "circle", color: MEASURED } },
    ...engines.filter((one) => one.values.some((value) => value !== null)).map((one) => ({
      type: "scatter", mode: "lines+markers", name: `${one.name}, ${levelName(one.level)}`, x: numbers, y: one.values,
      line: { color: one.colour, width: one.level === DEFAULT ? 1 : 2, dash: one.level === DEFAULT ? "dot" : one.level === BY_HAND ? "dash" : "solid" },
      marker: { size: 9, color: one.level === DEFAULT ? "#fff" : one.colour, line: { color: one.colour, width: 2 }, symbol: SIGNS[(names.indexOf(one.name) + 1) % SIGNS.length] },
    })),
  ];
  return draw(box, data, words("real.bounce"), words("real.restitution_axis"), { xaxis: { ...axis(words("real.bounce")), dtick: 1 } });
}
