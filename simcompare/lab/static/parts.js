// small pieces of the page
import { fileOf } from "/static/server.js";

/** An element with properties and what is in it. */
export function make(tag, properties = {}, ...inside) {
  const found = Object.assign(document.createElement(tag), properties);
  found.append(...inside);
  return found;
}

export const byId = (id) => document.getElementById(id);

/** Shows sentences in a box, or hides it where there are none. */
export function say(box, sentences) {
  box.replaceChildren(...sentences.map((one) => make("p", { textContent: one })));
  box.hidden = !sentences.length;
}

/** A table that scrolls by itself where it is too wide. */
export function table({ head, rows, title }) {
  const cells = (row) => row.map((one, i) => make(i ? "td" : "th", { textContent: one ?? "", ...(i ? {} : { scope: "row" }) }));
  const found = make("table", {},
    ...(title ? [make("caption", { textContent: title })] : []),
    make("thead", {}, make("tr", {}, ...head.map((one) => make("th", { scope: "col", textContent: one })))),
    make("tbody", {}, ...rows.map((row) => make("tr", {}, ...cells(row)))));
  const box = make("div", { className: "wide", tabIndex: 0 }, found);
  box.setAttribute("role", "region");
  box.setAttribute("aria-label", title ?? head.join(", "));
  return box;
}

/** A box to tick, or one of several, with its label. */
export function tick(type, name, value, text, properties = {}) {
  const input = make("input", { type, name, value, ...properties });
  return make("label", {}, input, " ", text);
}

export const ticked = (box) => [...box.querySelectorAll("input:checked")].map((one) => one.value);

/** Files to take home, by their names. */
export const links = (group, files) => files.map((name) => make("li", {}, make("a", { href: fileOf(group, name), textContent: name, ...(name.endsWith(".html") ? { target: "_blank" } : { download: name }) })));
