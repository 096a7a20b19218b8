// A real browser, a page in it, and what both said: Chromium on SwiftShader, or with `FOVEAL_BROWSER=firefox` Firefox on the
// machine's own drivers, which needs a screen.

import { existsSync, writeFileSync } from 'node:fs';
import { chromium, firefox } from 'playwright-core';
import { serve } from '../serve.mjs';

const QUIET = ['--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'];
/** What each browser is told for what it is to offer. */
const BROWSERS = {
  chromium: {
    type: chromium,
    named: 'CHROMIUM',
    paths: ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'],
    package: 'chromium',
    graphics: {
      // What it offers without further words.
      webgl2: { args: QUIET },
      nothing: { args: [...QUIET, '--disable-3d-apis'] },
      webgpu: { args: [...QUIET, '--enable-unsafe-webgpu', '--enable-features=Vulkan', '--use-vulkan=swiftshader', '--use-angle=swiftshader', '--use-webgpu-adapter=swiftshader'] },
    },
  },
  firefox: {
    type: firefox,
    named: 'FIREFOX',
    paths: ['/usr/bin/firefox-esr', '/usr/bin/firefox'],
    package: 'firefox-esr',
    graphics: {
      webgl2: firefoxWith({ 'dom.webgpu.enabled': false }),
      nothing: firefoxWith({ 'dom.webgpu.enabled': false, 'webgl.disabled': true }),
      webgpu: firefoxWith({ 'dom.webgpu.enabled': true, 'gfx.webgpu.ignore-blocklist': true }),
    },
  },
};

/** As its makers build it; it has no WebGL without a screen. */
function firefoxWith(firefoxUserPrefs) {
  return { channel: 'moz-firefox', headless: false, firefoxUserPrefs };
}

/** Where a frame may take seconds, waiting may take a minute. */
export const PATIENCE = 120_000;

/** The browser that the tests are for. */
export const BROWSER = process.env.FOVEAL_BROWSER ?? 'chromium';

/** For tests that Playwright can run in Chromium alone, with what they need. */
export const inChromium = (needed) => ({ skip: BROWSER === 'chromium' ? false : `in ${BROWSER} Playwright has no ${needed}` });

function launch(graphics) {
  const browser = BROWSERS[BROWSER];
  if (!browser) throw new Error(`FOVEAL_BROWSER=${BROWSER}: the tests know ${Object.keys(BROWSERS).join(' and ')}`);
  const executablePath = [process.env[browser.named], ...browser.paths].find((p) => p && existsSync(p));
  if (!executablePath) throw new Error(`no ${BROWSER}: install Debian's package ${browser.package}, or name one in ${browser.named}`);
  return browser.type.launch({ executablePath, ...browser.graphics[graphics] });
}

/** As Playwright waits, at each of the page's frames, and by this process's clock: Firefox may ask for no more frames once a device is lost. */
async function waitByBoth(page, wait, condition, asked) {
  let ended = false;
  const byClock = async () => {
    while (!ended && !(await page.evaluate(condition, asked))) await new Promise((done) => setTimeout(done, 200));
  };
  return Promise.race([wait(condition, asked), byClock()]).finally(() => { ended = true; });
}

/** A browser that offers `graphics` (`webgpu`, `webgl2` or `nothing`), and a server for the page, or for another in `folder`; `close` ends both. */
export async function open(graphics = 'webgpu', folder = undefined) {
  const server = await serve(0, folder);
  const browser = await launch(graphics);
  const address = `http://localhost:${server.address().port}/`;
  return {
    address,
    browser,
    /** Opens the page with what a link says, after `before` ran in it; `said` collects errors and warnings. */
    async visit(link = '', viewport = { width: 1280, height: 720 }, before = () => {}) {
      const context = await browser.newContext({ viewport, acceptDownloads: true });
      const page = await context.newPage();
      page.setDefaultTimeout(PATIENCE);
      const wait = page.waitForFunction.bind(page);
      if (BROWSER === 'firefox') page.waitForFunction = (condition, asked) => waitByBoth(page, wait, condition, asked);
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
