// A worker that reads a dropped file before the page does, and nothing else. A file that takes too long, or so much
// memory that the reader stops, ends this worker and not the page.

addEventListener('message', async ({ data: { renderer, name, bytes } }) => {
  try {
    const module = await import(renderer);
    await module.default();
    postMessage({ ready: true });
    module.rehearse(name, new Uint8Array(bytes));
    postMessage({ cause: null });
  } catch (cause) {
    // The importer's sentences are strings; all else is the reader's own end.
    postMessage({ cause: typeof cause === 'string' ? cause : `${name} made the reader stop (${cause}); nothing was loaded` });
  }
});
