// A limit for the memory of WebAssembly, which a page can otherwise not set: it is part of the module.

/** Number of the section that says how large the memory is. */
const MEMORY = 5;

/** An unsigned number in LEB128: its value and the place behind it. */
function read(bytes, at) {
  let value = 0;
  for (let shift = 0; ; shift += 7) {
    if (at >= bytes.length || shift > 28) throw new Error('the WebAssembly cannot be read');
    const byte = bytes[at++];
    value += (byte & 0x7f) * 2 ** shift;
    if (byte < 0x80) return [value, at];
  }
}

function write(value) {
  const bytes = [];
  do {
    bytes.push((value % 128) | (value >= 128 ? 0x80 : 0));
    value = Math.floor(value / 128);
  } while (value > 0);
  return bytes;
}

/** The same module, whose memory has at most so many pages of 64 KiB. */
export function capped(bytes, pages) {
  for (let at = 8; at < bytes.length; ) {
    const [size, content] = read(bytes, at + 1);
    const end = content + size;
    if (bytes[at] !== MEMORY) {
      at = end;
      continue;
    }
    const [count, place] = read(bytes, content);
    const kind = bytes[place];
    // 0: without a limit; 1: with one. Others are shared or of 64 bits.
    if (count !== 1 || kind > 1) throw new Error('the WebAssembly has another kind of memory');
    const [least, behind] = read(bytes, place + 1);
    const most = kind === 1 ? Math.min(pages, read(bytes, behind)[0]) : pages;
    const section = [1, 1, ...write(least), ...write(Math.max(least, most))];
    const header = [MEMORY, ...write(section.length)];
    const out = new Uint8Array(at + header.length + section.length + bytes.length - end);
    out.set(bytes.subarray(0, at));
    out.set([...header, ...section], at);
    out.set(bytes.subarray(end), at + header.length + section.length);
    return out;
  }
  throw new Error('the WebAssembly has no memory of its own');
}
