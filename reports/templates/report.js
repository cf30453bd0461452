"use strict";
// every figure is drawn from the JSON beside it, for the width that there is; one in a closed
// <details> when that is opened
(() => {
  const OPTIONS = { displaylogo: false, displayModeBar: "hover", modeBarButtonsToRemove: ["select2d", "lasso2d"] };
  // below the first width [px] panels stand one below the other; the second is what a page of paper has
  const NARROW = 640, PAPER = 1000;
  // width of a letter, heights of a line of words and of the plot without its margins [px]
  const LETTER = 8.5, LINE = 20, PLOT = 320;
  // height of the buttons above a figure, which must not hide its legend [px]
  const BUTTONS = 26;
  // words that are longer than their place go on in a second line
  const folded = (text, width) => text.split("<br>").map((line) => line.split(" ").reduce((lines, word) => {
    const last = lines[lines.length - 1];
    return last && `${last} ${word}`.length > width / LETTER ? [...lines, word] : [...lines.slice(0, -1), last ? `${last} ${word}` : word];
  }, []).join("<br>")).join("<br>");
  const lines = (text) => text.split("<br>").length;
  // one number along an axis tells no scale: the least count from which Plotly, whose steps are 2, 5
  // and 10, sets so many numbers
  const LEAST = 3;
  const numbered = (axis) => {
    const [low, high] = [...axis.range].sort((a, b) => a - b);
    for (let count = axis.nticks || 5; count < 20; count += 1) {
      const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
      const step = power * [2, 5, 10].find((one) => one >= rough / power);
      if (Math.floor(high / step) - Math.ceil(low / step) + 1 >= LEAST) return count;
    }
    return axis.nticks;
  };
  const counts = (layout) => Object.fromEntries(Object.entries(layout)
    .filter(([key, axis]) => /^[xy]axis\d*$/.test(key) && axis.type !== "log" && !axis.tickvals && !axis.dtick)
    .map(([key, axis]) => [`${key}.nticks`, numbered(axis)]));
  // fits what is written along an axis into so many pixels; returns the height that this takes
  const fitted = (axis, width) => {
    let high = 46;
    axis.title.text = folded(axis.title.text, width);
    if (axis.ticktext) {
      const longest = Math.max(...axis.ticktext.flatMap((text) => text.split("<br>")).map((line) => line.length));
      if (axis.ticktext.length * longest * LETTER > width) {
        axis.tickangle = -40;
        axis.ticktext = axis.ticktext.map((text) => text.replaceAll("<br>", " "));
      }
      if (axis.tickangle) high += 0.6 * LETTER * Math.max(...axis.ticktext.map((text) => text.length));
    } else if (axis.type === "log") {
      if (width < 300) Object.assign(axis, { dtick: 1 });
    } else {
      axis.nticks = Math.max(3, Math.min(axis.nticks, Math.floor(width / 70)));
      while (axis.dtick && axis.range[1] / axis.dtick > width / 32) axis.dtick *= 2;
    }
    return high + LINE * lines(axis.title.text);
  };
  // places every panel, in pixels from the left and the top of the plot, and returns its height
  const place = (layout, plot, wide) => {
    const axes = Object.keys(layout).filter((key) => /^xaxis\d*$/.test(key));
    const stacked = axes.length > 1 && wide < NARROW;
    if (wide < NARROW) Object.assign(layout.margin, { l: 44, r: 10 });
    // names beside the axes take what they need
    const names = axes.flatMap((key) => layout[`yaxis${key.slice(5)}`].ticktext || []).flatMap((text) => text.split("<br>"));
    const left = Math.max(layout.margin.l, 20 + LETTER * Math.max(0, ...names.map((name) => name.length)));
    const inner = wide - left - layout.margin.r - 30;
    const below = [], heads = axes.map((key, i) => {
      const [low, high] = stacked ? [0, 1] : layout[key].domain;
      const width = (high - low) * inner;
      below.push(fitted(layout[key], width));
      const head = layout.annotations[i];
      head.text = folded(head.text, width);
      return LINE * lines(head.text);
    });
    const sum = (some) => some.reduce((a, b) => a + b, 0);
    const height = stacked ? axes.length * plot + sum(below.slice(0, -1)) + sum(heads.slice(1)) : plot;
    let top = 0;
    axes.forEach((key, i) => {
      const y = layout[`yaxis${key.slice(5)}`], head = layout.annotations[i];
      y.title.text = folded(y.title.text, plot);
      if (!stacked) return Object.assign(head, { y: 1 });
      if (i) top += plot + below[i - 1] + heads[i];
      layout[key].domain = [0, 1];
      y.domain = [Math.max(0, 1 - (top + plot) / height), 1 - top / height];
      y.showticklabels = true;
      y.title.text = y.title.text || layout.yaxis.title.text;
      Object.assign(head, { x: 0, y: y.domain[1], xanchor: "left" });
    });
    layout.margin.b = stacked ? below.at(-1) : Math.max(...below);
    layout.margin.t = Math.max(...(stacked ? heads.slice(0, 1) : heads), 0) + 8;
    return height;
  };
  const draw = (box, paper) => {
    const wide = paper ? PAPER : box.clientWidth, size = `${wide} ${paper}`;
    if (box.dataset.size === size || !wide) return;
    box.dataset.size = size;
    const { data, layout } = JSON.parse(box.querySelector("script").textContent);
    // rows of names need their height; curves need less of it where there is little room
    const part = paper ? 0.65 : wide < NARROW && !layout.yaxis.ticktext ? 0.75 : 1;
    const height = place(layout, PLOT * Number(box.dataset.height) * part, wide);
    [...data, ...layout.shapes].forEach((one) => { if (one.showlegend) one.name = folded(one.name, wide - 130); });
    const heads = layout.margin.t, buttons = paper || wide < NARROW ? 0 : BUTTONS;
    const sized = (legend) => {
      const margin = { ...layout.margin, t: heads + legend + buttons };
      return { margin, width: wide, height: height + margin.t + margin.b, legend: { ...layout.legend, y: 1 + heads / height } };
    };
    // the legend is measured, then given its place; a finger has no pointer to hover with
    Plotly.react(box, data, { ...layout, ...sized(60) }, { ...OPTIONS, displayModeBar: wide < NARROW ? false : "hover" });
    const legend = box.querySelector(".legend .bg");
    const fits = sized(legend ? Math.ceil(legend.getBBox().height) + 6 : 0);
    Plotly.relayout(box, { ...fits, ...counts(box.layout) });
    Object.assign(box.style, { height: `${fits.height}px`, minHeight: 0 });
  };
  const boxes = [...document.querySelectorAll(".plot")], details = [...document.querySelectorAll("details")];
  const shown = () => boxes.filter((box) => !box.closest("details:not([open])"));
  const drawShown = () => shown().forEach((box) => draw(box, false));
  // what is linked to is opened, with all that it lies in
  const reach = () => {
    const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (!target) return;
    for (let one = target.closest("details"); one; one = one.parentElement.closest("details")) one.open = true;
    drawShown();
    target.scrollIntoView();
  };
  document.querySelectorAll("p.all button").forEach((button) => {
    const inside = [...button.closest("article").querySelectorAll("details")];
    button.hidden = !inside.length;
    button.addEventListener("click", () => {
      const open = inside.some((one) => !one.open);
      inside.forEach((one) => { one.open = open; });
      button.textContent = open ? "Close everything" : "Open everything";
    });
  });
  document.addEventListener("toggle", drawShown, true);
  window.addEventListener("hashchange", reach);
  window.addEventListener("resize", drawShown);
  // size of the letters of a table on paper [px]; one that is too wide for the page is made smaller
  const PRINTED = 10.7, tables = [...document.querySelectorAll(".wide table")];
  window.addEventListener("beforeprint", () => {
    details.forEach((one) => { one.dataset.was = one.open; one.open = one.open || one.className !== "settings"; });
    boxes.forEach((box) => draw(box, true));
    tables.forEach((table) => {
      const wide = table.scrollWidth * PRINTED / parseFloat(getComputedStyle(table).fontSize);
      table.style.zoom = Math.min(1, PAPER / wide);
    });
  });
  window.addEventListener("afterprint", () => {
    details.forEach((one) => { one.open = one.dataset.was === "true"; });
    tables.forEach((table) => { table.style.zoom = ""; });
    drawShown();
  });
  drawShown();
  reach();
})();
