// Which scene is shown: a generated one, or a file from the user.

import { tellSettings } from './chooser.js';
import { writeLink } from './link.js';
import { $, alone, forgetCosts, page, printable, redraw, say, wait } from './page.js';
import { hasStopped, isLost, orLost, rehearse } from './renderer.js';

const SCENES = ['demo', 'cornell', 'materials-grid', 'alpha', 'demo:1000'];

/** Bytes that a file may have, as in the reader: a larger one is not fetched into memory to be refused. */
const MOST_BYTES = 512 * 2 ** 20;

/** The user's files that have been shown, by name. Their bytes are read anew each time. */
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
    if (scene.bytes && !scene.isRead) await rehearse(scene.name, scene.bytes);
    scene.isRead = true;
    const text = await orLost(() => (scene.bytes
      ? page.viewer.load(scene.name, new Uint8Array(scene.bytes))
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

async function showFile(file) {
  if (file.size > MOST_BYTES) {
    const megabytes = (bytes) => `${(bytes / 1e6).toFixed(1)} MB`;
    say(`${file.name} is too large: it has ${megabytes(file.size)}, the limit is ${megabytes(MOST_BYTES)}; what is shown stays`);
    $('scene').value = page.scene.name;
    return;
  }
  let bytes;
  try {
    bytes = await file.arrayBuffer();
  } catch (cause) {
    say(`${file.name} cannot be read: ${cause.message}`);
    $('scene').value = page.scene.name;
    return;
  }
  if (await showAlone({ name: file.name, bytes })) files.set(file.name, file);
}

/** Shows what the list names: a file, or else a generated scene. */
function showNamed(name) {
  const file = files.get(name);
  return file ? showFile(file) : showAlone({ name, bytes: null });
}

export function wireScenes() {
  for (const scene of SCENES) $('scene').add(new Option(scene, scene));
  $('scene').addEventListener('change', (event) => showNamed(event.target.value));
  $('file').addEventListener('change', (event) => {
    const [file] = event.target.files;
    if (file) showFile(file);
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
    const dropped = [...event.dataTransfer.files];
    // A scene may come with files that lie beside it.
    const file = dropped.find(({ name }) => /\.(glb|gltf)$/i.test(name)) ?? dropped[0];
    if (file) showFile(file);
  });
}
