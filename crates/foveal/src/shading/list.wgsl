// Entry point that shades the samples of a list.

#import shading/shading.wgsl

// Texels as x | y << 16.
@group(2) @binding(0) var<storage, read> samples: array<u32>;
// Workgroups in x, y, z and the number of samples: the indirect dispatch's arguments with their
// cause.
@group(2) @binding(1) var<storage, read> dispatch: array<u32, 4>;
@group(2) @binding(2) var radiance: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(64)
fn shade_list(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = (group.y * dispatch[0] + group.x) * 64u + local;
    if index >= dispatch[3] {
        return;
    }
    let texel = vec2u(samples[index] & 0xffffu, samples[index] >> 16u);
    textureStore(radiance, texel, shade(texel));
}
