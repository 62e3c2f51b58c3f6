// The page's behaviour: which run, layers and arrangement are shown, and what the pointer and the keys do.

const report = block("report");
const palette = block("palette");
const get = id => document.getElementById(id);
const ARRANGEMENTS = [["one", "one at a time (o)"], ["slider", "slider against the truth (s)"], ["grid", "all side by side (g)"]];
const state = { run: -1, layer: "error", swapped: null, arrangement: "one", divider: 0.5, pixel: null, pinned: false, shown: new Set() };
let pixels = null;
let canvases = {};
const viewport = new Viewport(get("panes"), draw);

/** The runs in the order of the summary table that have pictures. */
const order = [...document.querySelectorAll("#summary-table tr[data-run] a")].map(link => Number(link.closest("tr").dataset.run));

/** The canvas of a layer, painted when it is first wanted. */
const canvasOf = layer => (canvases[layer] ??= painted(layer, pixels, palette, state.shown));
const available = () => LAYERS.filter(layer => layer !== "m" || pixels.m);

/** Shows a run. */
async function open(index, keepsPlace = false) {
  const opened = await pixelsOf(index);
  if (!opened) return;
  const run = report.runs[index];
  const sameSize = pixels && pixels.width === opened.width && pixels.height === opened.height;
  pixels = Object.assign(opened, { wrongAbove: run.wrong_above });
  canvases = {};
  state.run = index;
  state.shown = new Set(palette.causes.keys());
  if (!available().includes(state.layer)) state.layer = "error";
  get("viewer").hidden = false;
  get("run-name").textContent = `${run.scene} / ${run.light}: ${run.typed}`;
  get("run-figures").textContent = `${run.pixels.wrong} of ${run.pixels.asked} asked pixels wrong, ${run.pixels.undecided} undecided`;
  get("run-command").textContent = run.command;
  document.querySelectorAll("#summary-table tr[data-run]").forEach(row => {
    row.classList.toggle("open", Number(row.dataset.run) === index);
  });
  viewport.size = [pixels.width, pixels.height];
  if (!sameSize) Object.assign(state, { pixel: null, pinned: false });
  arrange(!(keepsPlace && sameSize));
  fillLegend(run);
  inspect(pixels, palette, state.pixel);
  if (location.hash !== `#run-${index}`) history.replaceState(null, "", `#run-${index}`);
  get("viewer").dataset.ready = index;
}

/** One pane per layer shown, and the buttons that choose. */
function arrange(fits) {
  const layers = state.arrangement === "grid" ? available() : [state.layer];
  const panes = layers.map(layer => {
    const figure = element("figure", null, { "data-layer": layer });
    figure.append(element("canvas", null, { "aria-label": `${layer} layer` }), element("figcaption", layer));
    return figure;
  });
  get("panes").replaceChildren(...panes);
  get("panes").className = state.arrangement;
  get("panes").style.setProperty("--aspect", `${pixels.width} / ${pixels.height}`);
  get("slider-row").hidden = state.arrangement !== "slider";
  choices(get("layers"), available().map((layer, i) => [layer, `${layer} (${i + 1})`]), state.layer, layer => choose({ layer }));
  choices(get("arrangements"), ARRANGEMENTS, state.arrangement, arrangement => choose({ arrangement }));
  get("layers").querySelectorAll("button").forEach(button => {
    button.addEventListener("pointerenter", () => swap(button.dataset.value));
    button.addEventListener("pointerleave", () => swap(null));
  });
  if (fits) viewport.fit();
  else draw();
}

/** Buttons of which one is chosen. */
function choices(group, values, chosen, then) {
  const buttons = values.map(([value, title]) => {
    const button = element("button", value, { type: "button", role: "radio", title, "data-value": value });
    button.setAttribute("aria-checked", value === chosen);
    button.addEventListener("click", () => then(value));
    return button;
  });
  group.replaceChildren(...buttons);
}

function choose(change) {
  const arrangementChanges = change.arrangement && change.arrangement !== state.arrangement;
  Object.assign(state, change, { swapped: null });
  arrange(arrangementChanges && viewport.fitted);
}

