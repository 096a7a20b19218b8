// How the pictures of two eyes share what is shown.

/** Ways to show both eyes side by side, each in full or at half its width. */
const IN_FULL = ['side-by-side', 'headset'];
const AT_HALF = ['side-by-side-half'];

const shows = (settings, ways) => settings.stereo !== 'off' && ways.includes(settings.show);

/** Where the right eye's picture begins, as a fraction of a width in pixels; 1 where it has no place of its own. */
export function cutAt(settings, width) {
  // Of an odd width the left eye has a column more.
  return shows(settings, [...IN_FULL, ...AT_HALF]) ? Math.ceil(width / 2) / width : 1;
}

/** Pixels to draw for a box of the page, `ratio` for each of its points. Where a side shows both eyes in full, the width is even. */
export function pictureSize(box, ratio, sides) {
  const columns = Object.values(sides).some((side) => shows(side, IN_FULL)) ? 2 : 1;
  const pixels = (points, step) => Math.max(16, step * Math.round((points * ratio) / step));
  return { width: pixels(box.width, columns), height: pixels(box.height, 1) };
}
