import { Drop } from "/static/drop.js";
import { byId, links, make } from "/static/parts.js";
import { Real } from "/static/real.js";
import { get } from "/static/server.js";
import { language, words } from "/static/words.js";

const asked = new URLSearchParams(location.search);
const GROUP = "simcompare.group";

// a browser may keep nothing of a page
function remembered(ask) {
  try {
    return ask(localStorage);
  } catch {
    return null;
  }
}

// a name of its own for each device, until its users say one
function group() {
  const box = byId("group");
  if (!box.value.trim()) box.value = words("page.group_start", { number: crypto.getRandomValues(new Uint16Array(1))[0] });
  remembered((store) => store.setItem(GROUP, box.value));
  return box.value.trim();
}

function expert(isOn) {
  document.body.classList.toggle("is-expert", isOn);
  document.querySelectorAll(".expert").forEach((one) => { one.hidden = !isOn; });
}

// what the group has stored, also before a restart of the server
async function stored(real) {
  const found = await get(`/api/groups/${encodeURIComponent(group())}`).catch(() => null);
  const results = (found?.results ?? []).filter((one) => one.kind === "fit" && one.recording), files = found?.files ?? [];
  byId("results").hidden = !results.length && !files.length;
  byId("stored").replaceChildren(
    ...results.map((one) => made(one, real)),
    ...links(group(), files));
  real.offer(found?.recordings ?? []);
}

// a fit of before, which can be looked at again
function made(one, real) {
  const button = make("button", { type: "button", textContent: words("results.show") });
  button.addEventListener("click", () => real.try(() => real.reopen(one)));
  return make("li", {}, `${new Date(one.when).toLocaleString(language)}: ${one.sentence} `, button);
}

async function share() {
  const found = await get("/api/share").catch(() => null);
  if (!found?.url) return;
  byId("share").hidden = false;
  byId("qr").append(document.importNode(new DOMParser().parseFromString(found.qr_svg, "image/svg+xml").documentElement, true));
  Object.assign(byId("share-url"), { href: found.url, textContent: found.url });
  byId("share-sentence").textContent = found.sentence;
}

function languages() {
  for (const link of document.querySelectorAll("[data-language]")) {
    if (link.dataset.language === language) link.setAttribute("aria-current", "true");
    link.addEventListener("click", () => {
      const there = new URL(location);
      there.searchParams.set("lang", link.dataset.language);
      link.href = there;
    });
  }
}

byId("group").value = asked.get("group") ?? remembered((store) => store.getItem(GROUP)) ?? "";
const drop = new Drop(group), real = new Real(group, drop);
byId("expert").addEventListener("change", (event) => expert(event.target.checked));
byId("group").addEventListener("change", () => stored(real));
document.addEventListener("stored", () => stored(real));
languages();
share();
await drop.start(asked.get("scenario"), asked.get("preset") ?? "").catch((error) => drop.refuse(error));
await stored(real);
