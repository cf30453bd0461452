// work of which only the newest counts
/** One job at a time; while it is done, only the newest wish waits. */
export class Latest {
  constructor(work) {
    Object.assign(this, { work, busy: false, wish: null });
  }
  async ask(wish) {
    this.wish = wish;
    if (this.busy) return;
    this.busy = true;
    try {
      while (this.wish !== null) {
        const now = this.wish;
        this.wish = null;
        await this.work(now);
      }
    } finally {
      this.busy = false;
    }
  }
}

/** Calls once when nothing new came for a while. */
export function settled(work, wait_ms) {
  let timer;
  return (...values) => {
    clearTimeout(timer);
    timer = setTimeout(() => work(...values), wait_ms);
  };
}
