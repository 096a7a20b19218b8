// The address holds what is shown: scene, technique, settings, divider, resolution, place.

import { $, page, say } from './page.js';

/** Least milliseconds between two changes of the address: browsers refuse more than 100 in half a minute. */
const LEAST_WAIT_MS = 500;
let waits = null;

/** What a link says of the camera; without `up` it does not lean. */
const PLACE = ['eye', 'target', 'up'];

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

/** Takes over an address's settings; tells which scene it names, and which place in it for the camera. */
export function readLink(address) {
  const link = new URLSearchParams(address.slice(1));
  const technique = page.techniques.find((t) => t.key === link.get('technique'));
  page.technique = technique ?? page.techniques[0];
  page.settings.use(page.technique);
  const unread = page.settings.read(link);
  const split = Number(link.get('split') ?? 0.5);
  page.split = split >= 0 && split <= 1 ? split : 0.5;
  const scale = link.get('scale');
  page.scale = [...$('scale').options].some((o) => o.value === scale) ? scale : 'auto';
  const scene = { name: link.get('scene') ?? 'demo', bytes: null };
  const [eye, target, up] = PLACE.map((key) => vector(link.get(key)));
  const place = eye && target ? { eye, target, up } : null;
  if (unread.length) say(`The link asks for what this page does not know: ${unread.join(', ')}`);
  return { scene, place };
}
