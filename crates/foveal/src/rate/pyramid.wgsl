// One level of the min-pyramid from the one below, from level 2 on. CPU twin: `rate/pyramid.rs`,
// `reduce`.

#variant
#variant DISPATCHED
#import shared/blocks.wgsl
#import shared/frame.wgsl
#ifdef DISPATCHED
#import shared/dispatched_level.wgsl
#else
#import shared/level.wgsl
#endif

// Neighbouring tiles differ by one level at most: a block is allowed only where all blocks around
// its children are allowed at their level.
override BALANCE: bool = false;

@group(1) @binding(0) var below: texture_2d<u32>;

fn reduced(block: vec2u, level: u32) -> u32 {
    let first = vec2i(block) * 2;
    let picture = picture_of(vec2u(first) << vec2u(level - 1u));
    let low = vec2i(picture.low >> vec2u(level - 1u));
    let end = vec2i((picture.end + (1u << (level - 1u)) - 1u) >> vec2u(level - 1u));
    var least = CELL_LEVEL;
    var edge = 0u;
    for (var i = 0u; i < 4u; i++) {
        let child = textureLoad(below, min(first + vec2i(vec2u(i & 1u, i >> 1u)), end - 1), 0).x;
        least = min(least, child & CELL_LEVEL);
        edge |= child & CELL_EDGE;
    }
    if BALANCE && least >= level {
        for (var i = 0; i < 12; i++) {
            // Around the 2 x 2 children: four above, four below, two on either side.
            let beside = vec2i(select(-1, 2, i > 9), (i - 8) & 1);
            let row = vec2i((i & 3) - 1, select(-1, 2, i > 3));
            let at = first + select(beside, row, i < 8);
            if all(at >= low) && all(at < end) && (textureLoad(below, at, 0).x & CELL_LEVEL) < level - 1u {
                least = level - 1u;
            }
        }
    }
    return least | edge;
}

#ifdef DISPATCHED
@compute @workgroup_size(8, 8)
fn reduce_all(@builtin(global_invocation_id) at: vec3u) {
    if is_of_level(at.xy) {
        write_cell(at.xy, reduced(at.xy, dispatched_level));
    }
}
#else
@fragment
fn reduce(in: LevelVertex) -> @location(0) u32 {
    return reduced(vec2u(in.position.xy), in.level);
}
#endif
