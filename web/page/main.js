// The page: loads the renderer, draws when something changed, and keeps going when something fails.

import load, { Viewer, default_settings, settings_table } from './foveal_web.js';
import { Camera } from './camera.js';
import { showFigures } from './figures.js';
import { control, fillPanel } from './panel.js';
import { Settings } from './settings.js';
import { TECHNIQUES } from './techniques.js';

const SCENES = ['demo', 'cornell', 'materials-grid', 'alpha', 'demo:1000'];
const $ = (id) => document.getElementById(id);

/** Everything that a frame hangs on. */
const page = {
  viewer: null,
  settings: null,
  technique: TECHNIQUES[0],
  camera: null,
  split: 0.5,
  scale: 'auto',
  autoScale: 1,
  always: false,
  gaze: true,
  // What is shown: a generated scene's name, or a dropped file's name and bytes.
  scene: { name: 'demo', bytes: null },
  home: null,
  stale: true,
  // The camera moved since the link was written.
  moved: false,
  busy: false,
  frames: 0,
  costs: { reference: null, chosen: null },
};

function redraw() {
  page.stale = true;
}

function say(text) {
  const message = document.createElement('div');
  message.className = 'message';
  const words = document.createElement('span');
  words.textContent = text;
  const close = document.createElement('button');
  close.type = 'button';
  close.textContent = 'Close';
  close.addEventListener('click', () => message.remove());
  message.append(words, close);
  $('messages').replaceChildren(message);
}

function wait(text) {
  $('wait').textContent = text ?? '';
  $('wait').hidden = !text;
}

// ---- settings ----

function applySettings() {
  const { reference, chosen } = page.settings.sides;
  try {
    page.viewer.set_settings(JSON.stringify(reference), JSON.stringify(chosen));
  } catch (cause) {
    say(String(cause));
  }
  redraw();
  writeLink();
}

function changeSetting(side, key, value) {
  page.settings.set(side, key, value);
  $('techniques').querySelector('[aria-checked="true"]')?.setAttribute('aria-checked', 'mixed');
  name();
  applySettings();
}

function useTechnique(technique) {
  page.settings.use(technique);
  showTechnique(technique);
}

function showTechnique(technique) {
  page.technique = technique;
  for (const button of $('techniques').children) {
    const mine = button.dataset.key === technique.key;
    button.setAttribute('aria-checked', String(mine));
    button.tabIndex = mine ? 0 : -1;
  }
  $('technique-text').textContent = technique.text;
  fillQuick();
  fillAll();
  name();
  applySettings();
}

function fillQuick() {
  const technique = page.technique;
  $('quick').replaceChildren();
  if (technique.gaze) {
    const label = document.createElement('label');
    const box = document.createElement('input');
    box.type = 'checkbox';
    box.id = 'gaze-follows';
    box.checked = page.gaze;
    box.addEventListener('change', () => { page.gaze = box.checked; });
    label.append(box, ' Gaze follows the pointer');
    $('quick').append(label);
  }
  for (const key of technique.quick) {
    const entry = page.settings.entry(key);
    if (!entry) continue;
    const offered = key === 'view' ? { ...entry, names: technique.views } : entry;
    const row = control(offered, page.settings.sides.chosen[key], 'quick', (value) => {
      changeSetting('chosen', key, value);
      fillAll();
    });
    row.style.width = '100%';
    $('quick').append(row);
  }
}

function shownSide() {
  return $('tab-chosen').getAttribute('aria-selected') === 'true' ? 'chosen' : 'reference';
}

function fillAll() {
  fillPanel($('settings'), page.settings, shownSide(), (side, key, value) => {
    changeSetting(side, key, value);
    if (side === 'chosen') fillQuick();
  });
}

/** The words at the picture's corners: what differs from the defaults. */
function name() {
  for (const [side, id] of [['reference', 'left-name'], ['chosen', 'right-name']]) {
    const { sides, table } = page.settings;
    const words = table
      .filter(({ key }) => key !== 'gaze' && page.settings.changed(side, key))
      .map(({ key }) => `${key} ${sides[side][key]}`);
    $(id).textContent = words.join(', ') || 'every pixel, every light';
  }
}

// ---- the link ----

