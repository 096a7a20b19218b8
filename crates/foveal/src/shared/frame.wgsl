// What every pass knows of the frame. Rust: `frame.rs`, `FrameUniform`. Nothing here may decide a
// branch by itself: `select`, or an override (ARCHITECTURE.md says why).
//
// With two eyes, targets hold the left one's picture and, from `eye_stride` on, the right one's. A
// position in pixels or texels is one of the target; whose it is, `view_of` and `view_at` say. With
// one eye all are view 0.

struct View {
    clip_from_world: mat4x4f,
    previous_clip_from_world: mat4x4f,
    world_from_view: mat4x4f,
    // View-space xy from normalized device coordinates: (ndc * xy + zw), times depth for a
    // perspective.
    view_from_ndc: vec4f,
    eye: vec3f,
    // Whole pixels by which the eye's picture is moved in the grid of clusters, so that both look
    // alike far away.
    cluster_shift_x: f32,
    // Unit view direction, world space.
    forward: vec3f,
    cluster_shift_y: f32,
    // Of the frame before: the eye, orthographic the unit direction to it; and half the picture's
    // width, perspective at distance 1.
    previous_eye: vec3f,
    previous_half_width: f32,
}

struct Frame {
    // The left or only eye's, the right eye's.
    views: array<View, 2>,
    zenith: vec3f,
    // Near plane's distance.
    near: f32,
    horizon: vec3f,
    // Far plane's distance minus the near plane's; orthographic only.
    depth_range: f32,
    nadir: vec3f,
    // Distance along the view axis where the second slice of clusters begins.
    cluster_near: f32,
    // Tiles across, tiles down, slices.
    cluster_counts: vec3u,
    // Slices per doubling of the distance.
    cluster_scale: f32,
    // Of one eye's picture, in pixels.
    size: vec2f,
    // Of the target, in texels.
    target_size: vec2f,
    // Side of a cluster's tile in pixels.
    cluster_tile: f32,
    // First column of the right eye; beyond every target with one eye.
    eye_stride: u32,
    // Radiance is multiplied by it before the tone map.
    exposure: f32,
    // 0 perspective, 1 orthographic.
    orthographic: u32,
    // Of the environment's map: see `shared/environment.wgsl`.
    irradiance: array<vec4f, 9>,
    // Cosine and sine of the angle by which the environment is turned about +y.
    environment_turn: vec2f,
    environment_intensity: f32,
    // Side of a point, in pixels; at least 1.
    point_size: f32,
    // Its last level, levels per doubling of the roughness, one over level 1's squared roughness.
    environment_levels: vec3f,
    // Width of a line, in pixels; at least 1.
    line_width: f32,
    // Texels by which places are moved along their normals before shadows are looked up.
    shadow_bias: f32,
    // Of lamps that shine from a point, in metres.
    light_radius: f32,
    // Tangent of half the angle that directional lights fill.
    sun_tangent: f32,
    // A bit for each view whose matrix is that of the frame before.
    resting_views: u32,
    // Standard deviation of what samples of light say of a pixel, over its luminance, from which on the
    // pixel is shaded.
    most_disagreement: f32,
}

@group(0) @binding(0) var<uniform> frame: Frame;

// The view that a texel of the target belongs to.
fn view_of(texel: vec2u) -> u32 {
    return u32(texel.x >= frame.eye_stride);
}

// The view that a position in pixels of the target belongs to.
fn view_at(pixel: vec2f) -> u32 {
    return u32(pixel.x >= f32(frame.eye_stride));
}

// Texels of one eye's picture: from `low` up to but not including `end`.
struct Picture {
    low: vec2u,
    end: vec2u,
}

// The picture that a texel belongs to.
fn picture_of(texel: vec2u) -> Picture {
    let low = vec2u(view_of(texel) * frame.eye_stride, 0u);
    return Picture(low, low + vec2u(frame.size));
}

// A position in pixels of the target, relative to its eye's picture.
fn in_eye(pixel: vec2f) -> vec2f {
    return pixel - vec2f(f32(view_at(pixel) * frame.eye_stride), 0.0);
}

// Distance along the view axis from reversed depth.
fn view_distance(depth: f32) -> f32 {
    return select(frame.near / depth, frame.near + (1.0 - depth) * frame.depth_range, frame.orthographic != 0u);
}

// Normalized device coordinates of a position in pixels of one eye's picture, y up.
fn ndc_of(pixel: vec2f) -> vec2f {
    return vec2f(2.0, -2.0) * pixel / frame.size + vec2f(-1.0, 1.0);
}

// View-space position (x right, y up, looking down -z) of a pixel position in an eye's picture at a
// distance along the view axis.
fn position_in_view(view: u32, pixel: vec2f, distance: f32) -> vec3f {
    let to_view = frame.views[view].view_from_ndc;
    let xy = ndc_of(pixel) * to_view.xy + to_view.zw;
    return vec3f(xy * select(distance, 1.0, frame.orthographic != 0u), -distance);
}

// The same for a position in pixels of the target.
fn view_position(pixel: vec2f, distance: f32) -> vec3f {
    return position_in_view(view_at(pixel), in_eye(pixel), distance);
}

// Width in metres of a pixel that faces a view's eye, at a distance along the view axis.
fn pixel_width_at(view: u32, distance: f32) -> f32 {
    let half_width = select(frame.views[0].view_from_ndc.x, frame.views[1].view_from_ndc.x, view != 0u);
    return 2.0 * abs(half_width) / frame.size.x * select(distance, 1.0, frame.orthographic != 0u);
}

// World position of a pixel position of the target at a distance along the view axis.
fn world_position(pixel: vec2f, distance: f32) -> vec3f {
    return (frame.views[view_at(pixel)].world_from_view * vec4f(view_position(pixel, distance), 1.0)).xyz;
}

// Unit vector from a world position to a view's eye.
fn direction_to_eye(view: u32, position: vec3f) -> vec3f {
    let v = frame.views[view].eye - position;
    return select(normalize(v), -frame.views[view].forward, frame.orthographic != 0u);
}
