// Radiance of a block's sample, and its light.

#import shading/coarse/block.wgsl
#import shading/coarse/light.wgsl
#import shading/input.wgsl
#import shared/blocks.wgsl
#import shared/frame.wgsl
#import shared/light.wgsl
#import shared/lighting.wgsl
#import shared/other_normals.wgsl
#import shared/surface.wgsl
#import shared/environment.wgsl
#import shadow/lookup.wgsl

// The samples are single pixels. Their level is a constant then, so that compilers leave out what
// blocks need, for which devices that run all branches would pay.
override SINGLE_PIXELS: bool = false;

fn level_of(level: u32) -> u32 {
    if SINGLE_PIXELS {
        return 0u;
    }
    return level;
}

// What a sample's light would make surfaces of its material show, as luminance.
struct ToldLight {
    // Scattered by a surface that faces `direction`.
    diffuse: f32,
    // Mirrored, for each `highlight`.
    specular: f32,
    direction: vec3f,
    specular_direction: vec3f,
    // Of its highlights.
    a2: f32,
}

struct LitBlock {
    // As `shade_block` gives it.
    radiance: vec4f,
    // As `pack_light` has it.
    light: vec4u,
}

// A block's surface: its sample's, with the mean normal and roughness of five texels that lie about
// as far away.
struct BlockSurface {
    // Its highlight is wider, as normals differ within the block (Toksvig 2005, 'Mipmapping normal
    // maps').
    surface: Surface,
    // The mean, without that.
    roughness: f32,
}

fn filter_over_block(sample_surface: Surface, block: vec2u, level: u32, distance: f32) -> BlockSurface {
    var s = sample_surface;
    var normal = s.normal;
    var a2 = squared_alpha(s);
    var count = 1.0;
    for (var candidate = 1u; candidate < 5u; candidate++) {
        let texel = sample_texel(block, level, candidate);
        let away = abs(view_distance(max(gbuffer_depth_at(texel), 1e-20)) - distance);
        let other = unpack_surface(gbuffer_words_at(texel), vec3f(0.0));
        let counts = f32(away < 0.1 * distance && dot(other.normal, s.normal) > 0.3);
        normal += counts * other.normal;
        a2 += counts * squared_alpha(other);
        count += counts;
    }
    a2 /= count;
    let wider = min(a2 + 1.0 - length(normal) / count, 1.0);
    s.normal = normalize(normal);
    s.roughness = sqrt(sqrt(wider));
    return BlockSurface(s, sqrt(sqrt(a2)));
}

// Sine of the angle by which a place at a block's rim may lie off the sample's plane and count as the same
// surface.
const MOST_OFF_PLANE: f32 = 0.3;

// What is seen at a place of a block's rim.
struct RimPixel {
    // From a sample's surface, and in w whether it counts, by 1.
    offset: vec4f,
    normal: vec3f,
}

// What is seen at a block's rim; `quarters`: the place, in quarters of the block's side.
fn rim_of(block: vec2u, level: u32, quarters: vec2u, s: Surface) -> RimPixel {
    let first = block << vec2u(level);
    let within = (quarters * ((1u << level) - 1u) + 2u) >> vec2u(2u);
    let texel = min(first + within, picture_of(first).end - 1u);
    let depth = gbuffer_depth_at(texel);
    let offset = world_position(vec2f(texel) + 0.5, view_distance(max(depth, 1e-20))) - s.position;
    let is_same = depth > 0.0 && abs(dot(s.vertex_normal, offset)) <= MOST_OFF_PLANE * length(offset);
    let normal = unit_from_octahedral(unpack2x16snorm(gbuffer_words_at(texel).y));
    return RimPixel(select(vec4f(0.0), vec4f(offset, 1.0), is_same), normal);
}

struct FourPixels {
    rim: Rim,
    normals: Normals,
}

// Four places at a block's rim, one on each side: the first at so many quarters of the upper side, the
// others where quarter turns of the block take it. No two lie in one column or row, nor does the sample in
// the middle share theirs.
fn four_of(block: vec2u, level: u32, quarters: u32, s: Surface) -> FourPixels {
    let left = 4u - quarters;
    let a = rim_of(block, level, vec2u(quarters, 0u), s);
    let b = rim_of(block, level, vec2u(4u, quarters), s);
    let c = rim_of(block, level, vec2u(left, 4u), s);
    let d = rim_of(block, level, vec2u(0u, left), s);
    let across = transpose(mat4x4f(a.offset, b.offset, c.offset, d.offset));
    let rim = Rim(across[0], across[1], across[2], across[3]);
    return FourPixels(rim, normals_of(a.normal, b.normal, c.normal, d.normal, rim.counts));
}

fn normals_of(a: vec3f, b: vec3f, c: vec3f, d: vec3f, counts: vec4f) -> Normals {
    let across = transpose(mat4x3f(a, b, c, d));
    return Normals(across[0], across[1], across[2], counts);
}

