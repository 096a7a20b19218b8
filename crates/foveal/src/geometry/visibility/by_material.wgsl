// One material alone.

#import shared/material.wgsl
#export shared/material_bindings.wgsl
#import shared/sample_gradients.wgsl

fn dispatch_number() -> u32 {
    return material.number;
}

fn take_material_of(instance: u32) {}

fn sample_material(image: texture_2d<f32>, how: sampler, slot: u32, uv: vec4f) -> vec4f {
    return textureSampleGrad(image, how, uv_of(slot, uv), uv_step(slot, uv_right), uv_step(slot, uv_down));
}
