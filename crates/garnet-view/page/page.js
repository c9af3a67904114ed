// What people do with the page, and what it tells them.

const scene = JSON.parse(document.getElementById("scene").textContent);
const part = (name) => document.getElementById(name);
const stage = part("stage");

/** Radians a key and a pixel turn. */
const KEY_TURN = Math.PI / 24;
const PIXEL_TURN = 0.008;

const state = {
  isShown: { garment: true, body: true },
  isWireframe: false,
  isTogether: false,
  coloring: -1,
  frame: 0,
  isPlaying: false,
};
const camera = new Camera();

/** Says something to those who do not see it. */
function say(text) {
  part("said").textContent = text;
}

function fail(error) {
  part("failure").textContent = `This page cannot be drawn: ${error.message}.`;
  part("failure").hidden = false;
  document.documentElement.dataset.state = "failed";
}

/** Corners of the box round a mesh in all frames, from the middle of each frame, and the middles. */
function measure(mesh) {
  mesh.middles = mesh.origins.map(() => [0, 0, 0]);
  mesh.reach = { across: 0, low: Infinity, high: -Infinity };
  mesh.origins.forEach((origin, frame) => {
    const first = 3 * frame * mesh.vertices;
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (let place = 0; place < 3 * mesh.vertices; place++) {
      const coordinate = origin[place % 3] + mesh.step * mesh.codes[first + place];
      low[place % 3] = Math.min(low[place % 3], coordinate);
      high[place % 3] = Math.max(high[place % 3], coordinate);
    }
    mesh.middles[frame] = low.map((bound, axis) => (bound + high[axis]) / 2);
    mesh.reach.across = Math.max(mesh.reach.across, Math.hypot(high[0] - low[0], high[2] - low[2]));
    mesh.reach.low = Math.min(mesh.reach.low, low[1]);
    mesh.reach.high = Math.max(mesh.reach.high, high[1]);
  });
}

/** The panes that are shown: their names and meshes. */
function panes() {
  const isShown = (index) => state.isShown[scene.meshes[index].part];
  const shown = scene.panes.map(({ name, meshes }) => ({ name, meshes: meshes.filter(isShown), all: meshes }));
  if (!state.isTogether) {
    return shown;
  }
  const once = (lists) => [...new Set(lists.flat())];
  const name = shown.map((pane) => pane.name).join(", ");
  return [{ name, meshes: once(shown.map((pane) => pane.meshes)), all: once(shown.map((pane) => pane.all)) }];
}

/** Where the middle of a pane is in a frame: it goes with the first mesh, but stays at its height. */
function centerOf(meshes, frame) {
  const lead = scene.meshes[meshes[meshes.length - 1]];
  const [x, , z] = lead.middles[Math.min(frame, lead.middles.length - 1)];
  const reaches = meshes.map((index) => scene.meshes[index].reach);
  const low = Math.min(...reaches.map((reach) => reach.low));
  const high = Math.max(...reaches.map((reach) => reach.high));
  return [x, (low + high) / 2, z];
}

/** How large what is in the panes is. */
function sizeOf(all) {
  let [width, height] = [0, 0];
  for (const { all: meshes } of all) {
    const reaches = meshes.map((index) => scene.meshes[index].reach);
    width = Math.max(width, ...reaches.map((reach) => reach.across));
    const low = Math.min(...reaches.map((reach) => reach.low));
    height = Math.max(height, Math.max(...reaches.map((reach) => reach.high)) - low);
  }
  return { width, height };
}

/** How many panes stand beside each other, so that they are as large as can be. */
function columnsFor(count, { width, height }) {
  const [across, down] = [stage.clientWidth || 1, stage.clientHeight || 1];
  let best = [0, 1];
  for (let columns = 1; columns <= count; columns++) {
    const rows = Math.ceil(count / columns);
    const scale = Math.min(across / columns / width, down / rows / height);
    best = scale > best[0] * 1.001 ? [scale, columns] : best;
  }
  return best[1];
}

let painter;
let isDue = false;

/** How coarse the picture is while it moves: 0 with smooth edges, 1 without, 2 with half as many
 *  pixels each way. Machines that are too slow for one take the next; at rest all draw smoothly. */
let coarseness = 0;

/** Milliseconds from what is asked for to the picture, beyond which the next coarseness is taken;
 *  browsers keep up to three pictures on their way. */
const TOO_SLOW = [22, 250, Infinity];

/** Milliseconds after which a picture is at rest. */
const REST = 120;

/** Milliseconds that the last pictures took, and what waits for rest. */
let [pace, resting] = [10, 0];

