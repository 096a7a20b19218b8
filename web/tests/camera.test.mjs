// The camera without a browser: `node --test web/tests/camera.test.mjs`.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Camera } from '../page/camera.js';

const still = () => new Camera({ addEventListener() {} }, () => {});

function assertNear(a, b, most = 1e-6) {
  a.forEach((v, i) => assert.ok(Math.abs(v - b[i]) < most, `${a} is not ${b}`));
}

function normal(v) {
  const length = Math.hypot(...v);
  return v.map((c) => c / length);
}

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

test('cameras that look straight down or lean stay as they are', () => {
  const camera = still();
  for (const [forward, up] of [
    [[0, -1, 0], [0, 0, -1]],
    [[0, -1, 0], normal([0.6, 0, 0.8])],
    [[0, 1, 0], [1, 0, 0]],
    [[0, 0, -1], [1, 0, 0]],
    [normal([0.5, -0.7, 1]), null],
  ]) {
    // At a right angle to the view, leaning.
    const upwards = up ?? normal(cross(normal(cross(forward, [0.3, 1, 0.2])), forward));
    const eye = [1, 2, 3];
    camera.reset({ eye, target: eye.map((e, i) => e + 2 * forward[i]), up: upwards, fov_y_deg: 50, near_m: 0.1 }, 1);
    const place = camera.place();
    assertNear(place.target.map((t, i) => (t - eye[i]) / 2), forward);
    assertNear(place.up, upwards);
    // To the right in the picture.
    camera.move(1, 0, 0);
    assertNear(camera.place().eye.map((e, i) => e - eye[i]), cross(forward, upwards));
  }
});

test('a camera turns as the picture leans, and looks up from straight down', () => {
  const camera = still();
  const place = { eye: [0, 0, 0], target: [0, 0, -1], up: [1, 0, 0], fov_y_deg: 50, near_m: 0.1 };
  camera.reset(place, 1);
  camera.turn(0, 0.2);
  assertNear(camera.place().target, [Math.sin(0.2), 0, -Math.cos(0.2)]);
  camera.reset({ ...place, target: [0, -1, 0] }, 1);
  camera.turn(0, Math.PI / 2);
  assertNear(camera.place().target, [1, 0, 0]);
  assertNear(camera.place().up, [0, 1, 0]);
});

test('a camera without a direction upwards does not lean, wherever it looks', () => {
  const camera = still();
  for (const [target, up] of [[[0, 0, -3], [0, 1, 0]], [[0, -3, 0], [0, 0, -1]], [[3, 0, 0], [0, 1, 0]]]) {
    camera.reset({ eye: [0, 0, 0], target, fov_y_deg: 50, near_m: 0.1 }, 1);
    assertNear(camera.place().up, up);
    assertNear(camera.place().target, target);
  }
});

test('rounded numbers lean no camera', () => {
  const camera = still();
  camera.reset({ eye: [0, 0, 0], target: [1, -0.5, -2], fov_y_deg: 50, near_m: 0.1 }, 1);
  const rounded = camera.place().up.map((v) => Number(v.toFixed(4)));
  camera.reset({ ...camera.place(), up: rounded }, 1);
  assert.equal(camera.roll, 0);
});

test('a scene\'s field of view and near plane stay while the camera moves', () => {
  const camera = still();
  assert.equal(camera.place().near_m, 0.05);
  camera.reset({ eye: [0, 0, 0.03], target: [0, 0, 0], fov_y_deg: 33, near_m: 0.00006 }, 0.01);
  camera.move(0.001, 0, 0.01);
  camera.turn(0.1, 0);
  const { fov_y_deg, near_m } = camera.place();
  assert.deepEqual([fov_y_deg, near_m], [33, 0.00006]);
});

test('a button that was let go unseen turns the camera no further', () => {
  const heard = {};
  const canvas = { addEventListener: (type, does) => { heard[type] = does; }, setPointerCapture() {}, clientHeight: 100 };
  const camera = new Camera(canvas, () => {});
  const pointer = (type, clientX, buttons) => heard[type]({ pointerId: 1, clientX, clientY: 0, buttons });
  pointer('pointerdown', 0, 2);
  pointer('pointermove', 10, 2);
  const turned = camera.yaw;
  assert.notEqual(turned, 0);
  pointer('pointermove', 30, 0);
  pointer('pointermove', 50, 1);
  assert.equal(camera.yaw, turned);
});
