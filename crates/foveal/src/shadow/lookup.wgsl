// Whether a light's rays reach a place: a look into the light's tiles of the atlas. CPU twin:
// `shadow/twin.rs`.

#import shared/frame.wgsl
#import shared/light.wgsl
#import shared/surface.wgsl
#ifndef REDUCED
#import shadow/contact.wgsl
#endif
#import shadow/tile.wgsl
#expects shadow_atlas, shadow_sampler

// Part of the light that passes at a place in the tile, in texels, with a reversed depth.
// `softness`: texels by which an edge fades to each side, per depth between it and the place.
#ifdef REDUCED
// WebGL 2 can neither read depth nor gather it: what is compared is blended by the sampler.
fn shadow_passing(tile: ShadowTile, at: vec2f, depth: f32, softness: f32) -> f32 {
    let texel = 1.0 / f32(textureDimensions(shadow_atlas).x);
    if SHADOWS != SHADOWS_SOFT {
        let inside = clamp(floor(at), vec2f(0.0), vec2f(tile.side - 1.0)) + 0.5;
        return textureSampleCompareLevel(shadow_atlas, shadow_sampler, (tile.corner + inside) * texel, depth);
    }
    // Four by four texels with the weights below, two by two of them at a time: the sampler blends
    // by where it is between them.
    let inside = clamp(at, vec2f(2.0), vec2f(tile.side - 2.0)) - 0.5;
    let first = min(floor(inside), vec2f(tile.side - 3.0));
    let f = inside - first;
    let low_weight = 2.0 - f;
    let high_weight = 1.0 + f;
    let low = (tile.corner + first - 0.5 + 1.0 / low_weight) * texel;
    let high = (tile.corner + first + 1.5 + f / high_weight) * texel;
    let a = textureSampleCompareLevel(shadow_atlas, shadow_sampler, low, depth);
    let b = textureSampleCompareLevel(shadow_atlas, shadow_sampler, vec2f(high.x, low.y), depth);
    let c = textureSampleCompareLevel(shadow_atlas, shadow_sampler, vec2f(low.x, high.y), depth);
    let d = textureSampleCompareLevel(shadow_atlas, shadow_sampler, high, depth);
    let upper = low_weight.x * a + high_weight.x * b;
    let lower = low_weight.x * c + high_weight.x * d;
    return (low_weight.y * upper + high_weight.y * lower) / 9.0;
}
#else
fn shadow_passing(tile: ShadowTile, at: vec2f, depth: f32, softness: f32) -> f32 {
    if SHADOWS == SHADOWS_CONTACT {
        return contact_passing(tile, at, depth, softness);
    }
    if SHADOWS != SHADOWS_SOFT {
        let inside = clamp(floor(at), vec2f(0.0), vec2f(tile.side - 1.0));
        let nearest = textureLoad(shadow_atlas, vec2u(tile.corner + inside), 0);
        return select(0.0, 1.0, depth >= nearest);
    }
    // Three by three comparisons a texel apart, each blended between four texels: together four
    // by four texels, in four quads.
    let inside = clamp(at, vec2f(2.0), vec2f(tile.side - 2.0)) - 0.5;
    let first = min(floor(inside), vec2f(tile.side - 3.0));
    let f = inside - first;
    let texel = 1.0 / f32(textureDimensions(shadow_atlas).x);
    let low = (tile.corner + first) * texel;
    let high = low + 2.0 * texel;
    let a = textureGatherCompare(shadow_atlas, shadow_sampler, low, depth);
    let b = textureGatherCompare(shadow_atlas, shadow_sampler, vec2f(high.x, low.y), depth);
    let c = textureGatherCompare(shadow_atlas, shadow_sampler, vec2f(low.x, high.y), depth);
    let d = textureGatherCompare(shadow_atlas, shadow_sampler, high, depth);
    // Of a quad: x lower left, y lower right, z upper right, w upper left.
    let g = 1.0 - f;
    // Weights of the four columns and rows: a texel wide, or three.
    let x = select(vec4f(g.x, 1.0, 1.0, f.x), vec4f(0.0, g.x, f.x, 0.0), tile.is_narrow);
    let y = select(vec4f(g.y, 1.0, 1.0, f.y), vec4f(0.0, g.y, f.y, 0.0), tile.is_narrow);
    let upper = y.x * (x.x * a.w + x.y * a.z + x.z * b.w + x.w * b.z) + y.y * (x.x * a.x + x.y * a.y + x.z * b.x + x.w * b.y);
    let lower = y.z * (x.x * c.w + x.y * c.z + x.z * d.w + x.w * d.z) + y.w * (x.x * c.x + x.y * c.y + x.z * d.x + x.w * d.y);
    return (upper + lower) / select(9.0, 1.0, tile.is_narrow);
}
#endif

