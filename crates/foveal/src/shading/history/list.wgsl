// Lists the samples that chosen pixels ask for, and the pixels that wait for them.

#import shading/history/layout.wgsl
#import shared/blocks.wgsl
#import shared/environment.wgsl
#import shared/wanted.wgsl

@group(1) @binding(0) var<storage, read> dispatch: Dispatch;
// Entries with a choice in place of a level.
@group(1) @binding(1) var<storage, read> chosen: array<u32>;
// What pixels show of the light that was reprojected.
@group(1) @binding(2) var radiance: texture_2d<f32>;
@group(1) @binding(3) var<storage, read_write> listed: array<Listed, LISTS>;
@group(1) @binding(4) var<storage, read_write> samples_listed: array<vec2u>;
// Pixels that have no history, as entries of level 0.
@group(1) @binding(5) var<storage, read_write> bare: array<u32>;
// A bit for each pixel that is a block's sample.
@group(1) @binding(6) var<storage, read_write> wanted: array<atomic<u32>>;

@compute @workgroup_size(64)
fn list_samples(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = list_index(group, local, dispatch.groups.x);
    if index >= dispatch.count {
        return;
    }
    let entry = chosen[index];
    let choice = entry >> 28u;
    let texel = entry_texel(entry);
    let is_shaded = choice >= CHOSEN_ITSELF;
    let level = select(choice, 0u, is_shaded);
    let sample = sample_texel(texel >> vec2u(level), level, 0u);
    var is_listed = is_shaded;
    if !is_shaded {
        bare[atomicAdd(&listed[BARE].count, 1u)] = sample_entry(texel, 0u);
        is_listed = is_first_to_want(sample);
    }
    if is_listed {
        let known_from = f32(choice - CHOSEN_ITSELF);
        let shown = min(luminance(textureLoad(radiance, texel, 0).rgb), 65504.0);
        let expected = select(vec2f(0.0, EXPECTED_NOTHING), vec2f(shown, known_from), choice > CHOSEN_ITSELF);
        atomicAdd(&listed[SAMPLES].of_level[level], 1u);
        let index = atomicAdd(&listed[select(SAMPLES, SINGLE, is_shaded)].count, 1u);
        samples_listed[select(arrayLength(&samples_listed) - 1u - index, index, is_shaded)] = vec2u(
            sample_entry(select(sample, texel, is_shaded), level),
            pack2x16float(expected),
        );
    }
}
