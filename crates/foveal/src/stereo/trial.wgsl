// A small scene on which the ways of submission are tried: draws of a few triangles each that lie
// everywhere and beyond every border. Rust: `stereo/trial.rs`.

#import shared/hash.wgsl

#variant
#variant CLIPPED
#variant LAYERED
#ifdef CLIPPED
enable clip_distances;
#endif

// Triangles of a draw.
const TRIANGLES: u32 = 128u;

struct Corner {
    @invariant @builtin(position) clip: vec4f,
    // Of the triangle, from 1 on.
    @location(0) @interpolate(flat) number: u32,
    // How far inside the eye's own half of the target; negative beyond the centre.
    @location(1) inside_own_half: f32,
}

// -1 to 1.
fn spread(value: u32) -> f32 {
    return f32(hash(value) >> 8u) / 8388608.0 - 1.0;
}

// As an eye sees it.
fn corner(drawn: u32, vertex: u32, eye: u32) -> Corner {
    let triangle = drawn * TRIANGLES + vertex / 3u;
    let center = 1.2 * vec2f(spread(triangle * 3u), spread(triangle * 3u + 1u));
    let depth = 0.5 + 0.49 * spread(triangle * 3u + 2u);
    let seed = (triangle * 3u + vertex % 3u) * 2u + 0x10000000u;
    let away = 0.25 * vec2f(spread(seed), spread(seed + 1u));
    let shift = select(0.3, -0.3, eye == 1u) * depth;
    return Corner(vec4f(center + away + vec2f(shift, 0.0), depth, 1.0), triangle + 1u, 1.0);
}

// One eye alone: a bit of the number tells which. Rust: `stereo/submission.rs`.
const EYE_BIT: u32 = 26u;

@vertex
fn eye_alone(@builtin(instance_index) drawn: u32, @builtin(vertex_index) vertex: u32) -> Corner {
    return corner(drawn & ((1u << EYE_BIT) - 1u), vertex, drawn >> EYE_BIT);
}

fn beside(drawn: u32, vertex: u32) -> Corner {
    let eye = drawn & 1u;
    var out = corner(drawn >> 1u, vertex, eye);
    out.inside_own_half = 1.0 + select(-out.clip.x, out.clip.x, eye == 1u);
    out.clip.x = 0.5 * out.clip.x + select(-0.5, 0.5, eye == 1u);
    return out;
}

// Both eyes as instances in turn, side by side.
@vertex
fn eyes_beside(@builtin(instance_index) drawn: u32, @builtin(vertex_index) vertex: u32) -> Corner {
    return beside(drawn, vertex);
}

@fragment
fn number(in: Corner) -> @location(0) u32 {
    if in.inside_own_half < 0.0 {
        discard;
    }
    return in.number;
}

#ifdef CLIPPED
// Both eyes side by side with a clip plane between them.
struct ClippedCorner {
    @invariant @builtin(position) clip: vec4f,
    @builtin(clip_distances) inside: array<f32, 1>,
    @location(0) @interpolate(flat) number: u32,
    @location(1) inside_own_half: f32,
}

@vertex
fn eyes_clipped(@builtin(instance_index) drawn: u32, @builtin(vertex_index) vertex: u32) -> ClippedCorner {
    let c = beside(drawn, vertex);
    // The plane alone decides.
    return ClippedCorner(c.clip, array<f32, 1>(c.inside_own_half), c.number, 1.0);
}
#endif

#ifdef LAYERED
// Both eyes to layers of their own.
@vertex
fn eyes_layered(
    @builtin(instance_index) drawn: u32,
    @builtin(vertex_index) vertex: u32,
    @builtin(view_index) view: u32,
) -> Corner {
    return corner(drawn, vertex, view);
}
#endif
