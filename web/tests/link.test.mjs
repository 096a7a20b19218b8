// Links in a real browser: what the address holds, and what comes of another address.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { loseFirst, open, picture, settled } from './browser.mjs';
import { drop, triangle } from './files.mjs';
import { difference } from './native.mjs';

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

test('another address in the open page is followed, and the way back too', async () => {
  const { page, said } = await site.visit('#scene=cornell&technique=culling&scale=0.25', SMALL);
  await settled(page);
  await page.evaluate(() => { window.foveal.scene.mark = true; });
  await page.locator('#picture').focus();
  await page.keyboard.press('ArrowLeft');
  const own = await written(page);
  assert.ok(own.has('eye'));
  // What the page writes itself loads nothing.
  assert.ok(await page.evaluate(() => window.foveal.scene.mark));
  await page.evaluate(() => { location.hash = '#scene=demo:1000&technique=msaa&right.samples=9&split=0.25&eye=0,1,2&target=0,1,0'; });
  await page.waitForFunction(() => window.foveal.scene.name === 'demo:1000');
  const link = await written(page);
  const { samples, split, eye, scale } = await page.evaluate(() => {
    const { settings, camera, ...page } = window.foveal;
    return { samples: settings.sides.chosen.samples, split: page.split, eye: camera.place().eye, scale: page.scale };
  });
  assert.deepEqual([samples, split, eye, scale], [9, 0.25, [0, 1, 2], 'auto']);
  assert.deepEqual(['scene', 'right.samples', 'split', 'eye'].map((name) => link.get(name)), ['demo:1000', '9', '0.250', '0.0000,1.0000,2.0000']);
  assert.equal(await page.locator('#techniques [aria-checked="true"]').getAttribute('data-key'), 'msaa');
  assert.deepEqual([await page.locator('#scale').inputValue(), await page.locator('#split').inputValue()], ['auto', '250']);
  await page.goBack();
  await page.waitForFunction(() => window.foveal.scene.name === 'cornell');
  assert.equal(String(await written(page)), String(own));
  assert.equal(await page.evaluate(() => window.foveal.loads), 1);
  assert.deepEqual(said, []);
  await page.context().close();
});

test('an address that names no scene of the page\'s keeps the scene, and says so', async () => {
  const { page, said } = await site.visit('#scene=cornell&technique=culling&scale=0.25', SMALL);
  await settled(page);
  await page.evaluate(() => { location.hash = '#scene=nowhere&technique=msaa&scale=0.25'; });
  await page.locator('.message').waitFor();
  assert.match(await page.locator('.message').textContent(), /nowhere/);
  const link = await written(page);
  assert.deepEqual([link.get('scene'), link.get('technique')], ['cornell', 'msaa']);
  // An empty one asks for nothing.
  await page.evaluate(() => { location.hash = ''; });
  await page.locator('#picture').focus();
  await page.keyboard.press('ArrowLeft');
  assert.equal((await written(page)).get('technique'), 'msaa');
  assert.deepEqual(said, []);
  await page.context().close();
});

test('a page that is opened with a scene that it does not have shows the demo scene', async () => {
  const { page } = await site.visit('#scene=nowhere&technique=culling&scale=0.25', SMALL);
  await page.waitForFunction(() => window.foveal.home);
  assert.match(await page.locator('.message').textContent(), /nowhere/);
  const link = await written(page);
  assert.deepEqual([link.get('scene'), link.get('technique'), link.has('eye')], ['demo', 'culling', false]);
  await page.context().close();
});

test('a link\'s scene is shown in its place where the device is lost while it loads', async () => {
  for (const place of ['', '&eye=0,1,2&target=0,1,0']) {
    const link = `#scene=cornell&technique=culling&scale=0.25${place}`;
    const visits = [await site.visit(link, SMALL), await site.visit(link, SMALL, loseFirst)];
    const [whole, lost] = visits.map(({ page }) => page);
    await lost.locator('.message').waitFor();
    assert.match(await lost.locator('.message').textContent(), /lost/i);
    await lost.waitForFunction(() => window.foveal.home);
    assert.ok((await picture(lost)).bytes.equals((await picture(whole)).bytes));
    assert.equal(String(await written(lost)), String(await written(whole)));
    for (const page of [whole, lost]) await page.context().close();
  }
});

test('an address that asks for the reduced renderer loads it', async () => {
  const { page } = await site.visit('#scene=cornell&scale=0.25', SMALL);
  await settled(page);
  await page.evaluate(() => { location.hash = '#backend=webgl2&scene=cornell&scale=0.25'; });
  await page.waitForFunction(() => document.getElementById('adapter').textContent.includes('WebGL 2'));
  assert.equal((await written(page)).get('backend'), 'webgl2');
  await page.context().close();
});

test('a link holds which way is up where the camera looks straight down', async () => {
  const pictures = [];
  for (const up of ['0.6000,0.0000,0.8000', '-0.6000,0.0000,-0.8000']) {
    const { page, said } = await site.visit(`#scene=cornell&technique=culling&scale=0.25&eye=0,0.9,0&target=0,0,0&up=${up}`, SMALL);
    pictures.push(await picture(page));
    const link = await written(page);
    assert.deepEqual(['target', 'up'].map((name) => link.get(name).replaceAll('-0.0000', '0.0000')), ['0.0000,0.0000,0.0000', up]);
    assert.deepEqual(said, []);
    await page.context().close();
  }
  // Half a turn apart.
  const [first, second] = pictures;
  const turned = { ...first, bytes: Buffer.from(new Uint32Array(new Uint8Array(first.bytes).buffer).reverse().buffer) };
  assert.ok(difference(first, second) > 10, `${difference(first, second)}`);
  assert.ok(difference(turned, second) < 1, `${difference(turned, second)}`);
});

test('what a link says and the page does not know is named, and the rest is shown', async () => {
  const unknown = ['technique=magic', 'split=2', 'scale=7', 'eye=1,2', 'middle.shadows=soft', 'left.magic=1', 'magic=1'];
  const { page, said } = await site.visit(`#scene=cornell&right.shadows=soft&${unknown.join('&')}`, SMALL);
  await settled(page);
  const message = await page.locator('.message').textContent();
  for (const word of unknown) assert.ok(message.includes(word), `${word}: ${message}`);
  const shown = await page.evaluate(() => [window.foveal.scene.name, window.foveal.settings.sides.chosen.shadows, window.foveal.technique.key, window.foveal.split]);
  assert.deepEqual(shown, ['cornell', 'soft', await page.evaluate(() => window.foveal.techniques[0].key), 0.5]);
  await page.locator('.message button').click();
  await page.evaluate(() => { location.hash = '#scene=cornell&backend=webgpu&technique=culling&split=0&scale=0.25&eye=0,1,3&target=0,1,0&up=0,1,0'; });
  await page.waitForFunction(() => window.foveal.technique.key === 'culling');
  await settled(page);
  assert.equal(await page.locator('.message').count(), 0);
  assert.deepEqual(said, []);
  await page.context().close();
});
