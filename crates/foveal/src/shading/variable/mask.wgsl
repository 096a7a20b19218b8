// At which rate each quad is shaded, and the list of the samples that follows. CPU twin: `twin.rs`.

#import rate/fovea.wgsl
#import shading/variable/passes.wgsl
#import shading/variable/rates.wgsl
#import shading/variable/reproject.wgsl
#import shared/frame.wgsl
#import shared/layers.wgsl

// 0 foveated, 1 constant, 3 content, 4 radii.
override SOURCE: u32 = 3u;
override OTHER: u32 = 0u;
// 0 the first source alone, 1 the coarser of both, 2 the finer.
override COMBINE: u32 = 0u;
// Contrast: 0 within the quad, 1 against the four neighbours of each pixel, 2 by 3 x 3 Sobel
// kernels.
override CONTRAST: u32 = 1u;
// Samples may stand for 4 x 4 pixels.
override BLOCKS: bool = false;
// Contrast needs what is known of other quads, which a pass before this one has reprojected.
override LOOKS_AROUND: bool = true;

// Luma that is added to the local mean: what a dark picture's contrast is relative to (Weber's law
// fails there).
const DARK: f32 = 0.1;
// Bit of a requested rate besides those of `rates.wgsl`: content asks for a block where the block's
// pixels are alike.
const ASKS_IF_ALIKE: u32 = 8u;
// Least cosine between normals of what counts as one plane.
const FLAT: f32 = 0.9;

struct Listed {
    groups_x: u32,
    groups_y: u32,
    groups_z: u32,
    count: atomic<u32>,
    // Samples of one pixel, wide, tall, of a quad, of a block.
    of_rate: array<atomic<u32>, 5>,
    // Quads of which nothing was known.
    unknown: atomic<u32>,
    reserved: array<u32, 6>,
}

@group(1) @binding(9) var<storage, read_write> listed: Listed;
// rates.wgsl.
@group(1) @binding(10) var<storage, read_write> samples: array<u32>;

// Luminances of a quad at an offset; of the quad in the centre where that one is unknown or not
// there: no eye looks at the other's picture.
fn luma_of(quad: vec2i, offset: vec2i, center: vec4f) -> vec4f {
    let at = quad + offset;
    let picture = picture_of(vec2u(quad) * 2u);
    let low = vec2i(picture.low / 2u);
    let end = vec2i((picture.end + 1u) / 2u);
    let inside = all(at >= low) && all(at < end);
    let found = textureLoad(reprojected, clamp(at, low, end - 1), 0);
    return select(center, unpack4x8unorm(found.x), inside && (found.y & KNOWN_AT_ALL) != 0u);
}

// Contrast across and down, relative to the mean.
fn contrast_of(quad: vec2i, l: vec4f) -> vec2f {
    let inner = vec2f(max(abs(l.x - l.y), abs(l.z - l.w)), max(abs(l.x - l.z), abs(l.y - l.w)));
    let sum = dot(l, vec4f(1.0));
    if CONTRAST == 0u {
        return inner / (sum * 0.25 + DARK);
    }
    let w = luma_of(quad, vec2i(-1, 0), l).yw;
    let e = luma_of(quad, vec2i(1, 0), l).xz;
    let n = luma_of(quad, vec2i(0, -1), l).zw;
    let s = luma_of(quad, vec2i(0, 1), l).xy;
    let ring = dot(w + e + n + s, vec2f(1.0));
    if CONTRAST == 1u {
        let across = max(abs(w - l.xz), abs(e - l.yw));
        let down = max(abs(n - l.xy), abs(s - l.zw));
        let outer = vec2f(max(across.x, across.y), max(down.x, down.y));
        return max(inner, outer) / ((sum + ring) / 12.0 + DARK);
    }
    let nw = luma_of(quad, vec2i(-1, -1), l).w;
    let ne = luma_of(quad, vec2i(1, -1), l).z;
    let sw = luma_of(quad, vec2i(-1, 1), l).y;
    let se = luma_of(quad, vec2i(1, 1), l).x;
    let rows = mat4x4f(
        vec4f(nw, n, ne),
        vec4f(w.x, l.xy, e.x),
        vec4f(w.y, l.zw, e.y),
        vec4f(sw, s, se),
    );
    var steepest = vec2f(0.0);
    for (var i = 0u; i < 4u; i++) {
        let x = i & 1u;
        let y = i >> 1u;
        let above = vec3f(rows[y][x], rows[y][x + 1u], rows[y][x + 2u]);
        let level = vec3f(rows[y + 1u][x], rows[y + 1u][x + 1u], rows[y + 1u][x + 2u]);
        let below = vec3f(rows[y + 2u][x], rows[y + 2u][x + 1u], rows[y + 2u][x + 2u]);
        let columns = above + 2.0 * level + below;
        let weights = vec3f(1.0, 2.0, 1.0);
        let sobel = vec2f(columns.z - columns.x, dot(below - above, weights));
        // A step of height 1 gives 4.
        steepest = max(steepest, abs(sobel) * 0.25);
    }
    return steepest / ((sum + ring + nw + ne + sw + se) / 16.0 + DARK);
}

