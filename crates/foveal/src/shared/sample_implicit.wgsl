// Textures of a rasterized fragment: the level of detail comes from its neighbours. Before material.wgsl.

fn sample_material(image: texture_2d<f32>, how: sampler, slot: u32, uv: vec4f) -> vec4f {
    return textureSample(image, how, uv_of(slot, uv));
}
