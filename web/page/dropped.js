// Files that a user gives: by the button, or dropped, alone or in folders.

/** Files that a dropped folder may hold, all that it holds included. */
const MOST_FILES = 5000;

const SCENE = /\.(glb|gltf)$/i;

/** How one path leads to another from the folder that it is in. */
function relative(from, to) {
  const [folders, steps] = [from.split('/').slice(0, -1), to.split('/')];
  let shared = 0;
  while (shared < folders.length && shared < steps.length - 1 && folders[shared] === steps[shared]) shared += 1;
  return [...folders.slice(shared).map(() => '..'), ...steps.slice(shared)].join('/');
}

/** The scene first, then what may lie beside it, named by the way there. Of several scenes it is the first one that is least deep in folders. */
function sceneFirst(given) {
  const depth = ({ path }) => path.split('/').length;
  const scenes = given.filter(({ path }) => SCENE.test(path)).sort((a, b) => depth(a) - depth(b));
  const scene = scenes[0] ?? given[0];
  const others = given.filter((one) => one !== scene && !SCENE.test(one.path));
  return [{ name: scene.file.name, file: scene.file }, ...others.map(({ path, file }) => ({ name: relative(scene.path, path), file }))];
}

/** Files without folders, as the button gives them. */
export const together = (files) => sceneFirst([...files].map((file) => ({ path: file.name, file })));

const promised = (call) => new Promise(call);

async function* within(entry) {
  if (entry.isFile) {
    yield { path: entry.fullPath.replace(/^\//, ''), file: await promised((done, failed) => entry.file(done, failed)) };
    return;
  }
  const reader = entry.createReader();
  for (;;) {
    // Some at a time; none at the end.
    const some = await promised((done, failed) => reader.readEntries(done, failed));
    if (!some.length) return;
    for (const inner of some) yield* within(inner);
  }
}

/** The files of a drop, as `together` gives them; an empty list where it holds none. What is dropped is known during the event alone, so this asks for it at once. */
export function dropped(transfer) {
  const plain = [...transfer.files];
  const entries = [...transfer.items].map((item) => (item.kind === 'file' ? item.webkitGetAsEntry?.() : null)).filter(Boolean);
  return (async () => {
    if (!entries.some((entry) => entry.isDirectory)) return plain.length ? together(plain) : [];
    const found = [];
    for (const entry of entries) {
      for await (const one of within(entry)) {
        found.push(one);
        if (found.length > MOST_FILES) throw new Error(`there are more than ${MOST_FILES} files in it; drop the folder of one scene`);
      }
    }
    if (!found.some(({ path }) => SCENE.test(path))) throw new Error('there is no .glb and no .gltf in it');
    return sceneFirst(found);
  })();
}
