// A module's memory can be given a limit: `node --test web/tests/cap.test.mjs`.

import { test } from 'node:test';
import assert from 'node:assert/strict';
import { capped } from '../page/cap.js';

const HEADER = [0, 0x61, 0x73, 0x6d, 1, 0, 0, 0];
/** Exports the memory as `m`. */
const EXPORT = [7, 5, 1, 1, 0x6d, 2, 0];

async function memory(bytes) {
  const { instance } = await WebAssembly.instantiate(bytes);
  return instance.exports.m;
}

/** Pages that a memory can have. */
function most(memory) {
  let pages = memory.buffer.byteLength / 65536;
  try {
    for (; pages < 400; pages += 1) memory.grow(1);
  } catch (cause) {
    assert.ok(cause instanceof RangeError, String(cause));
  }
  return pages;
}

test('a memory grows to the limit and no further', async () => {
  const unlimited = Uint8Array.from([...HEADER, 5, 3, 1, 0, 2, ...EXPORT]);
  assert.equal(most(await memory(unlimited)), 400);
  assert.equal(most(await memory(capped(unlimited, 7))), 7);
  // Two bytes of LEB128.
  assert.equal(most(await memory(capped(unlimited, 300))), 300);
});

test('a limit of the module\'s own stays where it is lower', async () => {
  const limited = Uint8Array.from([...HEADER, 5, 4, 1, 1, 2, 5, ...EXPORT]);
  assert.equal(most(await memory(capped(limited, 9))), 5);
  assert.equal(most(await memory(capped(limited, 3))), 3);
});

test('what is no module with one ordinary memory is refused', () => {
  for (const bytes of [[], HEADER, [...HEADER, 5], [...HEADER, 5, 3, 1, 3, 2], [...HEADER, 5, 3, 2, 0, 1, 0, 1]]) {
    assert.throws(() => capped(Uint8Array.from(bytes), 9), Error);
  }
});
