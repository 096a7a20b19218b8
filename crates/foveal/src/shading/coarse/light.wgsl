// What a sample of coarse shading holds beside its radiance: the lights' light, freed of the
// surface's own colour, so that other surfaces can be put into it (composite/light.wgsl). Rust:
// `composite/light_twin.rs`.
//
// Diffuse light is that of one light in the direction that light comes from on the whole, specular
// light that of one in the direction that it mostly comes from, spread out as the lights are: so
// that each pixel's own normal and roughness shape both.

#import shared/surface.wgsl
#import shared/environment.wgsl

// Least cosine between a normal and a direction of light: light that grazes a surface tells little
// of light on another.
const LEAST_COSINE: f32 = 0.1;

// Luminance, by display white, below which a difference counts as relative to this.
const DARK: f32 = 0.05;

// By how much lights in all directions widen a highlight. Found by measurement: 0.5, which follows
// from half-way directions' turning by half as much as the lights, makes rough stones too bright.
const SPREAD: f32 = 0.1;

// Tangent of the angle by which normals are tilted to ask what they would show.
const TILT: f32 = 0.5;
// About one minus that angle's cosine: the turn from which on a pixel counts as wholly tilted.
const WHOLLY_TILTED: f32 = 0.1;
// One minus the cosine between a normal and what a sample holds of it, at most.
const NORMAL_ROUNDING: f32 = 0.0023;

// Light is packed in this unit: daylight of 100,000 lux is beyond what a shared exponent holds.
const LIGHT_UNIT: f32 = 16.0;

struct SampleLight {
    // Irradiance on a surface that faces `direction`.
    diffuse: vec3f,
    // Radiance per `environment_reflectance` and `highlight`.
    specular: vec3f,
    // Unit directions, world space.
    direction: vec3f,
    specular_direction: vec3f,
    // Added to a surface's squared alpha: at most SPREAD.
    spread: f32,
    // The sample's mean normal, world space.
    normal: vec3f,
    // Of the lamps' luminance within the sample's block, by shadows and by normals at its rim: the
    // standard deviation, as a part of that luminance and DARK.
    deviation: f32,
    // What normals that are tilted from the sample's add to it, on surfaces that are turned so.
    tilted_deviation: f32,
}

// What a surface makes of light that reaches it: its factors of scattered and of mirrored light.
struct LightFactors {
    scattered: vec3f,
    mirrored: vec3f,
}

fn light_factors(s: Surface, v: vec3f) -> LightFactors {
    return LightFactors(diffuse_color(s) / PI, environment_reflectance(s, v));
}

// `mirror`: specular light by `highlight`.
fn reflected(by: LightFactors, diffuse: vec3f, mirror: vec3f) -> vec3f {
    return by.scattered * diffuse + by.mirrored * mirror;
}

// How much of a light's light a surface mirrors, for a normal and a squared alpha.
fn highlight(n: vec3f, v: vec3f, l: vec3f, a2: f32) -> f32 {
    let n_dot_l = max(dot(n, l), LEAST_COSINE);
    return n_dot_l * ggx_lobe(n, v, l, normalize(v + l), n_dot_l, min(a2, 1.0));
}

// What a surface shows of light that a sample holds, and of the environment, by a look into it.
fn shown_of(light: SampleLight, s: Surface, v: vec3f, reaching: f32, look: vec3f) -> vec3f {
    let diffuse = light.diffuse * max(dot(s.normal, light.direction), LEAST_COSINE);
    let mirror = light.specular * highlight(s.normal, v, light.specular_direction, squared_alpha(s) + light.spread);
    let lamps = reflected(light_factors(s, v), diffuse, mirror);
    return min(s.emissive + ambient(s, v, reaching, look) + lamps, vec3f(65504.0));
}

// The unit vector of a direction; `other` where it has none.
fn direction_or(direction: vec3f, other: vec3f) -> vec3f {
    let size = length(direction);
    return select(other, direction / max(size, 1e-30), size > 1e-30);
}

fn snorm_bits(v: vec2f, most: f32) -> vec2u {
    return vec2u(clamp(v, vec2f(-1.0), vec2f(1.0)) * most + (most + 0.5));
}

fn direction_bits(direction: vec3f) -> u32 {
    let bits = snorm_bits(octahedral_from_unit(direction), 511.0);
    return bits.x | (bits.y << 10u);
}

fn direction_from_bits(bits: u32) -> vec3f {
    return unit_from_octahedral(vec2f(vec2u(bits, bits >> 10u) & vec2u(0x3ffu)) / 511.0 - 1.0);
}

// The square root of a part of SPREAD in four bits.
fn spread_bits(spread: f32) -> u32 {
    return u32(sqrt(saturate(spread / SPREAD)) * 15.0 + 0.5);
}

fn spread_from_bits(bits: u32) -> f32 {
    let root = f32(bits) / 15.0;
    return SPREAD * root * root;
}

// A spread as it is held: what is divided by a highlight must be divided by the one that readers see.
fn rounded_spread(spread: f32) -> f32 {
    return spread_from_bits(spread_bits(spread));
}

// Four bits for a deviation of up to 15: what a sample misses may be many times what it holds.
fn deviation_bits(deviation: f32) -> u32 {
    let d = min(deviation, 100.0);
    return min(u32(15.5 * d / (0.5 + d) + 0.5), 15u);
}

fn deviation_from_bits(bits: u32) -> f32 {
    return 0.5 * f32(bits) / (15.5 - f32(bits));
}

// x: diffuse, y: specular, as shared exponents; z and w: directions as 2 x 10 bits; above them in z
// the square root of the spread and both deviations in 4 bits each; above them in w the normal as
// 2 x 6 bits.
fn pack_light(l: SampleLight) -> vec4u {
    let normal = snorm_bits(octahedral_from_unit(l.normal), 31.0);
    return vec4u(
        pack_shared_exponent(l.diffuse / LIGHT_UNIT),
        pack_shared_exponent(l.specular / LIGHT_UNIT),
        direction_bits(l.direction)
            | (spread_bits(l.spread) << 20u)
            | (deviation_bits(l.tilted_deviation) << 24u)
            | (deviation_bits(l.deviation) << 28u),
        direction_bits(l.specular_direction) | (normal.x << 20u) | (normal.y << 26u),
    );
}

fn unpack_light(words: vec4u) -> SampleLight {
    let normal = vec2f(vec2u(words.w >> 20u, words.w >> 26u) & vec2u(0x3fu)) / 31.0 - 1.0;
    return SampleLight(
        LIGHT_UNIT * unpack_shared_exponent(words.x),
        LIGHT_UNIT * unpack_shared_exponent(words.y),
        direction_from_bits(words.z),
        direction_from_bits(words.w),
        spread_from_bits((words.z >> 20u) & 0xfu),
        unit_from_octahedral(normal),
        deviation_from_bits(words.z >> 28u),
        deviation_from_bits((words.z >> 24u) & 0xfu),
    );
}