function writeLink() {
  const link = new URLSearchParams();
  if (!page.scene.bytes) link.set('scene', page.scene.name);
  link.set('technique', page.technique.key);
  page.settings.write(link);
  link.set('split', page.split.toFixed(3));
  if (page.scale !== 'auto') link.set('scale', page.scale);
  if (page.camera.touched) {
    const { eye, target } = page.camera.place();
    link.set('eye', eye.map((v) => v.toFixed(4)).join(','));
    link.set('target', target.map((v) => v.toFixed(4)).join(','));
  }
  history.replaceState(null, '', `#${link}`);
}

/** Takes over the address's wishes; tells which place it names for the camera. */
function readLink() {
  const link = new URLSearchParams(location.hash.slice(1));
  const technique = TECHNIQUES.find((t) => t.key === link.get('technique'));
  page.technique = technique ?? TECHNIQUES[0];
  page.settings.use(page.technique);
  const unread = page.settings.read(link);
  const split = Number(link.get('split') ?? 0.5);
  page.split = split >= 0 && split <= 1 ? split : 0.5;
  const scale = link.get('scale');
  if ([...$('scale').options].some((o) => o.value === scale)) page.scale = scale;
  page.scene = { name: link.get('scene') ?? 'demo', bytes: null };
  const numbers = (key) => link.get(key)?.split(',').map(Number);
  const [eye, target] = [numbers('eye'), numbers('target')];
  const place = [eye, target].every((p) => p?.length === 3 && p.every(Number.isFinite)) ? { eye, target } : null;
  if (unread.length) say(`The link asks for what this page does not know: ${unread.join(', ')}`);
  return place;
}

// ---- scenes ----

async function showScene(scene, place) {
  wait(`Loading ${scene.name}…`);
  // Let the words appear before the thread is taken.
  await new Promise((done) => setTimeout(done, 30));
  try {
    const text = scene.bytes
      ? await page.viewer.load(scene.name, new Uint8Array(scene.bytes))
      : await page.viewer.generate(scene.name);
    const shown = JSON.parse(text);
    page.scene = scene;
    page.home = { place: shown.camera, radius: shown.radius_m };
    page.camera.reset({ ...shown.camera, ...place }, shown.radius_m);
    page.camera.touched = Boolean(place);
    const figures = [`${shown.triangles.toLocaleString('en')} triangles`, `${shown.objects.toLocaleString('en')} objects`, `${shown.lights} lights`];
    $('scene-figures').textContent = figures.join(', ') + (shown.warnings.length ? `. ${shown.warnings.length} warnings: ${shown.warnings[0]}` : '');
    const select = $('scene');
    if (![...select.options].some((o) => o.value === scene.name)) select.add(new Option(scene.name, scene.name));
    select.value = scene.name;
    writeLink();
    redraw();
    return true;
  } catch (cause) {
    say(String(cause));
    $('scene').value = page.scene.name;
    return false;
  } finally {
    wait();
  }
}

/** Runs `work` alone: the viewer does one thing at a time. */
async function alone(work) {
  while (page.busy) await new Promise((done) => setTimeout(done, 10));
  page.busy = true;
  try {
    return await work();
  } finally {
    page.busy = false;
  }
}

async function showFile(file) {
  const bytes = await file.arrayBuffer();
  await alone(() => showScene({ name: file.name, bytes }));
}

// ---- frames ----

function pictureSize() {
  const box = $('stage').getBoundingClientRect();
  const ratio = Math.min(devicePixelRatio || 1, 2) * (page.scale === 'auto' ? page.autoScale : Number(page.scale));
  return { width: Math.max(16, Math.round(box.width * ratio)), height: Math.max(16, Math.round(box.height * ratio)) };
}

/** Halves the resolution while frames take longer than a quarter of a second; doubles it when there is time. */
function adapt(ms) {
  if (page.scale !== 'auto') return;
  if (ms > 250 && page.autoScale > 0.25) page.autoScale /= 2;
  else if (ms < 40 && page.autoScale < 1) page.autoScale *= 2;
  else return;
  redraw();
}

