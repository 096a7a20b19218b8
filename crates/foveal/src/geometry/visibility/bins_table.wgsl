// Pixels counted and scattered where subgroups cannot be asked: what a workgroup finds is gathered
// in a small hash table first, so that the bins are touched once per workgroup and material.

#variant EVERY
#variant RATED
#variant TILED
#import geometry/visibility/bins.wgsl
#import shared/layers.wgsl

// The hash table: bin + 1, pixels of it, where they go.
var<workgroup> keys: array<atomic<u32>, 256>;
var<workgroup> counts: array<atomic<u32>, 256>;
var<workgroup> starts: array<u32, 256>;

fn slot_of(key: u32) -> u32 {
    var slot = (key * 0x9e3779b1u) >> 24u;
    loop {
        let found = atomicCompareExchangeWeak(&keys[slot], 0u, key);
        if found.exchanged || found.old_value == key {
            break;
        }
        // An exchange may fail for no reason: then the slot is tried again.
        slot = (slot + u32(found.old_value != 0u)) & 255u;
    }
    return slot;
}

@compute @workgroup_size(8, 8)
fn count_pixels(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) local: u32) {
    let quad = keys_of(id.xy);
    var run_key = 0u;
    var run = 0u;
    for (var i = 0u; i < quad.count; i++) {
        let key = quad.keys[i];
        if key != 0u && key != run_key && run > 0u {
            atomicAdd(&counts[slot_of(run_key)], run);
            run = 0u;
        }
        run_key = select(run_key, key, key != 0u);
        run += u32(key != 0u);
    }
    if run > 0u {
        atomicAdd(&counts[slot_of(run_key)], run);
    }
    workgroupBarrier();
    for (var slot = local; slot < 256u; slot += 64u) {
        let found = atomicLoad(&counts[slot]);
        if found > 0u {
            atomicAdd(&bins[atomicLoad(&keys[slot]) - 1u].count, found);
        }
    }
}

@compute @workgroup_size(8, 8)
fn scatter_pixels(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) local: u32) {
    let quad = keys_of(id.xy);
    var slots: array<u32, 4>;
    var within: array<u32, 4>;
    var run_key = 0u;
    var slot = 256u;
    for (var i = 0u; i < quad.count; i++) {
        let key = quad.keys[i];
        if key != 0u {
            if key != run_key {
                run_key = key;
                slot = slot_of(key);
            }
            within[i] = atomicAdd(&counts[slot], 1u);
        }
        slots[i] = select(256u, slot, key != 0u);
        if quad.empty[i] {
            let texel = texel_of(id.xy, i);
            let at = in_layers(textureDimensions(surface).x, texel);
            textureStore(surface, at.xy, at.z, vec4u(0u));
        }
    }
    workgroupBarrier();
    for (var slot = local; slot < 256u; slot += 64u) {
        let found = atomicLoad(&counts[slot]);
        if found > 0u {
            let bin = atomicLoad(&keys[slot]) - 1u;
            starts[slot] = bins[bin].first + atomicAdd(&bins[bin].filled, found);
        }
    }
    workgroupBarrier();
    for (var i = 0u; i < quad.count; i++) {
        if slots[i] < 256u {
            let texel = texel_of(id.xy, i);
            pixels[starts[slots[i]] + within[i]] = texel.x | (texel.y << 16u);
        }
    }
}
