// Puts gathered light where it is kept.

#import composite/leaders.wgsl
#import shading/history/layout.wgsl

@group(1) @binding(0) var<storage, read> dispatch: Dispatch;
// Entries; with FROM_LED from its end back, as `led_entry` has them.
@group(1) @binding(1) var<storage, read> listed: array<u32>;
@group(1) @binding(2) var gathered: texture_2d<u32>;
@group(1) @binding(3) var light: texture_storage_2d<rgba32uint, write>;

override FROM_LED: bool = false;

@compute @workgroup_size(64)
fn scatter(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = list_index(group, local, dispatch.groups.x);
    if index < dispatch.count {
        let entry = listed[select(index, arrayLength(&listed) - 1u - index, FROM_LED)];
        let texel = select(entry_texel(entry), led_texel(entry), FROM_LED);
        textureStore(light, texel, textureLoad(gathered, texel, 0));
    }
}
