// What a visitor does by hand: touch, keys, buttons, files; and what becomes of it where a device is lost.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { open, picture, settled } from './browser.mjs';

const SMALL = { width: 1000, height: 300 };

let site;
before(async () => { site = await open(); });
after(() => site.close());

test('a picture has every pixel of a box of odd width', async () => {
  const { page, said } = await site.visit('#scene=cornell&scale=1&technique=stereo', SMALL);
  const size = async () => {
    const { width } = await picture(page, true);
    return [width, await page.evaluate(() => [document.getElementById('picture').width, document.getElementById('stage').clientWidth])].flat();
  };
  assert.deepEqual(await size(), [655, 655, 655]);
  await page.locator('#quick-show').selectOption('side-by-side');
  const [, canvas] = await size();
  assert.equal(canvas, 656);
  assert.deepEqual(said, []);
  await page.context().close();
});