function redraw() {
  if (!isDue && painter) {
    isDue = true;
    requestAnimationFrame(() => {
      isDue = false;
      draw(coarseness);
      painter.time((passed) => {
        // One slow picture alone, such as the first, tells nothing.
        pace += 0.2 * (Math.min(passed, 400) - pace);
        if (pace > TOO_SLOW[coarseness]) {
          [coarseness, pace] = [coarseness + 1, 10];
        }
      });
      clearTimeout(resting);
      if (coarseness > 0) {
        resting = setTimeout(() => requestAnimationFrame(() => isDue || draw(0)), REST);
      }
    });
  }
}

/** The panes with their places, and the box that all of them show. */
function layout() {
  const all = panes();
  const size = sizeOf(all);
  const columns = columnsFor(all.length, size);
  const rows = Math.ceil(all.length / columns);
  const [width, height] = [stage.clientWidth / columns, stage.clientHeight / rows];
  all.forEach((pane, index) => {
    pane.left = (index % columns) * width;
    pane.top = Math.floor(index / columns) * height;
  });
  return { all, width, height, box: { ...size, aspect: width / height } };
}

function draw(coarseness) {
  const density = (window.devicePixelRatio || 1) / (coarseness > 1 ? 2 : 1);
  const [across, down] = [stage.clientWidth, stage.clientHeight].map((side) => Math.max(1, Math.round(side * density)));
  if (stage.width !== across || stage.height !== down) {
    [stage.width, stage.height] = [across, down];
  }
  const { all, width, height, box } = layout();
  painter.begin(coarseness === 0);
  for (const pane of all) {
    const place = [pane.left, stage.clientHeight - pane.top - height, width, height];
    const pixels = place.map((side) => Math.round(side * density));
    painter.draw(pixels, pane.meshes, camera.matrices(centerOf(pane.all, state.frame), box), state);
  }
  painter.end();
}

/** A number with three digits that count. */
function rounded(value) {
  const digits = value === 0 ? 0 : Math.floor(Math.log10(Math.abs(value)));
  return value.toFixed(Math.max(0, Math.min(4, 2 - digits)));
}

/** How many vertices of a mesh have each kind but the first. */
function counts(mesh, values, kinds) {
  const found = kinds.map(() => 0);
  for (let vertex = 0; vertex < mesh.vertices; vertex++) {
    found[Math.round(valueAt(values, state.frame, vertex, mesh.vertices))]++;
  }
  const told = kinds.map((kind, index) => `${found[index]} ${kind}`).filter((_, index) => index > 0 && found[index] > 0);
  return told.length > 0 ? `vertices: ${told.join(", ")}` : "none found";
}

/** Mean and ends of the values of a mesh that are shown. */
function figures(mesh) {
  const values = mesh.values.find((found) => found.coloring === state.coloring);
  if (!values) {
    return null;
  }
  const { kinds } = scene.colorings[state.coloring];
  if (kinds.length > 0) {
    return counts(mesh, values, kinds);
  }
  let [sum, count, least, most] = [0, 0, Infinity, -Infinity];
  for (let vertex = 0; vertex < mesh.vertices; vertex++) {
    const value = valueAt(values, state.frame, vertex, mesh.vertices);
    if (!Number.isNaN(value)) {
      sum += value;
      count++;
      least = Math.min(least, value);
      most = Math.max(most, value);
    }
  }
  return count && `mean ${rounded(sum / count)}, from ${rounded(least)} to ${rounded(most)}`;
}

/** A spot of a color. */
function dot(color) {
  const spot = document.createElement("i");
  spot.style.background = color;
  return spot;
}

/** Writes names and figures over the panes. */
function tell() {
  const { all, width } = layout();
  part("names").replaceChildren(...all.map((pane) => {
    const label = document.createElement("div");
    Object.assign(label.style, { left: `${pane.left}px`, top: `${pane.top}px`, width: `${width}px` });
    const isNamed = scene.panes.length > 1;
    const garments = pane.all.map((index) => scene.meshes[index]).filter((mesh) => mesh.part === "garment");
    if (isNamed && !state.isTogether) {
      label.append(Object.assign(document.createElement("strong"), { textContent: pane.name }));
    }
    for (const mesh of garments) {
      const found = figures(mesh);
      const texts = [state.isTogether && isNamed ? mesh.name : "", found ?? ""].filter(Boolean);
      if (texts.length > 0) {
        const line = document.createElement("span");
        line.append(...(found ? [] : [dot(mesh.color)]), texts.join(": "), document.createElement("br"));
        label.append(line);
      }
    }
    return label;
  }));
}

