// Shades the blocks of a level that the stencil lets through; with LIGHT, their samples' light too.

#variant
#variant LIGHT
#variant AFFINE
#import shared/level.wgsl
#ifdef LIGHT
#import shading/coarse/block_light.wgsl
#else
#import shading/coarse/block.wgsl
#endif

#ifdef LIGHT
struct Shaded {
    @location(0) radiance: vec4f,
    @location(1) light: vec4u,
}

@fragment
fn shade_blocks(in: LevelVertex) -> Shaded {
    let lit = light_block(vec2u(in.position.xy), level_of(in.level));
    return Shaded(lit.radiance, lit.light);
}
#else
@fragment
fn shade_blocks(in: LevelVertex) -> @location(0) vec4f {
    return shade_block(vec2u(in.position.xy), in.level);
}
#endif