async function drawFrame() {
  const wish = { camera: page.camera.place(), split: page.split, ...pictureSize() };
  const canvas = $('picture');
  if (canvas.width !== wish.width || canvas.height !== wish.height) {
    canvas.width = wish.width;
    canvas.height = wish.height;
  }
  page.stale = false;
  if (page.moved) writeLink();
  page.moved = false;
  const cost = JSON.parse(await page.viewer.draw(JSON.stringify(wish)));
  page.frames += 1;
  page.costs = { reference: cost.reference ?? page.costs.reference, chosen: cost.chosen ?? page.costs.chosen };
  showFigures($('figures'), $('passes'), page.costs);
  adapt(cost.total_ms);
}

let last = performance.now();
async function turn(now) {
  const seconds = (now - last) / 1000;
  last = now;
  if (page.camera.step(seconds) || page.always) redraw();
  if (page.stale && !page.busy) {
    page.busy = true;
    try {
      await drawFrame();
    } catch (cause) {
      await mend(cause);
    } finally {
      page.busy = false;
    }
  }
  requestAnimationFrame(turn);
}

/** The chosen side's last picture as a PNG file. */
async function savePicture() {
  const pixels = new Uint8ClampedArray(await page.viewer.picture(true));
  const { width, height } = page.costs.chosen;
  const canvas = new OffscreenCanvas(width, height);
  canvas.getContext('2d').putImageData(new ImageData(pixels, width, height), 0, 0);
  const link = document.createElement('a');
  link.href = URL.createObjectURL(await canvas.convertToBlob());
  link.download = 'foveal.png';
  link.click();
  URL.revokeObjectURL(link.href);
}

/** After a failed frame: a lost device is opened anew, once; all else waits for the next change. */
async function mend(cause) {
  say(String(cause));
  if (!/lost/i.test(String(cause))) return;
  wait('Opening the graphics device again…');
  const place = page.camera.place();
  try {
    await openViewer();
    applySettings();
    await showScene(page.scene, place);
  } catch (again) {
    say(`${again}. Reload the page to try again.`);
  }
  wait();
}

async function openViewer() {
  const old = $('picture');
  const canvas = old.cloneNode();
  old.replaceWith(canvas);
  page.viewer = null;
  page.viewer = await Viewer.open(canvas);
  const touched = page.camera?.touched;
  const camera = new Camera(canvas, () => {
    camera.touched = true;
    page.moved = true;
    redraw();
  });
  camera.touched = touched;
  camera.orbit = $('orbit').checked;
  page.camera = camera;
  canvas.addEventListener('pointermove', follow);
  const { name: adapter, backend } = JSON.parse(page.viewer.adapter());
  $('adapter').textContent = `WebGPU${adapter ? ` on ${adapter}` : ''} (${backend})`;
}

/** The gaze goes where the pointer is. */
function follow(event) {
  if (!page.gaze || !page.technique.gaze || page.camera.pointers.size) return;
  const box = $('stage').getBoundingClientRect();
  const gaze = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  page.settings.set('chosen', 'gaze', gaze.map((v) => Math.round(v * 1000) / 1000));
  applySettings();
}

// ---- controls ----

function placeSplit() {
  $('handle').style.left = `${100 * page.split}%`;
  $('split').value = String(Math.round(1000 * page.split));
  $('left-name').style.visibility = page.split > 0.02 ? '' : 'hidden';
  $('right-name').style.visibility = page.split < 0.98 ? '' : 'hidden';
}

function moveSplit(split) {
  page.split = Math.max(0, Math.min(1, split));
  placeSplit();
  redraw();
  writeLink();
}

