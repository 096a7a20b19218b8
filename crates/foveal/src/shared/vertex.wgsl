// From a mesh's vertex to the world and the screen.

#ifdef CLIPPED
enable clip_distances;
#endif
#import shared/frame.wgsl
#import shared/identity.wgsl
#import shared/instances.wgsl
#ifdef STROKES
#import shared/stroke.wgsl
#endif

struct VertexIn {
    @builtin(instance_index) drawn_index: u32,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    // Both UV sets.
    @location(3) uv: vec4f,
    @location(4) color: vec4f,
    // Object space, in the pose of the frame before.
    @location(5) previous_position: vec3f,
}

struct VertexOut {
    @invariant @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) uv: vec4f,
    @location(4) color: vec4f,
    // The instance's number; the highest bit tells the eye.
    @location(5) @interpolate(flat) instance: u32,
    // x, y, w of the eye's own clip space now and in the frame before; w of `before`: by how many
    // metres the place has moved.
    @location(6) now: vec3f,
    @location(7) before: vec4f,
}

// How eyes are drawn: 0 one view to a target or layer, 1 each in a pass of its own, 2 as instances
// in turn.
override EYES: u32 = 0u;
// An eye's fragments beyond the centre of the target are discarded, not clipped.
override DISCARD_BEYOND: bool = false;

// Motion is found. Where it is not, nothing of it is computed. Rust: `geometry/motion.rs`.
override MOTION: bool = true;

// Highest bit of an instance's number on its way to the fragments: it is seen by the right eye.
const RIGHT_EYE: u32 = 0x80000000u;

// Which bit of the number that is drawn tells the eye that is drawn by itself. Rust:
// `stereo/submission.rs`.
const EYE_BIT: u32 = 26u;

// An instance's number, and the view that it is drawn for.
struct Drawn {
    instance: u32,
    view: u32,
}

fn drawn_as(instance_index: u32) -> Drawn {
    if EYES == 1u {
        return Drawn(drawn_at(instance_index & ((1u << EYE_BIT) - 1u)), instance_index >> EYE_BIT);
    } else if EYES == 2u {
        return Drawn(drawn_at(instance_index >> 1u), instance_index & 1u);
    }
    return Drawn(drawn_at(instance_index), 0u);
}

// From an eye's own clip space into its part of the target: left -w..w to the leftmost part, right
// to the rightmost. Two passes do it likewise, so that all ways round alike.
fn in_target(clip: vec4f, view: u32) -> vec4f {
    if EYES == 0u {
        return clip;
    }
    let part = frame.size.x / frame.target_size.x;
    let shift = (1.0 - part) * clip.w;
    return vec4f(clip.x * part + select(-shift, shift, view == 1u), clip.yzw);
}

// How far inside an eye's own half of the target, in clip space, from x, y, w there; negative
// beyond the centre.
fn inside_own_half(now: vec3f, marked_instance: u32) -> f32 {
    return now.z + select(-now.x, now.x, (marked_instance & RIGHT_EYE) != 0u);
}

fn is_beyond(now: vec3f, marked_instance: u32) -> bool {
    return DISCARD_BEYOND && inside_own_half(now, marked_instance) < 0.0;
}

// A vertex in the world: unit normal and tangent; a tangent of zero says that there is none.
struct WorldVertex {
    position: vec3f,
    normal: vec3f,
    tangent: vec4f,
}

fn instance_position(i: Instance, position: vec3f) -> vec3f {
    let p = vec4f(position, 1.0);
    return vec3f(dot(i.world_x, p), dot(i.world_y, p), dot(i.world_z, p));
}

fn previous_instance_position(i: Instance, position: vec3f) -> vec3f {
    let p = vec4f(position, 1.0);
    return vec3f(dot(i.previous_x, p), dot(i.previous_y, p), dot(i.previous_z, p));
}

// Whether a place rests in the world. Positions then and now do not tell: they are computed by
// different instructions, which may round differently.
fn rests_in_world(i: Instance, position: vec3f, previous_position: vec3f) -> bool {
    let instance_rests = all(i.world_x == i.previous_x) & all(i.world_y == i.previous_y) & all(i.world_z == i.previous_z);
    return instance_rests & all(position == previous_position);
}

// x, y, w of an eye's own clip space in the frame before, `now` where nothing has moved; and by how
// many metres the place has moved in the world. Zero without `MOTION`.
fn clip_before(i: Instance, view: u32, now: vec3f, position: vec3f, previous_position: vec3f) -> vec4f {
    if !MOTION {
        return vec4f(0.0);
    }
    let previous = previous_instance_position(i, previous_position);
    let before = frame.views[view].previous_clip_from_world * vec4f(previous, 1.0);
    let rests = rests_in_world(i, position, previous_position);
    let view_rests = ((frame.resting_views >> view) & 1u) != 0u;
    let moved = select(distance(previous, instance_position(i, position)), 0.0, rests);
    return vec4f(select(before.xyw, now, rests & view_rests), moved);
}

// 1, or -1 where the instance's transform turns the winding around.
fn handedness_of(i: Instance) -> f32 {
    return select(-1.0, 1.0, dot(i.world_x.xyz, cross(i.world_y.xyz, i.world_z.xyz)) >= 0.0);
}