/** What is on and off, in words. */
function describe() {
  const names = scene.panes.map((pane) => pane.name).join(", ");
  const coloring = scene.colorings[state.coloring];
  const colored = coloring ? `, colored by ${coloring.label}` : "";
  stage.setAttribute("aria-label", `${scene.title}: ${names}${colored}`);
}

function color(coloring) {
  state.coloring = coloring;
  part("coloring").value = String(coloring);
  const found = scene.colorings[coloring];
  part("legend").hidden = !found;
  if (found) {
    part("what").textContent = found.label;
    const hasKinds = found.kinds.length > 0;
    for (const name of ["bar", "low", "high", "kinds"]) {
      part(name).hidden = (name === "kinds") !== hasKinds;
    }
    part("kinds").replaceChildren(...found.kinds.map((kind, index) => {
      const line = document.createElement("li");
      line.append(dot(found.colors[index]), kind);
      return line;
    }));
    part("low").value = rounded(found.low);
    part("high").value = rounded(found.high);
    part("bar").setAttribute("aria-label", `Colors from ${rounded(found.low)} to ${rounded(found.high)}: ${found.label}`);
    const pixels = new ImageData(new Uint8ClampedArray(ramp(found.colors)), 256, 1);
    part("bar").getContext("2d").putImageData(pixels, 0, 0);
  }
  describe();
  tell();
  redraw();
  say(found ? `Colored by ${found.label}` : "Plain colors");
}

/** Takes the ends of the color bar as they are written there, if they rise. */
function stretchBar() {
  const found = scene.colorings[state.coloring];
  const [low, high] = ["low", "high"].map((end) => part(end).valueAsNumber);
  if (low < high) {
    Object.assign(found, { low, high });
  }
  color(state.coloring);
}

function toggle(name) {
  const button = part(name);
  if (button.hidden) {
    return;
  }
  const isOn = button.getAttribute("aria-pressed") !== "true";
  button.setAttribute("aria-pressed", String(isOn));
  if (name in state.isShown) {
    state.isShown[name] = isOn;
  } else if (name === "wireframe") {
    state.isWireframe = isOn;
  } else {
    state.isTogether = isOn;
    tell();
  }
  redraw();
  say(`${button.textContent} ${isOn ? "on" : "off"}`);
}

function go(frame) {
  const count = scene.frames.length;
  state.frame = ((frame % count) + count) % count;
  part("frame").value = state.frame;
  const name = `${state.frame + 1} of ${count}: ${scene.frames[state.frame]}`;
  part("frame").setAttribute("aria-valuetext", name);
  part("at").textContent = name;
  if (state.coloring >= 0) {
    tell();
  }
  redraw();
}

function play(isPlaying) {
  if (scene.frames.length < 2 || isPlaying === state.isPlaying) {
    return;
  }
  state.isPlaying = isPlaying;
  part("play").setAttribute("aria-pressed", String(isPlaying));
  part("play").textContent = isPlaying ? "Pause" : "Play";
  const [start, from] = [performance.now(), state.frame];
  const step = (now) => {
    if (state.isPlaying) {
      const frame = from + Math.floor(Math.max(0, now - start) / 1000 * scene.fps);
      if (frame % scene.frames.length !== state.frame) {
        go(frame);
      }
      requestAnimationFrame(step);
    }
  };
  requestAnimationFrame(step);
}

function look(view) {
  camera.look(view);
  part("view").value = view;
  redraw();
  say(`Seen from: ${part("view").selectedOptions[0].textContent}`);
}

function moved() {
  part("view").value = "";
  redraw();
}

function showAll() {
  camera.showAll();
  part("view").value = "2";
  redraw();
  say("All is shown");
}

function showKeys(isShown) {
  part("keys").hidden = !isShown;
  part("help").setAttribute("aria-expanded", String(isShown));
}

const TURNS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** What keys do, by the name that they have. */
const KEYS = {
  g: () => toggle("garment"),
  b: () => toggle("body"),
  w: () => toggle("wireframe"),
  o: () => toggle("together"),
  c: () => color(state.coloring + 1 < scene.colorings.length ? state.coloring + 1 : -1),
  h: () => showKeys(part("keys").hidden),
  "?": () => showKeys(part("keys").hidden),
  Escape: () => showKeys(false),
  " ": () => play(!state.isPlaying),
  ",": () => go(state.frame - 1),
  ".": () => go(state.frame + 1),
  "+": () => zoom(1.1),
  "=": () => zoom(1.1),
  "-": () => zoom(1 / 1.1),
  0: showAll,
  ...Object.fromEntries(Object.keys(VIEWS).map((view) => [view, () => look(view)])),
};

