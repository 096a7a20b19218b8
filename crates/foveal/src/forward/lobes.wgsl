// Lobes beside metallic-roughness: clear coat, sheen, anisotropy, iridescence and transmission, at a point
// of a surface and in its light. Rust: `scene/lobes.rs`; CPU twin: `forward/lobes_twin.rs`.

#import forward/film.wgsl
#import shared/environment.wgsl
#import shared/frame.wgsl
#import shared/light.wgsl
#import shared/light_list.wgsl
#import shared/lighting.wgsl
#import shared/material.wgsl
#ifdef REDUCED
#import shared/material_bindings.wgsl
#endif
#import shared/surface.wgsl
#import shadow/lookup.wgsl
#import shadow/tile.wgsl

// Which of the bound textures each of the material's places reads, from 1 on, three bits each.
override LOBE_TEXTURES: u32 = 0u;

// Further bits of `MATERIAL_CLASS`.
const HAS_CLEARCOAT: u32 = 4096u;
const HAS_SHEEN: u32 = 8192u;
const HAS_ANISOTROPY: u32 = 16384u;
const HAS_TRANSMISSION: u32 = 32768u;
// The coat's normal map has x and y alone (BC5).
const COAT_NORMAL_OF_TWO: u32 = 131072u;
const HAS_IRIDESCENCE: u32 = 262144u;

const CLEARCOAT: u32 = 0u;
const CLEARCOAT_ROUGHNESS: u32 = 1u;
const CLEARCOAT_NORMAL: u32 = 2u;
const SHEEN_COLOR: u32 = 3u;
const SHEEN_ROUGHNESS: u32 = 4u;
const ANISOTROPY: u32 = 5u;
const TRANSMISSION: u32 = 6u;
const THICKNESS: u32 = 7u;
const IRIDESCENCE: u32 = 8u;
const FILM_THICKNESS: u32 = 9u;

// Below, the distribution of fibres is too narrow for halves.
const LEAST_SHEEN_ROUGHNESS: f32 = 0.1;

struct Lobes {
    sheen_color: vec3f,
    sheen_roughness: f32,
    clearcoat: f32,
    clearcoat_roughness: f32,
    clearcoat_normal_scale: f32,
    anisotropy: f32,
    // Cosine and sine of the rotation.
    anisotropy_turn: vec2f,
    transmission: f32,
    // Metres, in the mesh's scale.
    thickness: f32,
    // Per metre.
    absorption: vec3f,
    ior: f32,
    iridescence: f32,
    film_ior: f32,
    // Nanometres where the texture is black and where it is white.
    film_thickness: vec2f,
    uv: array<UvMap, 10>,
}

@group(1) @binding(15) var<uniform> lobes: Lobes;
#ifndef REDUCED
@group(1) @binding(16) var lobe_texture_1: texture_2d<f32>;
@group(1) @binding(17) var lobe_sampler_1: sampler;
@group(1) @binding(18) var lobe_texture_2: texture_2d<f32>;
@group(1) @binding(19) var lobe_sampler_2: sampler;
@group(1) @binding(20) var lobe_texture_3: texture_2d<f32>;
@group(1) @binding(21) var lobe_sampler_3: sampler;
@group(1) @binding(22) var lobe_texture_4: texture_2d<f32>;
@group(1) @binding(23) var lobe_sampler_4: sampler;
@group(1) @binding(24) var lobe_texture_5: texture_2d<f32>;
@group(1) @binding(25) var lobe_sampler_5: sampler;
#endif

// A point of a lobed surface, ready to be lit.
struct LobedSurface {
    base: Surface,
    base_mirror: Mirror,
    clearcoat: f32,
    // The coat alone, as a dielectric that scatters nothing.
    coat: Surface,
    coat_mirror: Mirror,
    sheen_color: vec3f,
    sheen_roughness: f32,
    // Unit, along the longer side of highlights and across; and how much longer.
    along: vec3f,
    across: vec3f,
    anisotropy: f32,
    // Part of what would be scattered that passes instead, and through how much.
    transmission: f32,
    thickness: f32,
    film: Film,
}

fn bound_texture(place: u32) -> u32 {
    return (LOBE_TEXTURES >> (3u * place)) & 7u;
}

