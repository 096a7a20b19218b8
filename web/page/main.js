// The page: loads the renderer, makes the controls, and starts the clock of frames.

import load, { Viewer, default_settings, settings_table } from './foveal_web.js';
import { showTechnique, wireChooser } from './chooser.js';
import { placeSplit, wireControls } from './controls.js';
import { openViewer, turn } from './frames.js';
import { readLink } from './link.js';
import { $, page } from './page.js';
import { showScene, wireScenes } from './scenes.js';
import { Settings } from './settings.js';
import { showStills } from './stills.js';

async function begin() {
  if (!navigator.gpu) throw new Error('the browser does not offer it');
  page.memory = (await load()).memory;
  page.Viewer = Viewer;
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
  wireScenes();
  wireChooser();
  wireControls();
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
