"use strict";
// every figure is drawn from the JSON beside it; one in a closed <details> when that is opened
(() => {
  const options = { responsive: true, displaylogo: false, displayModeBar: "hover", modeBarButtonsToRemove: ["select2d", "lasso2d"] };
  const draw = (box) => {
    if (box.dataset.drawn) return;
    box.dataset.drawn = "yes";
    const figure = JSON.parse(box.querySelector("script").textContent);
    Plotly.newPlot(box, figure.data, figure.layout, options);
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
