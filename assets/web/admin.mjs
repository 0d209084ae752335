// The operators' live page: the browser asks for the next event by itself, once a second.

const live = document.getElementById("live");
if (live) {
  const source = new EventSource(live.dataset.events);
  source.addEventListener("message", (event) => {
    const fresh = new DOMParser().parseFromString(event.data, "text/html");
    const focused = live.contains(document.activeElement) ? document.activeElement.getAttribute("href") : null;
    live.replaceChildren(...[...fresh.body.childNodes].map((node) => document.adoptNode(node)));
    live.classList.remove("stale");
    if (focused) live.querySelector(`a[href="${CSS.escape(focused)}"]`)?.focus();
  });
  source.addEventListener("error", () => {
    live.classList.add("stale");
    // a session that has ended is answered with a refusal, after which the browser asks no more
    if (source.readyState === EventSource.CLOSED) location.reload();
  });
}
