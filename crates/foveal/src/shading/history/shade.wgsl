// Shades the samples of blocks, or with `SINGLE_PIXELS` pixels by themselves, and measures by how much
// these differ from what was expected. LIGHT asks for shadows within blocks.

#variant LIGHT
#import shading/coarse/block_light.wgsl
#import shading/coarse/light.wgsl
#import shading/history/measured.wgsl
#import shading/history/layout.wgsl
#import shared/frame.wgsl
#import shared/environment.wgsl

@group(2) @binding(0) var<storage, read> dispatch: Dispatch;
@group(2) @binding(1) var<storage, read> samples_listed: array<vec2u>;
@group(2) @binding(2) var light: texture_storage_2d<rgba32uint, write>;
@group(2) @binding(3) var radiance: texture_storage_2d<rgba16float, write>;
@group(2) @binding(4) var<storage, read_write> measured: array<Measured>;

fn measure(tile: u32, found: f32, expected: f32, is_own: bool) {
    let error = bitcast<u32>(abs(found - expected) / (max(found, expected) + DARK));
    atomicMax(&measured[tile].error, error);
    if is_own {
        atomicMax(&measured[tile].change, error);
    }
}

@compute @workgroup_size(64)
fn shade_samples(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = list_index(group, local, dispatch.groups.x);
    if index >= dispatch.count {
        return;
    }
    let from_end = arrayLength(&samples_listed) - 1u - index;
    let entry = samples_listed[select(from_end, index, SINGLE_PIXELS)];
    let level = level_of(entry.x >> 28u);
    let texel = entry_texel(entry.x);
    let lit = light_block(texel >> vec2u(level), level);
    textureStore(light, texel, lit.light);
    if !SINGLE_PIXELS {
        return;
    }
    textureStore(radiance, texel, vec4f(lit.radiance.rgb, 1.0));
    let expected = unpack2x16float(entry.y);
    if expected.y == EXPECTED_NOTHING {
        return;
    }
    measure(tile_number(texel), luminance(lit.radiance.rgb) * frame.exposure, expected.x * frame.exposure, expected.y == EXPECTED_OWN);
}
