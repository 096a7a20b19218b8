// What shading reads: the G-buffer and the lights.

#ifndef TABLES
#import shared/light.wgsl
#endif
#ifndef REDUCED
#import shared/layers.wgsl
#endif

#ifdef TABLES
@group(1) @binding(2) var light_table: texture_2d<u32>;
#else
@group(1) @binding(2) var<storage, read> lights: Lights;
#endif
#ifdef TABLES
@group(1) @binding(4) var shadow_table: texture_2d<u32>;
#else
@group(1) @binding(4) var<storage, read> shadow_rows: array<vec4u>;
#endif
@group(1) @binding(5) var shadow_atlas: texture_depth_2d;
@group(1) @binding(6) var shadow_sampler: sampler_comparison;

#ifdef REDUCED
@group(1) @binding(0) var gbuffer_surface: texture_2d<u32>;
@group(1) @binding(1) var gbuffer_depth: texture_2d<u32>;
@group(1) @binding(3) var cluster_table: texture_2d<u32>;

fn gbuffer_words_at(texel: vec2u) -> vec4u {
    return textureLoad(gbuffer_surface, texel, 0);
}

fn gbuffer_depth_at(texel: vec2u) -> f32 {
    return bitcast<f32>(textureLoad(gbuffer_depth, texel, 0).x);
}
#else
@group(1) @binding(0) var gbuffer_surface: texture_2d_array<u32>;
@group(1) @binding(1) var gbuffer_depth: texture_depth_2d_array;
@group(1) @binding(3) var<storage, read> cluster_lights: array<u32>;

fn gbuffer_words_at(texel: vec2u) -> vec4u {
    return load_words(gbuffer_surface, texel);
}

fn gbuffer_depth_at(texel: vec2u) -> f32 {
    return load_depth(gbuffer_depth, texel);
}
#endif