// White where the place has no texture.
fn sample_lobe(place: u32, uv: vec4f) -> vec4f {
    let map = lobes.uv[place];
    let p = vec3f(select(uv.xy, uv.zw, map.x.w > 0.5), 1.0);
    let at = vec2f(dot(map.x.xyz, p), dot(map.y.xyz, p));
    let bound = bound_texture(place);
#ifdef REDUCED
    // Where the material itself reads none.
    if bound == 1u {
        return textureSample(specular_color_texture, specular_color_sampler, at);
    } else if bound == 2u {
        return textureSample(specular_texture, specular_sampler, at);
    } else if bound == 3u {
        return textureSample(emissive_texture, emissive_sampler, at);
    } else if bound == 4u {
        return textureSample(occlusion_texture, occlusion_sampler, at);
    } else if bound == 5u {
        return textureSample(normal_texture, normal_sampler, at);
    } else if bound == 6u {
        return textureSample(metallic_roughness_texture, metallic_roughness_sampler, at);
    } else if bound == 7u {
        return textureSample(base_color_texture, base_color_sampler, at);
    }
#else
    if bound == 1u {
        return textureSample(lobe_texture_1, lobe_sampler_1, at);
    } else if bound == 2u {
        return textureSample(lobe_texture_2, lobe_sampler_2, at);
    } else if bound == 3u {
        return textureSample(lobe_texture_3, lobe_sampler_3, at);
    } else if bound == 4u {
        return textureSample(lobe_texture_4, lobe_sampler_4, at);
    } else if bound == 5u {
        return textureSample(lobe_texture_5, lobe_sampler_5, at);
    }
#endif
    return vec4f(1.0);
}

// Normal, tangent and uv as interpolated; `facing` is -1 where the back is seen.
fn lobes_at(s: Surface, normal: vec3f, tangent_at_rest: vec4f, uv: vec4f, facing: f32) -> LobedSurface {
    let tangent = turned(normal, tangent_at_rest);
    let bitangent = cross(normal, tangent.xyz) * tangent.w;
    let has_tangent = dot(tangent.xyz, tangent.xyz) > 0.0;
    let mirror = mirror_of(s);
    var found = LobedSurface(s, mirror, 0.0, s, mirror, vec3f(0.0), 1.0, vec3f(0.0), vec3f(0.0), 0.0, 0.0, 0.0, Film(0.0, 1.0, 0.0));
    if (MATERIAL_CLASS & HAS_CLEARCOAT) != 0u {
        found.clearcoat = lobes.clearcoat * sample_lobe(CLEARCOAT, uv).r;
        var n = s.vertex_normal;
        if bound_texture(CLEARCOAT_NORMAL) != 0u {
            var texel = sample_lobe(CLEARCOAT_NORMAL, uv).xyz * 2.0 - 1.0;
            if (MATERIAL_CLASS & COAT_NORMAL_OF_TWO) != 0u {
                texel = unit_above(texel.xy);
            }
            let bent = texel.x * lobes.clearcoat_normal_scale * tangent.xyz
                + texel.y * lobes.clearcoat_normal_scale * bitangent + texel.z * normal;
            n = select(n, normalize(bent) * facing, has_tangent);
        }
        let roughness = saturate(lobes.clearcoat_roughness * sample_lobe(CLEARCOAT_ROUGHNESS, uv).g);
        found.coat = Surface(
            s.position, n, s.vertex_normal, vec3f(0.0), 0.0, roughness, s.occlusion, vec3f(0.0), PLAIN_DIELECTRIC,
        );
        found.coat_mirror = mirror_of(found.coat);
    }
    if (MATERIAL_CLASS & HAS_SHEEN) != 0u {
        found.sheen_color = lobes.sheen_color * sample_lobe(SHEEN_COLOR, uv).rgb;
        let roughness = lobes.sheen_roughness * sample_lobe(SHEEN_ROUGHNESS, uv).a;
        found.sheen_roughness = clamp(roughness, LEAST_SHEEN_ROUGHNESS, 1.0);
    }
    if (MATERIAL_CLASS & HAS_ANISOTROPY) != 0u {
        var direction = lobes.anisotropy_turn;
        var strength = lobes.anisotropy;
        if bound_texture(ANISOTROPY) != 0u {
            let texel = sample_lobe(ANISOTROPY, uv).xyz;
            let d = texel.xy * 2.0 - 1.0;
            let turn = lobes.anisotropy_turn;
            direction = vec2f(turn.x * d.x - turn.y * d.y, turn.y * d.x + turn.x * d.y);
            strength *= texel.z;
        }
        let t = direction.x * tangent.xyz + direction.y * bitangent;
        let in_plane = t - dot(t, s.normal) * s.normal;
        let size = length(in_plane);
        found.along = in_plane / max(size, 1e-6);
        found.across = cross(s.normal, found.along);
        found.anisotropy = select(0.0, saturate(strength), has_tangent && size > 1e-6);
    }
    if (MATERIAL_CLASS & HAS_TRANSMISSION) != 0u {
        found.transmission = lobes.transmission * sample_lobe(TRANSMISSION, uv).r;
        found.thickness = lobes.thickness * sample_lobe(THICKNESS, uv).g;
    }
    if (MATERIAL_CLASS & HAS_IRIDESCENCE) != 0u {
        let thickness = mix(lobes.film_thickness.x, lobes.film_thickness.y, sample_lobe(FILM_THICKNESS, uv).g);
        let strength = lobes.iridescence * sample_lobe(IRIDESCENCE, uv).r;
        found.film = film_of(strength, lobes.film_ior, thickness);
    }
    return found;
}

