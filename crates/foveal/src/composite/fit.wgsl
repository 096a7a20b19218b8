// The patch of each listed tile of a level.
//
// Radiance at a corner is the affine least-squares fit through the samples of the tiles that touch
// it, so that affine radiance comes out exactly, and all tiles around a corner find the same value.
// A corner that lies within the edge of a coarser tile takes that edge's value instead, so that
// patches meet without a gap; levels are therefore fitted coarsest first. Tiles that show another
// surface than this one's sample are left out.

#import composite/patches.wgsl
#import composite/raise.wgsl
#import composite/seen.wgsl
#import composite/tiling.wgsl
#import shared/blocks.wgsl
#import shared/frame.wgsl

// Tiles of this level and up are drawn as quads by the composite, whatever they hold.
override QUAD_LEVEL: u32 = 3u;

struct Level {
    level: u32,
}

// Arguments of an indirect draw: vertices, instances, first of either.
struct Quads {
    vertices: u32,
    count: atomic<u32>,
    first_vertex: u32,
    first_instance: u32,
}

@group(2) @binding(0) var<uniform> current: Level;
@group(2) @binding(1) var<storage, read> dispatches: array<vec4u, 9>;
// Blocks as x | y << 16.
@group(2) @binding(2) var<storage, read> blocks: array<u32>;
// Two for each patch, and one; those of coarser levels are there already.
@group(2) @binding(3) var<storage, read_write> patches: array<vec4u>;
@group(2) @binding(4) var<storage, read_write> upper_raises: array<u32>;
// All tiles that the composite draws as quads, and those of them that hold an edge.
@group(2) @binding(5) var<storage, read_write> quads: array<Quads, 2>;
// Those tiles, as `pack_quad` has them: all in the first half, those with edges in the second.
@group(2) @binding(6) var<storage, read_write> quad_tiles: array<u32>;

fn is_inside(picture: Picture, texel: vec2i) -> bool {
    return all(texel >= vec2i(picture.low)) && all(texel < vec2i(picture.end));
}

// The texel of a quadrant around a corner; beyond the picture's border instead one in the next tile
// inwards, so that the fit goes on through the border. Outside the picture where there is none.
fn quadrant_texel(picture: Picture, corner: vec2i, quadrant: u32) -> vec2i {
    let first = vec2i(picture.low);
    let last = vec2i(picture.end) - 1;
    var texel = corner - 1 + vec2i(vec2u(quadrant, quadrant >> 1u) & vec2u(1u));
    for (var axis = 0u; axis < 2u; axis++) {
        if texel[axis] < first[axis] || texel[axis] > last[axis] {
            let touching = tile_at(vec2u(clamp(texel, first, last)));
            if texel[axis] < first[axis] {
                texel[axis] = i32(tile_high(touching)[axis]);
            } else {
                texel[axis] = i32(tile_low(touching)[axis]) - 1;
            }
            if texel[axis] < first[axis] || texel[axis] > last[axis] {
                return vec2i(-1);
            }
        }
    }
    return texel;
}

fn corners_of(tile: Tile) -> Patch {
    let index = patch_index(tile.block, tile.level);
    return unpack_corners(patches[2u * index], patches[2u * index + 1u].xy);
}

