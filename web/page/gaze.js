// Where an eye looks: the gaze as settings have it, from a place in the picture.

/** Ways to show two eyes that put their pictures side by side. */
const BESIDE = ['side-by-side', 'side-by-side-half', 'headset'];

/**
 * The gaze in the left eye's picture for a place in the whole one, both as fractions from the top left. In the right eye's
 * picture it is the place that the right eye's gaze is at then. The bend of a headset's lens is left out.
 */
export function gazeAt([x, y], settings) {
  const isBeside = settings.stereo !== 'off' && BESIDE.includes(settings.show);
  const eye = isBeside && x >= 0.5 ? 1 : 0;
  const place = isBeside ? [2 * x - eye, y] : [x, y];
  return place.map((v, axis) => Math.round((v - eye * settings['gaze-shift'][axis]) * 1000) / 1000);
}