// Metres by which a place is moved along its normal before it is compared, so that a surface does
// not shade itself: a texel's width, times what the filter and the slope ask for. `cosine`: of the
// angle between the normal and the tile's axis. Away from the tile's centre rays stand otherwise,
// but depth changes from texel to texel as the plane is tilted against the axis.
fn shadow_offset(tile: ShadowTile, texel_m: f32, cosine: f32) -> f32 {
    let slope = sqrt(max(1.0 - cosine * cosine, 0.0));
    return texel_m * frame.shadow_bias * (0.4 + slope) * select(1.0, 0.5, tile.is_narrow && SHADOWS != SHADOWS_CONTACT);
}

// The side of a cube that a direction from its centre points to.
fn cube_side(d: vec3f) -> u32 {
    let a = abs(d);
    if a.x >= a.y && a.x >= a.z {
        return select(0u, 1u, d.x < 0.0);
    } else if a.y >= a.z {
        return select(2u, 3u, d.y < 0.0);
    }
    return select(4u, 5u, d.z < 0.0);
}

// Unit vectors across, up and along a side.
fn side_axes(side: u32) -> mat3x3f {
    let x = vec3f(1.0, 0.0, 0.0);
    let y = vec3f(0.0, 1.0, 0.0);
    let z = vec3f(0.0, 0.0, 1.0);
    let axis = side / 2u;
    let along = select(select(z, y, axis == 1u), x, axis == 0u);
    return mat3x3f(
        select(select(x, z, axis == 1u), y, axis == 0u),
        select(select(y, x, axis == 1u), z, axis == 0u),
        select(along, -along, (side & 1u) != 0u),
    );
}

// Unit vectors across, up and along a unit vector (Duff et al. 2017, 'Building an Orthonormal
// Basis, Revisited'). Rust: `axes_along` in `shadow/volume.rs`, which tells -0 from 0 too.
fn axes_along(z: vec3f) -> mat3x3f {
    let sign = select(1.0, -1.0, (bitcast<u32>(z.z) >> 31u) != 0u);
    let a = -1.0 / (sign + z.z);
    let b = z.x * z.y * a;
    return mat3x3f(
        vec3f(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x),
        vec3f(b, sign + z.y * z.y * a, -z.y),
        z,
    );
}

// A position in a pyramid, across, up and along, in texels of its tile.
fn pyramid_texel(at: vec3f, tangent: f32, side: f32) -> vec2f {
    let half_inner = 0.5 * side - SHADOW_BORDER;
    return 0.5 * side + vec2f(at.x, -at.y) * (half_inner / (at.z * tangent));
}

// Texels by which an edge fades to each side, per depth (near / distance) between it and where its
// shadow falls: the lamp, seen from there past the edge, covers its radius * (1 / z of the edge - 1 /
// z of the place) at distance 1. A lamp counts as at most half as large as it stands high above the
// surface: a part of a larger one would be behind the surface, which would keep its own light away.
fn pyramid_softness(near: f32, tangent: f32, side: f32, height: f32) -> f32 {
    let lamp = min(frame.light_radius, 0.5 * height);
    return lamp * (0.5 * side - SHADOW_BORDER) / (tangent * near);
}

// The nearest distance from which things are drawn into a light's tiles. Rust: `near_of`.
fn shadow_near(range: f32) -> f32 {
    return clamp(range * 1e-3, 1e-4, 0.02);
}

// Where rays to four pixels at the rim of a sample's block are looked up: texels across and down, depths,
// and whether they count, by 1.
struct RimPlaces {
    x: vec4f,
    y: vec4f,
    depths: vec4f,
    counts: vec4f,
}

// Where a light's rays to a surface are looked up: as `shadow_passing` takes them, and to the pixels at
// the rim of the sample's block. Without a tile they pass.
struct ShadowPlace {
    tile: ShadowTile,
    at: vec2f,
    depth: f32,
    softness: f32,
    first: RimPlaces,
    second: RimPlaces,
}

const NO_PLACES: RimPlaces = RimPlaces(vec4f(0.0), vec4f(0.0), vec4f(0.0), vec4f(0.0));
const UNSHADOWED: ShadowPlace = ShadowPlace(
    ShadowTile(vec2f(0.0), 0.0, false),
    vec2f(0.0),
    0.0,
    0.0,
    NO_PLACES,
    NO_PLACES,
);

