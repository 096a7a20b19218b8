// Blocks of the coarse tiling: level l has square blocks of 2^l pixels. Blocks of all levels begin
// again where the right eye's picture does, so that none belongs to both; those at a picture's
// right and lower border may reach beyond it. CPU twins: `rate/pyramid.rs`,
// `shading/coarse/block.rs`.

#import shared/frame.wgsl

// Bits of a rate-map cell: the level, and whether the block holds a geometric edge.
const CELL_LEVEL: u32 = 15u;
const CELL_EDGE: u32 = 128u;

// Blocks across and down the target.
fn blocks_at(level: u32) -> vec2u {
    return (vec2u(frame.target_size) + (1u << level) - 1u) >> vec2u(level);
}

// Whether a block lies between the eyes' pictures, where nothing is seen.
fn is_padding(block: vec2u, level: u32) -> bool {
    let first = block << vec2u(level);
    return first.x >= picture_of(first).end.x;
}

// The texel that a block's sample looks at. Candidate 0 is the centre: of the four texels around it
// the one to the lower right. Candidates 1 to 4 lie a quarter of the side from the corners. A block
// whose candidate lies beyond its eye's picture takes the nearest of its texels inside.
fn sample_texel(block: vec2u, level: u32, candidate: u32) -> vec2u {
    let side = 1u << level;
    var within = vec2u(side >> 1u);
    if candidate > 0u {
        let corner = vec2u(candidate - 1u, (candidate - 1u) >> 1u) & vec2u(1u);
        within = (vec2u(side) * (1u + 2u * corner)) >> vec2u(2u);
    }
    let first = block << vec2u(level);
    return min(first + within, picture_of(first).end - 1u);
}

// Where a block was sampled, in pixels; `alpha` is its radiance's, which tells the candidate.
fn sample_position(block: vec2u, level: u32, alpha: f32) -> vec2f {
    return vec2f(sample_texel(block, level, u32(alpha + 0.5) - 1u)) + 0.5;
}
