// The finest level that one of 2 x 2 pixels requests, and whether they lie at a geometric edge:
// level 1 of the min-pyramid. Rust: `rate/request.rs`.
//
// Where samples hold light, bumpy surfaces request finer levels, the smoother they are the smaller
// the bumps: their highlights come from many directions, which a sample does not keep apart.

#variant
#variant BY_DEPTH
#variant DISPATCHED
#variant BY_DEPTH DISPATCHED
#import rate/fovea.wgsl
#import shared/blocks.wgsl
#import shared/frame.wgsl
#import shared/layers.wgsl
#ifdef DISPATCHED
#import shared/dispatched_level.wgsl
#else
#import shared/level.wgsl
#endif
#ifdef BY_DEPTH
#import rate/crease_of_depth.wgsl
#else
#import rate/crease_of_surface.wgsl
#endif

// 0 foveated, 1 constant, 2 image, 3 lens, 4 radii.
override SOURCE: u32 = 0u;
override OTHER: u32 = 1u;
// 0 the first source alone, 1 the coarser of both, 2 the finer.
override COMBINE: u32 = 0u;
// By so many levels bumpy surfaces are refined; sharp metals by twice as many.
override BUMPY_BY: u32 = 0u;

@group(1) @binding(1) var rate_image: texture_2d<u32>;
@group(1) @binding(2) var gbuffer_surface: texture_2d_array<u32>;
@group(1) @binding(3) var gbuffer_identity: texture_2d_array<u32>;
@group(1) @binding(4) var gbuffer_depth: texture_depth_2d_array;

// How much coarser the screen is here than on the lens's axis.
fn lens_level(pixel: vec2f) -> u32 {
    let tangent = view_position(pixel, 1.0).xy;
    return radii_below(dot(tangent, tangent), request.lens_squared_radii[view_at(pixel)]);
}

// The picture is stretched over each eye's.
fn image_texel(texel: vec2u) -> vec2u {
    let picture = picture_of(texel);
    return (min(texel, picture.end - 1u) - picture.low) * textureDimensions(rate_image) / (picture.end - picture.low);
}

fn level_from(source: u32, texel: vec2u) -> u32 {
    switch source {
        case 0u: { return foveated_level(vec2f(texel) + 0.5); }
        case 1u: { return request.constant_level; }
        case 3u: { return lens_level(vec2f(texel) + 0.5); }
        case 4u: { return radii_level(vec2f(texel) + 0.5); }
        default: { return textureLoad(rate_image, image_texel(texel), 0).x; }
    }
}

fn pixel_level(texel: vec2u) -> u32 {
    let level = level_from(SOURCE, texel);
    if COMBINE == 1u {
        return max(level, level_from(OTHER, texel));
    } else if COMBINE == 2u {
        return min(level, level_from(OTHER, texel));
    }
    return level;
}

fn instance_at(texel: vec2i) -> u32 {
    return load_words(gbuffer_identity, vec2u(texel)).x;
}

fn depth_at(texel: vec2i) -> f32 {
    return load_depth(gbuffer_depth, vec2u(texel));
}

// Whether a surface ends within a block of 2 x 2 pixels or between it and the blocks to its right
// and below: another instance, a crease of more than 45 degrees, or a jump in depth. Reversed depth
// is affine in screen space along a plane however it is tilted, so a jump shows as a second
// difference.
fn holds_edge(block: vec2u) -> bool {
    let last = vec2i(picture_of(block * 2u).end) - 1;
    let first = min(vec2i(block) * 2, last);
    let right = vec2i(min(first.x + 2, last.x), first.y);
    let down = vec2i(first.x, min(first.y + 2, last.y));
    let instance = instance_at(first);
    let same = vec3u(instance_at(right), instance_at(down), instance_at(min(first + 1, last))) == vec3u(instance);
    if !all(same) {
        return true;
    }
    if instance == 0u {
        return false;
    }
    // At the picture's border the three pixels in a row are not three: their bend is unknown.
    let depth = depth_at(first);
    if first.x + 2 <= last.x {
        let bend = depth - 2.0 * depth_at(first + vec2i(1, 0)) + depth_at(right);
        if abs(bend) > 0.02 * depth {
            return true;
        }
    }
    if first.y + 2 <= last.y {
        let bend = depth - 2.0 * depth_at(first + vec2i(0, 1)) + depth_at(down);
        if abs(bend) > 0.02 * depth {
            return true;
        }
    }
    return turns(first, last);
}

fn requested(block: vec2u) -> u32 {
    let last = picture_of(block * 2u).end - 1u;
    var level = request.coarsest;
    for (var i = 0u; i < 4u; i++) {
        level = min(level, pixel_level(min(block * 2u + vec2u(i & 1u, i >> 1u), last)));
    }
    if level == 0u || level > request.edges_up_to {
        return level;
    }
    if holds_edge(block) {
        return select(level, level - min(level, request.refine_by), level <= request.refine_up_to) | CELL_EDGE;
    }
#ifdef BY_DEPTH
    return level;
#else
    let first = vec2i(min(block * 2u, last));
    if BUMPY_BY == 0u || instance_at(first) == 0u {
        return level;
    }
    let by = min(BUMPY_BY * bumpiness(first, vec2i(last)), level);
    return level - by;
#endif
}

#ifdef DISPATCHED
@compute @workgroup_size(8, 8)
fn request_all(@builtin(global_invocation_id) at: vec3u) {
    if is_of_level(at.xy) {
        write_cell(at.xy, requested(at.xy));
    }
}
#else
@fragment
fn requested_level(in: LevelVertex) -> @location(0) u32 {
    return requested(vec2u(in.position.xy));
}
#endif
