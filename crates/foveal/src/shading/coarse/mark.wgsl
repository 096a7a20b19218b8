// Marks in the stencil which blocks of a level are tiles: the others are discarded. CPU twin:
// `rate/pyramid.rs`, `owns`.

#import shared/blocks.wgsl
#import shared/level.wgsl

override COARSEST: u32 = 8u;

// Mip l is level l + 1.
@group(1) @binding(0) var pyramid: texture_2d<u32>;

@fragment
fn mark(in: LevelVertex) {
    let block = vec2u(in.position.xy);
    if is_padding(block, in.level) {
        discard;
    }
    if in.level > 0u && (textureLoad(pyramid, block, in.level - 1u).x & CELL_LEVEL) < in.level {
        discard;
    }
    if in.level < COARSEST && (textureLoad(pyramid, block / 2u, in.level).x & CELL_LEVEL) > in.level {
        discard;
    }
}
