// Links in a real browser: what the address holds, and what comes of another address.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { open, settled } from './browser.mjs';
import { drop, triangle } from './files.mjs';

const SMALL = { width: 600, height: 300 };

let site;
before(async () => { site = await open(); });
after(() => site.close());

/** What the address holds, once it has followed. */
async function written(page) {
  await settled(page);
  // Within half a second.
  await page.waitForTimeout(1000);
  return new URLSearchParams((await page.evaluate(() => location.hash)).slice(1));
}

test('a link names no place in a file that it cannot hold', async () => {
  const { page, said } = await site.visit('#scene=cornell&scale=0.25&eye=0,1,2&target=0,1,0', SMALL);
  assert.equal((await written(page)).get('eye'), '0.0000,1.0000,2.0000');
  await drop(page, 'triangle.glb', triangle());
  await page.waitForFunction(() => document.getElementById('scene').value === 'triangle.glb');
  await page.locator('#picture').focus();
  await page.keyboard.press('ArrowLeft');
  const link = await written(page);
  assert.deepEqual(['scene', 'eye', 'target'].map((name) => link.has(name)), [false, false, false], String(link));
  assert.deepEqual(said, []);
  await page.context().close();
});
