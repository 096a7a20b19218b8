// What an entry adds to its pixel's sum. After samples.wgsl and weight.wgsl.

fn weighted(radiance: vec3f, coverage: u32) -> vec4f {
    return vec4f(radiance, 1.0) * (weight_of(radiance) * f32(coverage) / f32(COUNT));
}
