// Each pixel takes its tile's sample.

#import composite/tiling.wgsl
#import shared/level.wgsl

@fragment
fn nearest(in: LevelVertex) -> @location(0) vec4f {
    return vec4f(sample_of(tile_at(vec2u(in.position.xy))).rgb, 1.0);
}
