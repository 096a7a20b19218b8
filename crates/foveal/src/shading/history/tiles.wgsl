// What the last frame's samples say of each tile.

#import shading/history/measured.wgsl
#import shading/history/layout.wgsl
#import shading/history/parameters.wgsl

@group(1) @binding(0) var<uniform> parameters: HistoryParameters;
@group(1) @binding(1) var<storage, read_write> measured: array<Measured>;
// Errors that were measured of late, tile by tile.
@group(1) @binding(2) var<storage, read_write> kept: array<vec2f>;
// A texel for each tile: `TileHistory`.
@group(1) @binding(3) var tiles: texture_storage_2d<rg32float, write>;

// Part of an error that is kept from frame to frame.
const KEPT: f32 = 0.85;
// Of a change: it is gone when what was kept is.
const KEPT_CHANGE: f32 = 0.5;
// Part of an error that is expected in the tiles around.
const SPREAD: f32 = 0.7;

@compute @workgroup_size(64)
fn keep(@builtin(global_invocation_id) id: vec3u) {
    let tile = id.x;
    if tile >= tiles_across() * tiles_down() {
        return;
    }
    let error = bitcast<f32>(atomicLoad(&measured[tile].error));
    let change = bitcast<f32>(atomicLoad(&measured[tile].change));
    let largest = max(kept[tile] * vec2f(KEPT, KEPT_CHANGE), vec2f(error, change));
    kept[tile] = select(largest, vec2f(0.0), parameters.reset != 0u);
}

@compute @workgroup_size(64)
fn spread(@builtin(global_invocation_id) id: vec3u) {
    let tile = id.x;
    let across = tiles_across();
    let down = tiles_down();
    if tile >= across * down {
        return;
    }
    let at = vec2i(vec2u(tile % across, tile / across));
    var most = vec2f(0.0);
    for (var y = -1; y <= 1; y++) {
        for (var x = -1; x <= 1; x++) {
            let other = clamp(at + vec2i(x, y), vec2i(0), vec2i(vec2u(across, down)) - 1);
            let weight = select(SPREAD, 1.0, x == 0 && y == 0);
            most = max(most, weight * kept[u32(other.y) * across + u32(other.x)]);
        }
    }
    textureStore(tiles, at, vec4f(most, 0.0, 0.0));
}
