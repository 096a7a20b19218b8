// The materials of a family: textures are layers of its arrays. Rust: `scene/families.rs`.

#import shared/material.wgsl
#import shared/places.wgsl
#import shared/sample_gradients.wgsl

// All of the scene.
@group(1) @binding(0) var<storage, read> materials: array<Material>;
@group(1) @binding(1) var<uniform> family_number: u32;
@group(1) @binding(2) var base_color_texture: texture_2d_array<f32>;
@group(1) @binding(3) var base_color_sampler: sampler;
@group(1) @binding(4) var metallic_roughness_texture: texture_2d_array<f32>;
@group(1) @binding(5) var metallic_roughness_sampler: sampler;
@group(1) @binding(6) var normal_texture: texture_2d_array<f32>;
@group(1) @binding(7) var normal_sampler: sampler;
@group(1) @binding(8) var occlusion_texture: texture_2d_array<f32>;
@group(1) @binding(9) var occlusion_sampler: sampler;
@group(1) @binding(10) var emissive_texture: texture_2d_array<f32>;
@group(1) @binding(11) var emissive_sampler: sampler;
@group(1) @binding(12) var specular_texture: texture_2d_array<f32>;
@group(1) @binding(13) var specular_sampler: sampler;
@group(1) @binding(14) var specular_color_texture: texture_2d_array<f32>;
@group(1) @binding(15) var specular_color_sampler: sampler;

// The pixel's.
var<private> material: Material;

fn dispatch_number() -> u32 {
    return family_number;
}

fn take_material_of(instance: u32) {
    material = materials[place_of(instance).material];
}

fn sample_material(image: texture_2d_array<f32>, how: sampler, slot: u32, uv: vec4f) -> vec4f {
    let layer = (material.layers[slot / 4u] >> (slot % 4u * 8u)) & 255u;
    return textureSampleGrad(image, how, uv_of(slot, uv), layer, uv_step(slot, uv_right), uv_step(slot, uv_down));
}
