// One level of the min-pyramid from the one below. After frame, level and blocks.wgsl. CPU twin:
// `rate/pyramid.rs`, `reduce`.

// Neighbouring blocks of the tiling differ by one level at most.
override BALANCE: bool = false;

@group(1) @binding(0) var below: texture_2d<u32>;

@fragment
fn reduce(in: LevelVertex) -> @location(0) u32 {
    let block = vec2i(in.position.xy);
    let size = vec2i(blocks_at(in.level - 1u));
    let ring = select(0, 1, BALANCE);
    let first = max(2 * block - ring, vec2i(0));
    let last = min(2 * block + 1 + ring, size - 1);
    var least = CELL_LEVEL;
    var edge = 0u;
    for (var y = first.y; y <= last.y; y++) {
        for (var x = first.x; x <= last.x; x++) {
            let child = textureLoad(below, vec2i(x, y), 0).x;
            if all(vec2i(x, y) / 2 == block) {
                least = min(least, child & CELL_LEVEL);
                edge |= child & CELL_EDGE;
            } else if (child & CELL_LEVEL) < in.level - 1u {
                least = min(least, in.level - 1u);
            }
        }
    }
    return least | edge;
}
