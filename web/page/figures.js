// What frames cost, side by side.

const COLOURS = ['#59c2ff', '#ffb454', '#7fd962', '#d2a6ff', '#f07178', '#95e6cb', '#e6b450', '#6c9cff', '#ff8f40', '#aad94c', '#c594c5', '#5fb3b3'];

// A name, what it is of a side, how it is written, and how the sides are compared: a count is exact; the time of one frame is
// not: what many frames say stands under the name of the comparison.
const rows = [
  ['Frame', (s) => s.frame_ms, ms, 'frame'],
  ['Passes in all', (s) => (s.gpu_ms.length ? total(s.gpu_ms) : undefined), ms, 'passes'],
  ['Processor', (s) => total(s.cpu_ms), ms],
  ['Objects drawn', (s) => s.objects_visible, count, 'count'],
  ['Draws', (s) => s.draws, count, 'count'],
  ['Triangles', (s) => s.triangles, count, 'count'],
  ['Samples lit', (s) => s.shaded_samples, count, 'count'],
  ['… by pixels', (s) => s.shaded_samples / s.drawn_pixels, (v) => `${(100 * v).toFixed(1)} %`],
  ['Targets', (s) => s.target_bytes / 2 ** 20, (v) => `${v.toFixed(0)} MiB`],
];

function ms(value) {
  return `${value.toFixed(value < 10 ? 2 : 0)} ms`;
}

function count(value) {
  return value.toLocaleString('en');
}

function total(timings) {
  return timings.reduce((sum, timing) => sum + timing.ms, 0);
}

function cell(name, text, kind) {
  const made = document.createElement(name);
  made.textContent = text;
  if (kind) made.className = kind;
  return made;
}

const COLOUR_OF_FINDING = { faster: 'better', slower: 'worse' };

/**
 * Reference / chosen: above 1 the chosen side takes less. Times have a colour where many frames differ. Figures that are not
 * of one frame, `together`, may be of two views.
 */
function ratioCell(compare, left, right, { found, together }) {
  const told = found?.[compare];
  if (!compare || !(left > 0 && right > 0) || !(together || told)) return cell('td', '');
  if (compare === 'count') {
    const ratio = left / right;
    return cell('td', `${ratio.toFixed(2)}x`, ratio > 1 ? 'better' : '');
  }
  const [, ratio, interval] = (told?.text ?? 'measuring').match(/^([^(]*)(\(.*)?$/);
  const made = cell('td', ratio, COLOUR_OF_FINDING[told?.finding] ?? 'grey');
  if (interval) made.append(cell('small', interval));
  made.title = 'Reference / chosen, over frames that both sides draw in turn, by lot; in brackets the interval that holds the true ratio in 998 of 1,000 cases.';
  return made;
}

/** Fills the table; a side that was not drawn keeps its last figures. */
export function showFigures(table, passes, notices, { reference, chosen, ...compared }) {
  const body = table.tBodies[0];
  body.replaceChildren();
  for (const [name, pick, write, compare] of rows) {
    const [left, right] = [reference, chosen].map((s) => (s ? pick(s) : undefined));
    if (left === undefined && right === undefined) continue;
    const row = body.insertRow();
    row.append(cell('th', name));
    for (const value of [left, right]) row.append(cell('td', value === undefined ? '–' : write(value)));
    row.append(ratioCell(compare, left, right, compared));
  }
  showPasses(passes, reference, chosen);
  notices.textContent = noticesOf(chosen).join(' ');
}

const capital = (sentence) => sentence[0].toUpperCase() + sentence.slice(1);

/** What the renderer says of its own choices. */
function noticesOf(chosen) {
  const sentences = [];
  for (const off of [chosen?.variable?.notice, chosen?.coarse?.notice]) {
    if (off) sentences.push(`${capital(off.replace('--force-rate true', 'the switch Force'))}.`);
  }
  if (chosen?.stereo) sentences.push(`Both eyes: ${chosen.stereo.mode} (${chosen.stereo.reason}).`);
  if (chosen?.coarse) sentences.push(`Backend: ${chosen.coarse.backend} (${chosen.coarse.backend_reason}).`);
  return sentences;
}

/** How long the page took to its first frame, and the memory that it holds. */
export function showFooting(place, firstFrameMs, wasmBytes) {
  place.textContent = `First frame after ${(firstFrameMs / 1000).toFixed(1)} s; ${(wasmBytes / 2 ** 20).toFixed(0)} MiB of WebAssembly memory.`;
}

/** One bar per side, its passes to scale. */
function showPasses(place, reference, chosen) {
  place.replaceChildren();
  const sides = [reference, chosen].filter((s) => s?.gpu_ms.length);
  const longest = Math.max(...sides.map((s) => total(s.gpu_ms)));
  const names = [...new Set(sides.flatMap((s) => s.gpu_ms.map((t) => t.name)))];
  const colour = (name) => COLOURS[names.indexOf(name) % COLOURS.length];
  for (const side of sides) {
    const bar = document.createElement('div');
    bar.className = 'bar';
    for (const { name, ms: time } of side.gpu_ms) {
      const part = document.createElement('span');
      part.style.cssText = `width:${(100 * time) / longest}%;background:${colour(name)}`;
      part.title = `${name}: ${ms(time)}`;
      bar.append(part);
    }
    place.append(bar);
  }
  const keys = document.createElement('div');
  keys.className = 'keys';
  for (const name of names) {
    const key = document.createElement('span');
    const square = document.createElement('i');
    square.style.background = colour(name);
    key.append(square, name);
    keys.append(key);
  }
  place.append(keys);
}
