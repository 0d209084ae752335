// What a page sends waits here until the server has it on its disk: it survives a reload and a lost connection. Every item is
// known to the server by its key or its page, so that one which is sent twice counts once.

const FIRST_WAIT = 200; // ms, doubled after every failure
const LONGEST_WAIT = 8000; // ms
const PATIENCE = 12000; // ms until a request is given up

const pause = (ms, wake) => new Promise((done) => {
  const timer = setTimeout(done, ms);
  wake(() => { clearTimeout(timer); done(); });
});

// Random bits, as hexadecimal digits.
export function key() {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}

// The browser's storage; memory where it is blocked.
function storage() {
  try {
    localStorage.setItem("gaitway", "");
    localStorage.removeItem("gaitway");
    return localStorage;
  } catch {
    const held = new Map();
    return {
      get length() { return held.size; },
      key: (index) => [...held.keys()][index] ?? null,
      getItem: (name) => held.get(name) ?? null,
      setItem: (name, value) => held.set(name, value),
      removeItem: (name) => held.delete(name),
    };
  }
}

const store = storage();
const names = () => Array.from({ length: store.length }, (_, index) => store.key(index));

export class Queue {
  // `say` is called with saving, saved, offline, refused or lost.
  constructor(study, mark, say) {
    this.study = study;
    this.mark = mark;
    this.say = say;
    this.prefix = `gaitway:${mark}:`;
    this.count = 0;
    this.waiting = [];
    this.isRunning = false;
    this.isLost = false;
    this.wake = () => {};
    this.onRefused = () => {};
    this.onMoved = () => {};
    window.addEventListener("online", () => this.wake());
    // what an earlier participation in this browser has left cannot be sent any more
    names().filter((name) => name.startsWith("gaitway:") && !name.startsWith(this.prefix))
      .forEach((name) => store.removeItem(name));
  }

  // Items in the order in which they came.
  items() {
    return names().filter((name) => name.startsWith(`${this.prefix}item:`)).sort();
  }

  get isEmpty() {
    return this.items().length === 0;
  }

  // Sends a body, now or when it can be.
  send(route, body) {
    const order = `${String(Date.now()).padStart(15, "0")}:${String(this.count++).padStart(6, "0")}:${key()}`;
    store.setItem(`${this.prefix}item:${order}`, JSON.stringify({ route, body }));
    this.drain();
  }

  // Resolves when everything is on the server's disk.
  empty() {
    return new Promise((done) => {
      this.waiting.push(done);
      this.drain();
    });
  }

  // Only one tab sends at a time.
  async drain() {
    if (this.isRunning || this.isLost) return;
    this.isRunning = true;
    try {
      const work = () => this.work();
      await (navigator.locks ? navigator.locks.request(this.prefix, work) : work());
    } finally {
      this.isRunning = false;
    }
    if (this.isLost) return;
    if (!this.isEmpty) return this.drain();
    this.waiting.splice(0).forEach((done) => done());
  }

  async work() {
    let wait = FIRST_WAIT;
    for (let [next] = this.items(); next && !this.isLost; [next] = this.items()) {
      if (wait === FIRST_WAIT) this.say("saving");
      const outcome = await this.post(JSON.parse(store.getItem(next) ?? "null"));
      if (outcome === "again") {
        this.say("offline");
        await pause(wait, (wake) => { this.wake = wake; });
        wait = Math.min(LONGEST_WAIT, wait * 2);
        continue;
      }
      wait = FIRST_WAIT;
      if (outcome === "lost") {
        this.isLost = true;
        this.items().forEach((name) => store.removeItem(name));
      } else {
        store.removeItem(next);
      }
      this.say(outcome);
      if (outcome === "refused") {
        // the page may show an answer that the server does not have
        store.removeItem(`${this.prefix}given`);
        this.onRefused();
      }
    }
  }

  async post(item) {
    if (!item) return "saved";
    try {
      const reply = await fetch(`/s/${this.study}/${item.route}`, {
        method: "POST",
        headers: { "content-type": "application/json", "x-participation": this.mark },
        body: JSON.stringify(item.body),
        keepalive: true,
        signal: AbortSignal.timeout(PATIENCE),
      });
      if (reply.ok) {
        // another tab has answered the page
        if (item.route === "answer" && (await reply.json()).page !== item.body.page) this.onMoved();
        return "saved";
      }
      if (reply.status === 429 || reply.status >= 500) return "again";
      return [401, 403, 404, 410].includes(reply.status) ? "lost" : "refused";
    } catch {
      return "again";
    }
  }

  // What was answered on the current page, for a reload.
  given(page) {
    const kept = JSON.parse(store.getItem(`${this.prefix}given`) ?? "null");
    return kept?.page === page ? kept.values : {};
  }

  // Leaves nothing in the browser.
  forget() {
    names().filter((name) => name.startsWith(this.prefix)).forEach((name) => store.removeItem(name));
  }

  keep(page, question, value) {
    const values = { ...this.given(page), [question]: value };
    store.setItem(`${this.prefix}given`, JSON.stringify({ page, values }));
  }
}