// Part of light from everywhere that sheen of white reflects: rows by roughness, columns by the
// cosine between normal and view, at the middles of eighths. A test integrates the lobe.
var<private> sheen_parts: array<f32, 64> = array<f32, 64>(
    0.8665, 0.1615, 0.0257, 0.0029, 0.0002, 0.0000, 0.0000, 0.0000,
    0.7516, 0.3002, 0.1228, 0.0464, 0.0151, 0.0039, 0.0007, 0.0000,
    0.6526, 0.3647, 0.2155, 0.1252, 0.0692, 0.0353, 0.0153, 0.0044,
    0.6362, 0.4099, 0.2806, 0.1921, 0.1284, 0.0832, 0.0495, 0.0243,
    0.6671, 0.4625, 0.3412, 0.2535, 0.1862, 0.1352, 0.0938, 0.0588,
    0.7218, 0.5203, 0.3998, 0.3106, 0.2403, 0.1857, 0.1400, 0.0998,
    0.7766, 0.5716, 0.4493, 0.3583, 0.2859, 0.2293, 0.1816, 0.1392,
    0.8034, 0.5992, 0.4783, 0.3882, 0.3163, 0.2603, 0.2130, 0.1710,
);

fn sheen_part(cosine: f32, roughness: f32) -> f32 {
    let at = clamp(vec2f(cosine, roughness) * 8.0 - 0.5, vec2f(0.0), vec2f(7.0));
    let low = min(vec2u(at), vec2u(6u));
    let f = at - vec2f(low);
    let first = low.y * 8u + low.x;
    let upper = mix(sheen_parts[first], sheen_parts[first + 1u], f.x);
    return mix(upper, mix(sheen_parts[first + 8u], sheen_parts[first + 9u], f.x), f.y);
}

// Fibres' shadowing (Estevez and Kulla 2017, 'Production Friendly Microfacet Sheen BRDF').
fn fibre_shape(x: f32, alpha: f32) -> f32 {
    let t = (1.0 - alpha) * (1.0 - alpha);
    let a = mix(21.5473, 25.3245, t);
    let b = mix(3.82987, 3.32435, t);
    let c = mix(0.19823, 0.16801, t);
    let d = mix(-1.97760, -1.27393, t);
    let e = mix(-4.32054, -4.85967, t);
    return a / (1.0 + b * pow(max(x, 1e-4), c)) + d * x + e;
}

fn fibre_shadowing(cosine: f32, alpha: f32) -> f32 {
    let far = 2.0 * fibre_shape(0.5, alpha) - fibre_shape(1.0 - cosine, alpha);
    return exp(select(far, fibre_shape(cosine, alpha), cosine < 0.5));
}

// Radiance per irradiance of sheen of white: the Charlie distribution.
fn sheen_lobe(n: vec3f, v: vec3f, l: vec3f, n_dot_l: f32, roughness: f32) -> f32 {
    let alpha = roughness * roughness;
    let n_dot_v = max(dot(n, v), 1e-3);
    let n_dot_h = saturate(dot(n, normalize(v + l)));
    let sine2 = max(1.0 - n_dot_h * n_dot_h, 1e-6);
    let distribution = (2.0 + 1.0 / alpha) * pow(sine2, 0.5 / alpha) / (2.0 * PI);
    let shadowing = 1.0 + fibre_shadowing(n_dot_v, alpha) + fibre_shadowing(n_dot_l, alpha);
    return distribution / (4.0 * n_dot_v * max(n_dot_l, 1e-3) * shadowing);
}

// What sheen leaves for the layer below it, at a cosine.
fn below_sheen(s: LobedSurface, cosine: f32) -> f32 {
    let c = s.sheen_color;
    return 1.0 - max(c.x, max(c.y, c.z)) * sheen_part(cosine, s.sheen_roughness);
}

