// A light, and where along the view axis it is looked for. Rust: `lights/upload.rs`.

#import shared/frame.wgsl

struct Light {
    position: vec3f,
    // Metres; the light is exactly zero from here on.
    range: f32,
    // Colour times intensity.
    radiant: vec3f,
    // With `spot_scale` KHR_lights_punctual's attenuation: saturate(cos * scale + offset)^2, which is
    // 1 where there is no cone.
    spot_offset: f32,
    // Of the rays' travel, unit.
    direction: vec3f,
    spot_scale: f32,
    // No shader reads the rest: the CPU plans shadows by it (`shadow/plan.rs`, `shadow/rays.rs`).
    // Cosine and sine of the cone's half angle; (-1, 0) without a cone.
    cone_cos: f32,
    cone_sin: f32,
    // 0 directional, 1 point, 2 spot.
    kind: u32,
    // Metres within which it adds to a surface what is seen by itself: sizes of shadow tiles follow
    // from it. The range that a file gives.
    seen_m: f32,
}

struct Lights {
    count: u32,
    // 32-light words per cluster.
    words: u32,
    // Directional ones, which come first. They are in no cluster's words.
    directional: u32,
    reserved: u32,
    items: array<Light>,
}

// Four pixels at the rim of the block that a sample stands for: what they show, from the sample's place,
// in metres of world space, and by 1 which of them count: those that show the sample's surface.
struct Rim {
    x: vec4f,
    y: vec4f,
    z: vec4f,
    counts: vec4f,
}

// Four unit normals, and by 1 which of them count.
struct Normals {
    x: vec4f,
    y: vec4f,
    z: vec4f,
    counts: vec4f,
}

// The block of pixels that a sample stands for, by eight pixels at its rim and by normals. Of a
// single pixel none counts.
struct Block {
    first: Rim,
    second: Rim,
    asks_normals: bool,
    // Normals of the first four pixels at the rim.
    at_rim: Normals,
    // Others that its pixels may have: the sample's own, tilted to four sides.
    tilted: Normals,
}

// Whether all eight are looked at, or only the first four.
override BOTH_RIMS: bool = true;

const NO_RIM: Rim = Rim(vec4f(0.0), vec4f(0.0), vec4f(0.0), vec4f(0.0));
const NO_NORMALS: Normals = Normals(vec4f(0.0), vec4f(0.0), vec4f(0.0), vec4f(0.0));
const PIXEL: Block = Block(NO_RIM, NO_RIM, false, NO_NORMALS, NO_NORMALS);

// What of a light's rays arrives where it is looked at.
struct Arriving {
    // Part of them that reaches the sample.
    part: f32,
    // Variance of that part within the sample's block, estimated from the pixel at the rim whose part
    // differs most from the sample's.
    variance: f32,
}

const ALL_ARRIVES: Arriving = Arriving(1.0, 0.0);

fn cluster_slice(distance: f32) -> u32 {
    let slice = log2(max(distance / frame.cluster_near, 1e-6)) * frame.cluster_scale + 1.0;
    return u32(clamp(slice, 0.0, f32(frame.cluster_counts.z - 1u)));
}
