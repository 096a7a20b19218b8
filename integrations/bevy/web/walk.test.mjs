// The walk in a browser that has WebGL 2 alone.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { open } from '../../../web/tests/browser.mjs';

const PAGE = fileURLToPath(new URL('../target/page', import.meta.url));
const FRAMES = 20;
/** Two walks of frames that take a processor a second each. */
const PATIENCE = 600_000;

let site;
before(async () => {
  site = await open('webgl2', PAGE);
});
after(() => site?.close());

/** The page, once all is loaded and compiled: before, nothing is hidden. */
async function opened() {
  const { page, said } = await site.visit();
  page.setDefaultTimeout(PATIENCE);
  await page.waitForFunction(() => JSON.parse(window.house?.stats() || '{}').meshes_hidden > 0);
  return { page, said };
}

async function compared(samples) {
  const { page, said } = await opened();
  await page.evaluate(([frames, samples]) => window.house.compare(frames, samples), [FRAMES, samples]);
  await page.waitForFunction(() => window.house.comparison());
  const found = JSON.parse(await page.evaluate(() => window.house.comparison()));
  console.log(`${samples} samples a pixel: ${JSON.stringify(found)}`);
  assert.deepEqual(said, [], 'the console is without errors');
  await page.context().close();
  return found;
}

test('a culled walk shows the same pictures', async () => {
  const { frames, missing, differ, moved, culled } = await compared(1);
  assert.equal(frames, FRAMES);
  assert.equal(missing, 0);
  assert.equal(moved, FRAMES - 1, 'each frame shows something else than the one before');
  assert.ok(culled.meshes_hidden > 0 && culled.meshes_hidden < culled.meshes);
  assert.ok(culled.casters_hidden + culled.casters_unseen > 0);
  assert.equal(culled.refused_views, 0);
  assert.equal(differ, 0, 'culling changes no pixel');
});

test('the page switches culling off and on', async () => {
  const { page, said } = await opened();
  await page.locator('#culling').uncheck();
  await page.waitForFunction(() => JSON.parse(window.house.stats()).meshes === 0);
  await page.locator('#culling').check();
  await page.waitForFunction(() => JSON.parse(window.house.stats()).meshes_hidden > 0);
  assert.match(await page.locator('#said').textContent(), /meshes hidden/);
  assert.deepEqual(said, []);
  await page.context().close();
});