// What the coat leaves for everything below it: Fresnel's reflectance at the cosine between normal
// and view, as KHR_materials_clearcoat has it, would darken the rim of rough coats. The fit of
// `environment_reflectance` exceeds 1 where smooth coats are seen from the side.
fn below_coat(s: LobedSurface, v: vec3f) -> f32 {
    return 1.0 - s.clearcoat * saturate(environment_reflectance(s.coat, v).x);
}

// As `ggx_lobe`, longer along than across (Burley 2012; Heitz 2014).
fn anisotropic_lobe(s: LobedSurface, v: vec3f, l: vec3f, h: vec3f, n_dot_l: f32) -> f32 {
    let across = max(s.base.roughness * s.base.roughness, 0.002);
    let along = mix(across, 1.0, s.anisotropy * s.anisotropy);
    let n = s.base.normal;
    let n_dot_v = max(dot(n, v), 1e-4);
    let a2 = along * across;
    let f = vec3f(across * dot(s.along, h), along * dot(s.across, h), a2 * dot(n, h));
    let w2 = a2 / max(dot(f, f), 1e-20);
    let distribution = a2 * w2 * w2 / PI;
    let to_eye = vec3f(along * dot(s.along, v), across * dot(s.across, v), n_dot_v);
    let to_light = vec3f(along * dot(s.along, l), across * dot(s.across, l), n_dot_l);
    return distribution * 0.5 / (n_dot_l * length(to_eye) + n_dot_v * length(to_light));
}

// Radiance per irradiance of everything below the coat.
fn below_coat_reflected(s: LobedSurface, v: vec3f, l: vec3f, n_dot_l: f32) -> vec3f {
    var r: Reflection;
    if BLINN_PHONG {
        r = reflect_blinn_phong(s.base, s.base_mirror, v, l);
    } else {
        r = reflect_ggx(s.base, s.base_mirror, v, l, n_dot_l);
    }
    if (MATERIAL_CLASS & (HAS_ANISOTROPY | HAS_IRIDESCENCE)) != 0u {
        let h = normalize(v + l);
        let v_dot_h = saturate(dot(v, h));
        var fresnel = fresnel_of(s.base_mirror, v_dot_h);
        if (MATERIAL_CLASS & HAS_IRIDESCENCE) != 0u {
            let mirrored = film_mirrored(s.film, s.base, fresnel, v_dot_h);
            fresnel = mirrored.fresnel;
            r.diffuse_weight = select(mirrored.left, 1.0, BLINN_PHONG);
        }
        if (MATERIAL_CLASS & HAS_ANISOTROPY) != 0u {
            r.specular = fresnel * anisotropic_lobe(s, v, l, h, n_dot_l);
        } else {
            r.specular = fresnel * ggx_lobe(s.base.normal, v, l, h, n_dot_l, squared_alpha(s.base));
        }
        if MULTIPLE_SCATTERING {
            r.specular *= s.base_mirror.gain;
        }
    }
    let base = r.diffuse_weight * diffuse_color(s.base) * ((1.0 - s.transmission) / PI) + r.specular;
    if (MATERIAL_CLASS & HAS_SHEEN) != 0u {
        let n_dot_v = saturate(dot(s.base.normal, v));
        let left = min(below_sheen(s, n_dot_v), below_sheen(s, n_dot_l));
        return base * left + s.sheen_color * sheen_lobe(s.base.normal, v, l, n_dot_l, s.sheen_roughness);
    }
    return base;
}

// What a lobed surface sends to the eye of light from one direction.
fn lobes_reflected(s: LobedSurface, v: vec3f, left: f32, a: IncidentLight) -> vec3f {
    let n_dot_l = dot(s.base.normal, a.direction);
    let coat_n_dot_l = dot(s.coat.normal, a.direction);
    var sum = vec3f(0.0);
    if n_dot_l > 0.0 {
        sum = left * n_dot_l * below_coat_reflected(s, v, a.direction, n_dot_l);
    }
    if (MATERIAL_CLASS & HAS_CLEARCOAT) != 0u && coat_n_dot_l > 0.0 {
        let coat = reflect_ggx(s.coat, s.coat_mirror, v, a.direction, coat_n_dot_l);
        sum += s.clearcoat * coat_n_dot_l * coat.specular;
    }
    return sum * a.irradiance;
}

