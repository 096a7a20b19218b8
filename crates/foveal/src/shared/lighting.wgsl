// How a surface is lit by lights: the one lighting model of all passes.

#import shared/frame.wgsl
#import shared/light.wgsl
#import shared/light_list.wgsl
#import shared/other_normals.wgsl
#import shared/surface.wgsl
#import shared/environment.wgsl
#import shadow/lookup.wgsl
#import shadow/tile.wgsl
#ifdef REDUCED
#import reduced/missing.wgsl
#endif

// Blinn-Phong as in the techniques' sources, else metallic-roughness GGX.
override BLINN_PHONG: bool = false;
// Every light at every sample, else of those that shine from a point the ones of its cluster.
override BRUTE: bool = false;

// Light incident at a position: unit direction to the light, and irradiance on a facing surface.
struct IncidentLight {
    direction: vec3f,
    irradiance: vec3f,
}

// A surface's radiance, and what the lights alone send to it.
struct Lit {
    radiance: vec3f,
    // Irradiance that is left for diffuse reflection.
    diffuse: vec3f,
    // Specular radiance.
    specular: vec3f,
    // Sum of the unit directions to the lights, weighted by their luminance.
    direction: vec3f,
    // The same, weighted by the luminance of specular radiance.
    specular_direction: vec3f,
    // Variance of the luminance within the sample's block, by shadows.
    variance: f32,
    // What the other normals of the block show of the lights.
    others: OnNormals,
}

// Of a directional light.
fn incident_from_afar(light: Light) -> IncidentLight {
    return IncidentLight(-light.direction, light.radiant);
}

// Of a light that shines from a point: no nearer than a tenth of a millimetre.
fn incident(light: Light, position: vec3f) -> IncidentLight {
    let to_light = light.position - position;
    let squared = max(dot(to_light, to_light), 1e-8);
    let direction = to_light * inverseSqrt(max(dot(to_light, to_light), 1e-20));
    // KHR_lights_punctual's recommended window: 1 - (d/range)^4.
    let ratio = squared / (light.range * light.range);
    let cone = saturate(-dot(light.direction, direction) * light.spot_scale + light.spot_offset);
    let attenuation = saturate(1.0 - ratio * ratio) / squared * (cone * cone);
    return IncidentLight(direction, light.radiant * attenuation);
}

// What a surface makes of light from one direction: the part that is left for diffuse reflection,
// and the specular part.
struct Reflection {
    diffuse_weight: f32,
    specular: vec3f,
}

// Fresnel's reflectance (Schlick 1994).
fn fresnel_of(mirror: Mirror, v_dot_h: f32) -> vec3f {
    let m = 1.0 - v_dot_h;
    let m2 = m * m;
    return mirror.at_normal + (mirror.at_grazing - mirror.at_normal) * (m2 * m2 * m);
}

// What a surface makes of light by the cosine between the directions to the eye and half-way to it:
// the part that is left for diffuse reflection, and Fresnel's reflectance.
struct Shares {
    left: f32,
    mirrored: vec3f,
}

fn shares_of(mirror: Mirror, v_dot_h: f32) -> Shares {
    let m = 1.0 - saturate(v_dot_h);
    let m2 = m * m;
    let m5 = m2 * m2 * m;
    let left = 1.0 - (mirror.kept.x + (mirror.kept.y - mirror.kept.x) * m5);
    return Shares(left, mirror.at_normal + (mirror.at_grazing - mirror.at_normal) * m5);
}

// Lambert and GGX: glTF 2.0 appendix B, with the height-correlated visibility term (Heitz 2014).
fn reflect_ggx(s: Surface, mirror: Mirror, v: vec3f, l: vec3f, n_dot_l: f32) -> Reflection {
    let h = normalize(v + l);
    let shares = shares_of(mirror, dot(v, h));
    let once = shares.mirrored * ggx_lobe(s.normal, v, l, h, n_dot_l, squared_alpha(s));
    if MULTIPLE_SCATTERING {
        return Reflection(shares.left, once * mirror.gain);
    }
    return Reflection(shares.left, once);
}

// Lambert and normalized Blinn-Phong, the exponent taken from the roughness.
fn reflect_blinn_phong(s: Surface, mirror: Mirror, v: vec3f, l: vec3f) -> Reflection {
    let h = normalize(v + l);
    let alpha = max(s.roughness * s.roughness, 0.03);
    let exponent = 2.0 / (alpha * alpha) - 2.0;
    let highlight = (exponent + 8.0) / (8.0 * PI) * pow(max(dot(s.normal, h), 1e-6), exponent);
    return Reflection(1.0, mirror.at_normal * highlight);
}

// Luminance that a surface with each of these normals would show of light from one direction. `by`:
// luminance of what it scatters, and of what it mirrors for each lobe.
fn shown_on(normals: Normals, s: Surface, by: vec2f, v: vec3f, a: IncidentLight) -> vec4f {
    let n_dot_l = max(cosines_to(normals, a.direction), vec4f(0.0)) * normals.counts;
    let lobes = lobes_on(normals, v, a.direction, n_dot_l, squared_alpha(s));
    return luminance(a.irradiance) * (by.x * n_dot_l + by.y * lobes);
}