fn content_rate(quad: vec2u, lumas: vec4f, motion: vec2f) -> u32 {
    let contrast = contrast_of(vec2i(quad), lumas);
    let threshold = rates.threshold * (1.0 + rates.velocity_gain * length(motion));
    let coarse = vec2u(contrast <= vec2f(threshold));
    return coarse.x | (coarse.y << 1u) | (ASKS_IF_ALIKE * coarse.x * coarse.y);
}

fn rate_of_level(level: u32) -> u32 {
    return select(select(0u, 3u, level >= 1u), 7u | ASKS_IF_ALIKE, level >= 2u);
}

fn rate_from(source: u32, quad: vec2u, lumas: vec4f, motion: vec2f) -> u32 {
    switch source {
        case 0u: { return rate_of_level(foveated_level(vec2f(quad * 2u) + 1.0)); }
        case 1u: { return rate_of_level(request.constant_level); }
        case 4u: { return rate_of_level(radii_level(vec2f(quad * 2u) + 1.0)); }
        default: { return content_rate(quad, lumas, motion); }
    }
}

fn requested_rate(quad: vec2u, lumas: vec4f, motion: vec2f) -> u32 {
    let rate = rate_from(SOURCE, quad, lumas, motion);
    if COMBINE == 1u {
        return rate | rate_from(OTHER, quad, lumas, motion);
    } else if COMBINE == 2u {
        return rate & rate_from(OTHER, quad, lumas, motion);
    }
    return rate;
}

// What the pixels of a quad show.
struct Shown {
    // The coarsest rate at which a sample's pixels show one surface.
    limit: u32,
    // Of the plane through the first pixel and those to the right and below, any length.
    normal: vec3f,
}

fn are_parallel(a: vec3f, b: vec3f) -> bool {
    let along = dot(a, b);
    return along > 0.0 && along * along >= FLAT * FLAT * dot(a, a) * dot(b, b);
}

// Depth at a place relative to a quad's first pixel, as far as the picture goes.
fn depth_beside(picture: Picture, first: vec2u, offset: vec2i) -> f32 {
    return load_depth(depth, vec2u(clamp(vec2i(first) + offset, vec2i(picture.low), vec2i(picture.end) - 1)));
}

