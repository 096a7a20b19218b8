// Each pixel's owner level, and whether the owner holds a geometric edge. After frame, level and blocks.wgsl.
// CPU twin: `rate/pyramid.rs`, `owner_level`.

override COARSEST: u32 = 8u;

@group(1) @binding(0) var pyramid: texture_2d<u32>;

@fragment
fn owner_level(in: LevelVertex) -> @location(0) u32 {
    let texel = vec2u(in.position.xy);
    var level = 0u;
    var edge = textureLoad(pyramid, texel, 0).x & CELL_EDGE;
    while level < COARSEST {
        let cell = textureLoad(pyramid, texel >> vec2u(level + 1u), level + 1u).x;
        if (cell & CELL_LEVEL) <= level {
            break;
        }
        level++;
        edge = cell & CELL_EDGE;
    }
    return level | edge;
}
