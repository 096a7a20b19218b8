// Shadows that are sharp where they touch what casts them, and fade with the distance: percentage-
// closer soft shadows (Fernando 2005). CPU twin: `shadow/twin.rs`.

#import shadow/tile.wgsl
#expects shadow_atlas, shadow_sampler

// Texels that a kernel reaches at most, and at least. Rust: `shadow/records.rs`.
const CONTACT_REACH: f32 = 12.0;
const CONTACT_SHARPEST: f32 = 1.0;
// Places that are looked at for what casts shadows, and places that are compared.
const CONTACT_SEARCHED: u32 = 16u;
const CONTACT_COMPARED: u32 = 24u;
// Cosine and sine of the golden angle, by which each place is turned from the one before (Vogel
// 1979): the same in each frame and at each pixel, so that nothing flickers.
const GOLDEN: vec2f = vec2f(-0.73736888, 0.67549029);

// What stands before a place by less than this part of what its part of the lamp asks for is the
// place's own surface, seen at a flat angle.
const CONTACT_SLACK: f32 = 0.5;

fn turned_by_golden_angle(d: vec2f) -> vec2f {
    return vec2f(GOLDEN.x * d.x - GOLDEN.y * d.y, GOLDEN.y * d.x + GOLDEN.x * d.y);
}

// Mean depth between a place and what keeps the lamp from it, in texels of softness; 0 where nothing
// is found.
fn mean_softness(tile: ShadowTile, at: vec2f, depth: f32, softness: f32) -> f32 {
    var direction = vec2f(1.0, 0.0);
    var sum = 0.0;
    var found = 0.0;
    for (var i = 0u; i < CONTACT_SEARCHED; i++) {
        // Evenly by the radius: more of them near the place.
        let radius = CONTACT_REACH * (f32(i) + 0.5) / f32(CONTACT_SEARCHED);
        let texel = clamp(floor(at + radius * direction), vec2f(0.0), vec2f(tile.side - 1.0));
        let nearest = textureLoad(shadow_atlas, vec2u(tile.corner + texel), 0);
        let fade = (nearest - depth) * softness;
        // What stands aside by more than it fades hides no part of the lamp.
        let counts = fade > radius;
        sum += select(0.0, fade, counts);
        found += select(0.0, 1.0, counts);
        direction = turned_by_golden_angle(direction);
    }
    return sum / max(found, 1.0);
}

// Whether light passes at a place, blended between four texels.
fn compared_at(tile: ShadowTile, at: vec2f, depth: f32) -> f32 {
    let inside = clamp(at, vec2f(1.0), vec2f(tile.side - 1.0)) - 0.5;
    let first = min(floor(inside), vec2f(tile.side - 2.0));
    let f = inside - first;
    let texel = 1.0 / f32(textureDimensions(shadow_atlas).x);
    // x lower left, y lower right, z upper right, w upper left.
    let passes = textureGatherCompare(shadow_atlas, shadow_sampler, (tile.corner + first + 1.0) * texel, depth);
    return mix(mix(passes.w, passes.z, f.x), mix(passes.x, passes.y, f.x), f.y);
}

// Part of a lamp's light that passes at a place in the tile, in texels, with a reversed depth.
fn contact_passing(tile: ShadowTile, at: vec2f, depth: f32, softness: f32) -> f32 {
    let fades = mean_softness(tile, at, depth, softness);
    let reach = clamp(fades, CONTACT_SHARPEST, CONTACT_REACH);
    // Depth that a place at the kernel's border may stand before the surface: a plane that the lamp
    // stands above does so by less.
    let slack = select(0.0, CONTACT_SLACK * reach / softness, fades > CONTACT_SHARPEST);
    var direction = vec2f(1.0, 0.0);
    var sum = 0.0;
    for (var i = 0u; i < CONTACT_COMPARED; i++) {
        // Evenly by the area.
        let part = sqrt((f32(i) + 0.5) / f32(CONTACT_COMPARED));
        sum += compared_at(tile, at + reach * part * direction, depth + slack * part);
        direction = turned_by_golden_angle(direction);
    }
    return sum / f32(CONTACT_COMPARED);
}