// One surface: pixels of one instance in one plane, which goes on to one side at least across and
// down. (Two planes with a step between them along the quad's middle are one plane for the quad's
// own pixels, steep as it is.) `last` is the quad's last pixel within the picture.
fn shown_by(picture: Picture, maps: EyeMaps, first: vec2u, last: vec2u, who: vec4u, d: vec4f) -> Shown {
    let wide = who.x == who.y && who.z == who.w;
    let tall = who.x == who.z && who.y == who.w;
    // Depth is affine in the picture on a plane, so its slopes across and down give the plane's
    // normal, up to a factor: of the quad's upper left three pixels and of its lower right three.
    let step = depth_step(maps);
    let at_first = on_plane(maps, picture, first);
    let at_last = on_plane(maps, picture, last);
    let slopes = vec2f(d.y - d.x, d.z - d.x);
    let upper = normal_of(slopes / step, at_first, d.x);
    let lower = normal_of(vec2f(d.w - d.z, d.w - d.y) / step, at_last, d.w);
    let left = vec2f(d.x - depth_beside(picture, first, vec2i(-1, 0)), slopes.y);
    let right = vec2f(depth_beside(picture, first, vec2i(2, 0)) - d.y, d.w - d.y);
    let above = vec2f(slopes.x, d.x - depth_beside(picture, first, vec2i(0, -1)));
    let below = vec2f(d.w - d.z, depth_beside(picture, first, vec2i(0, 2)) - d.z);
    let at_right = vec2f(at_last.x, at_first.y);
    let at_below = vec2f(at_first.x, at_last.y);
    let across = are_parallel(upper, normal_of(left / step, at_first, d.x))
        || are_parallel(upper, normal_of(right / step, at_right, d.y));
    let down = are_parallel(upper, normal_of(above / step, at_first, d.x))
        || are_parallel(upper, normal_of(below / step, at_below, d.z));
    // Of a quad that the picture's edge cuts, what lies beside a step is not known.
    let flat = all(last == first + 1u) && are_parallel(upper, lower);
    let empty = who.x == 0u || who.w == 0u;
    let limit = u32(wide && (empty || (flat && across))) | (u32(tall && (empty || (flat && down))) << 1u);
    return Shown(limit, upper);
}

// From one pixel to the next, right and down, on the plane at distance 1.
fn depth_step(maps: EyeMaps) -> vec2f {
    return vec2f(2.0, -2.0) / frame.size * maps.view_from_ndc.xy;
}

// Of the plane through the point seen at `at` with depth `d`, from depth's slopes. The scale keeps
// products in range.
fn normal_of(slopes: vec2f, at: vec2f, d: f32) -> vec3f {
    let z = select(dot(slopes, at) - d, -1.0 / frame.depth_range, frame.orthographic != 0u);
    return vec3f(slopes, z) / max(d, 1e-20);
}

var<workgroup> tile_rates: array<u32, 64>;
var<workgroup> tile_who: array<u32, 64>;
// Least and greatest luma of each quad.
var<workgroup> tile_range: array<vec2f, 64>;
// Depth of each quad's first pixel, and its plane's normal.
var<workgroup> tile_depth: array<f32, 64>;
var<workgroup> tile_normal: array<vec3f, 64>;
// Samples of each rate, and where they begin: alike ones lie together, so that lanes that light
// them side by side have equally many pixels to write.
var<workgroup> found_of: array<atomic<u32>, 5>;
var<workgroup> starts: array<u32, 5>;
var<workgroup> found_unknown: atomic<u32>;

// Whether the four quads of a block are shaded as one.
fn is_block(picture: Picture, maps: EyeMaps, quad: vec2u, local: vec2u) -> bool {
    let first = (local.y & 6u) * 8u + (local.x & 6u);
    let others = array(first, first + 1u, first + 8u, first + 9u);
    var together = RATE | ASKS_IF_ALIKE;
    var range = tile_range[first];
    var same = true;
    var flat = true;
    for (var i = 0u; i < 4u; i++) {
        let at = others[i];
        together &= tile_rates[at];
        same = same && tile_who[at] == tile_who[first];
        flat = flat && are_parallel(tile_normal[first], tile_normal[at]);
        range = vec2f(min(range.x, tile_range[at].x), max(range.y, tile_range[at].y));
    }
    // The plane from quad to quad is the quads' own: no step in depth lies between them.
    let d = vec4f(tile_depth[others[0]], tile_depth[others[1]], tile_depth[others[2]], tile_depth[others[3]]);
    let step = 2.0 * depth_step(maps);
    let texel = (quad & vec2u(~1u)) * 2u;
    let upper = normal_of(vec2f(d.y - d.x, d.z - d.x) / step, on_plane(maps, picture, texel), d.x);
    let lower = normal_of(vec2f(d.w - d.z, d.w - d.y) / step, on_plane(maps, picture, texel + 2u), d.w);
    flat = flat && are_parallel(tile_normal[first], upper) && are_parallel(tile_normal[first], lower);
    let alike = range.y - range.x <= rates.threshold * (0.5 * (range.x + range.y) + DARK);
    let wanted = (together & RATE_BLOCK) != 0u || ((together & ASKS_IF_ALIKE) != 0u && alike);
    return same && wanted && (together & 3u) == 3u && (flat || tile_who[first] == 0u);
}

