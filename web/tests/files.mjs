// Files to drop.

/** A .glb of one red triangle. */
export function triangle() {
  const positions = new Float32Array([-1, 0, 0, 1, 0, 0, 0, 2, 0]);
  const json = {
    asset: { version: '2.0' },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, material: 0 }] }],
    materials: [{ pbrMetallicRoughness: { baseColorFactor: [1, 0, 0, 1], metallicFactor: 0 }, doubleSided: true }],
    accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: 'VEC3', min: [-1, 0, 0], max: [1, 2, 0] }],
    bufferViews: [{ buffer: 0, byteLength: 36 }],
    buffers: [{ byteLength: 36 }],
  };
  const words = Buffer.from(JSON.stringify(json));
  const padded = Buffer.concat([words, Buffer.alloc((4 - (words.length % 4)) % 4, 32)]);
  const head = Buffer.alloc(20);
  head.write('glTF', 0);
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(12 + 8 + padded.length + 8 + 36, 8);
  head.writeUInt32LE(padded.length, 12);
  head.write('JSON', 16);
  const chunk = Buffer.alloc(8);
  chunk.writeUInt32LE(36, 0);
  chunk.write('BIN\0', 4);
  return Buffer.concat([head, padded, chunk, Buffer.from(positions.buffer)]);
}

/** Drops a file onto the page, as a user would, with empty files of other names before it. */
export async function drop(page, name, bytes, before = []) {
  await page.evaluate(({ name, text, before }) => {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const dataTransfer = new DataTransfer();
    for (const other of before) dataTransfer.items.add(new File([], other));
    dataTransfer.items.add(new File([bytes], name));
    window.dispatchEvent(new DragEvent('drop', { dataTransfer, bubbles: true, cancelable: true }));
  }, { name, text: bytes.toString('base64'), before });
}
