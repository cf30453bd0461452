// The teacher's page: all groups, their results, and the queue. The PIN stays in this page.
"use strict";
const words = JSON.parse(document.getElementById("words").textContent);
const byId = (id) => document.getElementById(id);
const language = document.documentElement.lang;
let pin = "";
let isOpen = true;
let timer;
// what stands on the page now, and the kind of job of which there is one for each touch of a slider
let shown = "";
const RUN = "run";
const WRONG_PIN = 401;

async function ask(path, options = {}) {
  const headers = { "X-Pin": pin, "Accept-Language": language, ...(options.headers || {}) };
  const answer = await fetch(path, { ...options, headers }).catch(() => { throw new Error(byId("fault").dataset.lost); });
  const told = await answer.json().catch(() => ({}));
  if (answer.status === WRONG_PIN) leave();
  if (!answer.ok) throw new Error((told.faults || [answer.statusText]).join(" "));
  return told;
}

function made(tag, text, more = {}) {
  const element = Object.assign(document.createElement(tag), more);
  if (text) element.textContent = text;
  return element;
}

function link(group, file) {
  const name = file.name || file;
  return made("a", name, { href: `/files/${encodeURIComponent(group.key)}/${encodeURIComponent(name)}` });
}

function rowOf(group, result) {
  const row = document.createElement("tr");
  row.append(made("td", new Date(result.when).toLocaleTimeString(language)), made("td", words[`teacher_${result.kind}`]));
  const cell = made("td", result.sentence || "");
  for (const name of result.files || []) cell.append(" ", link(group, name));
  row.append(cell);
  return row;
}

function sectionOf(group) {
  const section = document.createElement("section");
  const runs = group.results.filter((one) => one.kind === RUN).length;
  const counts = `${words.teacher_recordings}: ${group.recordings.length}, ${words.teacher_runs}: ${runs}`;
  section.append(made("h3", group.name), made("p", counts));
  const table = document.createElement("table");
  for (const result of group.results.filter((one) => one.kind !== RUN)) table.append(rowOf(group, result));
  section.append(table);
  return section;
}

// who recorded or made something, the latest first; then who has only looked
function showGroups(groups) {
  const now = JSON.stringify(groups);
  if (now === shown) return; // a link that is about to be clicked stays where it is
  shown = now;
  const own = (group) => [...group.recordings, ...group.results.filter((one) => one.kind !== RUN)];
  const latest = (group) => own(group).map((one) => String(one.when)).sort().at(-1);
  const active = groups.filter((one) => own(one).length).sort((a, b) => latest(b).localeCompare(latest(a)));
  const others = groups.filter((one) => !own(one).length).map((one) => one.name);
  const rest = others.length ? [made("p", `${words.teacher_only} ${others.join(", ")}`)] : [];
  byId("groups").replaceChildren(...active.map(sectionOf), ...rest);
}

function showQueue(told) {
  isOpen = told.open;
  const state = isOpen ? words.teacher_open : words.teacher_closed;
  byId("state").textContent = `${state} ${words.teacher_waiting} ${told.waiting}.`;
  byId("switch").textContent = isOpen ? words.teacher_close : words.teacher_reopen;
}

async function show() {
  const told = await ask("/api/teacher");
  showQueue(told);
  showGroups(told.groups);
  byId("enter").hidden = true;
  byId("inside").hidden = false;
}

async function showCode() {
  const told = await ask("/api/share");
  if (!told.url) return; // a lab that is not shared has none
  const picture = made("img", "", { alt: told.url, width: 280 });
  picture.src = `data:image/svg+xml;utf8,${encodeURIComponent(told.qr_svg)}`;
  byId("code").replaceChildren(picture, made("p", told.url), made("p", told.sentence));
}

async function tried(what) {
  try {
    await what();
    byId("fault").textContent = "";
  } catch (error) {
    byId("fault").textContent = error.message;
  }
}

async function enter() {
  await show();
  await showCode();
  clearInterval(timer);
  timer = setInterval(() => tried(show), 5000);
}

// a lab that was started anew has another PIN: who goes on with the old one locks this device out
function leave() {
  clearInterval(timer);
  byId("enter").hidden = false;
  byId("inside").hidden = true;
}

byId("enter").addEventListener("submit", (event) => {
  event.preventDefault();
  pin = byId("pin").value;
  tried(enter);
});

if (document.body.dataset.pin === "no") tried(enter);

byId("switch").addEventListener("click", () => tried(async () => {
  const body = JSON.stringify({ open: !isOpen });
  const headers = { "Content-Type": "application/json" };
  showQueue(await ask("/api/teacher/queue", { method: "POST", body, headers }));
}));