// The same for all normals of a block.
fn shown_on_others(block: Block, s: Surface, mirror: Mirror, v: vec3f, a: IncidentLight) -> OnNormals {
    if !block.asks_normals || all(a.irradiance <= vec3f(0.0)) {
        return NOTHING_ON_NORMALS;
    }
    let shares = shares_of(mirror, dot(v, half_way(v, a.direction)));
    var mirrored = shares.mirrored;
    if MULTIPLE_SCATTERING {
        mirrored *= mirror.gain;
    }
    let by = vec2f(shares.left * luminance(diffuse_color(s)) / PI, luminance(mirrored));
    return OnNormals(shown_on(block.at_rim, s, by, v, a), shown_on(block.tilted, s, by, v, a));
}

fn is_lit(a: IncidentLight, n_dot_l: f32, others: OnNormals) -> bool {
    let is_faced = n_dot_l > 0.0 || any(others.at_rim + others.tilted > vec4f(0.0));
    return is_faced && any(a.irradiance > vec3f(0.0));
}

// Adds what light from one direction makes of a surface's radiance, and its part in the light that
// falls on it and on other normals.
fn add_incident(before: Lit, s: Surface, mirror: Mirror, v: vec3f, a: IncidentLight, n_dot_l: f32, others: OnNormals, arriving: Arriving) -> Lit {
    var sum = before;
    sum.others.at_rim += arriving.part * others.at_rim;
    sum.others.tilted += arriving.part * others.tilted;
    if n_dot_l <= 0.0 {
        return sum;
    }
    var r: Reflection;
    if BLINN_PHONG {
        r = reflect_blinn_phong(s, mirror, v, a.direction);
    } else {
        r = reflect_ggx(s, mirror, v, a.direction, n_dot_l);
    }
    let reflected = r.diffuse_weight * (1.0 - s.metallic) * s.base_color / PI + r.specular;
    let irradiance = a.irradiance * arriving.part;
#ifdef LIGHT
    let unshadowed = luminance(reflected * a.irradiance) * n_dot_l;
    let variance = arriving.variance * unshadowed * unshadowed;
#else
    let variance = 0.0;
#endif
    return Lit(
        sum.radiance + reflected * irradiance * n_dot_l,
        sum.diffuse + r.diffuse_weight * irradiance * n_dot_l,
        sum.specular + r.specular * irradiance * n_dot_l,
        sum.direction + a.direction * luminance(irradiance),
        sum.specular_direction + a.direction * (luminance(r.specular * irradiance) * n_dot_l),
        sum.variance + variance,
        sum.others,
    );
}

// Adds a directional light's part.
fn add_directional(sum: Lit, s: Surface, mirror: Mirror, v: vec3f, block: Block, index: u32) -> Lit {
    let light = light_at(index);
    let a = incident_from_afar(light);
    let n_dot_l = dot(s.normal, a.direction);
    let others = shown_on_others(block, s, mirror, v, a);
    if !is_lit(a, n_dot_l, others) {
        return sum;
    }
    var arriving = ALL_ARRIVES;
    if SHADOWS != 0u {
        arriving = directional_arriving(index, light, s, block);
        if arriving.part <= 0.0 && arriving.variance <= 0.0 {
            return sum;
        }
    }
    return add_incident(sum, s, mirror, v, a, n_dot_l, others, arriving);
}

// Adds the part of a light that shines from a point.
fn add_light(sum: Lit, s: Surface, mirror: Mirror, v: vec3f, block: Block, index: u32, light: Light) -> Lit {
    let a = incident(light, s.position);
    let n_dot_l = dot(s.normal, a.direction);
    let others = shown_on_others(block, s, mirror, v, a);
    if !is_lit(a, n_dot_l, others) {
        return sum;
    }
    var arriving = ALL_ARRIVES;
    if SHADOWS != 0u {
        arriving = light_arriving(index, light, s, block);
        if arriving.part <= 0.0 && arriving.variance <= 0.0 {
            return sum;
        }
    }
    return add_incident(sum, s, mirror, v, a, n_dot_l, others, arriving);
}

// Index of the first light word of the cluster at a position in pixels of the target and a distance
// along the view axis.
fn cluster_words_at(pixel: vec2f, distance: f32, words: u32) -> u32 {
    let view = view_at(pixel);
    let moved = in_eye(pixel) + vec2f(frame.views[view].cluster_shift_x, frame.views[view].cluster_shift_y);
    let tile = min(vec2u(moved / frame.cluster_tile), frame.cluster_counts.xy - 1u);
    let cluster = tile.x + frame.cluster_counts.x * (tile.y + frame.cluster_counts.y * cluster_slice(distance));
    return cluster * words;
}

// A place in a list of lights: the word that is walked, and its lights that are left. No bits: the end.
struct LightWalk {
    // Of the list: where it begins, how many.
    first: u32,
    words: u32,
    word: u32,
    bits: u32,
    // Where shadows are looked up, the first one's position, and its range in w.
    sphere: vec4f,
}

