// The divider, and the buttons that belong to the picture.

import { writeLink, writeLinkNow } from './link.js';
import { $, alone, page, redraw } from './page.js';
import { orLost } from './renderer.js';

export function placeSplit() {
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

/** The last frame as a PNG file: the chosen side, or the reference where that alone is shown. */
async function savePicture() {
  const { chosen, reference } = page.drawn;
  const cost = chosen ?? reference;
  if (!cost) return;
  const pixels = new Uint8ClampedArray(await orLost(() => page.viewer.picture(cost === chosen)));
  const { width, height } = cost;
  const canvas = new OffscreenCanvas(width, height);
  canvas.getContext('2d').putImageData(new ImageData(pixels, width, height), 0, 0);
  const link = document.createElement('a');
  link.href = URL.createObjectURL(await canvas.convertToBlob());
  link.download = 'foveal.png';
  link.click();
  URL.revokeObjectURL(link.href);
}

/** Saves when nothing else is at work; says what failed. A lost device is opened again by the next frame. */
function saveAlone() {
  return alone(() => savePicture().catch((cause) => {
    redraw();
    return page.restart(cause);
  }));
}

function goHome() {
  if (!page.home) return;
  page.camera.reset(page.home.place, page.home.radius);
  page.camera.touched = false;
  redraw();
  writeLink();
}

async function share() {
  writeLinkNow();
  try {
    await navigator.clipboard.writeText(location.href);
    $('share').textContent = 'Copied';
  } catch {
    $('share').textContent = 'It is in the address bar';
  }
  setTimeout(() => { $('share').textContent = 'Copy link'; }, 2000);
}

export function wireControls() {
  $('split').addEventListener('input', (event) => moveSplit(Number(event.target.value) / 1000));
  const handle = $('handle');
  handle.addEventListener('pointerdown', (event) => handle.setPointerCapture(event.pointerId));
  handle.addEventListener('pointermove', (event) => {
    if (!handle.hasPointerCapture(event.pointerId)) return;
    const box = $('stage').getBoundingClientRect();
    moveSplit((event.clientX - box.left) / box.width);
  });
  $('scale').addEventListener('change', (event) => {
    page.scale = event.target.value;
    page.resolution.reset();
    redraw();
    writeLink();
  });
  $('always').addEventListener('change', (event) => { page.always = event.target.checked; });
  $('orbit').addEventListener('change', (event) => { page.camera.orbit = event.target.checked; });
  $('home').addEventListener('click', goHome);
  $('share').addEventListener('click', share);
  $('save').addEventListener('click', saveAlone);
  $('fold').addEventListener('click', () => {
    const closed = $('panel').classList.toggle('closed');
    $('fold').setAttribute('aria-expanded', String(!closed));
  });
  new ResizeObserver(redraw).observe($('stage'));
}
