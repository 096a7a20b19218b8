// Lists the tiles of each level, and sizes the dispatches that shade them.

#import shared/blocks.wgsl

override COARSEST: u32 = 8u;

struct Level {
    level: u32,
}

@group(1) @binding(0) var<uniform> current: Level;
// Mip l is level l + 1.
@group(1) @binding(1) var pyramid: texture_2d<u32>;
// Tiles of each level; zeroed before.
@group(1) @binding(2) var<storage, read_write> counts: array<atomic<u32>, 9>;
// Blocks as x | y << 16.
@group(1) @binding(3) var<storage, read_write> blocks: array<u32>;

var<workgroup> found: atomic<u32>;
var<workgroup> first: u32;

fn is_tile(block: vec2u, level: u32) -> bool {
    if any(block >= blocks_at(level)) || is_padding(block, level) {
        return false;
    }
    if level > 0u && (textureLoad(pyramid, block, level - 1u).x & CELL_LEVEL) < level {
        return false;
    }
    return level == COARSEST || (textureLoad(pyramid, block / 2u, level).x & CELL_LEVEL) <= level;
}

// A workgroup looks at 16 x 16 blocks, a thread at 2 x 2 of them, and takes room for what it finds
// at once.
@compute @workgroup_size(8, 8)
fn list_tiles(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) local: u32) {
    let level = current.level;
    var mine: array<u32, 4>;
    var count = 0u;
    for (var i = 0u; i < 4u; i++) {
        let block = id.xy * 2u + vec2u(i & 1u, i >> 1u);
        if is_tile(block, level) {
            mine[count] = block.x | (block.y << 16u);
            count++;
        }
    }
    var place = 0u;
    if count > 0u {
        place = atomicAdd(&found, count);
    }
    workgroupBarrier();
    if local == 0u {
        let all_found = atomicLoad(&found);
        if all_found > 0u {
            first = atomicAdd(&counts[level], all_found);
        }
    }
    workgroupBarrier();
    for (var i = 0u; i < count; i++) {
        blocks[first + place + i] = mine[i];
    }
}

@compute @workgroup_size(8, 8)
fn count_tiles(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) local: u32) {
    let level = current.level;
    var count = 0u;
    for (var i = 0u; i < 4u; i++) {
        count += u32(is_tile(id.xy * 2u + vec2u(i & 1u, i >> 1u), level));
    }
    if count > 0u {
        atomicAdd(&found, count);
    }
    workgroupBarrier();
    if local == 0u && atomicLoad(&found) > 0u {
        atomicAdd(&counts[level], atomicLoad(&found));
    }
}
