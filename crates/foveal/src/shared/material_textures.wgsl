// The textures of a material, and how they are read.

#ifdef BY_FAMILY
#export geometry/visibility/by_family.wgsl
#else
#ifdef BY_MATERIAL
#export geometry/visibility/by_material.wgsl
#else
#import shared/material.wgsl
#export shared/material_bindings.wgsl

// Of a rasterized fragment: the level of detail comes from its neighbours.
fn sample_material(image: texture_2d<f32>, how: sampler, slot: u32, uv: vec4f) -> vec4f {
    return textureSample(image, how, uv_of(slot, uv));
}
#endif
#endif