/** Shows another layer in the place of the chosen one, for as long as it is asked for. */
function swap(layer) {
  state.swapped = layer;
  draw();
}

function draw() {
  if (!pixels) return;
  for (const figure of get("panes").children) {
    const own = state.arrangement === "grid" ? figure.dataset.layer : state.swapped || state.layer;
    figure.lastChild.textContent = state.arrangement === "slider" ? `truth | ${own}` : own;
    figure.dataset.shows = own;
    const layers = state.arrangement === "slider" ? [canvasOf("truth"), canvasOf(own)] : [canvasOf(own)];
    viewport.draw(figure.firstChild, layers, state.divider, state.pixel);
  }
  get("zoom").textContent = `${Math.round(100 * viewport.zoom)} %`;
}

/** The causes of the run with their pixels; unticking one takes its colour off the picture. */
function fillLegend(run) {
  const causes = palette.causes.map((cause, i) => ({ ...cause, i, pixels: run.causes?.[cause.name]?.pixels ?? 0 }));
  const present = causes.filter(cause => cause.pixels > 0).sort((a, b) => b.pixels - a.pixels);
  const items = present.map(cause => {
    const box = element("input", null, { type: "checkbox", "data-cause": cause.name });
    box.checked = true;
    box.addEventListener("change", () => {
      if (box.checked) state.shown.add(cause.i);
      else state.shown.delete(cause.i);
      delete canvases.causes;
      draw();
    });
    const label = element("label", null, { title: cause.meaning });
    label.append(box, swatch(cause.colour), element("span", cause.name), element("span", `${cause.pixels} px`, { class: "n" }));
    const item = element("li");
    item.append(label);
    return item;
  });
  get("legend").replaceChildren(...(items.length ? items : [element("li", "no pixel is wrong")]));
  const keys = [["false shadow", palette.false_shadow], ["false light", palette.false_light]];
  keys.push(...palette.classes.map(entry => [entry.name, entry.colour]));
  if (pixels.m) keys.push(["m ≤ 1", palette.m.colours[0]], [`m ≥ ${palette.m.largest}`, palette.m.colours.at(-1)]);
  get("keys").replaceChildren(
    ...keys.map(([name, colour]) => {
      const item = element("li");
      item.append(swatch(colour), element("span", name));
      return item;
    }),
  );
}

function swatch(colour) {
  const made = element("span", null, { class: "swatch" });
  made.style.background = `rgb(${colour.join(" ")})`;
  return made;
}

function point(at, pinned) {
  Object.assign(state, { pixel: at, pinned });
  inspect(pixels, palette, at);
  draw();
}

/** The run before or after the shown one in the summary's order. */
function step(by) {
  const next = order[order.indexOf(state.run) + by];
  if (next !== undefined) open(next, true);
}

const middle = () => viewport.paneSize().map(side => side / 2);
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const KEYS = {
  "+": () => viewport.zoomBy(2, middle()),
  "=": () => viewport.zoomBy(2, middle()),
  "-": () => viewport.zoomBy(0.5, middle()),
  0: () => viewport.fit(),
  j: () => step(1),
  k: () => step(-1),
  o: () => choose({ arrangement: "one" }),
  s: () => choose({ arrangement: "slider" }),
  g: () => choose({ arrangement: "grid" }),
  Escape: () => point(null, false),
};

document.addEventListener("keydown", event => {
  const typing = event.target.matches("input, select, textarea");
  if (!pixels || typing || event.ctrlKey || event.metaKey || event.altKey) return;
  const onPicture = event.target === get("panes") || event.target === document.body;
  if (event.key in KEYS) KEYS[event.key]();
  else if (event.key >= "1" && event.key <= String(available().length)) choose({ layer: available()[event.key - 1] });
  else if (event.key === " " && onPicture) swap("truth");
  else if (event.key in ARROWS && event.target === get("panes")) moveBy(ARROWS[event.key]);
  else return;
  event.preventDefault();
});
document.addEventListener("keyup", event => event.key === " " && state.swapped && swap(null));

