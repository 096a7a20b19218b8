// As bins_table.wgsl where subgroups can be asked: each of their materials is one sum and touches
// its bin once.

#variant EVERY
#variant RATED
#variant TILED
#import geometry/visibility/bins.wgsl
#import shared/layers.wgsl

const NONE: u32 = 0xffffffffu;

// Subgroups are near to squares: 4 x 2 quads, 8 x 4, 8 x 8.
fn quad_of(group: vec2u, local: u32) -> vec2u {
    let x = (local & 1u) | ((local >> 1u) & 2u) | ((local >> 2u) & 4u);
    let y = ((local >> 1u) & 1u) | ((local >> 2u) & 2u) | ((local >> 3u) & 4u);
    return group * 8u + vec2u(x, y);
}

// The least key above `done`.
fn next_key(quad: Quad, done: u32) -> u32 {
    var least = NONE;
    for (var i = 0u; i < quad.count; i++) {
        least = select(least, min(least, quad.keys[i]), quad.keys[i] > done);
    }
    return least;
}

fn pixels_of(quad: Quad, key: u32) -> u32 {
    var found = 0u;
    for (var i = 0u; i < quad.count; i++) {
        found += u32(quad.keys[i] == key);
    }
    return found;
}

@compute @workgroup_size(64)
fn count_pixels(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) local: u32,
    @builtin(subgroup_invocation_id) lane: u32,
) {
    let quad = keys_of(quad_of(group.xy, local));
    var key = subgroupMin(next_key(quad, 0u));
    while key != NONE {
        let found = subgroupAdd(pixels_of(quad, key));
        if lane == 0u {
            atomicAdd(&bins[key - 1u].count, found);
        }
        key = subgroupMin(next_key(quad, key));
    }
}

@compute @workgroup_size(64)
fn scatter_pixels(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) local: u32,
    @builtin(subgroup_invocation_id) lane: u32,
) {
    let at_quad = quad_of(group.xy, local);
    let quad = keys_of(at_quad);
    for (var i = 0u; i < quad.count; i++) {
        if quad.empty[i] {
            let texel = texel_of(at_quad, i);
            let at = in_layers(textureDimensions(surface).x, texel);
            textureStore(surface, at.xy, at.z, vec4u(0u));
        }
    }
    var key = subgroupMin(next_key(quad, 0u));
    while key != NONE {
        let own = pixels_of(quad, key);
        let found = subgroupAdd(own);
        var start = 0u;
        if lane == 0u {
            start = bins[key - 1u].first + atomicAdd(&bins[key - 1u].filled, found);
        }
        var place = subgroupBroadcastFirst(start) + subgroupExclusiveAdd(own);
        for (var i = 0u; i < quad.count; i++) {
            if quad.keys[i] == key {
                let texel = texel_of(at_quad, i);
                pixels[place] = texel.x | (texel.y << 16u);
                place++;
            }
        }
        key = subgroupMin(next_key(quad, key));
    }
}
