// The automatic resolution without a browser: `node --test web/tests/resolution.test.mjs`.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Resolution } from '../page/resolution.js';

const scales = (resolution, times) => times.map((ms) => {
  resolution.adapt(ms);
  return resolution.scale;
});

test('frames in which pipelines are compiled do not lower the resolution', () => {
  // Of variable shading on a processor, with more shaders from its second frame on.
  assert.deepEqual(scales(new Resolution(), [3225, 589, 116, 114, 114]), [1, 1, 1, 1, 1]);
  // A slider of what is compiled into the shaders.
  const resolution = new Resolution();
  for (let i = 0; i < 10; i++) {
    resolution.changed();
    assert.deepEqual(scales(resolution, [1000]), [1]);
  }
});

test('the resolution falls while frames stay slow, to a quarter, and rises where there is time', () => {
  const times = [300, 300, 300, 300, 300, 100, 300, 100, 30, 30, 30];
  assert.deepEqual(scales(new Resolution(), times), [1, 1, 0.5, 0.25, 0.25, 0.25, 0.25, 0.25, 0.5, 1, 1]);
});

test('a frame tells whether the next one has another size', () => {
  const resolution = new Resolution();
  assert.deepEqual([300, 300, 300, 300, 300, 100, 30, 30, 30].map((ms) => resolution.adapt(ms)), [false, false, true, true, false, false, true, true, false]);
});
