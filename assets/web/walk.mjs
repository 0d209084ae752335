// Plays a film: a walk, drawn from numbers on a canvas as the program's own renderer draws it, or a clip. It is in memory before
// it can be started, starts only when asked, and counts its own late frames.

const PATIENCE = 10000; // ms without a byte, or from the start to the first frame
const LATE = 1.5; // times the usual gap between two frames
const LONGEST_WAIT = 2000; // ms between two tries

const memory = new Map();
const pause = (ms) => new Promise((done) => setTimeout(done, ms));

// The bytes of a reply; fails when none comes for long.
async function read(reply, stop) {
  const parts = [];
  const reader = reply.body.getReader();
  for (;;) {
    const timer = setTimeout(stop, PATIENCE);
    const { done, value } = await reader.read().finally(() => clearTimeout(timer));
    if (done) return new Blob(parts);
    parts.push(value);
  }
}

// Whether the server answers at all.
const answers = () => fetch(document.querySelector("link[rel=icon]").href, {
  method: "HEAD", cache: "no-store", signal: AbortSignal.timeout(PATIENCE),
}).then((reply) => reply.ok, () => false);

// A walk or the address of a clip, by its name. Without a connection it waits; what is broken throws, and so does what does not
// come while the server answers.
async function load(name, waiting) {
  let since = performance.now();
  for (let wait = 200; !memory.has(name); wait = Math.min(LONGEST_WAIT, wait * 2)) {
    const control = new AbortController();
    const stop = () => control.abort();
    let reply = null;
    try {
      const timer = setTimeout(stop, PATIENCE);
      reply = await fetch(`/stimuli/${name}`, { signal: control.signal }).finally(() => clearTimeout(timer));
      if (reply.ok) {
        const bytes = await read(reply, stop);
        const isWalk = reply.headers.get("content-type").includes("json");
        memory.set(name, isWalk ? { walk: JSON.parse(await bytes.text()) } : { clip: reply.url });
        break;
      }
    } catch (error) {
      // a lost connection is no fault of the film
      if (reply?.ok && error.name !== "TypeError") throw error;
    }
    if (reply && reply.status >= 400 && reply.status < 500 && reply.status !== 429) {
      throw new Error(`status ${reply.status}`);
    }
    waiting();
    if (!(await answers())) since = performance.now();
    else if (performance.now() - since > PATIENCE) throw new Error("not there in time");
    await pause(wait);
  }
  return memory.get(name);
}

// Draws a walk `time` seconds after its left foot struck: `export::figure` of the program, line by line.
export function draw(context, walk, time) {
  const scale = context.canvas.width / walk.size[0];
  const colour = (channels) => `rgb(${channels.slice(0, 3).map(Math.trunc).join(" ")})`;
  const project = ([x, y, z]) => {
    const metre = walk.focus / Math.max(walk.camera[2] - z, walk.nearest);
    return [walk.centre[0] - (walk.camera[0] - x) * metre, walk.centre[1] + (walk.camera[1] - y) * metre, metre];
  };
  const line = (from, to, width, channels) => {
    context.strokeStyle = colour(channels);
    context.lineWidth = width;
    context.beginPath();
    context.moveTo(from[0], from[1]);
    context.lineTo(to[0], to[1]);
    context.stroke();
  };
  context.setTransform(scale, 0, 0, scale, 0, 0);
  context.lineCap = "round";
  context.fillStyle = colour(walk.paper);
  context.fillRect(0, 0, walk.size[0], walk.size[1]);
  const { every, range, half, thick, color } = walk.stripes;
  for (let stripe = range[0]; stripe <= range[1]; stripe += 1) {
    const z = stripe * every - (walk.speed / 1000 * time) % every;
    const from = project([-half, 0, z]);
    line(from, project([half, 0, z]), thick * from[2], color);
  }
  const count = walk.poses.length;
  const place = (time * 1000 / walk.cycle) * count;
  const [now, next] = [0, 1].map((step) => walk.poses[(Math.floor(place) + step) % count]);
  const share = place % 1;
  const pose = now.map((joint, j) => joint.map((mm, axis) => (mm + (next[j][axis] - mm) * share) / 1000));
  const depth = (joint) => pose[joint][2] + pose[walk.parents[joint]][2];
  const order = pose.map((_, joint) => joint).sort((a, b) => depth(a) - depth(b));
  for (const joint of order) {
    const [from, to] = [walk.parents[joint], joint].map((index) => project(pose[index]));
    const mix = Math.min(1, Math.max(0, 0.5 - 0.5 * depth(joint) / walk.depth));
    const channels = walk.body[0].map((near, c) => near + (walk.body[1][c] - near) * mix);
    line(from, to, walk.thick[0] * to[2], channels);
    if (joint === walk.head) {
      context.fillStyle = colour(channels);
      context.beginPath();
      context.arc(to[0], to[1], 0.5 * walk.thick[1] * to[2], 0, 2 * Math.PI);
      context.fill();
    }
  }
}

