"use strict";
// every figure is drawn from the JSON beside it; one in a closed <details> when that is opened
(() => {
  const options = { responsive: true, displaylogo: false, displayModeBar: "hover", modeBarButtonsToRemove: ["select2d", "lasso2d"] };
  // words that are longer than their axis go on in a second line
  const folded = (text, letters) => text.split(" ").reduce((lines, word) => {
    const last = lines[lines.length - 1];
    return last && `${last} ${word}`.length > letters ? [...lines, word] : [...lines.slice(0, -1), last ? `${last} ${word}` : word];
  }, []).join("<br>");
  const LETTER = 9;
  // on a telephone panels stand one below the other instead of side by side
  const stack = (layout, data, tall, wide) => {
    const axes = Object.keys(layout).filter((key) => /^xaxis\d*$/.test(key));
    if (!axes.length) return;
    // of each part the lower third is for the numbers and words below its axis; the last needs none
    const count = axes.length - 0.32, part = 1 / count, each = Math.max(260, tall);
    // names in the legend stand two in a row, long ones alone
    const names = [...data, ...layout.shapes].filter((one) => one.showlegend).length;
    const up = 100 + 28 * Math.ceil(0.7 * names);
    axes.forEach((key, i) => {
      const y = layout[`yaxis${key.slice(5)}`], top = 1 - i * part;
      layout[key].domain = [0, 1];
      y.domain = [top - 0.68 * part, top];
      y.showticklabels = true;
      Object.assign(layout[key], { nticks: 5, tickfont: { size: 12 } });
      layout[key].title.text = folded(layout[key].title.text, (wide - 110) / LETTER);
      y.title.text = folded(y.title.text, 0.68 * each / LETTER);
      const head = layout.annotations[i];
      Object.assign(head, { x: 0, y: top, xanchor: "left", yanchor: "bottom" });
    });
    layout.margin = { ...layout.margin, t: up, r: 12 };
    layout.height = each * count + up + 64;
    layout.legend.y = 1 + 34 / (each * count);
    return `${layout.height}px`;
  };
  const draw = (box) => {
    if (box.dataset.drawn) return;
    box.dataset.drawn = "yes";
    const figure = JSON.parse(box.querySelector("script").textContent);
    const height = box.clientWidth < 640 && stack(figure.layout, figure.data, 0.6 * box.clientHeight, box.clientWidth);
    if (height) box.style.height = height;
    // a finger has no pointer to hover with, and the tools would lie on the legend
    Plotly.newPlot(box, figure.data, figure.layout, height ? { ...options, displayModeBar: false } : options);
  };
  const hidden = (box) => box.closest("details:not([open])");
  const boxes = [...document.querySelectorAll(".plot")];
  boxes.filter((box) => !hidden(box)).forEach(draw);
  document.addEventListener("toggle", (event) => {
    event.target.querySelectorAll(".plot").forEach((box) => hidden(box) || draw(box));
  }, true);
  const details = [...document.querySelectorAll("details")];
  window.addEventListener("beforeprint", () => {
    details.forEach((one) => { one.dataset.was = one.open; one.open = true; });
    boxes.forEach(draw);
  });
  window.addEventListener("afterprint", () => {
    details.forEach((one) => { one.open = one.dataset.was === "true"; });
  });
})();
