// The environment: what is seen behind all surfaces, and what a surface reflects of it, lights
// aside. CPU twin: `environment/twin.rs`.

#import shared/frame.wgsl
#import shared/surface.wgsl

// Where its light comes from: `ENVIRONMENT_GRADIENT`, `ENVIRONMENT_MAP`, or 2 for no light at all.
override ENVIRONMENT: u32 = 0u;
// What is seen behind all surfaces: `BACKGROUND_SHARP`, `BACKGROUND_BLURRED`, or 2 for nothing.
override BACKGROUND: u32 = 0u;

const ENVIRONMENT_GRADIENT: u32 = 0u;
const ENVIRONMENT_MAP: u32 = 1u;
const BACKGROUND_SHARP: u32 = 0u;
const BACKGROUND_BLURRED: u32 = 1u;
// Roughness of the mirror in which a blurred background is seen.
const BLURRED_ROUGHNESS: f32 = 0.5;

// What microfacets lose by counting one bounce alone is given back.
override MULTIPLE_SCATTERING: bool = false;
// What occludes the environment is found in the picture's depth (`ambient/`).
override AMBIENT_OCCLUSION: bool = false;

const PI: f32 = 3.14159265;

// Level 0: radiance; the others: what rougher and rougher mirrors reflect of it.
@group(0) @binding(3) var environment_map: texture_cube<f32>;
// What a mirror reflects of light that comes from everywhere alike, in one bounce: the reflectance at
// right angles times the first, plus the second; what it leaves is 1 minus that reflectance, times the
// third. By the cosine between normal and view, and the roughness, both from 0 in the first entry to 1
// in the last.
@group(0) @binding(4) var environment_reflectances: texture_2d<f32>;
@group(0) @binding(5) var environment_sampler: sampler;
#ifndef TRANSMISSION
// Part of the environment's light that reaches each pixel, and the distance of the surface there.
// Surfaces that light passes read as many textures as there may be, without it.
#ifdef REDUCED
// Their bits: WebGL 2 draws to no floats of 32 bits.
@group(0) @binding(6) var ambient_visibility: texture_2d<u32>;

fn visibility_found(at: vec2i) -> vec2f {
    return bitcast<vec2f>(textureLoad(ambient_visibility, at, 0).xy);
}
#else
@group(0) @binding(6) var ambient_visibility: texture_2d<f32>;

fn visibility_found(at: vec2i) -> vec2f {
    return textureLoad(ambient_visibility, at, 0).xy;
}
#endif
#endif

// Difference of distances up to which a pixel's visibility is taken as it is, and the one beyond
// which no pixel around speaks for a surface: nothing occludes it then. As parts of the distance, or
// of half the height that a parallel projection shows.
const SAME_SURFACE: f32 = 0.005;
const OTHER_SURFACE: f32 = 0.05;

// Radiance of the scene's own sky in a direction.
fn gradient(direction: vec3f) -> vec3f {
    if direction.y >= 0.0 {
        return mix(frame.horizon, frame.zenith, sqrt(direction.y));
    }
    return mix(frame.horizon, frame.nadir, min(1.0, -4.0 * direction.y));
}

// A direction as the map has it, before it is turned.
fn in_map(d: vec3f) -> vec3f {
    let turn = frame.environment_turn;
    return vec3f(turn.x * d.x - turn.y * d.z, d.y, turn.y * d.x + turn.x * d.z);
}

// The level of the map that shows what a mirror of this roughness reflects.
fn environment_level(roughness: f32) -> f32 {
    let r = max(roughness, 1e-3);
    let levels = frame.environment_levels;
    return max(levels.x + levels.y * log2(r), min(r * r * levels.z, 1.0));
}

// What a mirror of this roughness reflects that looks in a unit direction.
fn environment(direction: vec3f, roughness: f32) -> vec3f {
    if ENVIRONMENT == ENVIRONMENT_MAP {
        let level = environment_level(roughness);
        let radiance = textureSampleLevel(environment_map, environment_sampler, in_map(direction), level).rgb;
        return frame.environment_intensity * radiance;
    }
    if ENVIRONMENT == ENVIRONMENT_GRADIENT {
        return gradient(direction);
    }
    return vec3f(0.0);
}

// Where a surface mirrors the environment from, a unit vector.
fn mirrored_direction(s: Surface, v: vec3f) -> vec3f {
    return normalize(mix(reflect(-v, s.normal), s.normal, s.roughness * s.roughness));
}

