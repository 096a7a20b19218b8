// Radiance of a block's sample, and its light.

#import shading/coarse/block.wgsl
#import shading/coarse/light.wgsl
#import shading/input.wgsl
#import shared/blocks.wgsl
#import shared/frame.wgsl
#import shared/light.wgsl
#import shared/lighting.wgsl
#import shared/surface.wgsl
#import shared/environment.wgsl

// By how much lights in all directions widen a highlight. Found by measurement: 0.5, which follows
// from half-way directions' turning by half as much as the lights, makes rough stones too bright.
const SPREAD: f32 = 0.1;

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

// A place at a block's rim, in quarters of its side: what is seen there, from a sample's surface, and
// in w whether that counts, by 1.
fn rim_of(block: vec2u, level: u32, quarters: vec2u, s: Surface) -> vec4f {
    let first = block << vec2u(level);
    let within = (quarters * ((1u << level) - 1u) + 2u) >> vec2u(2u);
    let texel = min(first + within, picture_of(first).end - 1u);
    let depth = gbuffer_depth_at(texel);
    let offset = world_position(vec2f(texel) + 0.5, view_distance(max(depth, 1e-20))) - s.position;
    let is_same = depth > 0.0 && abs(dot(s.vertex_normal, offset)) <= MOST_OFF_PLANE * length(offset);
    return select(vec4f(0.0), vec4f(offset, 1.0), is_same);
}

// Four places at a block's rim, one on each side: the first at so many quarters of the upper side, the
// others where quarter turns of the block take it. No two lie in one column or row, nor does the sample in
// the middle share theirs.
fn four_of(block: vec2u, level: u32, quarters: u32, s: Surface) -> Rim {
    let left = 4u - quarters;
    let a = rim_of(block, level, vec2u(quarters, 0u), s);
    let b = rim_of(block, level, vec2u(4u, quarters), s);
    let c = rim_of(block, level, vec2u(left, 4u), s);
    let d = rim_of(block, level, vec2u(0u, left), s);
    return Rim(
        vec4f(a.x, b.x, c.x, d.x),
        vec4f(a.y, b.y, c.y, d.y),
        vec4f(a.z, b.z, c.z, d.z),
        vec4f(a.w, b.w, c.w, d.w),
    );
}

// The rim of a block, by eight places or, without BOTH_RIMS, by four.
fn block_of(block: vec2u, level: u32, s: Surface) -> Block {
    var second = NO_RIM;
    if BOTH_RIMS {
        second = four_of(block, level, 3u, s);
    }
    return Block(four_of(block, level, 1u, s), second);
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
        stands_for = block_of(block, level, s);
    }
    let lit = light_surface(s, v, look, pixel, distance, stands_for);
    let direction = direction_or(lit.direction, s.normal);
    let specular_direction = direction_or(lit.specular_direction, s.normal);
    let together = saturate(length(lit.specular_direction) / max(luminance(lit.specular), 1e-30));
    let spread = SPREAD * (1.0 - together);
    let lobe = highlight(s.normal, v, specular_direction, squared_alpha(s) + spread);
    let lamps = luminance(diffuse_color(s) / PI * lit.diffuse + lit.specular);
    s.roughness = roughness;
    let light = SampleLight(
        lit.diffuse / max(dot(s.normal, direction), LEAST_COSINE),
        lit.specular / (max(environment_reflectance(s, v), vec3f(1e-3)) * max(lobe, 1e-6)),
        direction,
        specular_direction,
        spread,
        s.normal,
        sqrt(lit.variance) / (lamps + DARK / frame.exposure),
    );
    return LitBlock(vec4f(min(lit.radiance, vec3f(65504.0)), alpha), pack_light(light));
}
