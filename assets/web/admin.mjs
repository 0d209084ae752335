// The operators' live page: the browser asks for the next event by itself, once a second.

const PATIENCE = 5000; // ms without an event until the page says that it is old

const live = document.getElementById("live");
if (live) {
  const old = document.getElementById("old");
  let timer = null;
  const source = new EventSource(live.dataset.events);
  source.addEventListener("message", (event) => {
    const fresh = new DOMParser().parseFromString(event.data, "text/html");
    const focused = live.contains(document.activeElement) ? document.activeElement.getAttribute("href") : null;
    live.replaceChildren(...[...fresh.body.childNodes].map((node) => document.adoptNode(node)));
    clearTimeout(timer);
    [timer, old.hidden] = [null, true];
    if (focused) live.querySelector(`a[href="${CSS.escape(focused)}"]`)?.focus();
  });
  source.addEventListener("error", () => {
    // every event ends its connection
    timer ??= setTimeout(() => { old.hidden = false; }, PATIENCE);
    // a session that has ended is answered with a refusal, after which the browser asks no more
    if (source.readyState === EventSource.CLOSED) location.reload();
  });
}