// How far along an axis the pixels at a block's rim lie from its sample.
fn rim_along(axis: vec3f, rim: Rim) -> vec4f {
    return axis.x * rim.x + axis.y * rim.y + axis.z * rim.z;
}

// In a pyramid's tile; `at`: the sample's position, across, up and along.
fn rim_in_pyramid(rim: Rim, axes: mat3x3f, at: vec3f, near: f32, tangent: f32, side: f32) -> RimPlaces {
    let z = at.z + rim_along(axes[2], rim);
    let x = (at.x + rim_along(axes[0], rim)) / (z * tangent);
    let y = (at.y + rim_along(axes[1], rim)) / (z * tangent);
    let is_inside = (z > vec4f(near)) & (max(abs(x), abs(y)) <= vec4f(1.0));
    let half_inner = 0.5 * side - SHADOW_BORDER;
    return RimPlaces(
        0.5 * side + half_inner * x,
        0.5 * side - half_inner * y,
        near / z,
        select(vec4f(0.0), rim.counts, is_inside),
    );
}

// In a cascade's tile; `at`: the sample's place from its centre, across and up in texels, and its depth.
// `steps`: depths per metre.
fn rim_in_cascade(rim: Rim, axes: mat3x3f, at: vec3f, texel_m: f32, steps: f32, side: f32) -> RimPlaces {
    let x = at.x + rim_along(axes[0], rim) / texel_m;
    let y = at.y + rim_along(axes[1], rim) / texel_m;
    let half_inner = vec4f(0.5 * side - 1.0);
    return RimPlaces(
        0.5 * side + x,
        0.5 * side - y,
        at.z - rim_along(axes[2], rim) * steps,
        select(vec4f(0.0), rim.counts, max(abs(x), abs(y)) <= half_inner),
    );
}

// Of a light that shines from a point: in a side of a cube around it, or, where its cone fits into
// one tile, in that.
fn place_from_point(first: u32, light: Light, position: vec3f, normal: vec3f, block: Block) -> ShadowPlace {
    let from_light = position - light.position;
    let side = cube_side(from_light);
    // Three sides' tiles; or a cone's one, three times, and its tangent, which of a cube is 0.
    let row = u32(side >= 3u);
    let words = shadow_words(first + row);
    let of_three = side - 3u * row;
    let tile = shadow_tile(select(select(words.z, words.y, of_three == 1u), words.x, of_three == 0u));
    let cone_tangent = bitcast<f32>(words.w);
    let is_cube = cone_tangent == 0.0;
    if tile.side == 0.0 {
        return UNSHADOWED;
    }
    let of_cube = side_axes(side);
    let of_cone = axes_along(light.direction);
    let axes = mat3x3f(
        select(of_cone[0], of_cube[0], is_cube),
        select(of_cone[1], of_cube[1], is_cube),
        select(of_cone[2], of_cube[2], is_cube),
    );
    let near = shadow_near(light.range);
    let tangent = select(cone_tangent, 1.0, is_cube);
    let texel_m = 2.0 * tangent * dot(axes[2], from_light) / (tile.side - 2.0 * SHADOW_BORDER);
    let moved = from_light + normal * shadow_offset(tile, texel_m, dot(axes[2], normal));
    let at = vec3f(dot(axes[0], moved), dot(axes[1], moved), dot(axes[2], moved));
    if at.z <= near {
        return UNSHADOWED;
    }
    return ShadowPlace(
        tile,
        pyramid_texel(at, tangent, tile.side),
        near / at.z,
        pyramid_softness(near, tangent, tile.side, max(-dot(normal, from_light), 0.0)),
        rim_in_pyramid(block.first, axes, at, near, tangent, tile.side),
        rim_in_pyramid(block.second, axes, at, near, tangent, tile.side),
    );
}

