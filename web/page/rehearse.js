// A worker that reads a dropped file before the page does, and nothing else. A file that takes too long, or more memory
// than the reader may have here, ends this worker and not the page.

import { capped } from './cap.js';

/** Pages of 64 KiB that the reader may have: 3 GiB of the 4 that WebAssembly has. */
const MOST_PAGES = 49152;

/** The bytes of the renderer's WebAssembly, beside its JavaScript. */
async function webAssembly(renderer) {
  const response = await fetch(new URL(renderer.replace(/\.js$/, '_bg.wasm'), import.meta.url));
  if (!response.ok) throw new Error(`the reader cannot be fetched: ${response.status}`);
  return new Uint8Array(await response.arrayBuffer());
}

addEventListener('message', async ({ data: { renderer, name, bytes, beside } }) => {
  try {
    const module = await import(renderer);
    await module.default({ module_or_path: capped(await webAssembly(renderer), MOST_PAGES) });
    postMessage({ ready: true });
    module.rehearse(name, new Uint8Array(bytes), beside);
    postMessage({ cause: null });
  } catch (cause) {
    // The importer's sentences are strings; all else is the reader's own end.
    postMessage({ cause: typeof cause === 'string' ? cause : `${name} made the reader stop, perhaps for want of memory (${cause}); nothing was loaded` });
  }
});