// A look at the environment: in a surface, or, where `is_behind`, behind all surfaces, in the direction
// from the eye that `v` is opposite to. One look for both: where all branches are run each would cost.
fn environment_look(s: Surface, v: vec3f, is_behind: bool) -> vec3f {
    let background_roughness = select(0.0, BLURRED_ROUGHNESS, BACKGROUND == BACKGROUND_BLURRED);
    let roughness = select(s.roughness, background_roughness, is_behind);
    return environment(select(mirrored_direction(s, v), -v, is_behind), roughness);
}

// Radiance behind all surfaces, by a look there.
fn background(look: vec3f) -> vec3f {
    if BACKGROUND != BACKGROUND_SHARP && BACKGROUND != BACKGROUND_BLURRED {
        return vec3f(0.0);
    }
    // What a half can hold.
    return min(look, vec3f(65504.0));
}

// Irradiance of the map over pi (Ramamoorthi and Hanrahan 2001).
fn irradiance(normal: vec3f) -> vec3f {
    let n = in_map(normal);
    let c = frame.irradiance;
    var sum = c[0] + c[1] * n.y + c[2] * n.z + c[3] * n.x;
    sum += c[4] * (n.x * n.y) + c[5] * (n.y * n.z) + c[7] * (n.x * n.z);
    sum += c[6] * (3.0 * n.z * n.z - 1.0) + c[8] * (n.x * n.x - n.y * n.y);
    // Order 2 overshoots on the far side of a small, bright source.
    return max(sum.rgb, vec3f(0.0));
}

fn reflectance_at_normal(s: Surface) -> vec3f {
    return mix(s.dielectric.xyz, s.base_color, s.metallic);
}

// At grazing angles; exactly 1 for a plain dielectric.
fn reflectance_at_grazing(s: Surface) -> f32 {
    return 1.0 - (1.0 - s.metallic) * (1.0 - s.dielectric.w);
}

// What keeps light from being scattered, at right angles and at grazing ones. What is scattered is the
// dielectric's part of the mix of metal and dielectric, so that it is the dielectric's reflectance
// (glTF 2.0 appendix B), in the strongest channel: nothing is scattered in the reflection's
// complementary colour (KHR_materials_specular).
fn kept_from_scattering(s: Surface) -> vec2f {
    let d = s.dielectric;
    return vec2f(max(d.x, max(d.y, d.z)), d.w);
}

// What a surface mirrors by Fresnel's law, found once for all lights.
struct Mirror {
    at_normal: vec3f,
    at_grazing: f32,
    // As `kept_from_scattering`.
    kept: vec2f,
    // By how much further bounces brighten what it mirrors of lights: `further_bounces`.
    gain: vec3f,
}

fn mirror_of(s: Surface) -> Mirror {
    return Mirror(reflectance_at_normal(s), reflectance_at_grazing(s), kept_from_scattering(s), vec3f(1.0));
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
    if MULTIPLE_SCATTERING {
        return reflected_once(s, reflectance_terms(s, v)) * further_bounces(s, v);
    }
    let n_dot_v = saturate(dot(s.normal, v));
    let f0 = reflectance_at_normal(s);
    let r = s.roughness * vec4f(-1.0, -0.0275, -0.572, 0.022) + vec4f(1.0, 0.0425, 1.04, -0.04);
    let a004 = min(r.x * r.x, exp2(-9.28 * n_dot_v)) * r.x + r.y;
    let scale_bias = vec2f(-1.04, 1.04) * a004 + r.zw;
    return f0 * scale_bias.x + scale_bias.y * reflectance_at_grazing(s);
}

// The table's entry for a surface: from the first one's centre to the last one's.
fn reflectance_terms(s: Surface, v: vec3f) -> vec3f {
    let at = (vec2f(saturate(dot(s.normal, v)), s.roughness) * 31.0 + 0.5) / 32.0;
    return textureSampleLevel(environment_reflectances, environment_sampler, at, 0.0).xyz;
}

// What a rough mirror reflects of light that comes from everywhere alike, by the table's entry: in one
// bounce.
fn reflected_once(s: Surface, terms: vec3f) -> vec3f {
    return reflectance_at_normal(s) * terms.x + terms.y * reflectance_at_grazing(s);
}

// By how much bounces after the first brighten what a rough mirror shows of a light: a white one
// reflects all (Turquin 2019, 'Practical multiple scattering compensation for microfacet models').
fn further_bounces(s: Surface, v: vec3f) -> vec3f {
    let terms = reflectance_terms(s, v);
    // Of a mirror that absorbs nothing.
    let once = terms.x + terms.y;
    return 1.0 + reflectance_at_normal(s) * (1.0 / max(once, 0.05) - 1.0);
}