function wire() {
  for (const scene of SCENES) $('scene').add(new Option(scene, scene));
  $('scene').addEventListener('change', (event) => alone(() => showScene({ name: event.target.value, bytes: null })));
  $('file').addEventListener('change', (event) => {
    const [file] = event.target.files;
    if (file) showFile(file);
    event.target.value = '';
  });
  for (const technique of TECHNIQUES) {
    const button = document.createElement('button');
    button.type = 'button';
    button.setAttribute('role', 'radio');
    button.dataset.key = technique.key;
    button.textContent = technique.name;
    button.addEventListener('click', () => useTechnique(technique));
    $('techniques').append(button);
  }
  $('techniques').addEventListener('keydown', (event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!step) return;
    const count = TECHNIQUES.length;
    const next = (TECHNIQUES.indexOf(page.technique) + step + count) % count;
    useTechnique(TECHNIQUES[next]);
    $('techniques').children[next].focus();
    event.preventDefault();
  });
  const tabs = [$('tab-chosen'), $('tab-reference')];
  const select = (tab) => {
    for (const t of tabs) {
      t.setAttribute('aria-selected', String(t === tab));
      t.tabIndex = t === tab ? 0 : -1;
    }
    fillAll();
  };
  for (const tab of tabs) {
    tab.addEventListener('click', () => select(tab));
    tab.addEventListener('keydown', (event) => {
      if (event.key !== 'ArrowLeft' && event.key !== 'ArrowRight') return;
      const other = tabs.find((t) => t !== tab);
      select(other);
      other.focus();
    });
  }
  $('split').addEventListener('input', (event) => moveSplit(Number(event.target.value) / 1000));
  const handle = $('handle');
  handle.addEventListener('pointerdown', (event) => handle.setPointerCapture(event.pointerId));
  handle.addEventListener('pointermove', (event) => {
    if (!handle.hasPointerCapture(event.pointerId)) return;
    const box = $('stage').getBoundingClientRect();
    moveSplit((event.clientX - box.left) / box.width);
  });
  $('scale').addEventListener('change', (event) => { page.scale = event.target.value; page.autoScale = 1; redraw(); writeLink(); });
  $('always').addEventListener('change', (event) => { page.always = event.target.checked; });
  $('orbit').addEventListener('change', (event) => { page.camera.orbit = event.target.checked; });
  $('home').addEventListener('click', () => {
    if (!page.home) return;
    page.camera.reset(page.home.place, page.home.radius);
    page.camera.touched = false;
    redraw();
    writeLink();
  });
  $('share').addEventListener('click', async () => {
    writeLink();
    try {
      await navigator.clipboard.writeText(location.href);
      $('share').textContent = 'Copied';
    } catch {
      $('share').textContent = 'It is in the address bar';
    }
    setTimeout(() => { $('share').textContent = 'Copy link'; }, 2000);
  });
  $('save').addEventListener('click', () => alone(savePicture));
  $('fold').addEventListener('click', () => {
    const closed = $('panel').classList.toggle('closed');
    $('fold').setAttribute('aria-expanded', String(!closed));
  });
  let over = 0;
  addEventListener('dragenter', () => { over += 1; $('drop').hidden = false; });
  addEventListener('dragleave', () => { over -= 1; $('drop').hidden = over > 0 ? false : true; });
  addEventListener('dragover', (event) => event.preventDefault());
  addEventListener('drop', (event) => {
    event.preventDefault();
    over = 0;
    $('drop').hidden = true;
    const [file] = event.dataTransfer.files;
    if (file) showFile(file);
  });
  new ResizeObserver(redraw).observe($('stage'));
}

// ---- without WebGPU ----

function showStills(cause) {
  for (const id of ['stage', 'panel']) $(id).hidden = true;
  $('without').hidden = false;
  $('missing').textContent = `This page draws with WebGPU, which is missing here: ${cause}. Chrome, Edge, Safari 26 and Firefox 141 or newer have it. What you would see:`;
  for (const { key, name: title, text } of TECHNIQUES) {
    const figure = document.createElement('figure');
    const picture = document.createElement('img');
    picture.src = `stills/${key}.jpg`;
    picture.alt = `${title}: reference on the left, chosen settings on the right`;
    const caption = document.createElement('figcaption');
    const head = document.createElement('b');
    head.textContent = `${title}. `;
    caption.append(head, text);
    figure.append(picture, caption);
    $('stills').append(figure);
  }
}

async function begin() {
  await load();
  if (!navigator.gpu) throw new Error('the browser does not offer it');
  await openViewer();
}

async function main() {
  try {
    await begin();
  } catch (cause) {
    showStills(cause?.message ?? cause);
    return;
  }
  page.settings = new Settings(JSON.parse(default_settings()), JSON.parse(settings_table()));
  wire();
  const place = readLink();
  $('scale').value = page.scale;
  placeSplit();
  const wished = location.hash;
  showTechnique(page.technique);
  history.replaceState(null, '', wished || '#');
  if (!(await showScene(page.scene, place)) && page.scene.name !== 'demo') {
    await showScene({ name: 'demo', bytes: null });
  }
  requestAnimationFrame(turn);
}

window.foveal = page;
main();