// A canvas of the box's size in the screen's own pixels, and what draws on it.
function canvas(box, walk) {
  const element = document.createElement("canvas");
  box.replaceChildren(element);
  const context = element.getContext("2d", { alpha: false });
  let at = 0;
  const fit = () => {
    const width = Math.round((element.clientWidth || walk.size[0]) * (window.devicePixelRatio || 1));
    Object.assign(element, { width, height: Math.round(width * walk.size[1] / walk.size[0]) });
    draw(context, walk, at);
  };
  fit();
  new ResizeObserver(fit).observe(element);
  return { start: async () => {}, stop: () => {}, frame: (time) => draw(context, walk, at = time), length: null };
}

// A player of a clip that has enough of it to play to the end.
async function player(box, address) {
  const video = document.createElement("video");
  Object.assign(video, { muted: true, playsInline: true, preload: "auto", disablePictureInPicture: true });
  const ready = new Promise((done, fail) => {
    video.addEventListener("canplaythrough", done, { once: true });
    video.addEventListener("error", () => fail(new Error(`clip: ${video.error?.message ?? "unreadable"}`)));
    setTimeout(() => fail(new Error("clip: not ready in time")), PATIENCE);
  });
  video.src = address;
  box.replaceChildren(video);
  await ready;
  const start = async () => { video.currentTime = 0; await video.play(); };
  return { start, stop: () => video.pause(), frame: () => {}, length: video.duration };
}

// Plays once. Gives the gaps between frames, ms, or null if the page was hidden meanwhile.
function once(film, seconds) {
  return new Promise((done, fail) => {
    const gaps = [];
    let [first, last, isOver] = [null, null, false];
    const end = (act, value) => {
      if (isOver) return;
      isOver = true;
      clearTimeout(guard);
      document.removeEventListener("visibilitychange", hide);
      film.stop();
      act(value);
    };
    const hide = () => document.hidden && end(done, null);
    const guard = setTimeout(() => first === null && end(fail, new Error("no frame in time")), PATIENCE);
    const frame = (now) => {
      if (isOver) return;
      first ??= now;
      if (last !== null) gaps.push(now - last);
      last = now;
      const time = (now - first) / 1000;
      if (time >= seconds) return end(done, gaps);
      film.frame(time);
      requestAnimationFrame(frame);
    };
    document.addEventListener("visibilitychange", hide);
    film.start().then(() => requestAnimationFrame(frame), (error) => end(fail, error));
  });
}

// Makes a film ready in its box. `on.shown` gets the exposure after the last play, `on.fault` a reason.
export async function film(stage, { name, seconds, plays }, on) {
  const [box, status, button] = [".box", ".film-status", ".play"].map((part) => stage.querySelector(part));
  const say = (state) => { status.textContent = status.dataset[state] ?? ""; };
  stage.hidden = false;
  say("loading");
  let made;
  try {
    const loaded = await load(name, () => say("offline"));
    made = loaded.walk ? canvas(box, loaded.walk) : await player(box, loaded.clip);
  } catch (error) {
    say("broken");
    return on.fault(String(error.message ?? error));
  }
  const total = { started: 0, seconds_visible: 0, plays: 0, frames: 0, late_frames: 0, longest_ms: 0 };
  say("ready");
  button.disabled = false;
  button.addEventListener("click", async () => {
    button.disabled = true;
    say("playing");
    stage.scrollIntoView({ block: "nearest" });
    total.started ||= Date.now();
    try {
      do {
        const gaps = await once(made, made.length ?? seconds);
        if (!gaps) {
          say("hidden");
          button.disabled = false;
          return;
        }
        const usual = [...gaps].sort((a, b) => a - b)[Math.floor(gaps.length / 2)] ?? 0;
        total.plays += 1;
        total.frames += gaps.length;
        total.late_frames += gaps.filter((gap) => gap > LATE * usual).length;
        total.longest_ms = Math.max(total.longest_ms, ...gaps);
        total.seconds_visible += gaps.reduce((sum, gap) => sum + gap, 0) / 1000;
      } while (total.plays < plays);
    } catch (error) {
      say("broken");
      return on.fault(String(error.message ?? error));
    }
    say("ready");
    button.disabled = !on.again;
    on.shown({ ...total });
  });
}
