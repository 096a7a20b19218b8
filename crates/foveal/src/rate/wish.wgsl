// The level that each pixel wishes, and whether it lies at a geometric edge. After frame, surface, level and
// blocks.wgsl. Rust: `rate/wish.rs`.

struct Wish {
    // Gaze of the left and of the right eye, xy in pixels of the target.
    gaze: array<vec4f, 2>,
    // Squared radii in pixels from which on levels 1 to 8 are wished.
    squared_radii: array<vec4f, 2>,
    // Pixels of the target that belong to one eye.
    eye_width: f32,
    coarsest: u32,
    // Level of the constant source.
    constant_level: u32,
    // 0 foveated, 1 constant, 2 image.
    source: u32,
    other: u32,
    // 0 the first source alone, 1 the coarser of both, 2 the finer.
    combine: u32,
    // Edge pixels that wish 1 up to this level are shaded one by one.
    refine_up_to: u32,
    // Whether edges are looked for at all.
    find_edges: u32,
}

@group(1) @binding(0) var<uniform> wish: Wish;
@group(1) @binding(1) var rate_image: texture_2d<u32>;
@group(1) @binding(2) var gbuffer_surface: texture_2d<u32>;
@group(1) @binding(3) var gbuffer_identity: texture_2d<u32>;
@group(1) @binding(4) var gbuffer_depth: texture_depth_2d;

// Number of radii that the distance to the gaze exceeds.
fn foveated_level(pixel: vec2f) -> u32 {
    let eye = u32(pixel.x >= wish.eye_width);
    let offset = pixel - wish.gaze[eye].xy;
    let squared = vec4f(dot(offset, offset));
    let beyond = vec4u(squared >= wish.squared_radii[0]) + vec4u(squared >= wish.squared_radii[1]);
    return beyond.x + beyond.y + beyond.z + beyond.w;
}

fn level_from(source: u32, texel: vec2u) -> u32 {
    switch source {
        case 0u: { return foveated_level(vec2f(texel) + 0.5); }
        case 1u: { return wish.constant_level; }
        default: { return textureLoad(rate_image, texel * textureDimensions(rate_image) / picture_size(), 0).x; }
    }
}

fn normal_at(texel: vec2i) -> vec3f {
    return unit_from_octahedral(unpack2x16snorm(textureLoad(gbuffer_surface, texel, 0).y));
}

// Whether a surface ends between this pixel and its four neighbours: another instance, a crease of more than
// 45 degrees, or a jump in depth. Reversed depth is affine in screen space along a plane however it is tilted,
// so a jump shows as a second difference.
fn is_edge(texel: vec2i) -> bool {
    let last = vec2i(picture_size()) - 1;
    let right = vec2i(min(texel.x + 1, last.x), texel.y);
    let down = vec2i(texel.x, min(texel.y + 1, last.y));
    let left = vec2i(max(texel.x - 1, 0), texel.y);
    let up = vec2i(texel.x, max(texel.y - 1, 0));
    let own = textureLoad(gbuffer_identity, texel, 0).x;
    if own != textureLoad(gbuffer_identity, right, 0).x || own != textureLoad(gbuffer_identity, down, 0).x {
        return true;
    }
    if own == 0u {
        return false;
    }
    let depth = textureLoad(gbuffer_depth, texel, 0);
    let across = textureLoad(gbuffer_depth, left, 0) + textureLoad(gbuffer_depth, right, 0);
    let along = textureLoad(gbuffer_depth, up, 0) + textureLoad(gbuffer_depth, down, 0);
    // At the picture's border one neighbour is the pixel itself; the difference is then a slope: let pass.
    let inner = vec2f(select(vec2i(0), vec2i(1), texel > vec2i(0) & texel < last));
    let bend = abs(vec2f(across, along) - 2.0 * depth) * inner;
    if max(bend.x, bend.y) > 0.02 * depth {
        return true;
    }
    let normal = normal_at(texel);
    return min(dot(normal, normal_at(right)), dot(normal, normal_at(down))) < 0.7;
}

@fragment
fn wish_level(in: LevelVertex) -> @location(0) u32 {
    let texel = vec2u(in.position.xy);
    var level = level_from(wish.source, texel);
    if wish.combine == 1u {
        level = max(level, level_from(wish.other, texel));
    } else if wish.combine == 2u {
        level = min(level, level_from(wish.other, texel));
    }
    level = min(level, wish.coarsest);
    if level == 0u || wish.find_edges == 0u || !is_edge(vec2i(texel)) {
        return level;
    }
    return select(level, 0u, level <= wish.refine_up_to) | CELL_EDGE;
}
