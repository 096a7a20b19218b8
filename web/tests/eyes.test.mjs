// How two eyes share the picture, without a browser: `node --test web/tests/eyes.test.mjs`.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { cutAt, pictureSize } from '../page/eyes.js';

const eye = { stereo: 'off', show: 'side-by-side' };
const both = (show) => ({ stereo: 'instanced', show });

test('a picture has the pixels of its box, an even width where each eye has half of it', () => {
  const width = (sides, ratio = 1) => pictureSize({ width: 913, height: 40 }, ratio, sides).width;
  for (const side of [eye, both('flat'), both('anaglyph'), both('side-by-side-half')]) {
    assert.equal(width({ reference: eye, chosen: side }), 913, side.show);
  }
  for (const show of ['side-by-side', 'headset']) {
    assert.equal(width({ reference: eye, chosen: both(show) }), 914, show);
    assert.equal(width({ reference: both(show), chosen: eye }, 0.5), 456, show);
  }
  assert.deepEqual(pictureSize({ width: 3, height: 40 }, 1, { eye }), { width: 16, height: 40 });
});

test('the right eye begins after the left one, which has the odd column', () => {
  assert.equal(cutAt(both('side-by-side-half'), 913), 457 / 913);
  assert.equal(cutAt(both('side-by-side'), 914), 0.5);
  for (const settings of [eye, both('flat')]) assert.equal(cutAt(settings, 913), 1);
});
