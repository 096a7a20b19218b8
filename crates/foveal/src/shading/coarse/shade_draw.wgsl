// Shades the blocks of a level that the stencil lets through. After block.wgsl and level.wgsl.

@fragment
fn shade_blocks(in: LevelVertex) -> @location(0) vec4f {
    return shade_block(vec2u(in.position.xy), in.level);
}
