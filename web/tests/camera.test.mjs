// The camera without a browser: `node --test web/tests/camera.test.mjs`.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Camera } from '../page/camera.js';

test('a scene\'s field of view and near plane stay while the camera moves', () => {
  const camera = new Camera({ addEventListener() {} }, () => {});
  assert.equal(camera.place().near_m, 0.05);
  camera.reset({ eye: [0, 0, 0.03], target: [0, 0, 0], fov_y_deg: 33, near_m: 0.00006 }, 0.01);
  camera.move(0.001, 0, 0.01);
  camera.turn(0.1, 0);
  const { fov_y_deg, near_m } = camera.place();
  assert.deepEqual([fov_y_deg, near_m], [33, 0.00006]);
});
