// Merge: from the band of sub-samples to one G-buffer texel per pixel, which the ordinary stages
// read, and to entries for what else the pixel shows.

#import antialias/counters.wgsl
#import antialias/queue.wgsl
#import antialias/samples.wgsl
#import antialias/stored.wgsl
#import antialias/surfaces.wgsl
#import shading/input.wgsl
#import shared/full_screen.wgsl
#import shared/layers.wgsl

// Which pixels are edges: 0 none, 1 all, 2 by depth, 3 by surface.
override EDGES: u32 = 3u;

@group(2) @binding(2) var<storage, read_write> queue: QueueCounters;
@group(2) @binding(3) var<storage, read_write> entries: array<Entry>;

struct MergeOut {
    @location(0) surface: vec4u,
    @location(1) identity: vec2u,
    // How often the pixel is shaded, and how many sub-samples the texel stands for.
    @location(2) tally: vec2u,
    @builtin(frag_depth) depth: f32,
}

// As tatsy's shader has it, on our depth: reversed, 1 at the near plane.
fn depths_differ(pixel: vec2u) -> bool {
    let first = load_depth(gbuffer_depth, sample_texel(pixel, 0u));
    for (var i = 1u; i < COUNT; i++) {
        if abs(load_depth(gbuffer_depth, sample_texel(pixel, i)) - first) > 1e-4 {
            return true;
        }
    }
    return false;
}

@fragment
fn merge(@builtin(position) position: vec4f) -> MergeOut {
    let pixel = vec2u(position.xy);
    let packed = pixel.x | (pixel.y << 16u);
    var base = 0u;
    if EDGES == 3u {
        let found = largest_surface(pixel);
        let mean = blend_of(pixel, found.x);
        let identity = textureLoad(sample_identity, sample_texel(pixel, firstTrailingBit(found.x)), 0).xy;
        var shades = 1u;
        let further = found.y - 1u;
        if further > 0u && reserve(further, further, &base) {
            shades = found.y;
            var left = all_samples() & ~found.x;
            for (var i = 0u; left != 0u; i++) {
                let members = surface_of_first(pixel, left);
                left &= ~members;
                entries[base + i] = Entry(packed, members | (i << 16u) | (further << 24u));
            }
        }
        return MergeOut(mean.words, identity, vec2u(shades, countOneBits(found.x)), mean.depth);
    }
    var shades = 1u;
    if (EDGES == 1u || (EDGES == 2u && depths_differ(pixel))) && reserve(1u, COUNT, &base) {
        shades = min(COUNT, 255u);
        entries[base] = Entry(packed, 1u << 24u);
    }
    let texel = sample_texel(pixel, 0u);
    let words = load_words(gbuffer_surface, texel);
    let identity = textureLoad(sample_identity, texel, 0).xy;
    return MergeOut(words, identity, vec2u(shades, 1u), load_depth(gbuffer_depth, texel));
}
