// A surface without textures: eight layers of noise in world space, each over those before where
// its height is great. CPU twin: `geometry/procedural.rs`.

#import shared/frame.wgsl

const PROCEDURAL_LAYERS: u32 = 8u;

// PCG (Jarzynski and Olano 2020, 'Hash Functions for GPU Rendering') of a lattice point.
fn lattice_hash(cell: vec3u, seed: u32) -> u32 {
    let mixed = (cell.x * 0x8da6b343u) ^ (cell.y * 0xd8163841u) ^ (cell.z * 0xcb1ab31fu) ^ (seed * 0x9e3779b1u);
    let state = mixed * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// 0 to 1.
fn lattice_value(cell: vec3u, seed: u32) -> f32 {
    return f32(lattice_hash(cell, seed) >> 8u) / 16777216.0;
}

// Value noise, 0 to 1, and its gradient (yzw).
fn value_noise(p: vec3f, seed: u32) -> vec4f {
    let low = floor(p);
    let t = p - low;
    let cell = bitcast<vec3u>(vec3i(low));
    var v: array<f32, 8>;
    for (var i = 0u; i < 8u; i++) {
        v[i] = lattice_value(cell + ((vec3u(i) >> vec3u(0u, 1u, 2u)) & vec3u(1u)), seed);
    }
    let s = t * t * (3.0 - 2.0 * t);
    let slope = 6.0 * t * (1.0 - t);
    // Along x, then y, then z; a difference beside each mean.
    let across_x = vec4f(v[1] - v[0], v[3] - v[2], v[5] - v[4], v[7] - v[6]);
    let along_x = vec4f(v[0], v[2], v[4], v[6]) + s.x * across_x;
    let along_y = mix(along_x.xz, along_x.yw, s.y);
    let across_y = along_x.yw - along_x.xz;
    let d_x = mix(across_x.xz, across_x.yw, s.y);
    return vec4f(
        mix(along_y.x, along_y.y, s.z),
        slope * vec3f(mix(d_x.x, d_x.y, s.z), mix(across_y.x, across_y.y, s.z), along_y.y - along_y.x),
    );
}

// Metres that a pixel shows at a position, as the left or only eye sees it: both see the same
// surface.
fn pixel_size(position: vec3f) -> f32 {
    let view = frame.views[0];
    let distance = select(dot(position - view.eye, view.forward), 1.0, frame.orthographic != 0u);
    return 2.0 * distance * abs(view.view_from_ndc.y) / frame.size.y;
}

struct Procedural {
    // Factor of the base colour.
    tint: vec3f,
    roughness: f32,
    // Gradient of the height in metres.
    slope: vec3f,
}

// `frequency` of the coarsest layer in 1/m; each further one's is 1.7 times higher. Layers whose
// lumps are finer than two pixels, `pixel_m` wide each, fade into their mean.
fn procedural_at(position: vec3f, seed: u32, frequency: f32, pixel_m: f32) -> Procedural {
    var found = Procedural(vec3f(1.0), 0.7, vec3f(0.0));
    var f = frequency;
    for (var i = 0u; i < PROCEDURAL_LAYERS; i++) {
        let own = lattice_hash(vec3u(i), seed);
        let tone = unpack4x8unorm(own);
        let noise = value_noise(position * f, own);
        let shown = saturate(2.0 - 4.0 * f * pixel_m);
        let height = mix(0.5, noise.x, shown);
        let cover = select(smoothstep(0.4, 0.7, height), 1.0, i == 0u);
        found.tint = mix(found.tint, (0.4 + 0.6 * tone.xyz) * (0.4 + 0.6 * height), cover);
        found.roughness = mix(found.roughness, 0.3 + 0.6 * tone.w, cover);
        // Finer lumps are as much lower.
        found.slope = mix(found.slope, noise.yzw * (0.3 * shown), cover);
        f *= 1.7;
    }
    return found;
}

// The normal of a surface that is raised by the height.
fn procedural_normal(normal: vec3f, slope: vec3f) -> vec3f {
    return normalize(normal - (slope - dot(slope, normal) * normal));
}