function moveBy(step) {
  const from = state.pixel || viewport.pixelAt(middle()) || [0, 0];
  const to = from.map((value, axis) => Math.min(Math.max(value + step[axis], 0), viewport.size[axis] - 1));
  viewport.reveal(to);
  point(to, true);
}

/** Pointer: hovering inspects, a click pins, dragging pans. */
let drag = null;
const within = (event, pane) => {
  const box = pane.getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
};
get("panes").addEventListener("pointerdown", event => {
  if (!event.target.matches("canvas")) return;
  drag = { at: [event.clientX, event.clientY], moved: false };
  event.target.setPointerCapture(event.pointerId);
});
get("panes").addEventListener("pointermove", event => {
  if (!pixels || !event.target.matches("canvas")) return;
  if (drag) {
    const by = [event.clientX - drag.at[0], event.clientY - drag.at[1]];
    if (!drag.moved && Math.hypot(...by) < 4) return;
    Object.assign(drag, { at: [event.clientX, event.clientY], moved: true });
    viewport.panBy(...by);
  } else if (!state.pinned) point(viewport.pixelAt(within(event, event.target)), false);
});
get("panes").addEventListener("pointerup", event => {
  if (drag && !drag.moved && event.target.matches("canvas")) {
    const at = viewport.pixelAt(within(event, event.target));
    const again = state.pinned && at && at.join() === state.pixel.join();
    point(at, Boolean(at) && !again);
  }
  drag = null;
});
get("panes").addEventListener(
  "wheel",
  event => {
    if (!event.target.matches("canvas")) return;
    event.preventDefault();
    viewport.zoomBy(2 ** (-event.deltaY / 240), within(event, event.target));
  },
  { passive: false },
);
get("slider").addEventListener("input", event => {
  state.divider = event.target.value / event.target.max;
  draw();
});
get("zoom-in").addEventListener("click", KEYS["+"]);
get("zoom-out").addEventListener("click", KEYS["-"]);
get("zoom-fit").addEventListener("click", KEYS[0]);
get("zoom-one").addEventListener("click", () => viewport.zoomBy(1 / viewport.zoom, middle()));
get("run-before").addEventListener("click", KEYS.k);
get("run-after").addEventListener("click", KEYS.j);
document.querySelectorAll("button.copy").forEach(button => {
  button.addEventListener("click", () => navigator.clipboard?.writeText(get(button.dataset.copies).textContent));
});
document.querySelectorAll("#summary-table tr[data-run]").forEach(row => {
  if (!row.querySelector("a")) return;
  row.addEventListener("click", event => {
    event.preventDefault();
    openAndShow(Number(row.dataset.run));
  });
});
new ResizeObserver(() => (viewport.fitted ? viewport.fit() : draw())).observe(get("panes"));

function openAndShow(index) {
  return open(index, true).then(() => get("viewer").scrollIntoView({ block: "start" }));
}

/** The plot: one question at a time, since costs of different pictures do not compare. */
const questions = [...new Set(report.runs.filter(run => run.cost).map(run => `${run.scene} / ${run.light}`))];
get("trade-question").replaceChildren(...questions.map((name, i) => element("option", name, { value: i })));
function plot() {
  const name = questions[get("trade-question").value];
  const asked = report.runs.map((run, index) => ({ run, index })).filter(({ run }) => `${run.scene} / ${run.light}` === name);
  get("plot").replaceChildren(plotted(asked, get("trade-axis").value, openAndShow));
}
if (!report.runs.some(run => run.cost?.fragments > 0)) get("trade-axis").value = "bytes";
["trade-axis", "trade-question"].forEach(id => get(id).addEventListener("change", plot));
plot();

const fromHash = () => Number(/^#run-(\d+)$/.exec(location.hash)?.[1] ?? NaN);
window.addEventListener("hashchange", () => Number.isNaN(fromHash()) || openAndShow(fromHash()));
if (!Number.isNaN(fromHash())) openAndShow(fromHash());
else if (order.length > 0) open(order[0]);
