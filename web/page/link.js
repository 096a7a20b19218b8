// The address holds what is shown: scene, technique, settings, divider, resolution, place.

import { $, page, say } from './page.js';

/** Least milliseconds between two changes of the address: browsers refuse more than 100 in half a minute. */
const LEAST_WAIT_MS = 500;
let waits = null;

/** What a link says of the camera; without `up` it does not lean. */
const PLACE = ['eye', 'target', 'up'];

/** What a link holds beside settings. */
const OWN = ['backend', 'scene', 'technique', 'split', 'scale', ...PLACE];

/** Writes the link soon, once for all changes until then. */
export function writeLink() {
  waits ??= setTimeout(writeLinkNow, LEAST_WAIT_MS);
}

/** Leaves the address as it is until the next change. */
export function keepLink() {
  clearTimeout(waits);
  waits = null;
}

export function writeLinkNow() {
  keepLink();
  const link = new URLSearchParams();
  if (page.reducedOnPurpose) link.set('backend', 'webgl2');
  if (!page.scene.bytes) link.set('scene', page.scene.name);
  link.set('technique', page.technique.key);
  page.settings.write(link);
  link.set('split', page.split.toFixed(3));
  if (page.scale !== 'auto') link.set('scale', page.scale);
  // A link cannot hold a file, nor a place that means something in a file alone.
  if (page.camera.touched && !page.scene.bytes) {
    const place = page.camera.place();
    for (const key of PLACE) link.set(key, place[key].map((v) => v.toFixed(4)).join(','));
  }
  try {
    history.replaceState(null, '', `#${link}`);
  } catch {
    // Refused: the next change writes it.
  }
}

/** Whether an address asks for the reduced renderer. */
export function asksForReduced(address) {
  return new URLSearchParams(address.slice(1)).get('backend') === 'webgl2';
}

/** Three numbers as a link has them, or nothing. */
function vector(text) {
  const numbers = text?.split(',').map(Number);
  return numbers?.length === 3 && numbers.every(Number.isFinite) ? numbers : undefined;
}

/** Takes over a link's technique, divider and resolution, where they make sense; tells which do not. */
function readView(link) {
  const technique = page.techniques.find((t) => t.key === link.get('technique'));
  page.technique = technique ?? page.techniques[0];
  const split = Number(link.get('split') || NaN);
  const isSplit = split >= 0 && split <= 1;
  page.split = isSplit ? split : 0.5;
  const scale = link.get('scale');
  const isScale = [...$('scale').options].some((o) => o.value === scale);
  page.scale = isScale ? scale : 'auto';
  const read = { technique, split: isSplit, scale: isScale };
  return Object.keys(read).filter((key) => link.has(key) && !read[key]);
}

/** Takes over an address's settings; tells which scene it names, and which place in it for the camera. */
export function readLink(address) {
  const link = new URLSearchParams(address.slice(1));
  const unread = readView(link);
  page.settings.use(page.technique);
  const scene = { name: link.get('scene') ?? 'demo', bytes: null };
  const vectors = PLACE.map((key) => vector(link.get(key)));
  unread.push(...PLACE.filter((key, i) => link.has(key) && !vectors[i]));
  const [eye, target, up] = vectors;
  const place = eye && target ? { eye, target, up } : null;
  const words = unread.map((key) => `${key}=${link.get(key)}`);
  words.push(...page.settings.read([...link].filter(([name]) => !OWN.includes(name))));
  if (words.length) say(`The link asks for what this page does not know: ${words.join(', ')}`);
  return { scene, place };
}
