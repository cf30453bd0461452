// all that is asked of the server; what it refuses comes as sentences
import { language, words } from "/static/words.js";

// so long one question waits for an answer: the page tells in between how long it takes
const WAIT_S = 2;
// a phone loses its Wi-Fi for a moment: so often a job is asked for again, and so long after
const TRIES = 15, PAUSE_MS = 2000;

/** What was refused, in sentences. */
export class Refused extends Error {
  constructor(faults) {
    super(faults.join(" "));
    this.faults = faults;
  }
}

/** What did not come: the server may be asked again. */
class Lost extends Refused {}

async function answer(asked) {
  const response = await asked.catch(() => { throw new Lost([words("page.no_server")]); });
  const found = await response.json().catch(() => ({}));
  if (!response.ok) throw new Refused(found.faults ?? [words("page.refused", { status: response.status })]);
  return found;
}

const HEAD = { "Accept-Language": language };

export const get = (path) => answer(fetch(path, { headers: HEAD }));

export const post = (path, value) =>
  answer(fetch(path, { method: "POST", headers: { ...HEAD, "Content-Type": "application/json" }, body: JSON.stringify(value) }));

/** Sends a sound, a video or a table, and gives what was heard or seen in it. */
export function upload(group, name, kind, blob) {
  const query = new URLSearchParams({ group, name, kind });
  return answer(fetch(`/api/recordings?${query}`, { method: "POST", headers: { ...HEAD, "Content-Type": "application/octet-stream" }, body: blob }));
}

/** Where a file of a group is. */
export const fileOf = (group, name) => `/files/${encodeURIComponent(group)}/${encodeURIComponent(name)}`;

async function patiently(path) {
  for (let left = TRIES; ; left -= 1) {
    try {
      return await get(path);
    } catch (error) {
      if (!(error instanceof Lost) || !left) throw error;
      await new Promise((resolve) => { setTimeout(resolve, PAUSE_MS); });
    }
  }
}

/** Has a job done and gives its result; tells now and then whether it waits, and at which place. */
export async function job(what, tell = () => {}) {
  const { id } = await post("/api/jobs", what);
  for (;;) {
    const now = await patiently(`/api/jobs/${id}?wait=${WAIT_S}`);
    if (now.result) return { ...now.result, id };
    if (now.state === "failed") throw new Refused(now.faults ?? [words("page.failed")]);
    tell(now);
  }
}
