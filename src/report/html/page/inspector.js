// The inspector: everything known of one pixel, in numbers.

const CLASS_NAMES = ["background", "facing away", "not lit", "undecided", "asked"];

/** An element with text; text is never read as HTML. */
function element(name, text, attributes = {}) {
  const made = document.createElement(name);
  if (text !== undefined && text !== null) made.textContent = text;
  Object.entries(attributes).forEach(([key, value]) => made.setAttribute(key, value));
  return made;
}

const signed = value => (value > 0 ? `+${value}` : String(value));

/** Label and text of every fact about a pixel. */
function factsOf(pixels, palette, i) {
  const kind = pixels.class[i];
  const facts = [["class", CLASS_NAMES[kind], "class"]];
  if (kind === ASKED) {
    const error = pixels.technique[i] - pixels.truth[i];
    const size = Math.abs(error);
    facts.push(["truth", pixels.truth[i], "truth"], ["technique", pixels.technique[i], "technique"]);
    facts.push(["error", signed(error), "error"]);
    facts.push(["verdict", size > pixels.wrongAbove ? "wrong" : size > palette.differing_above ? "differs" : "right", "verdict"]);
    const cause = pixels.cause[i] && palette.causes[pixels.cause[i] - 1];
    if (cause) facts.push(["cause", `${cause.name}: ${cause.meaning}`, "cause"]);
    if (pixels.m && !Number.isNaN(pixels.m[i])) facts.push(["texel", `m = ${pixels.m[i]} pixels`, "m"]);
  }
  const triangle = id => (id ? `triangle ${id - 1} of ${meshOf(pixels, id - 1)}` : "none");
  if (kind !== 0) facts.push(["surface", triangle(pixels.receiver[i]), "receiver"]);
  if (kind === ASKED || kind === UNDECIDED) facts.push(["occluder", triangle(pixels.occluder[i]), "occluder"]);
  return facts;
}

/** Stage, value, change and cause of every stage of a pixel; none where nothing was replayed. */
function stagesOf(pixels, palette, i) {
  const at = replayedAt(pixels, i);
  if (at < 0) return [];
  let before = pixels.exact[at];
  return pixels.stages.map(stage => {
    const [value, change] = [stage.value[at], stage.value[at] - before];
    before = value;
    return [stage.name, value, signed(change), change === 0 ? "" : palette.causes[stage.cause[at]].name];
  });
}

/** Fills the inspector in. */
function inspect(pixels, palette, at) {
  const get = id => document.getElementById(id);
  get("pixel-at").textContent = at ? at.join(", ") : "";
  get("pixel").replaceChildren();
  get("pixel-stages").hidden = get("pixel-explain").hidden = true;
  if (!at) return;
  const i = at[1] * pixels.width + at[0];
  for (const [label, text, name] of factsOf(pixels, palette, i)) {
    get("pixel").append(element("dt", label), element("dd", text, { "data-fact": name }));
  }
  const stages = stagesOf(pixels, palette, i);
  const rows = stages.map(([name, value, change, cause]) => {
    const row = element("tr");
    row.append(element("td", name), element("td", value, { class: "n" }), element("td", change, { class: "n" }), element("td", cause));
    return row;
  });
  get("pixel-stages").tBodies[0].replaceChildren(...rows);
  get("pixel-stages").hidden = rows.length === 0;
  get("pixel-command").textContent = `${pixels.explain} --pixel ${at.join(",")}`;
  get("pixel-explain").hidden = pixels.class[i] !== ASKED;
}
