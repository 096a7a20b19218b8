// Files that are given together, and those that cannot be shown, in a real browser.

import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { open, picture, settled } from './browser.mjs';
import { triangle } from './files.mjs';
import { redPixels } from './native.mjs';

const SMALL = { width: 1000, height: 300 };

let site;
before(async () => { site = await open(); });
after(() => site.close());

/** The triangle as a .gltf that names its buffer. */
function apart() {
  const glb = triangle();
  const length = glb.readUInt32LE(12);
  const json = JSON.parse(glb.subarray(20, 20 + length));
  json.buffers[0].uri = 'data/the%20triangle.bin';
  return [Buffer.from(JSON.stringify(json)), glb.subarray(glb.length - 36)];
}

/** Opens files by the button. */
const choose = (page, files) => page.locator('#file').setInputFiles(files.map(([name, buffer]) => ({ name, buffer, mimeType: 'application/octet-stream' })));

test('a .gltf is shown with the files that it names, and without them says which is missing', async () => {
  const { page, said } = await site.visit('#scene=cornell&scale=0.25&technique=culling', SMALL);
  await settled(page);
  const [gltf, bin] = apart();
  await choose(page, [['apart.gltf', gltf]]);
  await page.locator('.message').waitFor();
  assert.match(await page.locator('.message').textContent(), /apart\.gltf.*"data\/the triangle\.bin" lies beside the file.*give both at once/);
  assert.equal(await page.locator('#scene').inputValue(), 'cornell');
  await page.locator('.message button').click();
  await choose(page, [['the triangle.bin', bin], ['apart.gltf', gltf]]);
  await page.waitForFunction(() => document.getElementById('scene').value === 'apart.gltf');
  const red = redPixels(await picture(page, false));
  assert.ok(red > 100, `${red} red pixels`);
  // From the list, and on another device, too.
  await page.locator('#scene').selectOption('cornell');
  await page.waitForFunction(() => window.foveal.scene.name === 'cornell');
  await page.locator('#scene').selectOption('apart.gltf');
  await page.waitForFunction(() => window.foveal.scene.name === 'apart.gltf');
  await settled(page);
  await page.evaluate(() => { window.foveal.viewer.lose_device(); window.foveal.stale = true; });
  await page.locator('.message').waitFor();
  assert.equal(redPixels(await picture(page, false)), red);
  assert.deepEqual(said, []);
  await page.context().close();
});

/** Drops a folder, as the browser tells of one; `content` holds bytes by paths. */
const dropFolder = (page, folder, content) => page.evaluate(({ folder, content }) => {
  const entry = (path, inside) => (typeof inside === 'string'
    ? { isFile: true, isDirectory: false, fullPath: path, file: (done) => done(new File([Uint8Array.from(atob(inside), (c) => c.charCodeAt(0))], path.split('/').at(-1))) }
    : {
      isFile: false,
      isDirectory: true,
      fullPath: path,
      createReader() {
        // One at a time, as readers may.
        const left = Object.entries(inside).map(([name, within]) => entry(`${path}/${name}`, within));
        return { readEntries: (done) => done(left.splice(0, 1)) };
      },
    });
  const event = new DragEvent('drop', { bubbles: true, cancelable: true });
  const items = [{ kind: 'file', webkitGetAsEntry: () => entry(`/${folder}`, content) }];
  Object.defineProperty(event, 'dataTransfer', { value: { items, files: [] } });
  dispatchEvent(event);
}, { folder, content });

test('a dropped folder shows its scene, with files of one name in two folders', async () => {
  const { page, said } = await site.visit('#scene=cornell&scale=0.25&technique=culling', SMALL);
  await settled(page);
  const text = (bytes) => bytes.toString('base64');
  const [gltf, bin] = apart();
  const wrong = { 'apart.gltf': text(Buffer.from('{}')), 'the triangle.bin': text(Buffer.alloc(36)) };
  await dropFolder(page, 'model', { 'read me.txt': '', older: wrong, 'apart.gltf': text(gltf), data: { 'the triangle.bin': text(bin) } });
  await page.waitForFunction(() => document.getElementById('scene').value === 'apart.gltf');
  const red = redPixels(await picture(page, false));
  assert.ok(red > 100, `${red} red pixels`);
  // Up and down again.
  const json = JSON.parse(gltf);
  json.buffers[0].uri = '../data/the%20triangle.bin';
  await dropFolder(page, 'model', { gltf: { 'up.gltf': text(Buffer.from(JSON.stringify(json))) }, data: { 'the triangle.bin': text(bin) } });
  await page.waitForFunction(() => document.getElementById('scene').value === 'up.gltf');
  await dropFolder(page, 'pictures', { 'a.png': '' });
  await page.locator('.message').waitFor();
  assert.match(await page.locator('.message').textContent(), /no \.glb and no \.gltf in it/);
  assert.equal(await page.locator('#scene').inputValue(), 'up.gltf');
  assert.deepEqual(said, []);
  await page.context().close();
});

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
