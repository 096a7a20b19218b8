// The page in a real browser: what a visitor does, and what must come of it.

import assert from 'node:assert/strict';
import { mkdirSync, mkdtempSync, readFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { footing, inChromium, open, picture, savePicture, settled } from './browser.mjs';
import { drop, triangle } from './files.mjs';
import { difference, flip, foveal, redPixels } from './native.mjs';

const ROOT = fileURLToPath(new URL('../..', import.meta.url));
const SHOTS = join(ROOT, 'out/web');
const SMALL = { width: 1000, height: 420 };

let site;
before(async () => {
  mkdirSync(SHOTS, { recursive: true });
  site = await open();
});
after(() => site.close());

const shot = (page, name) => page.screenshot({ path: join(SHOTS, `${name}.png`) });
const costs = (page) => page.evaluate(() => window.foveal.costs);

test('the page draws, names what it draws with and says nothing in the console', async () => {
  const { page, said } = await site.visit('#scene=demo&scale=0.5');
  await settled(page);
  const { reference, chosen } = await costs(page);
  assert.ok(chosen.shaded_samples < 0.6 * reference.shaded_samples, 'coarse shading lights fewer samples');
  assert.equal(await page.locator('#wait').isVisible(), false);
  assert.ok((await page.locator('#figures tbody tr').count()) >= 7);
  // Reference / chosen: fewer samples are above 1; times have no colour before enough frames were drawn.
  const told = await page.locator('#figures tbody tr').evaluateAll((all) => Object.fromEntries(all.map((row) => [row.cells[0].textContent, [parseFloat(row.cells[3].textContent), row.cells[3].className]])));
  assert.ok(told['Samples lit'][0] > 1.6 && told['Samples lit'][1] === 'better', JSON.stringify(told));
  assert.equal(told.Frame[1], 'grey');
  assert.match(await page.locator('#adapter').textContent(), /WebGPU/);
  assert.equal(await page.locator('#reduced').isVisible(), false);
  console.log(await footing(page));
  await shot(page, 'desktop');
  assert.deepEqual(said, []);
  await page.context().close();
});

test('equal settings are no difference, many more samples are slower', async () => {
  const { page, said } = await site.visit('#scene=demo:1000&technique=antialiasing&scale=0.25', SMALL);
  await settled(page);
  const compared = async (antialiasing) => {
    await page.evaluate((aa) => {
      const { foveal } = window;
      const { sides } = foveal.settings;
      sides.chosen = { ...sides.reference, aa };
      Object.assign(foveal, { unapplied: true, stale: true, measured: false });
      foveal.costs.found = null;
    }, antialiasing);
    await page.waitForFunction(() => window.foveal.measured && window.foveal.costs.found?.frame);
    return page.locator('#figures tbody tr').evaluateAll((all) => {
      const cell = all.find((row) => row.cells[0].textContent === 'Frame').cells[3];
      return [cell.textContent, cell.className];
    });
  };
  const [same, color] = await compared('none');
  assert.match(same, /^no difference \(/);
  assert.equal(color, 'grey');
  const [slower, worse] = await compared('ssaa');
  assert.match(slower, /^0\.\d\dx \(0\.\d\d to 0\.\d\d\)$/);
  assert.equal(worse, 'worse');
  assert.deepEqual(said, []);
  await page.context().close();
});

test('every technique draws, with every view that it offers', async () => {
  const { page, said } = await site.visit('#scene=demo:1000&scale=0.25', SMALL);
  await settled(page);
  for (const button of await page.locator('#techniques button').all()) {
    await button.click();
    await settled(page);
    const name = await button.getAttribute('data-key');
    assert.equal(await button.getAttribute('aria-checked'), 'true');
    assert.equal(await page.locator('.message').count(), 0, await page.locator('#messages').textContent());
    await shot(page, `technique-${name}`);
    for (const id of ['#quick-view', '#quick-show']) {
      if (!(await page.locator(id).count())) continue;
      for (const option of await page.locator(`${id} option`).all()) {
        const value = await option.getAttribute('value');
        await page.locator(id).selectOption(value);
        await settled(page);
        assert.equal(await page.locator('.message').count(), 0, await page.locator('#messages').textContent());
        await shot(page, `technique-${name}-${value}`);
      }
    }
  }
  assert.deepEqual(said, []);
  await page.context().close();
});

test('culling in WebAssembly hides objects and changes no pixel', async () => {
  const { page } = await site.visit('#scene=demo:1000&technique=culling&scale=0.5', SMALL);
  const [left, right] = [await picture(page, false), await picture(page, true)];
  const { reference, chosen } = await costs(page);
  assert.ok(chosen.objects_occluded > 0 && chosen.objects_visible < reference.objects_visible);
  assert.ok(left.bytes.equals(right.bytes));
  await page.context().close();
});

test('both eyes in one submission give the picture of two passes, with half the draws', async () => {
  const { page } = await site.visit('#scene=demo:1000&technique=stereo&scale=0.5', SMALL);
  for (const show of ['anaglyph-dubois', 'side-by-side']) {
    await page.locator('#quick-show').selectOption(show);
    const [left, right] = [await picture(page, false), await picture(page, true)];
    const { reference, chosen } = await costs(page);
    assert.equal(reference.draws, 2 * chosen.draws);
    // Every pixel of each eye is lit once, however many of them are shown.
    assert.equal(chosen.shaded_samples, chosen.drawn_pixels);
    assert.match(chosen.stereo.mode, /^instanced/);
    assert.ok(difference(left, right) < 0.01, `${show}: ${difference(left, right)}`);
    assert.equal(await page.locator('.message').count(), 0, await page.locator('#messages').textContent());
    if (show !== 'side-by-side') continue;
    let moved = 0;
    const half = 2 * right.width;
    for (let y = 0; y < right.height; y++) {
      for (let x = 0; x < half; x++) moved += Number(right.bytes[y * 2 * half + x] !== right.bytes[y * 2 * half + half + x]);
    }
    assert.ok(moved > 0.1 * half * right.height, 'the eyes see different things');
  }
  await page.context().close();
});

test('variable shading lights fewer samples and is hard to tell from full shading', async () => {
  const { page } = await site.visit('#scene=demo:1000&technique=variable&scale=0.5', SMALL);
  const [left, right] = [await picture(page, false), await picture(page, true)];
  const { reference, chosen } = await costs(page);
  assert.ok(chosen.variable.active);
  assert.ok(chosen.shaded_samples < 0.9 * reference.shaded_samples, `${chosen.shaded_samples} of ${reference.shaded_samples}`);
  assert.ok(difference(left, right) < 3, `${difference(left, right)} of 255`);
  // A still camera's rates are constant, and so is its picture.
  await page.evaluate(() => { window.foveal.stale = true; });
  assert.ok((await picture(page, true)).bytes.equals(right.bytes));
  await page.context().close();
});

test('the picture is the native one', async () => {
  const { page } = await site.visit('#scene=demo:1000&left.anisotropy=1&scale=1&split=1', { width: 848, height: 270 });
  const { width, height } = await picture(page, false);
  const folder = mkdtempSync(join(tmpdir(), 'foveal-web-'));
  const [theirs, ours] = [join(folder, 'page.png'), join(folder, 'native.png')];
  await savePicture(page, false, theirs);
  foveal('render', 'demo:1000', '--anisotropy', '1', '--size', `${width}x${height}`, '--output', ours);
  assert.ok(flip(ours, theirs) < 0.01, `FLIP to the native picture is ${flip(ours, theirs)}`);
  await page.context().close();
});

test('the saved picture is the chosen side\'s, or the reference\'s where that alone is shown', inChromium('downloads'), async () => {
  for (const [split, chosen] of [['0.5', true], ['0', true], ['1', false]]) {
    const { page, said } = await site.visit(`#scene=cornell&technique=msaa&scale=0.25&split=${split}`, SMALL);
    const shown = await picture(page, chosen);
    const waits = page.waitForEvent('download', { timeout: 20_000 });
    await page.locator('#save').click();
    const png = readFileSync(await (await waits).path());
    const bytes = await page.evaluate(async (text) => {
      const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${text}`)).blob());
      const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
      context.drawImage(bitmap, 0, 0);
      return [...context.getImageData(0, 0, bitmap.width, bitmap.height).data];
    }, png.toString('base64'));
    assert.ok(shown.bytes.equals(Buffer.from(bytes)), `split ${split}`);
    assert.deepEqual(said, []);
    await page.context().close();
  }
});

test('the divider moves by keyboard and by dragging, and hides what it covers', async () => {
  const { page } = await site.visit('#scene=cornell&scale=0.25', SMALL);
  await settled(page);
  await page.locator('#split').focus();
  await page.keyboard.press('ArrowRight');
  assert.equal(await page.evaluate(() => window.foveal.split), 0.501);
  await page.keyboard.press('End');
  await settled(page);
  assert.equal(await page.locator('#right-name').isVisible(), false);
  const box = await page.locator('#stage').boundingBox();
  await page.mouse.move(box.x + box.width - 4, box.y + 100);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width * 0.25, box.y + 100, { steps: 4 });
  await page.mouse.up();
  await settled(page);
  assert.ok(Math.abs((await page.evaluate(() => window.foveal.split)) - 0.25) < 0.01);
  await page.context().close();
});

test('a side that is hidden has no figures of another scene, and no ratio to another view', async () => {
  const { page, said } = await site.visit('#scene=cornell&technique=culling&scale=0.25', SMALL);
  const [reference, ratio] = [1, 3];
  const triangles = (column) => page.locator('#figures tbody tr').evaluateAll((all, c) => all.find((row) => row.cells[0].textContent === 'Triangles').cells[c].textContent, column);
  await settled(page);
  assert.match(await triangles(ratio), /x$/);
  await page.locator('#split').focus();
  await page.keyboard.press('Home');
  await settled(page);
  // What the side cost when it was drawn last.
  assert.match(await triangles(reference), /\d/);
  await page.locator('#picture').focus();
  await page.keyboard.press('ArrowLeft');
  await settled(page);
  assert.equal(await triangles(ratio), '');
  await page.locator('#scene').selectOption('demo:1000');
  await page.waitForFunction(() => window.foveal.scene.name === 'demo:1000');
  await settled(page);
  assert.deepEqual([await triangles(reference), await triangles(ratio)], ['–', '']);
  assert.deepEqual(said, []);
  await page.context().close();
});

test('the automatic resolution follows the time of frames', async () => {
  const { page, said } = await site.visit('#scene=cornell&technique=culling', { width: 500, height: 200 });
  await settled(page);
  const width = () => page.evaluate(() => document.getElementById('picture').width);
  const full = await width();
  for (const [ms, least] of [[1000, full / 4], [10, full]]) {
    await page.evaluate((total_ms) => {
      const { viewer } = window.foveal;
      viewer.draw = async (request) => JSON.stringify({ ...JSON.parse(await Object.getPrototypeOf(viewer).draw.call(viewer, request)), total_ms });
    }, ms);
    await page.locator('#always').check();
    await page.waitForFunction((least) => Math.abs(document.getElementById('picture').width - least) <= 2, least);
    await page.locator('#always').uncheck();
    await settled(page);
    assert.ok(Math.abs((await width()) - least) <= 2, `${await width()} of ${full}`);
  }
  assert.deepEqual(said, []);
  await page.context().close();
});

test('on a monitor with more pixels a point the page draws more pixels', inChromium('change of monitors'), async () => {
  const { page, said } = await site.visit('#scene=cornell&technique=culling&scale=1', { width: 500, height: 200 });
  await settled(page);
  const devtools = await page.context().newCDPSession(page);
  const width = () => page.evaluate(() => document.getElementById('picture').width);
  const first = await width();
  for (const ratio of [2, 1.5, 1]) {
    await devtools.send('Emulation.setDeviceMetricsOverride', { width: 500, height: 200, deviceScaleFactor: ratio, mobile: false });
    await page.waitForFunction((ratio) => devicePixelRatio === ratio, ratio);
    await page.waitForTimeout(300);
    await settled(page);
    assert.ok(Math.abs((await width()) - ratio * first) <= 2, `${await width()} of ${first} at ${ratio}`);
  }
  assert.deepEqual(said, []);
  await page.context().close();
});

test('looking around by mouse and keys changes the picture, and home brings it back', async () => {
  const { page } = await site.visit('#scene=cornell&scale=0.25&technique=culling', SMALL);
  const first = await picture(page);
  const box = await page.locator('#picture').boundingBox();
  await page.mouse.move(box.x + 100, box.y + 100);
  await page.mouse.down();
  await page.mouse.move(box.x + 180, box.y + 120, { steps: 3 });
  await page.mouse.up();
  const turned = await picture(page);
  assert.ok(!turned.bytes.equals(first.bytes));
  await page.locator('#picture').focus();
  await page.keyboard.press('ArrowLeft');
  await page.keyboard.down('w');
  await page.waitForTimeout(300);
  await page.keyboard.up('w');
  assert.ok(!(await picture(page)).bytes.equals(turned.bytes));
  await page.locator('#home').click();
  assert.ok((await picture(page)).bytes.equals(first.bytes));
  await page.context().close();
});

test('the gaze follows the pointer', async () => {
  const { page } = await site.visit('#scene=cornell&scale=0.25', SMALL);
  await settled(page);
  const box = await page.locator('#picture').boundingBox();
  await page.mouse.move(box.x + box.width * 0.8, box.y + box.height * 0.3);
  await settled(page);
  const gaze = await page.evaluate(() => window.foveal.settings.sides.chosen.gaze);
  assert.ok(Math.abs(gaze[0] - 0.8) < 0.01 && Math.abs(gaze[1] - 0.3) < 0.01, String(gaze));
  await page.context().close();
});

test('a link holds the settings, the place and the divider', async () => {
  const { page } = await site.visit('#scene=cornell&scale=0.25&technique=msaa', SMALL);
  await settled(page);
  await page.locator('#settings summary').first().click();
  await page.locator('#quick-samples').fill('9');
  await page.locator('#picture').focus();
  await page.keyboard.press('ArrowLeft');
  await settled(page);
  // The address follows within half a second.
  await page.waitForTimeout(1000);
  const hash = await page.evaluate(() => location.hash);
  const shown = await picture(page);
  const again = await site.visit(hash, SMALL);
  // Places are rounded to a tenth of a millimetre.
  assert.ok(difference(await picture(again.page), shown) < 0.5);
  assert.equal(await again.page.evaluate(() => window.foveal.settings.sides.chosen.samples), 9);
  const odd = await site.visit('#scene=cornell&scale=0.25&right.nonsense=1', SMALL);
  await settled(odd.page);
  assert.match(await odd.page.locator('#messages').textContent(), /right\.nonsense=1/);
  for (const p of [page, again.page, odd.page]) await p.context().close();
});

test('a dropped .glb is shown; a broken one is named, and the page goes on', async () => {
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
  await page.locator('.message button').click();
  await page.locator('#scene').selectOption('cornell');
  await page.waitForFunction(() => window.foveal.scene.name === 'cornell');
  await settled(page);
  assert.equal(await page.locator('.message').count(), 0);
  await page.locator('#scene').selectOption('triangle.glb');
  await page.waitForFunction(() => window.foveal.scene.name === 'triangle.glb');
  const again = redPixels(await picture(page, false));
  assert.equal(again, red);
  // Of several files the scene is shown.
  await drop(page, 'second.glb', triangle(), ['bark.png', 'tree.bin']);
  await page.waitForFunction(() => document.getElementById('scene').value === 'second.glb');
  assert.equal(await page.locator('.message').count(), 0);
  assert.deepEqual(said, []);
  await page.context().close();
});

test('a file that takes too long is given up, and the page goes on', async () => {
  const { page, said } = await site.visit('#scene=cornell&scale=0.25', SMALL);
  await settled(page);
  await page.evaluate(() => { window.foveal.mostSeconds = 0; });
  await drop(page, 'slow.glb', triangle());
  await page.locator('.message').waitFor();
  assert.match(await page.locator('.message').textContent(), /slow\.glb took more than 0 s to read and was given up/);
  assert.equal(await page.locator('#scene').inputValue(), 'cornell');
  await page.evaluate(() => { delete window.foveal.mostSeconds; });
  await drop(page, 'triangle.glb', triangle());
  await page.waitForFunction(() => document.getElementById('scene').value === 'triangle.glb');
  const red = redPixels(await picture(page, false));
  assert.ok(red > 200, `${red} red pixels`);
  assert.deepEqual(said, []);
  await page.context().close();
});

test('a renderer that stops is started again', async () => {
  const { page } = await site.visit('#scene=cornell&scale=0.25', SMALL);
  const first = await picture(page);
  await page.evaluate(() => {
    const { viewer } = window.foveal;
    // As a trap in a future: the promise never ends, and the window alone is told.
    viewer.draw = () => new Promise(() => queueMicrotask(() => { throw new WebAssembly.RuntimeError('unreachable'); }));
    window.foveal.stale = true;
  });
  await page.locator('.message').waitFor();
  assert.match(await page.locator('.message').textContent(), /stopped \(unreachable\) and was started again/);
  assert.ok((await picture(page)).bytes.equals(first.bytes));
  assert.equal(await page.evaluate(() => window.foveal.loads), 2);
  await page.context().close();
});

test('control characters of a file are shown and not obeyed', async () => {
  const { page } = await site.visit('#scene=cornell&scale=0.25', SMALL);
  await settled(page);
  await drop(page, 'a\u202e\u001b[2J.glb', triangle().subarray(0, 60));
  await page.locator('.message').waitFor();
  assert.match(await page.locator('.message').textContent(), /a\\u202e\\u001b\[2J\.glb/);
  await page.context().close();
});

test('settings that cannot be met are said, and the last picture stays', async () => {
  const { page } = await site.visit('#scene=cornell&scale=0.25&technique=msaa', SMALL);
  await settled(page);
  await page.evaluate(() => { location.hash = ''; });
  await page.locator('#quick-samples').fill('5');
  await page.locator('.message').waitFor();
  assert.match(await page.locator('.message').textContent(), /samples/);
  await page.locator('#quick-samples').fill('4');
  await page.locator('.message button').click();
  await settled(page);
  assert.equal(await page.locator('.message').count(), 0);
  await page.context().close();
});

test('a lost device is opened again', async () => {
  const { page } = await site.visit('#scene=cornell&scale=0.25', SMALL);
  const first = await picture(page);
  await page.evaluate(() => { window.foveal.viewer.lose_device(); window.foveal.stale = true; });
  await page.locator('.message').waitFor();
  assert.match(await page.locator('.message').textContent(), /lost/i);
  const again = await picture(page);
  assert.ok(again.bytes.equals(first.bytes));
  await page.context().close();
});

test('a device that every frame loses is opened again once, and once more at the next change', async () => {
  const { page } = await site.visit('#scene=cornell&scale=0.25&technique=culling', SMALL);
  await settled(page);
  await page.evaluate(() => {
    const { Viewer } = window.foveal;
    window.opened = 0;
    window.foveal.Viewer = { open: (canvas) => { window.opened += 1; return Viewer.open(canvas); } };
    Viewer.prototype.draw = async () => { throw 'the graphics device was lost: a test'; };
  });
  for (const opened of [1, 2]) {
    await page.evaluate(() => { window.foveal.stale = true; });
    await page.locator('.message', { hasText: 'lost again' }).waitFor();
    await page.waitForTimeout(1000);
    assert.equal(await page.evaluate(() => window.opened), opened);
    await page.locator('.message button').click();
  }
  await page.context().close();
});

test('a setting that names the word of a lost device opens none', async () => {
  const { page, said } = await site.visit('#scene=cornell&scale=0.25&technique=culling&right.display=lost', SMALL);
  await page.locator('.message').waitFor();
  assert.match(await page.locator('.message').textContent(), /display.*lost/);
  await page.evaluate(() => { window.foveal.viewer.mark = true; window.foveal.stale = true; });
  await page.waitForTimeout(1000);
  assert.ok(await page.evaluate(() => window.foveal.viewer.mark));
  assert.deepEqual(said, []);
  await page.context().close();
});

test('where no device can be opened again the page says so, whatever is asked of it', async () => {
  const { page, said } = await site.visit('#scene=cornell&scale=0.25&technique=culling', SMALL);
  await settled(page);
  // Shown, too: Firefox asks for no more frames else, and Playwright clicks between frames.
  await page.waitForTimeout(500);
  await page.evaluate(() => {
    const { foveal } = window;
    foveal.Viewer = { open: async () => { throw 'the browser found no graphics adapter'; } };
    foveal.viewer.lose_device();
    foveal.stale = true;
  });
  await page.waitForFunction(() => document.getElementById('messages').textContent.includes('no graphics adapter. Reload the page'));
  for (const ask of [() => page.locator('#save').click(), () => page.locator('#scene').selectOption('demo:1000')]) {
    await page.locator('.message button').click();
    await ask();
    await page.locator('.message').waitFor();
    assert.match(await page.locator('.message').textContent(), /No graphics device is open\. Reload the page/);
  }
  assert.deepEqual(said, []);
  await page.context().close();
});

test('where the browser asks for no frames any more the page goes on drawing', async () => {
  const { page, said } = await site.visit('#scene=cornell&scale=0.25&technique=culling', SMALL);
  await settled(page);
  await page.evaluate(() => { window.requestAnimationFrame = () => 0; });
  const frames = () => page.evaluate(() => window.foveal.frames);
  // The first one was asked for before.
  for (let change = 0; change < 3; change += 1) {
    const before = await frames();
    await page.evaluate(() => { window.foveal.stale = true; });
    for (let wait = 0; wait < 300 && (await frames()) === before; wait += 1) await page.waitForTimeout(100);
    assert.ok((await frames()) > before, `change ${change}`);
  }
  assert.deepEqual(said, []);
  await page.context().close();
});

test('a picture that cannot be saved is said, and the page goes on', async () => {
  const { page, said } = await site.visit('#scene=cornell&scale=0.25', SMALL);
  const first = await picture(page);
  for (const [fail, sentence] of [
    [() => { window.foveal.viewer.lose_device(); }, /lost/i],
    // As a trap in a future: the promise never ends, and the window alone is told.
    [() => { window.foveal.viewer.picture = () => new Promise(() => queueMicrotask(() => { throw new WebAssembly.RuntimeError('unreachable'); })); }, /stopped \(unreachable\) and was started again/],
  ]) {
    await page.evaluate(fail);
    await page.locator('#save').click();
    await page.locator('.message').waitFor();
    assert.match(await page.locator('.message').textContent(), sentence);
    assert.ok((await picture(page)).bytes.equals(first.bytes));
    await page.locator('.message button').click();
  }
  assert.deepEqual(said.filter((text) => !text.includes('unreachable')), []);
  await page.context().close();
});

test('on a phone the picture and the controls share the screen', async () => {
  const { page } = await site.visit('#scene=demo:1000&scale=0.5', { width: 390, height: 844 });
  await settled(page);
  const [stage, panel] = [await page.locator('#stage').boundingBox(), await page.locator('#panel').boundingBox()];
  assert.ok(stage.height > 300 && panel.y >= stage.y + stage.height - 1);
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390);
  await shot(page, 'phone');
  await page.locator('#fold').click();
  await settled(page);
  assert.ok((await page.locator('#stage').boundingBox()).height > 700);
  await shot(page, 'phone-folded');
  await page.setViewportSize({ width: 844, height: 390 });
  await settled(page);
  await shot(page, 'phone-turned');
  await page.context().close();
});

test('without WebGPU and WebGL there is a picture of each technique and a sentence', async (t) => {
  const bare = await open('nothing');
  t.after(() => bare.close());
  const { page } = await bare.visit();
  await page.locator('#stills img').first().waitFor();
  assert.match(await page.locator('#missing').textContent(), /WebGPU.*WebGL/);
  const loaded = await page.locator('#stills img').evaluateAll(async (images) => {
    await Promise.all(images.map((image) => image.decode()));
    return images.length;
  });
  assert.ok(loaded >= 6);
  await shot(page, 'without-graphics');
});