fn world_vertex(i: Instance, position: vec3f, normal: vec3f, tangent: vec4f) -> WorldVertex {
    // Normals go by the cofactor matrix: the inverse transpose times the determinant, so without a
    // division.
    let cx = cross(i.world_y.xyz, i.world_z.xyz);
    let cy = cross(i.world_z.xyz, i.world_x.xyz);
    let cz = cross(i.world_x.xyz, i.world_y.xyz);
    let handedness = handedness_of(i);
    let n = handedness * vec3f(dot(cx, normal), dot(cy, normal), dot(cz, normal));
    let t = vec3f(dot(i.world_x.xyz, tangent.xyz), dot(i.world_y.xyz, tangent.xyz), dot(i.world_z.xyz, tangent.xyz));
    return WorldVertex(
        instance_position(i, position),
        unit_or(n, vec3f(0.0, 1.0, 0.0)),
        vec4f(unit_or(t, vec3f(0.0)), tangent.w * handedness),
    );
}

@vertex
fn vertex(in: VertexIn) -> VertexOut {
    return vertex_of(in, drawn_as(in.drawn_index));
}

fn vertex_of(in: VertexIn, d: Drawn) -> VertexOut {
    let i = instance_at(d.instance);
#ifdef STROKES
    let world = world_vertex(i, in.position, in.normal, vec4f(0.0));
#else
    let world = world_vertex(i, in.position, in.normal, in.tangent);
#endif

    var out: VertexOut;
#ifdef STROKES
    let other_end = instance_position(i, in.tangent.xyz);
    let here = frame.views[d.view].clip_from_world * vec4f(world.position, 1.0);
    let there = frame.views[d.view].clip_from_world * vec4f(other_end, 1.0);
    let clip = stroke_corner(here, there, in.tangent, d.view);
    let cut = select(cut_at_near(here, there), 0.0, in.tangent.w == 0.0);
    let position = mix(world.position, other_end, cut);
#else
    let position = world.position;
    let clip = frame.views[d.view].clip_from_world * vec4f(world.position, 1.0);
#endif
    out.clip = in_target(clip, d.view);
    out.now = clip.xyw;
    out.world = position;
#ifdef STROKES
    // Zero: not lit.
    out.normal = select(world.normal, vec3f(0.0), all(in.normal == vec3f(0.0)));
#else
    out.normal = world.normal;
#endif
    out.tangent = world.tangent;
    out.uv = in.uv;
    out.color = in.color;
    out.instance = d.instance | (d.view << 31u);
    out.before = clip_before(i, d.view, out.now, in.position, in.previous_position);
    return out;
}

// Motion since the frame before, for x, y, w of clip space then and now. Zero where they are equal:
// the difference of two equal quotients need not be, where one of them is rounded later.
fn motion_in_pixels(now: vec3f, before: vec3f) -> vec2f {
    let moved = select(now.xy / now.z - before.xy / before.z, vec2f(0.0), all(now == before));
    return clamp(moved * vec2f(0.5, -0.5) * frame.size, vec2f(-60000.0), vec2f(60000.0));
}

// Part of a pixel's width, at a surface's distance, by which the surface has moved in the world from
// which on other light falls on it. Light drifts along with what is slower, until it is renewed.
const MOVED: f32 = 0.015625;

// `shared/identity.wgsl`.
fn identity_of(marked_instance: u32, now: vec3f, before: vec4f) -> vec2u {
    let number = (marked_instance & ~RIGHT_EYE) + 1u;
    if !MOTION {
        return vec2u(number, 0u);
    }
    let view = select(0u, 1u, (marked_instance & RIGHT_EYE) != 0u);
    let pixel_width = 2.0 * abs(frame.views[view].view_from_ndc.x * now.z) / frame.size.x;
    let motion = pack2x16float(motion_in_pixels(now, before.xyz)) & ~HAS_MOVED;
    let moved = select(0u, HAS_MOVED, before.w > MOVED * pixel_width);
    return vec2u(number, motion | moved);
}

fn unit_or(v: vec3f, otherwise: vec3f) -> vec3f {
    // Of an instance that is scaled by 1e-8 the normal is some 1e-16 long, whose square is lost.
    let lifted = select(v, v * 1e18, dot(v, v) < 1e-20);
    let squared = dot(lifted, lifted);
    return select(otherwise, lifted * inverseSqrt(max(squared, 1e-37)), squared > 1e-30);
}

#ifdef LAYERED
// Run once for each layer of the target; a layer is an eye's.
@vertex
fn vertex_layered(in: VertexIn, @builtin(view_index) view: u32) -> VertexOut {
    return vertex_of(in, Drawn(drawn_at(in.drawn_index), view));
}
#endif

#ifdef CLIPPED
// `VertexOut` with a clip plane between the eyes' parts of the target.
struct ClippedVertexOut {
    @invariant @builtin(position) clip: vec4f,
    @builtin(clip_distances) inside_own_half: array<f32, 1>,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) uv: vec4f,
    @location(4) color: vec4f,
    @location(5) @interpolate(flat) instance: u32,
    @location(6) now: vec3f,
    @location(7) before: vec4f,
}

@vertex
fn vertex_clipped(in: VertexIn) -> ClippedVertexOut {
    let v = vertex_of(in, drawn_as(in.drawn_index));
    // A little beyond the centre, so that rounding takes no pixel away, and less than any
    // sub-sample lies beyond it.
    let slack = v.now.z / (64.0 * frame.size.x);
    let inside = array<f32, 1>(inside_own_half(v.now, v.instance) + slack);
    return ClippedVertexOut(
        v.clip, inside, v.world, v.normal, v.tangent, v.uv, v.color, v.instance, v.now, v.before,
    );
}
#endif
