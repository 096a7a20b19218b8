// The normal seen at a texel, world space: the surface's, bumps included. After surface.wgsl and layers.wgsl, beside
// `gbuffer_surface`.

fn normal_seen(texel: vec2u) -> vec3f {
    return unit_from_octahedral(unpack2x16snorm(load_words(gbuffer_surface, texel).y));
}