// Whether the surface or its coat faces a light that sends anything.
fn lobes_face(s: LobedSurface, a: IncidentLight) -> bool {
    let cosine = max(dot(s.base.normal, a.direction), dot(s.coat.normal, a.direction));
    return cosine > 0.0 && any(a.irradiance > vec3f(0.0));
}

// A directional light's part in the radiance of a lobed surface; `left` is what the coat leaves.
fn lobes_lit_from_afar(s: LobedSurface, v: vec3f, left: f32, index: u32) -> vec3f {
    let light = light_at(index);
    var a = incident_from_afar(light);
    if !lobes_face(s, a) {
        return vec3f(0.0);
    }
    if SHADOWS != 0u {
        a.irradiance *= directional_arriving(index, light, s.base, PIXEL).part;
    }
    return lobes_reflected(s, v, left, a);
}

// The same of a light that shines from a point.
fn lobes_lit_by(s: LobedSurface, v: vec3f, left: f32, index: u32, light: Light) -> vec3f {
    var a = incident(light, s.base.position);
    if !lobes_face(s, a) {
        return vec3f(0.0);
    }
    if SHADOWS != 0u {
        a.irradiance *= light_arriving(index, light, s.base, PIXEL).part;
    }
    return lobes_reflected(s, v, left, a);
}

// The environment's light on a lobed surface.
fn lobes_ambient(s: LobedSurface, v: vec3f, left: f32, seen: f32) -> vec3f {
    var scattering = s.base;
    var mirror = s.base;
    if (MATERIAL_CLASS & HAS_IRIDESCENCE) != 0u {
        mirror = under_film(s.film, s.base, v);
        scattering.dielectric = mirror.dielectric;
    }
    if (MATERIAL_CLASS & HAS_ANISOTROPY) != 0u {
        // Bent as a mirror of grooves is (KHR_materials_anisotropy).
        let bent = cross(cross(s.across, v), s.across);
        let kept = 1.0 - s.anisotropy * (1.0 - s.base.roughness);
        let turned = mix(bent, s.base.normal, kept * kept * kept * kept);
        mirror.normal = normalize(select(s.base.normal, turned, s.anisotropy > 0.0));
    }
    var below = (1.0 - s.transmission) * environment_diffuse(scattering, v) * seen
        + environment_specular(mirror, v, environment_look(mirror, v, false)) * mirrored_seen(mirror, v, seen);
    if (MATERIAL_CLASS & HAS_SHEEN) != 0u {
        let cosine = saturate(dot(s.base.normal, v));
        let around = Surface(
            s.base.position, s.base.normal, s.base.vertex_normal, vec3f(1.0), 0.0, 1.0, 1.0, vec3f(0.0), vec4f(0.0),
        );
        let white = environment_diffuse(around, v) * seen;
        below = below * below_sheen(s, cosine) + s.sheen_color * sheen_part(cosine, s.sheen_roughness) * white;
    }
    var sum = left * below;
    if (MATERIAL_CLASS & HAS_CLEARCOAT) != 0u {
        let coat = environment_specular(s.coat, v, environment_look(s.coat, v, false));
        sum += s.clearcoat * coat * mirrored_seen(s.coat, v, seen);
    }
    return sum * s.base.occlusion;
}

// Radiance that leaves a lobed surface towards the eye: as `light_surface` has it of others.
fn lit_with_lobes(lobed: LobedSurface, pixel: vec2f, distance: f32) -> vec3f {
    var s = lobed;
    let v = direction_to_eye(view_at(pixel), s.base.position);
    if MULTIPLE_SCATTERING {
        if (MATERIAL_CLASS & HAS_IRIDESCENCE) != 0u {
            s.base_mirror.gain = further_bounces(under_film(s.film, s.base, v), v);
        } else {
            s.base_mirror.gain = further_bounces(s.base, v);
        }
    }
    let left = below_coat(s, v);
    var sum = s.base.emissive * left + lobes_ambient(s, v, left, environment_seen(pixel, distance));
    let directional = directional_lights();
    for (var i = 0u; i < directional; i++) {
        sum += lobes_lit_from_afar(s, v, left, i);
    }
    // A coat may face a light that its base does not face.
    let facing = select(s.base.normal, vec3f(0.0), (MATERIAL_CLASS & HAS_CLEARCOAT) != 0u);
    var walk = first_light(pixel, distance, s.base.position, facing);
    loop {
        if walk.bits != 0u {
            sum += lobes_lit_by(s, v, left, light_number(walk), light_of(walk));
        }
        walk = next_light(walk, s.base.position, facing);
        continuing {
            break if walk.bits == 0u;
        }
    }
    return sum;
}
