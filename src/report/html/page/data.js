"use strict";
// The page's data: JSON blocks, and planes of one number per pixel, unpacked when a run is opened.

/** What a data block of the page holds; null where there is none. */
function block(id) {
  const element = document.getElementById(id);
  return element ? JSON.parse(element.textContent) : null;
}

/** The bytes behind base64 of gzip. */
async function inflated(base64) {
  const text = atob(base64);
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) packed[i] = text.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

/** Ids from the differences between neighbours, modulo 2^32. */
function summed(differences) {
  for (let i = 1; i < differences.length; i++) differences[i] += differences[i - 1];
  return differences;
}

const LAYOUTS = {
  u8: bytes => new Uint8Array(bytes),
  u16: bytes => new Uint16Array(bytes),
  delta32: bytes => summed(new Uint32Array(bytes)),
  f64: bytes => new Float64Array(bytes),
};

/** The numbers of a plane; NaN where there is none. */
async function unpacked(plane) {
  const numbers = LAYOUTS[plane.layout](await inflated(plane.data));
  if (!plane.palette) return numbers;
  const palette = plane.palette.map(value => (value === null ? NaN : value));
  const values = new Float64Array(numbers.length);
  for (let i = 0; i < numbers.length; i++) values[i] = palette[numbers[i]];
  return values;
}

/** An object with each of its planes unpacked, all else as it is. */
async function opened(packed) {
  const entries = await Promise.all(
    Object.entries(packed).map(async ([key, value]) => [key, value && value.layout ? await unpacked(value) : value]),
  );
  return Object.fromEntries(entries);
}

/** Everything known of a run's pixels; null for a run without an answer. */
async function pixelsOf(index) {
  const packed = block(`pixels-${index}`);
  if (!packed) return null;
  const [run, question] = await Promise.all([opened(packed), opened(block(`question-${packed.question}`))]);
  run.stages = await Promise.all(packed.stages.map(opened));
  return { ...question, ...run, width: question.size[0], height: question.size[1] };
}

/** The mesh a triangle id belongs to. */
function meshOf(pixels, triangle) {
  const found = pixels.meshes.find(([end]) => triangle < end);
  return found ? found[1] : "?";
}

/** Where a pixel stands among the replayed ones; -1 if it is none of them. */
function replayedAt(pixels, index) {
  let [low, high] = [0, pixels.replayed.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (pixels.replayed[middle] < index) low = middle + 1;
    else high = middle;
  }
  return pixels.replayed[low] === index ? low : -1;
}
