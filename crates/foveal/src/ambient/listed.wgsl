// Ambient visibility of the blocks of a list, at their samples.

#import ambient/horizons.wgsl

@group(1) @binding(2) var found: texture_storage_2d<r32float, write>;
// Texels as x | y << 14 | level << 28.
@group(1) @binding(3) var<storage, read> listed: array<u32>;
// Workgroups in x, y, z and the number of listed texels.
@group(1) @binding(4) var<storage, read> dispatch: array<u32, 4>;

@compute @workgroup_size(64)
fn find_listed(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = (group.y * dispatch[0] + group.x) * 64u + local;
    if index >= dispatch[3] {
        return;
    }
    let entry = listed[index];
    let texel = vec2u(entry, entry >> 14u) & vec2u(0x3fffu);
    let level = entry >> 28u;
    textureStore(found, texel, vec4f(visibility_from(texel, pattern_of(place_of(texel, level), level))));
}
