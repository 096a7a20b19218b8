// The page in a browser that has WebGL 2 alone: less is drawn, and it is said.

import assert from 'node:assert/strict';
import { mkdirSync, mkdtempSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { footing, loseFirst, open, picture, savePicture, settled } from './browser.mjs';
import { drop, triangle } from './files.mjs';
import { difference, flip, redPixels } from './native.mjs';

const SHOTS = fileURLToPath(new URL('../../out/web', import.meta.url));
const SMALL = { width: 1000, height: 420 };

let site;
before(async () => {
  mkdirSync(SHOTS, { recursive: true });
  site = await open('webgl2');
});
after(() => site.close());

const shot = (page, name) => page.screenshot({ path: join(SHOTS, `reduced-${name}.png`) });
const costs = (page) => page.evaluate(() => window.foveal.costs);

test('the page draws with WebGL 2 and says what is missing', async () => {
  const { page, said } = await site.visit('#scene=demo:1000&scale=0.5');
  await settled(page);
  assert.match(await page.locator('#adapter').textContent(), /WebGL 2/);
  const notice = await page.locator('#reduced').textContent();
  for (const word of ['no WebGPU', 'reduced', 'coarse shading', 'anti-aliasing', 'variable shading']) assert.ok(notice.includes(word), notice);
  const offered = await page.locator('#techniques button').evaluateAll((all) => all.map((b) => b.dataset.key));
  assert.deepEqual(offered, ['culling', 'stereo']);
  const keys = await page.evaluate(() => window.foveal.settings.table.map(({ key }) => key));
  assert.ok(keys.includes('stereo') && !keys.includes('aa') && !keys.includes('shading'));
  const { reference, chosen } = await costs(page);
  assert.ok(chosen.objects_occluded > 0 && chosen.objects_visible < reference.objects_visible);
  const [left, right] = [await picture(page, false), await picture(page, true)];
  assert.ok(left.bytes.equals(right.bytes), 'culling changes no pixel');
  console.log(await footing(page));
  await shot(page, 'desktop');
  assert.deepEqual(said, []);
  await page.context().close();
});

/** Holds WebGL 2 to WebGPU where a link asks for `settings`; tells the FLIP of WebGL 2 where it asks for `plain` ones, if any. */
async function flipToWebGpu(t, name, settings, plain = null) {
  const full = await open('webgpu');
  t.after(() => full.close());
  const folder = mkdtempSync(join(tmpdir(), 'foveal-web-'));
  const files = [];
  for (const [kind, where, link] of [['webgl2', site, settings], ['webgpu', full, settings], ['plain', site, plain]].filter(([, , link]) => link)) {
    const { page, said } = await where.visit(`#technique=culling&left.anisotropy=1&split=1&${link}`, { width: 848, height: 270 });
    files.push(join(folder, `${kind}.png`));
    await savePicture(page, false, files.at(-1));
    await shot(page, `${name}-${kind}`);
    const { names } = await page.evaluate(() => window.foveal.settings.table.find(({ key }) => key === 'shadows'));
    assert.equal(names.includes('contact'), kind === 'webgpu');
    assert.deepEqual(said, []);
    await page.context().close();
  }
  const error = flip(files[0], files[1]);
  const without = plain ? flip(files[2], files[1]) : null;
  console.log(`FLIP of WebGL 2 to WebGPU, ${name}: ${error}, plain: ${without}`);
  assert.ok(error < 0.01, `FLIP to WebGPU is ${error}`);
  return without;
}

test('the picture is that of WebGPU', async (t) => {
  await flipToWebGpu(t, 'demo', 'scene=demo:1000&scale=1');
});

test('shadows are those of WebGPU', async (t) => {
  const cornell = 'scene=cornell&scale=0.5&left.shadows=';
  assert.ok(await flipToWebGpu(t, 'shadows', `${cornell}soft`, `${cornell}off`) > 0.05);
});

test('clear coat, sheen, glass and ambient occlusion are those of WebGPU', async (t) => {
  const lobes = 'scene=lobes&scale=0.5&left.environment=sky&left.ambient-occlusion=';
  assert.ok(await flipToWebGpu(t, 'lobes', `${lobes}screen`, `${lobes}off`) > 0.003);
});

test('the last picture stays while one of another size is drawn, and where that fails', async () => {
  const { page, said } = await site.visit('#scene=cornell&scale=0.25&technique=culling', SMALL);
  await settled(page);
  // Of what the screen shows there; a canvas that was cleared is black.
  const brightness = async () => {
    const png = await page.locator('#picture').screenshot();
    return page.evaluate(async (text) => {
      const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${text}`)).blob());
      const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
      context.drawImage(bitmap, 0, 0);
      const { data } = context.getImageData(bitmap.width / 4, bitmap.height / 2, bitmap.width / 8, 20);
      return data.reduce((sum, v, i) => sum + (i % 4 === 3 ? 0 : v), 0) / data.length;
    }, png.toString('base64'));
  };
  const before = await brightness();
  await page.evaluate(() => { window.foveal.viewer.draw = async () => { throw 'a test'; }; });
  await page.setViewportSize({ width: SMALL.width + 100, height: SMALL.height });
  await page.locator('.message').waitFor();
  assert.ok((await brightness()) > 0.5 * before, `${await brightness()} of ${before}`);
  assert.deepEqual(said, []);
  await page.context().close();
});

test('both eyes in one submission, by discarding, give the picture of two passes', async () => {
  const { page, said } = await site.visit('#scene=demo:1000&technique=stereo&scale=0.5', SMALL);
  for (const show of ['side-by-side', 'anaglyph', 'anaglyph-dubois']) {
    await page.locator('#quick-show').selectOption(show);
    const [left, right] = [await picture(page, false), await picture(page, true)];
    const { reference, chosen } = await costs(page);
    assert.equal(reference.draws, 2 * chosen.draws);
    assert.equal(chosen.stereo.mode, 'instanced-discard');
    assert.ok(difference(left, right) < 0.01, `${show}: ${difference(left, right)}`);
    assert.equal(await page.locator('.message').count(), 0, await page.locator('#messages').textContent());
    let coloured = 0;
    for (let i = 0; i < right.bytes.length; i += 4) coloured += Number(Math.abs(right.bytes[i] - right.bytes[i + 1]) > 40);
    assert.ok(coloured > 500, `${show}: ${coloured} coloured pixels`);
    await shot(page, show);
  }
  assert.deepEqual(said, []);
  await page.context().close();
});

test('a dropped .glb is shown, a broken one is named, and a link may ask for too much', async () => {
  const { page, said } = await site.visit('#scene=cornell&scale=0.25', SMALL);
  await settled(page);
  await drop(page, 'triangle.glb', triangle());
  await page.waitForFunction(() => document.getElementById('scene').value === 'triangle.glb');
  const red = redPixels(await picture(page, false));
  assert.ok(red > 200, `${red} red pixels`);
  await drop(page, 'broken.glb', triangle().subarray(0, 60));
  await page.locator('.message').waitFor();
  assert.match(await page.locator('.message').textContent(), /broken\.glb/);
  assert.equal(await page.locator('#scene').inputValue(), 'triangle.glb');
  assert.deepEqual(said, []);
  const odd = await site.visit('#scene=cornell&scale=0.25&right.shading=coarse', SMALL);
  await settled(odd.page);
  assert.match(await odd.page.locator('#messages').textContent(), /right\.shading=coarse/);
  for (const p of [page, odd.page]) await p.context().close();
});

test('a lost device and a lost context are opened again', async () => {
  const { page } = await site.visit('#scene=cornell&scale=0.25', SMALL);
  const first = await picture(page);
  for (const lose of [
    () => { window.foveal.viewer.lose_device(); window.foveal.stale = true; },
    () => document.getElementById('picture').getContext('webgl2').getExtension('WEBGL_lose_context').loseContext(),
  ]) {
    await page.evaluate(lose);
    await page.locator('.message').waitFor();
    assert.match(await page.locator('.message').textContent(), /lost/i);
    assert.ok((await picture(page)).bytes.equals(first.bytes));
    await page.locator('.message button').click();
  }
  await page.context().close();
});

test('a link\'s scene is shown where the device is lost while it loads', async () => {
  const { page } = await site.visit('#scene=cornell&scale=0.25', SMALL, loseFirst);
  await page.waitForFunction(() => window.foveal.home);
  assert.match(await page.locator('.message').textContent(), /lost/i);
  await settled(page);
  assert.deepEqual(await page.evaluate(() => [window.foveal.scene.name, window.foveal.camera.touched]), ['cornell', false]);
  await page.context().close();
});

test('a context that is lost while a picture is saved is opened again', async () => {
  const { page, said } = await site.visit('#scene=cornell&scale=0.25', SMALL);
  const first = await picture(page);
  // Nobody tells wgpu that the context is gone.
  await page.evaluate(() => { window.foveal.viewer.picture = () => new Promise(() => {}); });
  await page.locator('#save').click();
  await page.evaluate(() => document.getElementById('picture').getContext('webgl2').getExtension('WEBGL_lose_context').loseContext());
  await page.locator('.message').waitFor();
  assert.match(await page.locator('.message').textContent(), /lost/i);
  assert.ok((await picture(page)).bytes.equals(first.bytes));
  assert.deepEqual(said, []);
  await page.context().close();
});

test('a browser that has WebGPU draws with WebGL 2 where the link asks for it', async (t) => {
  const full = await open('webgpu');
  t.after(() => full.close());
  const { page } = await full.visit('#backend=webgl2&scene=cornell&scale=0.25', { width: 390, height: 844 });
  await settled(page);
  assert.match(await page.locator('#adapter').textContent(), /WebGL 2/);
  // The address follows within half a second.
  await page.waitForTimeout(1000);
  assert.match(await page.evaluate(() => location.hash), /backend=webgl2/);
  await shot(page, 'phone');
  await page.context().close();
});