// A normal tilted to four sides; those that the eye cannot see do not count.
fn tilted_from(normal: vec3f, v: vec3f) -> Normals {
    let axes = axes_along(normal);
    let a = normalize(normal + TILT * axes[0]);
    let b = normalize(normal - TILT * axes[0]);
    let c = normalize(normal + TILT * axes[1]);
    let d = normalize(normal - TILT * axes[1]);
    let facing = vec4f(dot(a, v), dot(b, v), dot(c, v), dot(d, v));
    return normals_of(a, b, c, d, select(vec4f(0.0), vec4f(1.0), facing > vec4f(0.0)));
}

// A block of several pixels, by eight places at its rim or, without BOTH_RIMS, by four.
fn block_of(block: vec2u, level: u32, s: Surface, v: vec3f) -> Block {
    let first = four_of(block, level, 1u, s);
    var second = NO_RIM;
    if BOTH_RIMS {
        second = four_of(block, level, 3u, s).rim;
    }
    // What other normals show is asked of GGX alone.
    if BLINN_PHONG {
        return Block(first.rim, second, false, NO_NORMALS, NO_NORMALS);
    }
    return Block(first.rim, second, true, first.normals, tilted_from(s.normal, v));
}

// Part of the squared difference between what a normal shows of the lamps and what the sample's light
// tells it that counts as variance. Found by measurement.
const VARIANCE_OF_NORMALS: f32 = 0.2;

// Luminance that a sample's light tells surfaces with these normals to show.
fn told_on(normals: Normals, told: ToldLight, v: vec3f) -> vec4f {
    let cosines = max(cosines_to(normals, told.direction), vec4f(LEAST_COSINE));
    let mirrored = max(cosines_to(normals, told.specular_direction), vec4f(LEAST_COSINE));
    return told.diffuse * cosines + told.specular * lobes_on(normals, v, told.specular_direction, mirrored, told.a2);
}

fn light_block(block: vec2u, level: u32) -> LitBlock {
    let candidate = candidate_of(block, level);
    let alpha = f32(1u + candidate);
    let texel = sample_texel(block, level, candidate);
    let pixel = vec2f(texel) + 0.5;
    let depth = gbuffer_depth_at(texel);
    let is_behind = depth == 0.0;
    let distance = select(view_distance(depth), 1.0, is_behind);
    var s = unpack_surface(gbuffer_words_at(texel), world_position(pixel, distance));
    var roughness = s.roughness;
    if level > 0u {
        let filtered = filter_over_block(s, block, level, distance);
        s = filtered.surface;
        roughness = filtered.roughness;
    }
    let v = direction_to_eye(view_at(pixel), s.position);
    let look = environment_look(s, v, is_behind);
    if is_behind {
        return LitBlock(vec4f(background(look), alpha), vec4u(0u));
    }
    var stands_for = PIXEL;
    if level > 0u {
        stands_for = block_of(block, level, s, v);
    }
    let lit = light_surface(s, v, look, pixel, distance, stands_for);
    let direction = direction_or(lit.direction, s.normal);
    let specular_direction = direction_or(lit.specular_direction, s.normal);
    let together = saturate(length(lit.specular_direction) / max(luminance(lit.specular), 1e-30));
    let spread = rounded_spread(SPREAD * (1.0 - together));
    let lobe = highlight(s.normal, v, specular_direction, squared_alpha(s) + spread);
    let scattered = diffuse_color(s) / PI * lit.diffuse;
    let told = ToldLight(
        luminance(scattered) / max(dot(s.normal, direction), LEAST_COSINE),
        luminance(lit.specular) / max(lobe, 1e-6),
        direction,
        specular_direction,
        min(squared_alpha(s) + spread, 1.0),
    );
    let at_rim = most_apart(stands_for.at_rim, lit.others.at_rim, told_on(stands_for.at_rim, told, v));
    let tilted = most_apart(stands_for.tilted, lit.others.tilted, told_on(stands_for.tilted, told, v));
    let variance = lit.variance + VARIANCE_OF_NORMALS * at_rim * at_rim;
    let whole = luminance(scattered + lit.specular) + DARK / frame.exposure;
    s.roughness = roughness;
    let light = SampleLight(
        lit.diffuse / max(dot(s.normal, direction), LEAST_COSINE),
        lit.specular / (max(environment_reflectance(s, v), vec3f(1e-3)) * max(lobe, 1e-6)),
        direction,
        specular_direction,
        spread,
        s.normal,
        sqrt(variance) / whole,
        sqrt(VARIANCE_OF_NORMALS) * tilted / whole,
    );
    return LitBlock(vec4f(min(lit.radiance, vec3f(65504.0)), alpha), pack_light(light));
}
