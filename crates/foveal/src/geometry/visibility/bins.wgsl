// The seen pixels sorted by material: counted, summed up, scattered. Materials of a family have
// bins side by side, so that its pixels are one range of the list. CPU twin: `twin.rs`.
//
// A workgroup looks at 16 x 16 pixels, a thread at 2 x 2 of them. Counted and scattered they are by
// bins_table.wgsl or bins_subgroups.wgsl.

#import geometry/visibility/family.wgsl
#import shared/layers.wgsl
#import geometry/visibility/listed.wgsl
#import shared/places.wgsl

// Workgroups that a dispatch may have in one dimension.
const MAX_ROW: u32 = 65535u;

struct Bin {
    count: atomic<u32>,
    // Where in `pixels` the bin begins, and how many of its pixels are there already.
    first: u32,
    filled: atomic<u32>,
    reserved: u32,
}

@group(1) @binding(0) var identity: texture_2d_array<u32>;
#ifdef TABLES
@group(1) @binding(1) var place_table: texture_2d<u32>;
#else
@group(1) @binding(1) var<storage, read> places: array<Place>;
#endif
// One for each material.
@group(1) @binding(2) var<storage, read_write> bins: array<Bin>;
// x | y << 16.
@group(1) @binding(3) var<storage, read_write> pixels: array<u32>;
@group(1) @binding(4) var surface: texture_storage_2d_array<rgba32uint, write>;
@group(1) @binding(5) var<storage, read_write> families: array<Family>;
#ifndef EVERY
// Shading rates or owner levels of 2 x 2 pixels each.
@group(1) @binding(6) var mask: texture_2d<u32>;
#endif

// What a thread finds at its 2 x 2 pixels: bin + 1, or 0 where nothing is, or where the pixel is
// another's to stand for.
struct Quad {
    // Pixels to look at: all, or none. A loop of none costs nothing, a branch that none takes does.
    count: u32,
    keys: array<u32, 4>,
    // The surface is read, but nothing is seen.
    empty: array<bool, 4>,
}

fn texel_of(quad: vec2u, i: u32) -> vec2u {
    return quad * 2u + vec2u(i & 1u, i >> 1u);
}

fn keys_of(quad: vec2u) -> Quad {
    let rate = rate_at(quad);
    var found: Quad;
    found.count = select(0u, 4u, has_listed(quad, rate));
    // Pixels side by side mostly show one instance, whose bin is looked up once.
    var instance = 0u;
    var key = 0u;
    for (var i = 0u; i < found.count; i++) {
        let texel = texel_of(quad, i);
        let there = all(texel < whole_size(identity));
        let read = there && is_read(texel, rate);
        var seen = 0u;
        if read {
            seen = load_words(identity, texel).x;
        }
        if seen != instance {
            instance = seen;
            key = 0u;
            if seen != 0u {
                key = place_of(seen - 1u).bin + 1u;
            }
        }
        found.keys[i] = select(0u, key, is_listed(texel, rate));
        found.empty[i] = read && seen == 0u;
    }
    return found;
}

var<workgroup> sums: array<u32, 256>;

// One workgroup: an inclusive sum over 256 bins at a time (Hillis and Steele 1986).
@compute @workgroup_size(256)
fn sum_bins(@builtin(local_invocation_index) local: u32) {
    let length = arrayLength(&bins);
    var before = 0u;
    for (var chunk = 0u; chunk < length; chunk += 256u) {
        let bin = chunk + local;
        var count = 0u;
        if bin < length {
            count = atomicLoad(&bins[bin].count);
        }
        sums[local] = count;
        workgroupBarrier();
        for (var stride = 1u; stride < 256u; stride *= 2u) {
            var left = 0u;
            if local >= stride {
                left = sums[local - stride];
            }
            workgroupBarrier();
            sums[local] += left;
            workgroupBarrier();
        }
        if bin < length {
            bins[bin].first = before + sums[local] - count;
        }
        before += sums[255];
        workgroupBarrier();
    }
    storageBarrier();
    for (var family = local; family < arrayLength(&families); family += 256u) {
        // A family has at least one bin.
        let last = families[family].end - 1u;
        let first = bins[families[family].begin].first;
        let count = bins[last].first + atomicLoad(&bins[last].count) - first;
        let groups = (count + 63u) / 64u;
        families[family].groups_x = min(groups, MAX_ROW);
        families[family].groups_y = (groups + MAX_ROW - 1u) / MAX_ROW;
        families[family].groups_z = 1u;
        families[family].count = count;
        families[family].first = first;
    }
}