@compute @workgroup_size(8, 8)
fn find_rates(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let at = local.y * 8u + local.x;
    let quad = id.xy;
    let first = quad * 2u;
    let picture = picture_of(first);
    let inside = all(first < picture.end);
    let last = min(first + 1u, picture.end - 1u);
    var rate = 0u;
    var notes = 0u;
    var found = vec2u(0u);
    var who = 0u;
    var d = 0.0;
    var normal = vec3f(0.0);
    let maps = maps_at(first);
    if inside {
        let corner = load_words(identity, first).xy;
        let motion = motion_of(maps, picture, first, corner);
        who = corner.x;
        d = load_depth(depth, first);
        if LOOKS_AROUND {
            found = textureLoad(reprojected, quad, 0).xy;
        } else {
            found = reprojected_to(picture, maps, first, who, d, motion);
        }
        let probed = (quad.x & rates.probe_mask) == rates.probe_x && (quad.y & rates.probe_mask) == rates.probe_y;
        notes = select(0u, RATE_PROBED, probed) | select(RATE_UNKNOWN, 0u, (found.y & KNOWN_AT_ALL) != 0u);
        if notes == 0u {
            let right = vec2u(last.x, first.y);
            let below = vec2u(first.x, last.y);
            let ids = vec4u(
                who,
                load_words(identity, right).x,
                load_words(identity, below).x,
                load_words(identity, last).x,
            );
            let depths = vec4f(d, load_depth(depth, right), load_depth(depth, below), load_depth(depth, last));
            rate = requested_rate(quad, unpack4x8unorm(found.x), motion);
            // A level of 2 and more asks for blocks; they are found below.
            let shown = shown_by(picture, maps, first, last, ids, depths);
            normal = shown.normal;
            rate &= shown.limit | RATE_BLOCK | ASKS_IF_ALIKE;
            rate = select(rate & 3u, rate, (rate & 3u) == 3u);
        }
    }
    if BLOCKS {
        let l = unpack4x8unorm(found.x);
        tile_who[at] = select(0xffffffffu, who, inside);
        tile_range[at] = vec2f(min(min(l.x, l.y), min(l.z, l.w)), max(max(l.x, l.y), max(l.z, l.w)));
        tile_rates[at] = rate;
        tile_depth[at] = d;
        tile_normal[at] = normal;
        workgroupBarrier();
        rate = select(rate & 3u, 7u, is_block(picture, maps, quad, local.xy));
    } else {
        rate &= 3u;
    }

    var count = 0u;
    if inside {
        textureStore(mask, quad, vec4u(rate | notes, 0u, 0u, 0u));
        textureStore(known, quad, vec4u(found.x, found.y | select(0u, KNOWN_FULL, rate == 0u), 0u, 0u));
        let there = last - first + 1u;
        // A wide sample takes a row, a tall one a column.
        count = select(there.x, 1u, (rate & RATE_WIDE) != 0u) * select(there.y, 1u, (rate & RATE_TALL) != 0u);
        count = select(count, 0u, (rate & RATE_BLOCK) != 0u && !stands_for_sample(first, rate));
    }
    let group = min(rate, 4u);
    var place = 0u;
    if count > 0u {
        place = atomicAdd(&found_of[group], count);
    }
    if (notes & RATE_UNKNOWN) != 0u {
        atomicAdd(&found_unknown, 1u);
    }
    workgroupBarrier();
    if at == 0u {
        var sum = 0u;
        for (var i = 0u; i < 5u; i++) {
            let found = atomicLoad(&found_of[i]);
            starts[i] = sum;
            sum += found;
            atomicAdd(&listed.of_rate[i], found);
        }
        let start = atomicAdd(&listed.count, sum);
        for (var i = 0u; i < 5u; i++) {
            starts[i] += start;
        }
        atomicAdd(&listed.unknown, atomicLoad(&found_unknown));
    }
    workgroupBarrier();
    if count > 0u {
        var next = starts[group] + place;
        for (var i = 0u; i < 4u; i++) {
            let texel = first + vec2u(i & 1u, i >> 1u);
            if all(texel <= last) && stands_for_sample(texel, rate) {
                samples[next] = packed_sample(texel, rate);
                next++;
            }
        }
    }
}