// Of a directional light: in the finest cascade that holds the place.
fn place_from_sun(first: u32, light: Light, position: vec3f, normal: vec3f, block: Block) -> ShadowPlace {
    let axes = axes_along(light.direction);
    let cosine = -dot(normal, light.direction);
    let words = shadow_words(first);
    let cascades = shadow_words(first + 1u).x;
    for (var i = 0u; i < 4u; i++) {
        let tile = shadow_tile(words[i]);
        // Centre across and up, half the width.
        let cascade = shadow_row(cascades + i);
        let away = abs(vec2f(dot(axes[0], position), dot(axes[1], position)) - cascade.xy);
        let texel_m = 2.0 * cascade.z / max(tile.side, 1.0);
        // The last one holds the scene: there is none to go on to.
#ifdef REDUCED
        let reach = SHADOW_BORDER;
#else
        let reach = select(SHADOW_BORDER, CONTACT_REACH + 2.0, SHADOWS == SHADOWS_CONTACT);
#endif
        let margin = select(reach * texel_m, 0.0, i == 3u);
        if tile.side == 0.0 || max(away.x, away.y) > cascade.z - margin {
            continue;
        }
        let moved = position + normal * shadow_offset(tile, texel_m, cosine);
        let at = (vec2f(dot(axes[0], moved), dot(axes[1], moved)) - cascade.xy) / texel_m;
        // End along the rays, and one by the length.
        let span = shadow_row(first + 1u).zw;
        let depth = (span.x - dot(light.direction, moved)) * span.y;
        // Metres between two depths, times the tangent of half the angle that the light fills.
        let softness = frame.sun_tangent / (span.y * texel_m);
        return ShadowPlace(
            tile,
            0.5 * tile.side + vec2f(at.x, -at.y),
            depth,
            softness,
            rim_in_cascade(block.first, axes, vec3f(at, depth), texel_m, span.y, tile.side),
            rim_in_cascade(block.second, axes, vec3f(at, depth), texel_m, span.y, tile.side),
        );
    }
    return UNSHADOWED;
}

#ifdef LIGHT
// A comparison, blended between four texels.
fn rim_passing(tile: ShadowTile, at: vec2f, depth: f32) -> f32 {
    let texel = 1.0 / f32(textureDimensions(shadow_atlas).x);
    let inside = clamp(at, vec2f(1.0), vec2f(tile.side - 1.0)) - 0.5;
    let first = min(floor(inside), vec2f(tile.side - 2.0));
    let f = inside - first;
    // x lower left, y lower right, z upper right, w upper left.
    let q = textureGatherCompare(shadow_atlas, shadow_sampler, (tile.corner + first + 1.0) * texel, depth);
    return mix(mix(q.w, q.z, f.x), mix(q.x, q.y, f.x), f.y);
}

// Variance for each unit of the largest difference within a block. Found by measurement together with
// `WITHIN_A_BLOCK` (composite/gather.wgsl), when a sample held deviations of up to the light on itself
// alone.
const VARIANCE_OF_APART: f32 = 0.2;

// By how much the part of a light's rays that reaches four pixels at a rim differs from the sample's where
// it differs most. What is looked up there these pixels would look up themselves, as shadow/mask.rs expects
// of lookups.
fn rim_apart(tile: ShadowTile, places: RimPlaces, part: f32) -> f32 {
    let passing = vec4f(
        rim_passing(tile, vec2f(places.x.x, places.y.x), places.depths.x),
        rim_passing(tile, vec2f(places.x.y, places.y.y), places.depths.y),
        rim_passing(tile, vec2f(places.x.z, places.y.z), places.depths.z),
        rim_passing(tile, vec2f(places.x.w, places.y.w), places.depths.w),
    );
    let apart = abs(passing - part) * places.counts;
    return max(max(apart.x, apart.y), max(apart.z, apart.w));
}
#endif

fn arriving_at(place: ShadowPlace) -> Arriving {
    if place.tile.side == 0.0 {
        return ALL_ARRIVES;
    }
    let part = shadow_passing(place.tile, place.at, place.depth, place.softness);
#ifdef LIGHT
    if any(place.first.counts + place.second.counts > vec4f(0.0)) {
        var apart = rim_apart(place.tile, place.first, part);
        if BOTH_RIMS {
            apart = max(apart, rim_apart(place.tile, place.second, part));
        }
        return Arriving(part, VARIANCE_OF_APART * apart);
    }
#endif
    return Arriving(part, 0.0);
}

// What of a directional light's rays arrives at a surface's sample; `block` as in `light_surface`. The
// atlas knows nothing of normal maps, so the vertex normal tells how the surface lies.
fn directional_arriving(index: u32, light: Light, s: Surface, block: Block) -> Arriving {
    return arriving_at(place_from_sun(index * SHADOW_ROWS, light, s.position, s.vertex_normal, block));
}

// The same of a light that shines from a point.
fn light_arriving(index: u32, light: Light, s: Surface, block: Block) -> Arriving {
    return arriving_at(place_from_point(index * SHADOW_ROWS, light, s.position, s.vertex_normal, block));
}
