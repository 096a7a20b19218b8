// Light that interferes in a thin film on a surface (KHR_materials_iridescence; Belcour and Barla 2017,
// 'A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence'). CPU twin:
// `forward/film_twin.rs`.

#import shared/environment.wgsl
#import shared/surface.wgsl

// Nanometres up to which a film fades in: none at all is the surface without.
const FADED_FILM: f32 = 10.0;

struct Film {
    // 0 to 1.
    strength: f32,
    // Index of refraction, at least 1: that of air is before it.
    ior: f32,
    // Nanometres.
    thickness: f32,
}

fn film_of(strength: f32, ior: f32, thickness: f32) -> Film {
    return Film(saturate(strength) * saturate(thickness / FADED_FILM), ior, thickness);
}

fn fifth_power(x: f32) -> f32 {
    let x2 = x * x;
    return x2 * x2 * x;
}

// How much the colours of a difference of paths (nanometres) and phases (by channel of what is below)
// are stronger or weaker than without interference: the sensitivities of CIE 1931's X, Y and Z as
// normal distributions over the wave number, of which X has two, after a Fourier transform; then linear
// sRGB.
fn interference(difference: f32, phase: vec3f) -> vec3f {
    let turn = 2.0 * PI * difference;
    let turn2 = turn * turn;
    var xyz = vec3f(0.846590, 1.000222, 1.001122)
        * cos(vec3f(1.6810e-3, 1.7953e-3, 2.2084e-3) * turn + phase)
        * exp(-turn2 * vec3f(4.3278e-9, 9.3046e-9, 6.6121e-9));
    xyz.x += 0.153868 * cos(2.2399e-3 * turn + phase.x) * exp(-turn2 * 4.5282e-9);
    return vec3f(
        dot(vec3f(3.2404542, -1.5371385, -0.4985314), xyz),
        dot(vec3f(-0.9692660, 1.8760108, 0.0415560), xyz),
        dot(vec3f(0.0556434, -0.2040259, 1.0572252), xyz),
    );
}

// What a film on a surface of a reflectance at right angles reflects, at a cosine to its normal: no less
// than nothing and no more than all.
fn film_reflectance(film: Film, base_f0: vec3f, cosine: f32) -> vec3f {
    let within = sqrt(max(1.0 - (1.0 - cosine * cosine) / (film.ior * film.ior), 0.0));
    // Air to film.
    let upper_root = (film.ior - 1.0) / (film.ior + 1.0);
    let upper_f0 = upper_root * upper_root;
    let upper = upper_f0 + (1.0 - upper_f0) * fifth_power(1.0 - cosine);
    let passed = 1.0 - upper;
    // Film to surface, whose index of refraction is that of a dielectric of its reflectance.
    let root = sqrt(clamp(base_f0, vec3f(0.0), vec3f(0.9999)));
    let base_ior = (1.0 + root) / (1.0 - root);
    let lower_root = (base_ior - film.ior) / (base_ior + film.ior);
    let lower_f0 = lower_root * lower_root;
    let lower = lower_f0 + (1.0 - lower_f0) * fifth_power(1.0 - within);
    // Half a turn from below the upper side, and another where the surface has the lower index.
    let phase = PI + select(vec3f(0.0), vec3f(PI), base_ior < vec3f(film.ior));
    let difference = 2.0 * film.ior * film.thickness * within;
    // Light that goes to and fro: all of it, then how the first and the second return interfere.
    let round = clamp(upper * lower, vec3f(1e-5), vec3f(0.9999));
    let returned = passed * passed * lower / (1.0 - round);
    let root_of_round = sqrt(round);
    let first = (returned - passed) * root_of_round;
    var sum = upper + returned;
    sum += 2.0 * first * interference(difference, phase);
    sum += 2.0 * first * root_of_round * interference(2.0 * difference, 2.0 * phase);
    return saturate(sum);
}

// What a surface with a film mirrors at a cosine, and what that leaves to be scattered.
struct FilmMirrored {
    fresnel: vec3f,
    left: f32,
}

// `fresnel`: without the film.
fn film_mirrored(film: Film, s: Surface, fresnel: vec3f, cosine: f32) -> FilmMirrored {
    let dielectric = film_reflectance(film, s.dielectric.xyz, cosine);
    let metal = film_reflectance(film, s.base_color, cosine);
    let bare = s.dielectric.xyz + (s.dielectric.w - s.dielectric.xyz) * fifth_power(1.0 - cosine);
    let d = mix(bare, dielectric, film.strength);
    return FilmMirrored(
        mix(fresnel, mix(dielectric, metal, s.metallic), film.strength),
        1.0 - max(d.x, max(d.y, d.z)),
    );
}

// The reflectance at right angles with which Fresnel's law gives what a film reflects at a cosine.
fn film_at_normal(film: Film, base_f0: vec3f, at_grazing: f32, cosine: f32) -> vec3f {
    let m5 = min(fifth_power(1.0 - cosine), 0.9);
    let found = (film_reflectance(film, base_f0, cosine) - at_grazing * m5) / (1.0 - m5);
    return mix(base_f0, saturate(found), film.strength);
}

// The surface without a film that mirrors what this one does with its film, for light from all around.
fn under_film(film: Film, s: Surface, v: vec3f) -> Surface {
    let cosine = saturate(dot(s.normal, v));
    var bare = s;
    bare.base_color = film_at_normal(film, s.base_color, 1.0, cosine);
    bare.dielectric = vec4f(film_at_normal(film, s.dielectric.xyz, s.dielectric.w, cosine), s.dielectric.w);
    return bare;
}