// What bounces after the first reflect of light that comes from everywhere alike (Fdez-Aguera 2019, 'A
// Multiple-Scattering Microfacet Model for Real-Time Image-based Lighting').
fn reflected_further(s: Surface, terms: vec3f) -> vec3f {
    let lost = max(1.0 - terms.x - terms.y, 0.0);
    let at_normal = reflectance_at_normal(s);
    // Fresnel's reflectance over all directions.
    let mean = at_normal + (reflectance_at_grazing(s) - at_normal) / 21.0;
    return reflected_once(s, terms) * mean * lost / (1.0 - mean * lost);
}

// Mean radiance from the directions before a surface, by their cosines.
fn environment_around(normal: vec3f) -> vec3f {
    if ENVIRONMENT == ENVIRONMENT_MAP {
        return irradiance(normal);
    }
    if ENVIRONMENT == ENVIRONMENT_GRADIENT {
        return mix(mix(frame.nadir, frame.zenith, 0.5 + 0.5 * normal.y), frame.horizon, 0.4);
    }
    return vec3f(0.0);
}

// The environment's light in a rough mirror, by a look into it.
fn environment_specular(s: Surface, v: vec3f, look: vec3f) -> vec3f {
    if MULTIPLE_SCATTERING {
        let terms = reflectance_terms(s, v);
        let once = reflected_once(s, terms) * look;
        return once + reflected_further(s, terms) * environment_around(s.normal);
    }
    if ENVIRONMENT == ENVIRONMENT_MAP {
        let terms = reflectance_terms(s, v);
        let reflected = reflectance_at_normal(s) * terms.x + terms.y * reflectance_at_grazing(s);
        return reflected * look;
    }
    return environment_reflectance(s, v) * look;
}

// What a surface scatters of the environment's light.
fn environment_diffuse(s: Surface, v: vec3f) -> vec3f {
    if ENVIRONMENT == ENVIRONMENT_MAP {
        let part = reflectance_terms(s, v).z;
        let left = 1.0 - kept_from_scattering(s);
        return diffuse_color(s) * (left.x * part + left.y * (1.0 - part)) * irradiance(s.normal);
    }
    if ENVIRONMENT == ENVIRONMENT_GRADIENT {
        let around = mix(mix(frame.nadir, frame.zenith, 0.5 + 0.5 * s.normal.y), frame.horizon, 0.4);
        return s.base_color * (1.0 - s.metallic) * around;
    }
    return vec3f(0.0);
}

// Part of the environment's light that reaches a surface at a position in pixels of the target and a
// distance along the view axis. Sub-samples and what is drawn forward may lie on another surface
// than the pixel's: they take the pixel around that is nearest to theirs.
fn environment_seen(pixel: vec2f, distance: f32) -> f32 {
#ifdef TRANSMISSION
    return 1.0;
#else
    if !AMBIENT_OCCLUSION {
        return 1.0;
    }
    let picture = picture_of(vec2u(pixel));
    let first = vec2i(picture.low);
    let last = vec2i(picture.end) - 1;
    let at = clamp(vec2i(pixel), first, last);
    var found = visibility_found(at);
    let half_height = abs(frame.views[view_at(pixel)].view_from_ndc.y);
    let scale = select(distance, half_height, frame.orthographic != 0u);
    if abs(found.y - distance) > SAME_SURFACE * scale {
        for (var i = 0; i < 9; i++) {
            let beside = clamp(at + vec2i(i % 3, i / 3) - 1, first, last);
            let other = visibility_found(beside);
            found = select(found, other, abs(other.y - distance) < abs(found.y - distance));
        }
    }
    return select(1.0, found.x, abs(found.y - distance) <= OTHER_SURFACE * scale);
#endif
}

// The same of light in a rough mirror, which comes from fewer directions (Lagarde and de Rousiers
// 2014, 'Moving Frostbite to Physically Based Rendering', section 4.10.2).
fn mirrored_seen(s: Surface, v: vec3f, seen: f32) -> f32 {
    if !AMBIENT_OCCLUSION {
        return 1.0;
    }
    let n_dot_v = saturate(dot(s.normal, v));
    return saturate(pow(n_dot_v + seen, exp2(-16.0 * s.roughness * s.roughness - 1.0)) - 1.0 + seen);
}

// The environment's light, of which `seen` reaches the surface, by a look into it.
fn ambient(s: Surface, v: vec3f, seen: f32, look: vec3f) -> vec3f {
    let diffuse = environment_diffuse(s, v) * seen;
    let specular = environment_specular(s, v, look) * mirrored_seen(s, v, seen);
    return (diffuse + select(specular, vec3f(0.0), s.occlusion < 0.0)) * abs(s.occlusion);
}
