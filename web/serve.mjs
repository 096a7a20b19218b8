// A plain static server for dist/ or another folder: `node web/serve.mjs [PORT] [FOLDER]`.

import { createServer } from 'node:http';
import { readFile } from 'node:fs/promises';
import { extname, join, resolve, sep } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const DIST = resolve(fileURLToPath(new URL('../dist', import.meta.url)));
const TYPES = {
  '.html': 'text/html; charset=utf-8',
  '.js': 'text/javascript',
  '.css': 'text/css',
  '.wasm': 'application/wasm',
  '.jpg': 'image/jpeg',
};

/** The file that a URL names; null for one that is malformed or leads out of `folder`. */
function fileOf(folder, url) {
  let path;
  try {
    path = decodeURIComponent(new URL(url, 'http://localhost').pathname);
  } catch {
    return null;
  }
  if (path.includes('\0')) return null;
  const file = join(folder, path.endsWith('/') ? `${path}index.html` : path);
  return file.startsWith(folder + sep) ? file : null;
}

async function answer(folder, request, response) {
  const end = (status, text, headers = {}) => {
    response.writeHead(status, { 'content-type': 'text/plain', ...headers });
    response.end(text);
  };
  if (request.method !== 'GET' && request.method !== 'HEAD') {
    return end(405, 'only GET and HEAD', { allow: 'GET, HEAD' });
  }
  const file = fileOf(folder, request.url);
  if (file === null) return end(400, 'malformed URL');
  let body;
  try {
    body = await readFile(file);
  } catch {
    return end(404, 'not found');
  }
  return end(200, body, { 'content-type': TYPES[extname(file)] ?? 'application/octet-stream' });
}

/** Serves `folder` on `port` (0: any free one); resolves to the server. No request ends it. */
export function serve(port, folder = DIST) {
  const server = createServer((request, response) => {
    answer(folder, request, response).catch(() => response.destroy());
  });
  return new Promise((done, failed) => {
    server.once('error', failed);
    server.listen(port, '127.0.0.1', () => done(server));
  });
}

if (import.meta.url === pathToFileURL(process.argv[1]).href) {
  const words = process.argv[2] ?? '8000';
  const port = /^\d+$/.test(words) ? Number(words) : NaN;
  const fail = (cause) => {
    console.error(`web/serve.mjs: ${cause}`);
    process.exit(1);
  };
  if (!(port < 65536)) fail(`the port is ${words}; it must be a number from 0 to 65535`);
  const server = await serve(port, resolve(process.argv[3] ?? DIST)).catch((cause) => fail(cause.code === 'EADDRINUSE'
    ? `port ${port} is in use; name another: node web/serve.mjs 8001`
    : `port ${port} cannot be used: ${cause.message}`));
  console.log(`http://localhost:${server.address().port}/`);
}
