// The renderer's WebAssembly: loaded, loaded anew after it stopped, and read with in a worker.

import { page } from './page.js';

/** Seconds that a dropped file may take to be read. */
const MOST_SECONDS = 20;

/** Loads the renderer; one that has stopped is left behind, with its memory. */
export async function loadRenderer() {
  const path = page.reduced ? './webgl2/foveal_web.js' : './foveal_web.js';
  page.loads += 1;
  const renderer = await import(page.loads > 1 ? `${path}?again=${page.loads}` : path);
  page.memory = (await renderer.default()).memory;
  page.Viewer = renderer.Viewer;
  return renderer;
}

/** Whether the renderer has stopped for good: nothing in its memory can be relied on. */
export function hasStopped(cause) {
  return cause instanceof WebAssembly.RuntimeError;
}

/** Sentences of a device that is gone; others may hold the word in the name of a scene or the value of a setting. */
const LOST = /^the graphics (device was lost|API reported .*\blost\b)|^the canvas gives no picture to draw into: Lost/i;

/** Whether the viewer says that its device is gone. */
export function isLost(cause) {
  return LOST.test(String(cause));
}

/**
 * A promise of the renderer that also fails where the renderer stops meanwhile: a stop within a future is told to the
 * window alone, and the future never ends.
 */
export function orStopped(promise) {
  return new Promise((done, failed) => {
    const stopped = ({ error }) => {
      // Timers of a renderer that was left behind may fail too.
      const mine = page.loads === 1 || !error?.stack?.includes('foveal_web') || error.stack.includes(`?again=${page.loads}`);
      if (hasStopped(error) && mine) end(failed)(error);
    };
    const end = (how) => (value) => {
      removeEventListener('error', stopped);
      how(value);
    };
    addEventListener('error', stopped);
    promise.then(end(done), end(failed));
  });
}

/** What the viewer promises when it is called; fails where the renderer stops, or the canvas loses its context, meanwhile. */
export function orLost(call) {
  return new Promise((done, failed) => {
    if (page.lost) throw page.lost;
    if (!page.viewer) throw 'No graphics device is open. Reload the page to try again.';
    page.fail = failed;
    orStopped(call()).then(done, failed);
  });
}

/** Reads a scene's file in a worker of its own. Fails with a sentence where it cannot be read, or takes too long. */
export function rehearse({ name, bytes, beside }) {
  return new Promise((done, failed) => {
    const worker = new Worker(new URL('./rehearse.js', import.meta.url), { type: 'module' });
    const end = (cause) => {
      clearTimeout(timer);
      worker.terminate();
      if (cause) failed(cause);
      else done();
    };
    const seconds = page.mostSeconds ?? MOST_SECONDS;
    const late = () => end(`${name} took more than ${seconds} s to read and was given up; what is shown stays. Programs outside the browser have more time: foveal scene info`);
    let timer = setTimeout(late, 3 * seconds * 1000);
    worker.addEventListener('message', ({ data }) => {
      if (!data.ready) return end(data.cause);
      // Fetching and compiling the renderer does not count.
      clearTimeout(timer);
      timer = setTimeout(late, seconds * 1000);
    });
    worker.addEventListener('error', (event) => {
      event.preventDefault();
      end(`${name} cannot be read: ${event.message || 'the reader did not start'}`);
    });
    const renderer = page.reduced ? './webgl2/foveal_web.js' : './foveal_web.js';
    worker.postMessage({ renderer, name, bytes, beside });
  });
}
