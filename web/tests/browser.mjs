// A real browser on SwiftShader, a page in it, and what both said.

import { existsSync, writeFileSync } from 'node:fs';
import { chromium } from 'playwright-core';
import { serve } from '../serve.mjs';

const QUIET = ['--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'];
/** What the browser offers. Without further words it is WebGL 2 alone. */
const GRAPHICS = {
  webgl2: [],
  nothing: ['--disable-3d-apis'],
  webgpu: ['--enable-unsafe-webgpu', '--enable-features=Vulkan', '--use-vulkan=swiftshader', '--use-angle=swiftshader', '--use-webgpu-adapter=swiftshader'],
};

/** Where a frame may take seconds, waiting may take a minute. */
export const PATIENCE = 120_000;

function executablePath() {
  const found = [process.env.CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find((p) => p && existsSync(p));
  if (!found) throw new Error('no Chromium: install Debian\'s package chromium, or name one in CHROMIUM');
  return found;
}

/** A browser with `graphics` (of `GRAPHICS`) and a server for the page, or for another in `folder`; `close` ends both. */
export async function open(graphics = 'webgpu', folder = undefined) {
  const server = await serve(0, folder);
  const browser = await chromium.launch({ executablePath: executablePath(), args: [...QUIET, ...GRAPHICS[graphics]] });
  const address = `http://localhost:${server.address().port}/`;
  return {
    address,
    browser,
    /** Opens the page with what a link says, after `before` ran in it; `said` collects errors and warnings. */
    async visit(link = '', viewport = { width: 1280, height: 720 }, before = () => {}) {
      const context = await browser.newContext({ viewport, acceptDownloads: true });
      const page = await context.newPage();
      page.setDefaultTimeout(PATIENCE);
      const said = [];
      page.on('console', (m) => { if (m.type() === 'error') said.push(m.text()); });
      page.on('pageerror', (e) => said.push(String(e)));
      await page.addInitScript(before);
      await page.goto(`${address}${link}`);
      return { page, said };
    },
    async close() {
      await browser.close();
      server.closeAllConnections?.();
      await new Promise((done) => server.close(done));
    },
  };
}

/** For `visit`: gives the page's first device back as soon as the page has it. */
export function loseFirst() {
  let viewer = null;
  let opened = 0;
  const lose = {
    get: () => viewer,
    set(next) {
      viewer = next;
      if (next && opened++ === 0) next.lose_device();
    },
  };
  Object.defineProperty(window, 'foveal', {
    configurable: true,
    set(page) {
      Object.defineProperty(page, 'viewer', lose);
      Object.defineProperty(window, 'foveal', { value: page });
    },
  });
}

/** Waits until a frame of the present settings is on the canvas. */
export async function settled(page) {
  await page.waitForFunction(() => {
    const { frames, stale, busy, unsettled } = window.foveal ?? {};
    const settled = frames > 0 && !stale && !busy && !(unsettled > 0);
    // The page goes on drawing, to compare its sides: not while a test looks.
    if (settled) window.foveal.measured = true;
    return settled;
  });
}

/** The last picture of one side, as RGBA bytes, with its size and its mean colour. */
export async function picture(page, chosen = true) {
  await settled(page);
  const { bytes, width, height } = await page.evaluate(async (side) => {
    const { viewer, costs } = window.foveal;
    const pixels = await viewer.picture(side);
    const { width, height } = side ? costs.chosen : costs.reference;
    let text = '';
    for (let i = 0; i < pixels.length; i += 32768) text += String.fromCharCode(...pixels.subarray(i, i + 32768));
    return { bytes: btoa(text), width, height };
  }, chosen);
  return { bytes: Buffer.from(bytes, 'base64'), width, height };
}

/** Writes the last picture of one side as a PNG file. */
export async function savePicture(page, chosen, file) {
  await settled(page);
  const text = await page.evaluate(async (side) => {
    const { viewer, costs } = window.foveal;
    const { width, height } = side ? costs.chosen : costs.reference;
    const pixels = new Uint8ClampedArray(await viewer.picture(side));
    const canvas = new OffscreenCanvas(width, height);
    canvas.getContext('2d').putImageData(new ImageData(pixels, width, height), 0, 0);
    const buffer = new Uint8Array(await (await canvas.convertToBlob()).arrayBuffer());
    let bytes = '';
    for (const byte of buffer) bytes += String.fromCharCode(byte);
    return btoa(bytes);
  }, chosen);
  writeFileSync(file, Buffer.from(text, 'base64'));
}

/** What the page says of its own start: printed with the tests. */
export async function footing(page) {
  await settled(page);
  const text = await page.locator('#footing').textContent();
  return `${await page.locator('#adapter').textContent()}: ${text}`;
}