fn corner_radiance(corner: vec2i, own: Tile, own_sample: vec4f, own_seen: Seen) -> vec3f {
    var tiles: array<Tile, 4>;
    var valid: array<bool, 4>;
    var all_pure = true;
    var all_touch = true;
    let picture = picture_of(tile_low(own));
    for (var i = 0u; i < 4u; i++) {
        let texel = quadrant_texel(picture, corner, i);
        valid[i] = is_inside(picture, texel);
        all_touch = all_touch && all(abs(2 * (texel - corner) + 1) == vec2i(1));
        if valid[i] {
            tiles[i] = tile_at(vec2u(texel));
            all_pure = all_pure && !tiles[i].has_edge && tiles[i].level > 0u;
        }
    }
    var offsets: array<vec2f, 4>;
    var radiance: array<vec3f, 4>;
    var weights = vec4f(0.0);
    var least = own_sample.rgb;
    var most = own_sample.rgb;
    for (var i = 0u; i < 4u; i++) {
        if !valid[i] {
            continue;
        }
        let tile = tiles[i];
        let value = sample_of(tile);
        let texel = sample_texel(tile.block, tile.level, u32(value.a + 0.5) - 1u);
        let is_own = all(tile.block == own.block) && tile.level == own.level;
        if !(all_pure || is_own) && !same_surface(own_seen, seen_at(texel)) {
            all_touch = false;
            continue;
        }
        if tile.level > own.level {
            let low = vec2i(tile_low(tile));
            let high = vec2i(tile_high(tile));
            if any((corner > low) & (corner < high)) && all((corner >= low) & (corner <= high)) {
                return patch_at(corners_of(tile), within(tile, vec2f(corner)));
            }
        }
        offsets[i] = vec2f(texel) + 0.5 - vec2f(corner);
        radiance[i] = value.rgb;
        // All then pull alike at their gradient: a near sample is worth as much as a far one is
        // not.
        weights[i] = 1.0 / (dot(offsets[i], offsets[i]) + 0.25);
        least = min(least, value.rgb);
        most = max(most, value.rgb);
    }

    var s = 0.0;
    var sx = 0.0;
    var sy = 0.0;
    var sxx = 0.0;
    var sxy = 0.0;
    var syy = 0.0;
    for (var i = 0u; i < 4u; i++) {
        let w = weights[i];
        let d = offsets[i];
        s += w;
        sx += w * d.x;
        sy += w * d.y;
        sxx += w * d.x * d.x;
        sxy += w * d.x * d.y;
        syy += w * d.y * d.y;
    }
    // Few or collinear samples leave gradients undetermined: a little of the identity makes them
    // small.
    let ridge = 1e-4 * (sxx + syy);
    sxx += ridge;
    syy += ridge;
    // First row of the inverse of the normal matrix, up to a factor.
    let row = vec3f(sxx * syy - sxy * sxy, sxy * sy - sx * syy, sx * sxy - sxx * sy);
    var sum = vec3f(0.0);
    var total = 0.0;
    for (var i = 0u; i < 4u; i++) {
        let part = weights[i] * (row.x + dot(row.yz, offsets[i]));
        total += part;
        sum += part * radiance[i];
    }
    let fitted = sum / total;
    // Four samples around a corner enclose it: an affine fit stays between them, and others shall.
    // Past the border or an edge the fit runs on, but not away.
    let slack = select((most - least) * 1.5, vec3f(0.0), all_touch);
    return clamp(fitted, max(least - slack, vec3f(0.0)), min(most + slack, vec3f(65504.0)));
}

// Where the tile to the right of one (`axis` 0) or below it has another size, nobody fits a patch
// of this size there, but this tile looks for its raises there: an earlier frame's must not be
// found.
fn clear_beside(own: Tile, axis: u32) {
    var block = own.block;
    block[axis] += 1u;
    let first = block << vec2u(own.level);
    let inside = first[axis] < picture_of(tile_low(own)).end[axis];
    if inside && tile_at(first).level != own.level {
        let number = patch_index(block, own.level);
        patches[2u * number + 1u] = vec4u(0u);
        upper_raises[number] = 0u;
    }
}

@compute @workgroup_size(64)
fn fit_patches(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let dispatch = dispatches[current.level];
    let index = (group.y * dispatch.x + group.x) * 64u + local;
    if index >= dispatch.w {
        return;
    }
    let block = vec2u(blocks[index] & 0xffffu, blocks[index] >> 16u);
    let first = block << vec2u(current.level);
    let own = tile_at(min(first, picture_of(first).end - 1u));
    let value = sample_of(own);
    let seen = seen_at(sample_texel(own.block, own.level, u32(value.a + 0.5) - 1u));
    let low = vec2i(tile_low(own));
    let high = vec2i(tile_high(own));
    var corners: array<vec3f, 4>;
    for (var i = 0u; i < 4u; i++) {
        let far = (vec2u(i, i >> 1u) & vec2u(1u)) == vec2u(1u);
        corners[i] = corner_radiance(select(low, high, far), own, value, seen);
    }
    let left = edge_raise(own, value, seen, 0u, corners[0], corners[2]);
    let upper = edge_raise(own, value, seen, 1u, corners[0], corners[1]);
    let packed = pack_patch(Patch(corners[0], corners[1], corners[2], corners[3], left, upper));
    let number = patch_index(own.block, own.level);
    patches[2u * number] = packed.part_0;
    patches[2u * number + 1u] = packed.part_1;
    upper_raises[number] = packed.part_2;
    clear_beside(own, 0u);
    clear_beside(own, 1u);

    if own.level >= QUAD_LEVEL || own.has_edge {
        quad_tiles[atomicAdd(&quads[0].count, 1u)] = pack_quad(own);
    }
    if own.has_edge {
        quad_tiles[arrayLength(&quad_tiles) / 2u + atomicAdd(&quads[1].count, 1u)] = pack_quad(own);
    }
}
