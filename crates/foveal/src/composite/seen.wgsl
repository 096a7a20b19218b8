// What is seen at a texel of the G-buffer, and whether two texels show the same surface.

#import shared/frame.wgsl
#import shared/layers.wgsl
#ifdef BY_DEPTH
#import shared/normal_of_depth.wgsl
#else
#import shared/normal_of_surface.wgsl
#endif

@group(1) @binding(2) var gbuffer_surface: texture_2d_array<u32>;
@group(1) @binding(3) var gbuffer_identity: texture_2d_array<u32>;
@group(1) @binding(4) var gbuffer_depth: texture_depth_2d_array;

struct Seen {
    // 0 is the backdrop.
    instance: u32,
    // World space.
    position: vec3f,
    normal: vec3f,
}

fn seen_at(texel: vec2u) -> Seen {
    let distance = view_distance(max(load_depth(gbuffer_depth, texel), 1e-20));
    return Seen(
        load_words(gbuffer_identity, texel).x,
        world_position(vec2f(texel) + 0.5, distance),
        normal_seen(texel),
    );
}

// Neither leaves the other's tangent plane by much: 27 degrees of arc; nor do the normals differ
// much.
fn same_surface(a: Seen, b: Seen) -> bool {
    if a.instance != b.instance {
        return false;
    }
    if a.instance == 0u {
        return true;
    }
    let between = b.position - a.position;
    let away = max(abs(dot(between, a.normal)), abs(dot(between, b.normal)));
    return away <= 0.45 * length(between) && dot(a.normal, b.normal) > SAME_NORMAL;
}
