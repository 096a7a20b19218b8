// Owner level of 2 x 2 pixels, and whether the owner holds a geometric edge. Tiles of level 1 and
// up hold such quads whole, so the pixels of one agree. CPU twin: `rate/pyramid.rs`, `owner_level`.

#variant
#variant DISPATCHED
#import shared/blocks.wgsl
#ifdef DISPATCHED
#import shared/dispatched_level.wgsl
#else
#import shared/level.wgsl
#endif

override COARSEST: u32 = 8u;

// Mip l is level l + 1.
@group(1) @binding(0) var pyramid: texture_2d<u32>;

fn owner_at(quad: vec2u) -> u32 {
    var owner = textureLoad(pyramid, quad, 0).x;
    if (owner & CELL_LEVEL) == 0u {
        return owner;
    }
    var level = 1u;
    while level < COARSEST {
        let cell = textureLoad(pyramid, quad >> vec2u(level), level).x;
        if (cell & CELL_LEVEL) <= level {
            break;
        }
        level++;
        owner = cell;
    }
    return level | (owner & CELL_EDGE);
}

#ifdef DISPATCHED
@compute @workgroup_size(8, 8)
fn own_all(@builtin(global_invocation_id) at: vec3u) {
    if is_of_level(at.xy) {
        write_cell(at.xy, owner_at(at.xy));
    }
}
#else
@fragment
fn owner_level(in: LevelVertex) -> @location(0) u32 {
    return owner_at(vec2u(in.position.xy));
}
#endif
