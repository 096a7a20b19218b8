// Each pixel takes its tile's sample. After tiling.wgsl.

@fragment
fn nearest(in: LevelVertex) -> @location(0) vec4f {
    return vec4f(sample_of(tile_at(vec2u(in.position.xy))).rgb, 1.0);
}
