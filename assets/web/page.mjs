// A participant's page. Its forms work without this; with it every answer is sent at once, waits while there is no connection,
// and the next page takes the place of this one when the server has everything on its disk.

import { Queue, key } from "./queue.mjs";
import { film } from "./walk.mjs";

const TYPING = 800; // ms after the last letter until a text is sent
const PREFIX = "q:"; // of the names of fields with answers

let queue = null;
let page = null;
let isLeaving = false;
let wasRefused = false;
let shown = 0; // when the page was shown, ms
let seen = new Map(); // when each question was first to be seen, ms
let first = new Map(); // from then to its first answer, ms
let last = new Map(); // what was sent last
let typing = new Map(); // timers

const main = () => document.getElementById("main");
const pause = (ms) => new Promise((done) => setTimeout(done, ms));

function say(state) {
  const status = document.getElementById("status");
  if (status && status.textContent !== status.dataset[state]) status.textContent = status.dataset[state] ?? "";
}

// Fetches the current page and puts it in the place of this one.
async function turn() {
  let text = null;
  for (let wait = 200; text === null; wait = Math.min(8000, wait * 2)) {
    try {
      const reply = await fetch(`/s/${main().dataset.study}/go`, { signal: AbortSignal.timeout(12000) });
      if (reply.status < 500 && reply.status !== 429) {
        text = await reply.text();
        break;
      }
    } catch {
      // as if it had said that it is unavailable
    }
    say("offline");
    await pause(wait);
  }
  const fresh = new DOMParser().parseFromString(text, "text/html");
  const script = (of) => of.querySelector("script")?.getAttribute("src");
  if (!fresh.getElementById("main") || script(fresh) !== script(document)) return location.reload();
  document.title = fresh.title;
  Object.assign(document.documentElement, { lang: fresh.documentElement.lang, dir: fresh.documentElement.dir });
  for (const part of ["header", "main", "footer"]) {
    document.querySelector(part).replaceWith(document.adoptNode(fresh.querySelector(part)));
  }
  begin();
  const heading = main().querySelector("h1");
  window.scrollTo(0, 0);
  if (heading) {
    heading.tabIndex = -1;
    heading.focus({ preventScroll: true });
  }
  if (wasRefused) say("refused");
  wasRefused = false;
}

// The question of a field, and what it holds: nothing, a number or a text.
const question = (field) => field.name.slice(PREFIX.length);
const isText = (field) => field.type === "textarea";

// Sends what a field holds, if it is an answer and was not sent.
function answer(field) {
  clearTimeout(typing.get(field.name));
  if (!field.validity.valid && field.value !== "") return;
  const name = question(field);
  const ms = Math.max(0, Math.round(performance.now() - (seen.get(name) ?? shown)));
  if (!first.has(name)) first.set(name, ms);
  if ((last.get(name) ?? "") === field.value) return;
  last.set(name, field.value);
  const body = { page, question: name, first_ms: first.get(name), ms, key: key() };
  if (field.value !== "") Object.assign(body, isText(field) ? { text: field.value } : { value: Number(field.value) });
  queue.keep(page, name, field.value);
  queue.send("answer", body);
}

function type(field) {
  const name = question(field);
  if (!first.has(name)) first.set(name, Math.round(performance.now() - (seen.get(name) ?? shown)));
  clearTimeout(typing.get(field.name));
  typing.set(field.name, setTimeout(() => answer(field), TYPING));
}

// Sends what belongs to the page's end, and turns the page when the server has it.
async function leave(route, body) {
  if (isLeaving) return;
  isLeaving = true;
  await queue.empty();
  queue.send(route, body);
  await queue.empty();
  await turn();
}

function form(element) {
  const fields = [...element.elements].filter((field) => field.name?.startsWith(PREFIX));
  for (const [name, value] of Object.entries(queue.given(page))) {
    for (const field of fields.filter((own) => question(own) === name)) {
      if (field.type === "radio") field.checked = field.value === value;
      else field.value = value;
      last.set(name, value);
    }
  }
  const watcher = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) {
      const name = target.dataset.question;
      if (isIntersecting && !seen.has(name)) seen.set(name, performance.now());
    }
  }, { threshold: 0.5 });
  element.querySelectorAll("[data-question]").forEach((group) => watcher.observe(group));
  element.addEventListener("change", (event) => event.target.name?.startsWith(PREFIX) && answer(event.target));
  element.addEventListener("input", (event) => {
    if (event.target.name?.startsWith(PREFIX) && event.target.type !== "radio") type(event.target);
  });
  element.addEventListener("submit", (event) => {
    event.preventDefault();
    fields.filter((field) => field.type !== "radio").forEach(answer);
    leave("event", { event: "next", page });
  });
}

// Keys 1 to 9 choose in the group that has the focus.
function choose(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || !/^[1-9]$/.test(event.key)) return;
  const group = document.activeElement?.closest("fieldset");
  if (!group || document.activeElement.type !== "radio") return;
  const chosen = group.querySelectorAll("input[type=radio]")[Number(event.key) - 1];
  if (!chosen) return;
  event.preventDefault();
  chosen.focus();
  chosen.click();
}

// Telemetry: it may get lost.
function sign(kind) {
  if (!queue || !page) return;
  fetch(`/s/${queue.study}/event`, {
    method: "POST",
    headers: { "content-type": "application/json", "x-participation": queue.mark },
    body: JSON.stringify({ event: "sign", page, kind }),
    keepalive: true,
  }).catch(() => {});
}

function show(stage, { film: name, seconds, plays }) {
  const isFirst = Number(plays) > 0;
  film(stage, { name, seconds: Number(seconds), plays: Number(plays) || 1 }, {
    again: !isFirst,
    shown: (exposure) => isFirst ? leave("event", { event: "shown", page, exposure }) : sign("replay"),
    fault: (reason) => isFirst ? leave("event", { event: "fault", page, reason }) : sign("replay failed"),
  });
}

// Brings the page to life that the document has now.
function begin() {
  const { study, mark, page: id } = main().dataset;
  [page, isLeaving, shown] = [id ?? null, false, performance.now()];
  [seen, first, last, typing] = [new Map(), new Map(), new Map(), new Map()];
  const again = main().querySelector("[data-again]");
  if (again) setTimeout(turn, Number(again.dataset.again) * 1000);
  if (!mark) return;
  if (queue?.mark !== mark) {
    queue = new Queue(study, mark, say);
    queue.onMoved = () => isLeaving || turn();
    queue.onRefused = () => {
      wasRefused = true;
      if (!isLeaving) turn();
    };
  }
  const answers = document.getElementById("answers");
  if (answers && page) form(answers);
  const stage = main().querySelector(".film");
  if (stage && page) show(stage, main().dataset);
  // what a reload interrupted is sent now, and may lead to another page
  if (!queue.isEmpty && !isLeaving && page) {
    isLeaving = true;
    queue.empty().then(turn);
  }
  if (main().dataset.ended) queue.empty().then(() => queue.forget()).then(back);
}

// Goes to where credit is granted, once: a participant who comes back to this page may stay.
function back() {
  const link = main().querySelector("a[data-credit]");
  if (!link || history.state?.went) return;
  history.replaceState({ went: true }, "");
  location.assign(link.href);
}

document.addEventListener("keydown", choose);
document.addEventListener("visibilitychange", () => sign(document.hidden ? "hidden" : "visible"));
window.addEventListener("pageshow", (event) => event.persisted && queue && turn());
begin();
