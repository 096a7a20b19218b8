// The page: loads the renderer, makes the controls, and starts the clock of frames.

import { showTechnique, wireChooser } from './chooser.js';
import { placeSplit, wireControls } from './controls.js';
import { askForTurn, openViewer } from './frames.js';
import { asksForReduced, keepLink, readLink, writeLink } from './link.js';
import { $, alone, page } from './page.js';
import { loadRenderer } from './renderer.js';
import { showScene, wireScenes } from './scenes.js';
import { Settings } from './settings.js';
import { showStills } from './stills.js';
import { TECHNIQUES } from './techniques.js';

/** The renderer for WebGPU, or the reduced one for WebGL 2; tells its module. */
async function begin(reduced) {
  if (reduced) {
    if (!document.createElement('canvas').getContext('webgl2')) throw new Error('no WebGL 2');
  } else if (!(await navigator.gpu?.requestAdapter())) {
    throw new Error('no WebGPU');
  }
  page.reduced = reduced;
  page.loads = 0;
  const renderer = await loadRenderer();
  await openViewer();
  return renderer;
}

/** The best that this browser can do; `null` where it can draw nothing. */
async function beginSomehow() {
  page.reducedOnPurpose = asksForReduced(location.hash);
  const causes = [];
  for (const reduced of page.reducedOnPurpose ? [true] : [false, true]) {
    try {
      const renderer = await begin(reduced);
      if (reduced) showReduced(causes);
      return renderer;
    } catch (cause) {
      causes.push(cause?.message ?? String(cause));
    }
  }
  showStills(causes.join(', '));
  return null;
}

/** Says that it is the reduced set, and what is missing. */
function showReduced(causes) {
  page.techniques = TECHNIQUES.filter((t) => t.reduced);
  const missing = TECHNIQUES.filter((t) => !t.reduced && !t.sum).map((t) => t.name.toLowerCase());
  const why = causes.length ? `This browser offers ${causes.join(', ')}` : 'As the link asks';
  $('reduced').textContent = `${why}: a reduced renderer draws with WebGL 2. Every pixel is lit, for one eye or two, with or without culling. Missing: ${missing.join(', ')}, contact shadows, the views, and times per pass.`;
  $('reduced').hidden = false;
}

/** Shows what an address asks for; tells whether its scene is shown. */
function showLink(address) {
  page.asked = readLink(address);
  $('scale').value = page.scale;
  placeSplit();
  showTechnique(page.technique);
  // It stays the address while its scene is loaded.
  keepLink();
  return showScene(page.asked.scene, page.asked.place).catch((cause) => page.restart(cause));
}

/** Follows addresses that the open page is given: by hand, or by the way back. Those that it writes itself tell nobody. */
function followLinks() {
  let last = null;
  addEventListener('hashchange', ({ newURL }) => {
    const address = new URL(newURL).hash;
    if (!address) return;
    last = address;
    if (asksForReduced(address) !== page.reducedOnPurpose) {
      history.replaceState(null, '', address);
      location.reload();
      return;
    }
    alone(async () => {
      if (address === last && !(await showLink(address))) writeLink();
    });
  });
}

async function main() {
  const renderer = await beginSomehow();
  if (!renderer) return;
  page.settings = new Settings(JSON.parse(renderer.default_settings()), JSON.parse(renderer.settings_table()));
  wireScenes();
  wireChooser();
  wireControls();
  followLinks();
  await alone(async () => {
    await showLink(location.hash);
    if (!page.home && !page.stoppedAt && !page.lost) await showScene({ name: 'demo', bytes: null });
  });
  askForTurn();
}

window.foveal = page;
main();
