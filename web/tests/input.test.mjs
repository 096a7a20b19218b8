// What a visitor does by hand: touch, keys, buttons, files; and what becomes of it where a device is lost.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { inChromium, open, picture, settled } from './browser.mjs';

const SMALL = { width: 1000, height: 300 };

let site;
before(async () => { site = await open(); });
after(() => site.close());

test('a message of a setting that cannot be read comes once, and can be closed', async () => {
  const { page, said } = await site.visit('#scene=cornell&scale=0.25&technique=culling', SMALL);
  await settled(page);
  await page.evaluate(() => {
    window.messages = 0;
    new MutationObserver(() => { window.messages += 1; }).observe(document.getElementById('messages'), { childList: true });
  });
  await page.locator('#settings details', { has: page.locator('#chosen-display') }).locator('summary').click();
  await page.locator('#always').check();
  await page.locator('#chosen-display').fill('sofa');
  await page.locator('#chosen-display').press('Enter');
  await page.locator('.message').waitFor();
  assert.match(await page.locator('.message').textContent(), /sofa/);
  await page.waitForTimeout(1000);
  assert.equal(await page.evaluate(() => window.messages), 1);
  await page.locator('.message button').click();
  await page.waitForTimeout(500);
  assert.equal(await page.locator('.message').count(), 0);
  // It is said again with the next change, until it can be read.
  await page.locator('#picture').focus();
  await page.keyboard.press('ArrowLeft');
  await page.locator('.message').waitFor();
  await page.locator('#always').uncheck();
  await page.locator('#chosen-display').fill('h60');
  await page.locator('#chosen-display').press('Enter');
  await page.locator('.message button').click();
  await settled(page);
  assert.equal(await page.locator('.message').count(), 0);
  assert.deepEqual(said, []);
  await page.context().close();
});

test('a lost device keeps the keyboard where it was, and nothing of the one before', async () => {
  const { page } = await site.visit('#scene=cornell&scale=0.25&technique=culling', SMALL);
  await settled(page);
  await page.locator('#picture').focus();
  await page.evaluate(() => {
    window.before = window.foveal.viewer;
    window.before.lose_device();
    window.foveal.stale = true;
  });
  await page.locator('.message').waitFor();
  await settled(page);
  assert.equal(await page.evaluate(() => window.before.__wbg_ptr), 0);
  const eye = () => page.evaluate(() => window.foveal.camera.yaw);
  const turned = await eye();
  await page.keyboard.press('ArrowLeft');
  assert.notEqual(await eye(), turned);
  await page.context().close();
});

test('the gaze goes where a finger taps', inChromium('fingers'), async () => {
  const { page, said } = await site.visit('#scene=cornell&scale=0.25&technique=coarse', SMALL);
  await settled(page);
  const box = await page.locator('#stage').boundingBox();
  const session = await page.context().newCDPSession(page);
  const touch = (type, points) => session.send('Input.dispatchTouchEvent', { type, touchPoints: points });
  await touch('touchStart', [{ x: box.x + 0.25 * box.width, y: box.y + 0.75 * box.height }]);
  await touch('touchEnd', []);
  await page.waitForFunction(() => window.foveal.settings.sides.chosen.gaze[0] !== 0.5);
  const gaze = await page.evaluate(() => window.foveal.settings.sides.chosen.gaze);
  assert.ok(Math.abs(gaze[0] - 0.25) < 0.01 && Math.abs(gaze[1] - 0.75) < 0.01, String(gaze));
  assert.deepEqual(said, []);
  await page.context().close();
});

test('a file that is too large is refused before it is read', async () => {
  const { page, said } = await site.visit('#scene=cornell&scale=0.25&technique=culling', SMALL);
  await settled(page);
  await page.evaluate(() => {
    const mebibyte = new Blob([new Uint8Array(1 << 20)]);
    Blob.prototype.arrayBuffer = () => { throw new Error('it was read'); };
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File(Array(513).fill(mebibyte), 'huge.glb'));
    window.dispatchEvent(new DragEvent('drop', { dataTransfer, bubbles: true, cancelable: true }));
  });
  await page.locator('.message').waitFor();
  assert.match(await page.locator('.message').textContent(), /huge\.glb is too large: it has 537\.9 MB, the limit is 536\.9 MB/);
  assert.equal(await page.locator('#scene').inputValue(), 'cornell');
  assert.deepEqual(said, []);
  await page.context().close();
});

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
