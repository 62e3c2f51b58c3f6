// Layers: what the numbers of a run look like, in the colours of gnomon's PNG pictures.

const ASKED = 4;
const UNDECIDED = 3;
const LAYERS = ["truth", "technique", "error", "causes", "m"];

const blend = (a, b, share) => a.map((channel, i) => Math.floor(channel + share * (b[i] - channel) + 0.5));
const grey = value => Array(3).fill(Math.floor(255 * value + 0.5));

/** The colour at a position (0 to 1) in a list of evenly spaced ones. */
function along(colours, position) {
  const at = Math.min(Math.max(position, 0), 1) * (colours.length - 1);
  const left = Math.min(Math.floor(at), colours.length - 2);
  return blend(colours[left], colours[left + 1], at - left);
}

/** What a layer shows at an asked and decided pixel, given everything known of the run. */
function colourAt(layer, pixels, palette, shown, i) {
  const truth = pixels.truth[i];
  const error = pixels.technique[i] - truth;
  switch (layer) {
    case "truth":
      return grey(truth);
    case "technique":
      return grey(pixels.technique[i]);
    case "error":
      return blend(dim(palette, truth), error < 0 ? palette.false_shadow : palette.false_light, Math.abs(error));
    case "causes": {
      const cause = pixels.cause[i];
      if (!cause || !shown.has(cause - 1)) return dim(palette, truth);
      const wrong = Math.abs(error) > pixels.wrongAbove;
      return blend(dim(palette, truth), palette.causes[cause - 1].colour, wrong ? 1 : palette.merely_differing);
    }
    default: {
      const m = pixels.m[i];
      return Number.isNaN(m) ? palette.classes[0].colour : along(palette.m.colours, Math.log(m) / Math.log(palette.m.largest));
    }
  }
}

const dim = (palette, truth) => blend(palette.dim_shadow, palette.dim_lit, truth);

/** Red, green and blue as one opaque pixel of a canvas. */
const opaque = ([r, g, b]) => ((255 << 24) | (b << 16) | (g << 8) | r) >>> 0;

/** A canvas of the picture's own size with a layer in it. `shown` are the causes that have their colour. */
function painted(layer, pixels, palette, shown) {
  const canvas = Object.assign(document.createElement("canvas"), { width: pixels.width, height: pixels.height });
  const context = canvas.getContext("2d");
  const image = context.createImageData(pixels.width, pixels.height);
  const target = new Uint32Array(image.data.buffer);
  const classes = palette.classes.map(entry => opaque(entry.colour));
  const kinds = layer === "m" ? [pixels.m] : [pixels.truth, pixels.technique, pixels.cause];
  // Neighbours mostly look alike: a colour is worked out where something changes.
  let [last, colour] = [-1, 0];
  for (let i = 0; i < target.length; i++) {
    if (pixels.class[i] !== ASKED) {
      target[i] = classes[pixels.class[i]];
      continue;
    }
    if (last < 0 || kinds.some(kind => kind[i] !== kind[last])) {
      colour = opaque(colourAt(layer, pixels, palette, shown, i));
      last = i;
    }
    target[i] = colour;
  }
  context.putImageData(image, 0, 0);
  return canvas;
}