// The lowest `count` bits; all from 32 on.
fn lowest_bits(count: u32) -> u32 {
    return select((1u << count) - 1u, 0xffffffffu, count >= 32u);
}

// The lights of one word that shine from a point, `first` being the cluster's first word.
fn light_bits(first: u32, word: u32) -> u32 {
    if BRUTE {
        let before = word * 32u;
        let directional = directional_lights();
        let afar = directional - min(directional, before);
        return lowest_bits(light_count() - before) & ~lowest_bits(afar);
    }
    return cluster_word(first + word);
}

// Whether a light may send anything to a place with this normal; a normal of 0 faces every light.
fn may_reach(sphere: vec4f, position: vec3f, normal: vec3f) -> bool {
    let to_light = sphere.xyz - position;
    // Rounding of the product may err, but never to the small side.
    let faces = dot(normal, to_light) > -1e-6 * sphere.w;
    return faces && dot(to_light, to_light) < sphere.w * sphere.w;
}

// The same place, or, where shadows are looked up, the next one whose light may reach the surface:
// pixels of a cluster then look up their own lights, and need not wait for those of others.
fn with_lights(walk: LightWalk, position: vec3f, normal: vec3f) -> LightWalk {
    var w = walk;
    var found = false;
    loop {
        if w.bits == 0u && w.word + 1u < w.words {
            w.word++;
            w.bits = light_bits(w.first, w.word);
        }
        if w.bits != 0u {
            found = true;
            if SHADOWS != 0u {
                w.sphere = light_sphere(light_number(w));
                found = may_reach(w.sphere, position, normal);
            }
            w.bits = select(w.bits & (w.bits - 1u), w.bits, found);
        }
        continuing {
            break if found || (w.bits == 0u && w.word + 1u >= w.words);
        }
    }
    return w;
}

// At the first light that may reach a surface, of the cluster at a position in pixels of the target
// and a distance along the view axis.
fn first_light(pixel: vec2f, distance: f32, position: vec3f, normal: vec3f) -> LightWalk {
    let words = light_words();
    let first = cluster_words_at(pixel, distance, words);
    let bits = select(0u, light_bits(first, 0u), words > 0u);
    return with_lights(LightWalk(first, words, 0u, bits, vec4f(0.0)), position, normal);
}

fn next_light(walk: LightWalk, position: vec3f, normal: vec3f) -> LightWalk {
    let left = walk.bits & (walk.bits - 1u);
    return with_lights(LightWalk(walk.first, walk.words, walk.word, left, walk.sphere), position, normal);
}

fn light_number(walk: LightWalk) -> u32 {
    return walk.word * 32u + firstTrailingBit(walk.bits);
}

// The first light of a walk.
fn light_of(walk: LightWalk) -> Light {
    let index = light_number(walk);
    if SHADOWS != 0u {
        return light_in(index, walk.sphere);
    }
    return light_at(index);
}

// Radiance that leaves a surface towards the eye, and the lights' light that it comes from. `block`:
// what the sample stands for; a pixel has no variance. `look`: into the surface.
//
// Lights are summed in ascending order whichever way they are found, so that clustered and brute agree
// to the bit. Directional ones have a loop of their own: a device that runs all branches would look up
// both kinds' shadows for each light. The loop over the others asks at its end: such a device runs
// the body of a loop once for its last question, too.
fn light_surface(s: Surface, v: vec3f, look: vec3f, pixel: vec2f, distance: f32, block: Block) -> Lit {
    let seen = environment_seen(pixel, distance);
    let radiance = s.emissive + ambient(s, v, seen, look);
    var sum = Lit(radiance, vec3f(0.0), vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0, NOTHING_ON_NORMALS);
    var mirror = mirror_of(s);
    if MULTIPLE_SCATTERING {
        mirror.gain = further_bounces(s, v);
    }
    let directional = directional_lights();
    for (var i = 0u; i < directional; i++) {
        sum = add_directional(sum, s, mirror, v, block, i);
    }
    // Other normals of a block may face a light that the sample does not face.
    let facing = select(s.normal, vec3f(0.0), block.asks_normals);
    var walk = first_light(pixel, distance, s.position, facing);
    loop {
        if walk.bits != 0u {
            sum = add_light(sum, s, mirror, v, block, light_number(walk), light_of(walk));
        }
        walk = next_light(walk, s.position, facing);
        continuing {
            break if walk.bits == 0u;
        }
    }
    return sum;
}

// Radiance of a pixel: what leaves a surface towards the eye, or is behind all surfaces.
fn radiance_of(s: Surface, pixel: vec2f, distance: f32, is_behind: bool) -> vec3f {
    let v = direction_to_eye(view_at(pixel), s.position);
    let look = environment_look(s, v, is_behind);
    if is_behind {
        return background(look);
    }
    // The largest half: brighter would become infinite in the target.
    return min(light_surface(s, v, look, pixel, distance, PIXEL).radiance, vec3f(65504.0));
}