function zoom(factor) {
  camera.enlarge(factor);
  redraw();
}

function press(event) {
  const isElsewhere = /^(SELECT|INPUT)$/.test(event.target.tagName);
  const isButton = event.target.tagName === "BUTTON" && event.key === " ";
  if (event.ctrlKey || event.altKey || event.metaKey || isElsewhere || isButton) {
    return;
  }
  const turn = TURNS[event.key];
  const act = KEYS[event.key.length === 1 ? event.key.toLowerCase() : event.key];
  if (turn && event.shiftKey) {
    camera.move(0.05 * turn[0], 0.05 * turn[1], layout().box);
    redraw();
  } else if (turn) {
    camera.turn(-KEY_TURN * turn[0], -KEY_TURN * turn[1]);
    moved();
  } else if (act) {
    act();
  } else {
    return;
  }
  event.preventDefault();
}

/** The pointers that are down, by their number. */
const pointers = new Map();

function pointerMoved(event) {
  const last = pointers.get(event.pointerId);
  if (!last) {
    return;
  }
  const before = [...pointers.values()];
  const now = { x: event.clientX, y: event.clientY, pans: last.pans };
  pointers.set(event.pointerId, now);
  const after = [...pointers.values()];
  const { height, box } = layout();
  const middle = (places) => ["x", "y"].map((axis) => places.reduce((sum, place) => sum + place[axis], 0) / places.length);
  const [[x0, y0], [x1, y1]] = [middle(before), middle(after)];
  if (after.length > 1) {
    const apart = ([a, b]) => Math.hypot(a.x - b.x, a.y - b.y) || 1;
    camera.enlarge(apart(after) / apart(before));
  }
  if (after.length > 1 || now.pans) {
    camera.move((x1 - x0) / height, (y0 - y1) / height, box);
    redraw();
  } else {
    camera.turn(-PIXEL_TURN * (x1 - x0), PIXEL_TURN * (y1 - y0));
    moved();
  }
}

function listen() {
  for (const name of ["garment", "body", "wireframe", "together"]) {
    part(name).addEventListener("click", () => toggle(name));
  }
  part("coloring").addEventListener("change", (event) => color(Number(event.target.value)));
  part("view").addEventListener("change", (event) => event.target.value && look(event.target.value));
  part("low").addEventListener("change", stretchBar);
  part("high").addEventListener("change", stretchBar);
  part("help").addEventListener("click", () => showKeys(part("keys").hidden));
  part("play").addEventListener("click", () => play(!state.isPlaying));
  part("frame").addEventListener("input", (event) => go(Number(event.target.value)));
  document.addEventListener("keydown", press);
  stage.addEventListener("pointerdown", (event) => {
    stage.setPointerCapture(event.pointerId);
    const pans = event.button !== 0 || event.shiftKey;
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY, pans });
  });
  stage.addEventListener("pointermove", pointerMoved);
  for (const end of ["pointerup", "pointercancel"]) {
    stage.addEventListener(end, (event) => pointers.delete(event.pointerId));
  }
  stage.addEventListener("contextmenu", (event) => event.preventDefault());
  stage.addEventListener("dblclick", showAll);
  stage.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(-0.0015 * event.deltaY * (event.deltaMode === 1 ? 30 : 1)));
  }, { passive: false });
  stage.addEventListener("webglcontextlost", (event) => event.preventDefault());
  stage.addEventListener("webglcontextrestored", () => location.reload());
  new ResizeObserver(() => {
    tell();
    redraw();
  }).observe(stage);
}

/** Leaves out what there is no use for. */
function furnish() {
  const parts = new Set(scene.meshes.map((mesh) => mesh.part));
  part("garment").hidden = part("body").hidden = parts.size < 2;
  part("together").hidden = scene.panes.length < 2;
  const options = [{ label: "plain" }, ...scene.colorings].map(({ label }, index) => {
    return new Option(label, String(index - 1));
  });
  part("coloring").append(...options);
  part("coloring").parentElement.hidden = options.length < 2;
  part("view").value = "2";
  document.querySelector("footer").hidden = scene.frames.length < 2;
  part("frame").max = scene.frames.length - 1;
}

try {
  decode(scene, await inflated(part("numbers").textContent));
  part("numbers").remove();
  scene.meshes.forEach(measure);
  painter = new Painter(stage, scene);
  furnish();
  listen();
  go(0);
  color(-1);
  say("");
  draw(0);
  document.documentElement.dataset.state = "drawn";
} catch (error) {
  fail(error);
}
