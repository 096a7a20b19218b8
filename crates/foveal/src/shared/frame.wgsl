// What every pass knows of the frame. Rust: `frame.rs`, `FrameUniform`.
// Nothing here may decide a branch by itself: `select`, or an override (ARCHITECTURE.md says why).

struct Frame {
    clip_from_world: mat4x4f,
    previous_clip_from_world: mat4x4f,
    world_from_view: mat4x4f,
    // View-space xy from normalized device coordinates: (ndc * xy + zw), times depth for a perspective.
    view_from_ndc: vec4f,
    eye: vec3f,
    // 0 perspective, 1 orthographic.
    orthographic: u32,
    // Unit view direction, world space.
    forward: vec3f,
    // Radiance is multiplied by it before the tone map.
    exposure: f32,
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
    // Pixels.
    size: vec2f,
    // Side of a cluster's tile in pixels.
    cluster_tile: f32,
    // Unused; keeps the size a multiple of 16 bytes.
    reserved: f32,
}

@group(0) @binding(0) var<uniform> frame: Frame;

// Distance along the view axis from reversed depth.
fn view_distance(depth: f32) -> f32 {
    return select(frame.near / depth, frame.near + (1.0 - depth) * frame.depth_range, frame.orthographic != 0u);
}

// Normalized device coordinates of a position in pixels, y up.
fn ndc_of(pixel: vec2f) -> vec2f {
    return vec2f(2.0, -2.0) * pixel / frame.size + vec2f(-1.0, 1.0);
}

// View-space position (x right, y up, looking down -z) of a pixel position at a distance along the view axis.
fn view_position(pixel: vec2f, distance: f32) -> vec3f {
    let xy = ndc_of(pixel) * frame.view_from_ndc.xy + frame.view_from_ndc.zw;
    return vec3f(xy * select(distance, 1.0, frame.orthographic != 0u), -distance);
}

fn world_from_view_position(view: vec3f) -> vec3f {
    return (frame.world_from_view * vec4f(view, 1.0)).xyz;
}

// Unit vector from a world position to the eye.
fn direction_to_eye(position: vec3f) -> vec3f {
    return select(normalize(frame.eye - position), -frame.forward, frame.orthographic != 0u);
}

// Radiance of the surroundings in a direction: the backdrop and the ambient term.
fn environment(direction: vec3f) -> vec3f {
    if direction.y >= 0.0 {
        return mix(frame.horizon, frame.zenith, sqrt(direction.y));
    }
    return mix(frame.horizon, frame.nadir, min(1.0, -4.0 * direction.y));
}
