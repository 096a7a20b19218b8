// What shading reads. After layers.wgsl. reduced/input.wgsl stands in where there are no storage buffers.

@group(1) @binding(0) var gbuffer_surface: texture_2d_array<u32>;
@group(1) @binding(1) var gbuffer_depth: texture_depth_2d_array;
@group(1) @binding(2) var<storage, read> lights: Lights;
@group(1) @binding(3) var<storage, read> cluster_lights: array<u32>;

fn gbuffer_words_at(texel: vec2u) -> vec4u {
    return load_words(gbuffer_surface, texel);
}

fn gbuffer_depth_at(texel: vec2u) -> f32 {
    return load_depth(gbuffer_depth, texel);
}
