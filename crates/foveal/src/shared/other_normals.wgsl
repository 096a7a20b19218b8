// Lobes and differences at several normals at once: what a block's other normals show is asked of
// each light by `shared/lighting.wgsl`, and compared by `shading/coarse/block_light.wgsl`.

#import shared/environment.wgsl
#import shared/light.wgsl

// Luminance by each of a block's normals.
struct OnNormals {
    at_rim: vec4f,
    tilted: vec4f,
}

const NOTHING_ON_NORMALS: OnNormals = OnNormals(vec4f(0.0), vec4f(0.0));

// The direction half-way between two; any where these are opposite.
fn half_way(v: vec3f, l: vec3f) -> vec3f {
    let sum = v + l;
    return sum * inverseSqrt(max(dot(sum, sum), 1e-20));
}

fn cosines_to(normals: Normals, direction: vec3f) -> vec4f {
    return direction.x * normals.x + direction.y * normals.y + direction.z * normals.z;
}

// `ggx_lobe` times the cosine to the light.
fn lobes_on(normals: Normals, v: vec3f, l: vec3f, n_dot_l: vec4f, a2: f32) -> vec4f {
    let n_dot_v = max(cosines_to(normals, v), vec4f(1e-4));
    let n_dot_h = saturate(cosines_to(normals, half_way(v, l)));
    let d = n_dot_h * n_dot_h * (a2 - 1.0) + 1.0;
    let distribution = a2 / (PI * d * d);
    let by_light = n_dot_l * sqrt(n_dot_v * n_dot_v * (1.0 - a2) + a2);
    let by_eye = n_dot_v * sqrt(n_dot_l * n_dot_l * (1.0 - a2) + a2);
    return 0.5 * distribution * n_dot_l / (by_light + by_eye);
}

// The largest difference between what normals show and what they were told to, of those that count.
fn most_apart(normals: Normals, shown: vec4f, told: vec4f) -> f32 {
    let apart = abs(shown - told) * normals.counts;
    return max(max(apart.x, apart.y), max(apart.z, apart.w));
}
