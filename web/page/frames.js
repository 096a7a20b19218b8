// The clock of frames: draws when something changed, and keeps going when something fails.

import { Camera } from './camera.js';
import { applySettings, framesToSettle, tellSettings } from './chooser.js';
import { pictureSize } from './eyes.js';
import { showFigures, showFooting } from './figures.js';
import { gazeAt } from './gaze.js';
import { writeLink } from './link.js';
import { $, page, redraw, say, wait } from './page.js';
import { hasStopped, isLost, loadRenderer, orLost, orStopped } from './renderer.js';
import { showFirst, showScene } from './scenes.js';

/** The size to draw at; the canvas takes it over with the picture, and shows the one before until then. */
function sizeToDraw() {
  const ratio = Math.min(devicePixelRatio || 1, 2) * (page.scale === 'auto' ? page.resolution.scale : Number(page.scale));
  return pictureSize($('stage').getBoundingClientRect(), ratio, page.settings.sides);
}

async function drawFrame() {
  page.unsettled = page.stale ? framesToSettle() : page.unsettled;
  // A frame that fails is not asked for again before the next change.
  page.stale = false;
  const request = { camera: page.camera.place(), split: page.split, ...sizeToDraw() };
  tellSettings();
  if (page.moved) writeLink();
  page.moved = false;
  const cost = JSON.parse(await orLost(() => page.viewer.draw(JSON.stringify(request))));
  losses = 0;
  page.unsettled -= 1;
  page.frames += 1;
  page.firstFrameMs ??= performance.now();
  page.drawn = { reference: cost.reference, chosen: cost.chosen };
  page.costs = {
    reference: cost.reference ?? page.costs.reference,
    chosen: cost.chosen ?? page.costs.chosen,
    found: { frame: cost.frame, passes: cost.passes },
    together: Boolean(cost.reference && cost.chosen),
  };
  page.measured = cost.is_measured;
  showFigures($('figures'), $('passes'), $('notices'), page.costs);
  showFooting($('footing'), page.firstFrameMs, page.memory.buffer.byteLength);
  if (page.scale === 'auto' && page.resolution.adapt(cost.total_ms)) redraw();
}

/** Whether a point of the page has become other pixels, as on another monitor; its size need not change. */
let pixelRatio = devicePixelRatio;
function hasOtherPixels() {
  const before = pixelRatio;
  pixelRatio = devicePixelRatio;
  return pixelRatio !== before;
}

/** The last frame failed: the next one waits for a change, even where frames are drawn all the time. */
let failed = false;

/** Milliseconds that the browser has to ask for a frame. Firefox asks for none after a device is lost that showed none yet. */
const LONGEST_WAIT_MS = 1000;

/** Takes a turn at the browser's next frame, or without one when that does not come. */
export function askForTurn() {
  const frame = requestAnimationFrame((now) => {
    clearTimeout(late);
    turn(now);
  });
  const late = setTimeout(() => {
    cancelAnimationFrame(frame);
    // Nobody sees what a hidden page draws.
    if (document.hidden) askForTurn();
    else turn(performance.now());
  }, LONGEST_WAIT_MS);
}

let last = performance.now();
async function turn(now) {
  const seconds = (now - last) / 1000;
  last = now;
  if (page.camera.step(seconds) || hasOtherPixels() || (page.always && !failed)) redraw();
  if ((page.stale || page.unsettled > 0 || !page.measured) && !page.busy) {
    page.busy = true;
    try {
      await drawFrame();
      failed = false;
    } catch (cause) {
      failed = true;
      page.unsettled = 0;
      page.measured = true;
      await mend(cause);
    } finally {
      page.busy = false;
    }
  }
  askForTurn();
}

/** Devices that were lost since the last frame. */
let losses = 0;

/** After a failed frame: a lost device is opened anew, once; all else waits for the next change. */
async function mend(cause) {
  if (hasStopped(cause)) return restart(cause, true);
  say(String(cause));
  if (!isLost(cause)) return;
  losses += 1;
  if (losses > 1) {
    // It may be the frame itself that a device is lost by.
    losses = 0;
    return say(`${cause}. It was lost again before a frame was drawn; the next change opens it once more`);
  }
  await reopen('Opening the graphics device again…', async () => {}, page.home && page.camera.place());
}

/** After the renderer has stopped: another one takes its place, and shows the scene before. */
async function restart(cause, whileDrawing = false) {
  if (!hasStopped(cause)) return say(String(cause));
  say(`The renderer stopped (${cause.message}) and was started again`);
  let place = page.home && page.camera.place();
  // What stopped it before anything was shown is not asked for again.
  page.asked = page.home && page.asked;
  // It may be the scene itself that cannot be drawn.
  if (whileDrawing && page.stoppedAt === page.scene) {
    if (page.scene.name === 'demo') return say(`The renderer stopped again (${cause.message}). Reload the page to try again.`);
    page.scene = { name: 'demo', bytes: null };
    place = null;
  }
  if (whileDrawing) page.stoppedAt = page.scene;
  // Nothing in its memory can be relied on, not even to free it.
  page.viewer = null;
  await reopen('Starting the renderer again…', loadRenderer, place);
}
page.restart = restart;

async function reopen(words, load, place) {
  wait(words);
  try {
    await load();
    await openViewer();
    // The device may be lost again before the scene is there.
    if (place) page.camera.reset(place, page.home.radius);
    applySettings();
    await (page.home ? showScene(page.scene, place) : showFirst());
  } catch (again) {
    say(`${again}. Reload the page to try again.`);
  }
  wait();
}

/** Opens the device on a canvas of its own: one that had a device cannot get another kind. */
export async function openViewer() {
  const old = $('picture');
  const hasFocus = document.activeElement === old;
  const canvas = old.cloneNode();
  old.replaceWith(canvas);
  if (hasFocus) canvas.focus();
  // Nobody tells wgpu that a WebGL context is gone: its frame would never end.
  page.lost = null;
  canvas.addEventListener('webglcontextlost', () => {
    page.lost = 'the graphics device was lost: the browser took the WebGL context away';
    page.fail?.(page.lost);
    redraw();
  });
  letGo(page.viewer);
  page.viewer = null;
  page.viewer = await orStopped(page.Viewer.open(canvas));
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
  // A finger that moves turns the camera: where it is lifted the gaze goes, as where it taps.
  canvas.addEventListener('pointerup', follow);
  const { name, backend } = JSON.parse(page.viewer.adapter());
  const kind = backend === 'gl' ? 'WebGL 2' : 'WebGPU';
  $('adapter').textContent = `${kind}${name ? ` on ${name}` : ''} (${backend})`;
}

/** Frees a viewer whose device is gone, with all that it has on the device. */
function letGo(viewer) {
  try {
    viewer?.free();
  } catch {
    // A call of it never ends, and holds on to it.
  }
}

/** The gaze goes where the pointer is. */
function follow(event) {
  if (!page.gaze || !page.technique.gaze || page.camera.pointers.size) return;
  const box = $('stage').getBoundingClientRect();
  const place = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  page.settings.set('chosen', 'gaze', gazeAt(place, page.settings.sides.chosen, $('picture').width));
  applySettings();
}
