// Accuracy against cost: one point per run, on logarithmic axes, with the runs that nothing beats joined by a line.

const SVG = "http://www.w3.org/2000/svg";
const PLOT = { width: 860, height: 380, left: 76, right: 16, top: 14, bottom: 48 };
const AXES = {
  fragments: { label: "shaded fragments (log)", of: cost => cost.fragments },
  bytes: { label: "bytes of maps and buffers (log)", of: cost => cost.bytes },
  vertices: { label: "vertices (log)", of: cost => cost.vertices },
  texel_reads: { label: "texel reads (log)", of: cost => cost.texel_reads },
  ms: { label: "GPU milliseconds, median (log)", of: cost => cost.gpu_ms && cost.gpu_ms.median },
};
const MARKS = [
  (x, y) => `M${x - 5},${y}a5,5 0 1,0 10,0a5,5 0 1,0 -10,0`,
  (x, y) => `M${x - 5},${y - 5}h10v10h-10z`,
  (x, y) => `M${x},${y - 6}l6,11h-12z`,
  (x, y) => `M${x},${y - 7}l6,7l-6,7l-6,-7z`,
  (x, y) => `M${x - 6},${y - 5}h12l-6,11z`,
];

function svg(name, attributes, text) {
  const made = document.createElementNS(SVG, name);
  Object.entries(attributes).forEach(([key, value]) => made.setAttribute(key, value));
  if (text !== undefined) made.textContent = text;
  return made;
}

/** A logarithmic scale over whole decades that hold the values. */
function scale(values, from, to) {
  const low = Math.floor(Math.log10(Math.min(...values)));
  const high = Math.max(Math.ceil(Math.log10(Math.max(...values))), low + 1);
  const at = value => from + ((Math.log10(value) - low) / (high - low)) * (to - from);
  return { at, decades: Array.from({ length: high - low + 1 }, (_, i) => 10 ** (low + i)) };
}

/** The points that no other point beats in both figures, by cost. */
function front(points) {
  const byCost = [...points].sort((a, b) => a.cost - b.cost || a.wrong - b.wrong);
  let best = Infinity;
  return byCost.filter(point => point.wrong < best && ((best = point.wrong), true));
}

const decade = value => (value >= 1e-3 && value < 1e5 ? String(Number(value.toPrecision(1))) : value.toExponential(0));

/** The plot of the runs that answered one question. `open` shows a run. */
function plotted(runs, axis, open) {
  const { width, height, left, right, top, bottom } = PLOT;
  const points = runs
    .map(({ run, index }) => ({ run, index, cost: run.cost && AXES[axis].of(run.cost), share: run.error && run.error.wrong_fraction }))
    .filter(point => point.cost > 0 && point.share !== null && point.share !== undefined);
  if (points.length === 0) return element("p", "No run of this question has both figures.", { class: "hint" });
  // No wrong pixel has no logarithm: it is drawn at less than one pixel.
  points.forEach(point => (point.wrong = Math.max(point.share, 0.3 / point.run.pixels.asked)));
  const x = scale(points.map(point => point.cost), left, width - right);
  const y = scale(points.map(point => 100 * point.wrong), height - bottom, top);
  const plot = svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "group", "aria-label": "wrong pixels against cost" });
  for (const value of x.decades) {
    plot.append(svg("line", { x1: x.at(value), x2: x.at(value), y1: top, y2: height - bottom, class: "rule" }));
    plot.append(svg("text", { x: x.at(value), y: height - bottom + 18, "text-anchor": "middle" }, decade(value)));
  }
  for (const value of y.decades) {
    plot.append(svg("line", { x1: left, x2: width - right, y1: y.at(value), y2: y.at(value), class: "rule" }));
    plot.append(svg("text", { x: left - 8, y: y.at(value) + 4, "text-anchor": "end" }, `${decade(value)} %`));
  }
  plot.append(svg("text", { x: (left + width - right) / 2, y: height - 8, "text-anchor": "middle", class: "axis" }, AXES[axis].label));
  const up = `translate(14 ${(top + height - bottom) / 2}) rotate(-90)`;
  plot.append(svg("text", { transform: up, "text-anchor": "middle", class: "axis" }, "wrong pixels of those asked (log)"));
  const best = front(points);
  plot.append(svg("polyline", { points: best.map(p => `${x.at(p.cost)},${y.at(100 * p.wrong)}`).join(" "), class: "front" }));
  const families = [...new Set(points.map(point => point.run.technique.split(":")[0]))];
  for (const point of points) {
    const family = families.indexOf(point.run.technique.split(":")[0]);
    const link = svg("a", { href: `#run-${point.index}`, class: `mark family-${family % MARKS.length}` });
    const [px, py] = [x.at(point.cost), y.at(100 * point.wrong)];
    link.append(svg("path", { d: MARKS[family % MARKS.length](px, py) }));
    const percent = `${Number((100 * point.share).toPrecision(3))} %`;
    link.append(svg("title", {}, `${point.run.typed}: ${percent} wrong, ${AXES[axis].label.split(" (")[0]} ${point.cost}`));
    if (best.includes(point)) {
      const end = px > 0.7 * width;
      link.append(svg("text", { x: px + (end ? -10 : 10), y: py - 8, "text-anchor": end ? "end" : "start" }, point.run.typed));
    }
    link.addEventListener("click", event => (event.preventDefault(), open(point.index)));
    plot.append(link);
  }
  families.forEach((name, i) => {
    const at = [left + 14 + 150 * i, top + 8];
    plot.append(svg("path", { d: MARKS[i % MARKS.length](...at), class: `key family-${i % MARKS.length}` }));
    plot.append(svg("text", { x: at[0] + 10, y: at[1] + 4 }, name));
  });
  return plot;
}
