// From a mesh's vertex to the world and the screen. Needs frame.wgsl. Rust: `scene/instances.rs`.

struct Instance {
    // Rows of the affine world_from_object.
    world_x: vec4f,
    world_y: vec4f,
    world_z: vec4f,
    previous_x: vec4f,
    previous_y: vec4f,
    previous_z: vec4f,
}

@group(0) @binding(1) var<storage, read> instances: array<Instance>;
// Which instance each drawn one is.
@group(0) @binding(2) var<storage, read> drawn: array<u32>;

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
    @location(5) @interpolate(flat) instance: u32,
    // x, y, w of clip space now and in the frame before.
    @location(6) now: vec3f,
    @location(7) before: vec3f,
}

@vertex
fn vertex(in: VertexIn) -> VertexOut {
    let index = drawn[in.drawn_index];
    let i = instances[index];
    let p = vec4f(in.position, 1.0);
    let q = vec4f(in.previous_position, 1.0);
    let world = vec3f(dot(i.world_x, p), dot(i.world_y, p), dot(i.world_z, p));
    let previous = vec3f(dot(i.previous_x, q), dot(i.previous_y, q), dot(i.previous_z, q));
    // Normals go by the cofactor matrix: the inverse transpose times the determinant, so without a division.
    let cx = cross(i.world_y.xyz, i.world_z.xyz);
    let cy = cross(i.world_z.xyz, i.world_x.xyz);
    let cz = cross(i.world_x.xyz, i.world_y.xyz);
    let handedness = select(-1.0, 1.0, dot(i.world_x.xyz, cx) >= 0.0);
    let normal = handedness * vec3f(dot(cx, in.normal), dot(cy, in.normal), dot(cz, in.normal));
    let t = in.tangent.xyz;
    let tangent = vec3f(dot(i.world_x.xyz, t), dot(i.world_y.xyz, t), dot(i.world_z.xyz, t));

    var out: VertexOut;
    out.clip = frame.views[0].clip_from_world * vec4f(world, 1.0);
    out.world = world;
    out.normal = unit_or(normal, vec3f(0.0, 1.0, 0.0));
    // Zero stays zero: it says that there is no tangent.
    out.tangent = vec4f(unit_or(tangent, vec3f(0.0)), in.tangent.w * handedness);
    out.uv = in.uv;
    out.color = in.color;
    out.instance = index;
    out.now = out.clip.xyw;
    out.before = (frame.views[0].previous_clip_from_world * vec4f(previous, 1.0)).xyw;
    return out;
}

fn unit_or(v: vec3f, otherwise: vec3f) -> vec3f {
    let squared = dot(v, v);
    return select(otherwise, v * inverseSqrt(max(squared, 1e-37)), squared > 1e-30);
}
