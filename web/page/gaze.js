// Where an eye looks: the gaze as settings have it, from a place in the picture.

import { cutAt } from './eyes.js';

/**
 * The gaze in the left eye's picture for a place in the whole one, which is `width` pixels wide, both as fractions from the
 * top left. In the right eye's picture it is the place that the right eye's gaze is at then. The bend of a headset's lens is
 * left out.
 */
export function gazeAt([x, y], settings, width) {
  const cut = cutAt(settings, width);
  const isBeside = cut < 1;
  const eye = isBeside && x >= cut ? 1 : 0;
  const place = isBeside ? [2 * (x - eye * cut), y] : [x, y];
  return place.map((v, axis) => Math.round((v - eye * settings['gaze-shift'][axis]) * 1000) / 1000);
}
