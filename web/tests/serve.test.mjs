// The static server answers whatever is asked of it, and goes on: `node --test web/tests/serve.test.mjs`.

import { test } from 'node:test';
import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { mkdtemp, mkdir, rm, writeFile } from 'node:fs/promises';
import { connect } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { serve } from '../serve.mjs';

/** Sends a request line as it is and resolves to the status, or null where the server hangs up. */
function ask(port, line) {
  return new Promise((done) => {
    const socket = connect(port, '127.0.0.1');
    let text = '';
    socket.on('data', (data) => { text += data; });
    socket.on('close', () => done(Number(/^HTTP\/1\.1 (\d+)/.exec(text)?.[1] ?? 0) || null));
    socket.on('error', () => {});
    socket.write(`${line}\r\nHost: x\r\nConnection: close\r\n\r\n`);
  });
}

test('malformed URLs are answered with 400, and the server goes on', async () => {
  const outer = await mkdtemp(join(tmpdir(), 'foveal-serve-'));
  const folder = join(outer, 'dist');
  await mkdir(folder);
  await writeFile(join(outer, 'secret'), 'secret');
  await writeFile(join(outer, 'dist-secret'), 'secret');
  await writeFile(join(folder, 'index.html'), 'hello');
  const server = await serve(0, folder);
  const { port } = server.address();
  try {
    for (const [line, status] of [
      ['GET / HTTP/1.1', 200],
      ['HEAD /index.html HTTP/1.1', 200],
      ['GET /%E0%A4%A HTTP/1.1', 400],
      ['GET /% HTTP/1.1', 400],
      ['GET /a%00b HTTP/1.1', 400],
      ['GET // HTTP/1.1', 400],
      ['GET http://[ HTTP/1.1', 400],
      ['GET /../secret HTTP/1.1', 404],
      ['GET /..%2fsecret HTTP/1.1', 400],
      ['GET /..%2fdist-secret HTTP/1.1', 400],
      ['GET /none.html HTTP/1.1', 404],
      ['POST / HTTP/1.1', 405],
      ['nonsense', 400],
      ['GET / HTTP/1.1', 200],
    ]) {
      assert.equal(await ask(port, line), status, line);
    }
  } finally {
    server.close();
    await rm(outer, { recursive: true });
  }
});

test('a port that cannot be used is said in a line', async () => {
  const server = await serve(0, tmpdir());
  const used = String(server.address().port);
  const program = fileURLToPath(new URL('../serve.mjs', import.meta.url));
  try {
    for (const [port, cause] of [[used, `port ${used} is in use`], ['eight', 'the port is eight'], ['70000', 'the port is 70000']]) {
      const { code, said } = await new Promise((done) => {
        execFile(process.execPath, [program, port], (error, _, said) => done({ code: error?.code, said }));
      });
      assert.equal(code, 1);
      assert.ok(said.startsWith(`web/serve.mjs: ${cause}`) && said.trim().split('\n').length === 1, said);
    }
  } finally {
    server.close();
  }
});
