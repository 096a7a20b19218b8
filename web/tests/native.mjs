// The native program beside the page, and small sums over pictures.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { BROWSER } from './browser.mjs';

const ROOT = fileURLToPath(new URL('../..', import.meta.url));

/** Runs the program that FOVEAL names, or builds it first; tells what it printed. */
export function foveal(...words) {
  // Chromium's own driver where it can be found: drivers differ in how they choose mip levels.
  const driver = '/usr/lib/chromium/vk_swiftshader_icd.json';
  const env = BROWSER === 'chromium' && existsSync(driver) ? { ...process.env, VK_DRIVER_FILES: driver } : process.env;
  const [program, ...first] = process.env.FOVEAL ? [process.env.FOVEAL] : ['cargo', 'run', '--quiet', '--package', 'foveal-cli', '--'];
  return execFileSync(program, [...first, ...words], { cwd: ROOT, encoding: 'utf8', env });
}

/** The FLIP error of two PNG files. */
export function flip(a, b) {
  return JSON.parse(foveal('compare', a, b, '--json')).flip;
}

/** Mean difference of two pictures' channels, of 255. */
export function difference(a, b) {
  assert.deepEqual([a.width, a.height], [b.width, b.height]);
  return a.bytes.reduce((sum, v, i) => sum + Math.abs(v - b.bytes[i]), 0) / a.bytes.length;
}

/** Pixels that are red. */
export function redPixels({ bytes }) {
  let red = 0;
  for (let i = 0; i < bytes.length; i += 4) red += Number(bytes[i] > 2 * bytes[i + 1] && bytes[i] > 60);
  return red;
}
