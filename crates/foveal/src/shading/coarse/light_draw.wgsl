// As shade_draw.wgsl, with the samples' light. After block_light.wgsl and level.wgsl.

struct Shaded {
    @location(0) radiance: vec4f,
    @location(1) light: vec4u,
}

@fragment
fn shade_blocks(in: LevelVertex) -> Shaded {
    let lit = light_block(vec2u(in.position.xy), in.level);
    return Shaded(lit.radiance, lit.light);
}
