// Scenes of files in a real browser.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { open, settled } from './browser.mjs';

const SMALL = { width: 1000, height: 300 };

let site;
before(async () => { site = await open(); });
after(() => site.close());

/** Opens files by the button. */
const choose = (page, files) => page.locator('#file').setInputFiles(files.map(([name, buffer]) => ({ name, buffer, mimeType: 'application/octet-stream' })));

test('a scene without geometry is shown, and its camera moves', async () => {
  const { page, said } = await site.visit('#scene=cornell&scale=0.25&technique=culling', SMALL);
  await settled(page);
  await choose(page, [['empty.gltf', Buffer.from('{"asset":{"version":"2.0"}}')]]);
  await page.waitForFunction(() => document.getElementById('scene').value === 'empty.gltf');
  await settled(page);
  const { pace, distance } = await page.evaluate(() => window.foveal.camera);
  assert.ok(pace > 0 && distance > 1, `${pace} ${distance}`);
  assert.deepEqual(said, []);
  await page.context().close();
});

test('what comes from a file that a page cannot name is not offered', async () => {
  const { page } = await site.visit('#scene=cornell&scale=0.25&technique=culling&right.environment=image', SMALL);
  await page.locator('.message').waitFor();
  assert.match(await page.locator('.message').textContent(), /right\.environment=image/);
  const offered = await page.evaluate(() => window.foveal.settings.table.flatMap(({ names }) => names));
  assert.ok(offered.includes('sky') && !offered.includes('image'), String(offered));
  await page.context().close();
});
