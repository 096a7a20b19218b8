// The gaze without a browser: `node --test web/tests/gaze.test.mjs`.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { gazeAt } from '../page/gaze.js';

test('the gaze is a place of the left eye\'s picture', () => {
  const gaze = (show, place, stereo = 'instanced', width = 100) => gazeAt(place, { stereo, show, 'gaze-shift': [0.25, 0] }, width);
  assert.deepEqual(gaze('flat', [0.75, 0.25]), [0.75, 0.25]);
  assert.deepEqual(gaze('anaglyph', [0.75, 0.25]), [0.75, 0.25]);
  assert.deepEqual(gaze('side-by-side', [0.75, 0.25], 'off'), [0.75, 0.25]);
  for (const show of ['side-by-side', 'side-by-side-half', 'headset']) {
    assert.deepEqual(gaze(show, [0.25, 0.25]), [0.5, 0.25]);
    assert.deepEqual(gaze(show, [0.75, 0.25]), [0.25, 0.25]);
  }
  // Of five columns the left eye has three.
  assert.deepEqual(gaze('side-by-side-half', [0.5, 0.25], 'instanced', 5), [1, 0.25]);
  assert.deepEqual(gaze('side-by-side-half', [0.7, 0.25], 'instanced', 5), [-0.05, 0.25]);
});
