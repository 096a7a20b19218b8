// Techniques and settings: buttons, the few settings beside them, all settings, and what the viewer is told.

import { writeLink } from './link.js';
import { $, page, redraw } from './page.js';
import { control, fillPanel } from './panel.js';

/** Frames after a change until variable shading has measured every place. */
const SETTLING_FRAMES = 8;

/** The next frame is drawn with the settings as they are now. */
export function applySettings() {
  page.unapplied = true;
  redraw();
  writeLink();
}

/**
 * Tells the viewer; for whoever has it alone. Throws a sentence where a setting cannot be read, and again before each
 * frame until it can: no picture is drawn that its names do not describe.
 */
export function tellSettings() {
  if (!page.unapplied || !page.viewer) return;
  const { reference, chosen } = page.settings.sides;
  page.viewer.set_settings(JSON.stringify(reference), JSON.stringify(chosen));
  page.unapplied = false;
}

/** How often a picture is drawn that nobody changes any more. */
export function framesToSettle() {
  return Object.values(page.settings.sides).some((side) => side.shading === 'variable') ? SETTLING_FRAMES : 1;
}

function changeSetting(side, key, value) {
  page.settings.set(side, key, value);
  page.resolution.changed();
  $('techniques').querySelector('[aria-checked="true"]')?.setAttribute('aria-checked', 'mixed');
  nameSides();
  applySettings();
}

function useTechnique(technique) {
  page.settings.use(technique);
  showTechnique(technique);
}

export function showTechnique(technique) {
  page.technique = technique;
  page.resolution.changed();
  for (const button of $('techniques').children) {
    const mine = button.dataset.key === technique.key;
    button.setAttribute('aria-checked', String(mine));
    button.tabIndex = mine ? 0 : -1;
  }
  $('technique-text').textContent = technique.text;
  fillQuick();
  fillAll();
  nameSides();
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
      // Both sides are looked at through the same glasses.
      for (const side of technique.shared?.includes(key) ? ['reference', 'chosen'] : ['chosen']) changeSetting(side, key, value);
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
function nameSides() {
  for (const [side, id] of [['reference', 'left-name'], ['chosen', 'right-name']]) {
    const { sides, table } = page.settings;
    const words = table
      .filter(({ key }) => key !== 'gaze' && page.settings.changed(side, key))
      .map(({ key }) => `${key} ${sides[side][key]}`);
    $(id).textContent = words.join(', ') || 'every pixel, every light';
  }
}

export function wireChooser() {
  for (const technique of page.techniques) {
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
    const count = page.techniques.length;
    const next = (page.techniques.indexOf(page.technique) + step + count) % count;
    useTechnique(page.techniques[next]);
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
}
