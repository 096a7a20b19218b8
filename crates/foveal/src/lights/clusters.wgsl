// Light assignment: which lights reach which cluster (froxel), one bit each. One workgroup per
// light that shines from a point walks the clusters around the light's sphere.

#import shared/frame.wgsl
#import shared/light.wgsl
#import shared/light_table.wgsl

#ifdef TABLES
@group(1) @binding(0) var light_table: texture_2d<u32>;
#else
@group(1) @binding(0) var<storage, read> lights: Lights;
#endif
@group(1) @binding(1) var<storage, read_write> cluster_bits: array<atomic<u32>>;

// How many views share the grid.
override VIEWS: u32 = 1u;

struct Box {
    low: vec3f,
    high: vec3f,
}

// Distances along the view axis where a slice begins and ends.
fn slice_span(slice: u32) -> vec2f {
    let begin = frame.cluster_near * exp2((f32(slice) - 1.0) / frame.cluster_scale);
    let end = frame.cluster_near * exp2(f32(slice) / frame.cluster_scale);
    return vec2f(
        select(begin, -1e30, slice == 0u),
        select(end, 1e30, slice == frame.cluster_counts.z - 1u),
    );
}

// The cluster in a view's space, its depth clipped to the light's: slices at both ends are
// infinite.
fn cluster_box(view: u32, cluster: vec3u, nearest: f32, farthest: f32) -> Box {
    let span = slice_span(cluster.z);
    let z = vec2f(max(span.x, nearest), min(span.y, farthest));
    let shift = vec2f(frame.views[view].cluster_shift_x, frame.views[view].cluster_shift_y);
    let corner = vec2f(cluster.xy) * frame.cluster_tile - shift;
    let a = position_in_view(view, corner, z.x).xy;
    let b = position_in_view(view, corner + frame.cluster_tile, z.x).xy;
    let c = position_in_view(view, corner, z.y).xy;
    let d = position_in_view(view, corner + frame.cluster_tile, z.y).xy;
    return Box(
        vec3f(min(min(a, b), min(c, d)), -z.y),
        vec3f(max(max(a, b), max(c, d)), -z.x),
    );
}

// A light's centre in a view's space.
fn center_in(view: u32, position: vec3f) -> vec3f {
    let world_from_view = frame.views[view].world_from_view;
    let offset = position - world_from_view[3].xyz;
    return vec3f(
        dot(world_from_view[0].xyz, offset),
        dot(world_from_view[1].xyz, offset),
        dot(world_from_view[2].xyz, offset),
    );
}

@compute @workgroup_size(64)
fn assign(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = group.x;
    if index < directional_lights() {
        return;
    }
    let light = light_at(index);
    // A little more than the range: rounding may err, but never to the small side.
    let radius = light.range * 1.0001 + 1e-4;
    // The eyes look the same way and stand side by side, so the distance is the same for both.
    let center = center_in(0u, light.position);
    let nearest = -center.z - radius;
    let farthest = -center.z + radius;
    if farthest < 0.0 && frame.orthographic == 0u {
        return;
    }
    // The slice is a rounded logarithm: one more on either side holds what rounding may have moved.
    var first = cluster_slice(nearest);
    first -= min(first, 1u);
    let last = min(cluster_slice(farthest) + 1u, frame.cluster_counts.z - 1u);
    let per_slice = frame.cluster_counts.x * frame.cluster_counts.y;
    let count = per_slice * (last - first + 1u);
    for (var i = local; i < count; i += 64u) {
        let in_slice = i % per_slice;
        let cluster = vec3u(in_slice % frame.cluster_counts.x, in_slice / frame.cluster_counts.x, first + i / per_slice);
        var touches = false;
        for (var view = 0u; view < VIEWS && !touches; view++) {
            let begin = select(max(nearest, 0.0), nearest, frame.orthographic != 0u);
            let b = cluster_box(view, cluster, begin, farthest);
            let seen = center_in(view, light.position);
            let gap = max(max(b.low - seen, seen - b.high), vec3f(0.0));
            touches = dot(gap, gap) <= radius * radius;
        }
        if touches {
            let flat = cluster.x + frame.cluster_counts.x * (cluster.y + frame.cluster_counts.y * cluster.z);
            atomicOr(&cluster_bits[flat * light_words() + index / 32u], 1u << (index % 32u));
        }
    }
}
