// Which scene is shown: a generated one, or a file from the user.

import { tellSettings } from './chooser.js';
import { dropped, together } from './dropped.js';
import { writeLink } from './link.js';
import { $, alone, forgetCosts, page, printable, redraw, say, wait } from './page.js';
import { hasStopped, isLost, orLost, rehearse } from './renderer.js';

const SCENES = ['demo', 'cornell', 'materials-grid', 'alpha', 'demo:1000'];

/** Bytes that files may have, as in the reader: larger ones are not fetched into memory to be refused. */
const MOST_BYTES = 512 * 2 ** 20;

/** The user's files that have been shown, each with those beside it, by name. Their bytes are read anew each time. */
const files = new Map();

export async function showScene(scene, place) {
  wait(`Loading ${printable(scene.name)}…`);
  // Let the words appear before the thread is taken.
  await new Promise((done) => setTimeout(done, 30));
  // Settings that cannot be read are said; frames go on saying so.
  try {
    tellSettings();
  } catch (cause) {
    say(String(cause));
  }
  try {
    if (scene.bytes && !scene.isRead) await rehearse(scene);
    scene.isRead = true;
    const text = await orLost(() => (scene.bytes
      ? page.viewer.load(scene.name, new Uint8Array(scene.bytes), scene.beside)
      : page.viewer.generate(scene.name)));
    const shown = JSON.parse(text);
    page.scene = scene;
    forgetCosts();
    page.resolution.changed();
    page.home = { place: shown.camera, radius: shown.radius_m };
    page.camera.reset({ ...shown.camera, ...place }, shown.radius_m);
    page.camera.touched = Boolean(place);
    const figures = [`${shown.triangles.toLocaleString('en')} triangles`, `${shown.objects.toLocaleString('en')} objects`, `${shown.lights} lights`];
    $('scene-figures').textContent = figures.join(', ') + (shown.warnings.length ? `. ${shown.warnings.length} warnings: ${printable(shown.warnings[0])}` : '');
    const select = $('scene');
    if (![...select.options].some((o) => o.value === scene.name)) select.add(new Option(printable(scene.name), scene.name));
    select.value = scene.name;
    writeLink();
    redraw();
    return true;
  } catch (cause) {
    if (hasStopped(cause)) throw cause;
    if (isLost(cause)) page.lost = String(cause);
    say(String(cause));
    $('scene').value = page.scene.name;
    return false;
  } finally {
    wait();
  }
}

/** Where nothing is shown yet: what the address asked for, or else the demo scene. A lost device can show neither. */
export async function showFirst() {
  if (page.asked) await showScene(page.asked.scene, page.asked.place);
  if (!page.home && !page.lost) await showScene({ name: 'demo', bytes: null });
}

/** Shows a scene when nothing else is at work; a renderer that stops at it is loaded anew, with the scene before. */
function showAlone(scene) {
  return alone(() => showScene(scene).catch((cause) => page.restart(cause)));
}

/** Says why no file is shown. */
function refuse(sentence) {
  say(sentence);
  $('scene').value = page.scene.name;
}

/** Shows the first of the files; the others are those that it may name. */
async function showFiles(given) {
  const [{ name }] = given;
  const size = given.reduce((sum, { file }) => sum + file.size, 0);
  if (size > MOST_BYTES) {
    const megabytes = (bytes) => `${(bytes / 1e6).toFixed(1)} MB`;
    const all = given.length > 1 ? ' with the files beside it' : '';
    refuse(`${name} is too large: it has ${megabytes(size)}${all}, the limit is ${megabytes(MOST_BYTES)}; what is shown stays`);
    return;
  }
  const read = [];
  for (const { name: one, file } of given) {
    try {
      read.push([one, await file.arrayBuffer()]);
    } catch (cause) {
      refuse(`${one} cannot be read: ${cause.message}`);
      return;
    }
  }
  const [[, bytes], ...others] = read;
  if (await showAlone({ name, bytes, beside: new Map(others) })) files.set(name, given);
}

/** Shows what the list names: a file, or else a generated scene. */
function showNamed(name) {
  const known = files.get(name);
  return known ? showFiles(known) : showAlone({ name, bytes: null });
}

export function wireScenes() {
  for (const scene of SCENES) $('scene').add(new Option(scene, scene));
  $('scene').addEventListener('change', (event) => showNamed(event.target.value));
  $('file').addEventListener('change', (event) => {
    if (event.target.files.length) showFiles(together(event.target.files));
    event.target.value = '';
  });
  let over = 0;
  addEventListener('dragenter', () => { over += 1; $('drop').hidden = false; });
  addEventListener('dragleave', () => { over -= 1; $('drop').hidden = over <= 0; });
  addEventListener('dragover', (event) => event.preventDefault());
  addEventListener('drop', (event) => {
    event.preventDefault();
    over = 0;
    $('drop').hidden = true;
    dropped(event.dataTransfer).then(
      (files) => (files.length ? showFiles(files) : null),
      (cause) => refuse(`What was dropped cannot be shown: ${cause.message}`),
    );
  });
}
