// Settings in links without a browser: `node --test web/tests/settings.test.mjs`.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Settings } from '../page/settings.js';

const TABLE = [
  { key: 'aa', kind: 'choice', names: ['none', 'msaa'] },
  { key: 'culling', kind: 'choice', names: ['auto', 'off'] },
  { key: 'samples', kind: 'integer', least: 1, most: 16 },
  { key: 'gaze', kind: 'place' },
];
const DEFAULTS = { aa: 'none', culling: 'auto', samples: 4, gaze: [0.5, 0.5] };
const TECHNIQUE = { reference: { culling: 'off' }, chosen: { aa: 'msaa', gaze: [0.2, 0.2] } };

/** Both sides of a page that is opened with the link of another, and that link. */
function reopened(changes) {
  const settings = new Settings(DEFAULTS, TABLE);
  settings.use(TECHNIQUE);
  for (const change of changes) settings.set(...change);
  const link = new URLSearchParams();
  settings.write(link);
  const again = new Settings(DEFAULTS, TABLE);
  again.use(TECHNIQUE);
  assert.deepEqual(again.read(new URLSearchParams(link.toString())), []);
  assert.deepEqual(again.sides, settings.sides);
  return link;
}

test('a link holds what is set back to the default', () => {
  const link = reopened([['chosen', 'aa', 'none'], ['chosen', 'gaze', [0.5, 0.5]], ['reference', 'culling', 'auto']]);
  assert.equal(link.get('right.aa'), 'none');
});

test('a link holds what is changed, and nothing that is the default', () => {
  const link = reopened([['chosen', 'samples', 9], ['reference', 'gaze', [0.1, 0.9]]]);
  assert.equal(link.get('right.samples'), '9');
  assert.equal(link.get('left.gaze'), '0.1,0.9');
  for (const name of ['left.samples', 'left.aa', 'right.culling']) assert.equal(link.has(name), false, name);
  // A link's meaning does not hang on what a later page's technique sets.
  assert.equal(link.get('right.aa'), 'msaa');
});

test('a number that no control can be set to is not read', () => {
  for (const [text, unread] of [['16', []], ['17', ['right.samples=17']], ['-5', ['right.samples=-5']], ['4.5', ['right.samples=4.5']]]) {
    const settings = new Settings(DEFAULTS, TABLE);
    assert.deepEqual(settings.read(new URLSearchParams({ 'right.samples': text })), unread);
    assert.equal(settings.sides.chosen.samples, unread.length ? 4 : 16);
  }
});
