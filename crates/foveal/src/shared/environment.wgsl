// What a surface reflects of its environment, lights aside.

#import shared/frame.wgsl
#import shared/surface.wgsl

const PI: f32 = 3.14159265;

fn reflectance_at_normal(s: Surface) -> vec3f {
    return mix(vec3f(0.04), s.base_color, s.metallic);
}

fn luminance(color: vec3f) -> f32 {
    return dot(color, vec3f(0.2126, 0.7152, 0.0722));
}

// Square of the GGX distribution's alpha.
fn squared_alpha(s: Surface) -> f32 {
    let alpha = max(s.roughness * s.roughness, 0.002);
    return alpha * alpha;
}

// GGX distribution times visibility (glTF 2.0 appendix B; Heitz 2014): `l` and `v` are unit
// directions, `h` lies half-way.
fn ggx_lobe(n: vec3f, v: vec3f, l: vec3f, h: vec3f, n_dot_l: f32, a2: f32) -> f32 {
    let n_dot_v = max(dot(n, v), 1e-4);
    let n_dot_h = saturate(dot(n, h));
    let d = n_dot_h * n_dot_h * (a2 - 1.0) + 1.0;
    let distribution = a2 / (PI * d * d);
    let visibility = 0.5 / (n_dot_l * sqrt(n_dot_v * n_dot_v * (1.0 - a2) + a2)
        + n_dot_v * sqrt(n_dot_l * n_dot_l * (1.0 - a2) + a2));
    return distribution * visibility;
}

// Radiance of diffuse reflection per irradiance over pi that is left for it.
fn diffuse_color(s: Surface) -> vec3f {
    return (1.0 - s.metallic) * s.base_color;
}

// What a rough mirror reflects of light that comes from everywhere alike (environment BRDF after
// Karis 2014, 'Physically Based Shading on Mobile').
fn environment_reflectance(s: Surface, v: vec3f) -> vec3f {
    let n_dot_v = saturate(dot(s.normal, v));
    let f0 = reflectance_at_normal(s);
    let r = s.roughness * vec4f(-1.0, -0.0275, -0.572, 0.022) + vec4f(1.0, 0.0425, 1.04, -0.04);
    let a004 = min(r.x * r.x, exp2(-9.28 * n_dot_v)) * r.x + r.y;
    let scale_bias = vec2f(-1.04, 1.04) * a004 + r.zw;
    return f0 * scale_bias.x + scale_bias.y;
}

// The environment's light in a rough mirror.
fn environment_specular(s: Surface, v: vec3f) -> vec3f {
    let mirror = mix(reflect(-v, s.normal), s.normal, s.roughness * s.roughness);
    return environment_reflectance(s, v) * environment(normalize(mirror));
}

// The environment's light: a cosine-weighted look along the normal, and the mirror.
fn ambient(s: Surface, v: vec3f) -> vec3f {
    let irradiance = mix(mix(frame.nadir, frame.zenith, 0.5 + 0.5 * s.normal.y), frame.horizon, 0.4);
    let diffuse = s.base_color * (1.0 - s.metallic) * irradiance;
    return (diffuse + select(environment_specular(s, v), vec3f(0.0), s.occlusion < 0.0)) * abs(s.occlusion);
}
