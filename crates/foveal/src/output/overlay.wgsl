// The tiling drawn over the picture, alpha saying how much of it.

#import composite/tiling.wgsl
#import shared/blocks.wgsl
#import shared/level.wgsl

// Which: 1 levels, 2 tile borders, 3 samples.
override VIEW: u32 = 1u;

// White, then a hue per level from green over blue and red to yellow.
fn level_color(level: u32) -> vec3f {
    let hue = 0.36 + f32(level) * 0.1;
    let wheel = abs(fract(hue + vec3f(0.0, 2.0, 1.0) / 3.0) * 6.0 - 3.0) - 1.0;
    return select(saturate(wheel), vec3f(1.0), level == 0u);
}

@fragment
fn overlay(in: LevelVertex) -> @location(0) vec4f {
    let texel = vec2u(in.position.xy);
    let tile = tile_at(texel);
    if VIEW == 1u {
        return vec4f(level_color(tile.level), 0.6);
    }
    if VIEW == 2u {
        // The last row and column of a tile; pixels have no border to draw.
        let last = ((tile.block + 1u) << vec2u(tile.level)) - 1u;
        let border = tile.level > 0u && any(texel == last);
        return vec4f(level_color(tile.level), select(0.0, 0.7, border));
    }
    let sampled = vec2u(sample_position(tile.block, tile.level, sample_of(tile).a));
    return vec4f(vec3f(0.0), select(0.9, 0.0, all(texel == sampled)));
}
