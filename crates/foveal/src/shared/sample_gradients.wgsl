// Textures where there are no neighbours: the importing shader sets how both UV sets change from
// pixel to pixel.

#import shared/material.wgsl

// Per pixel to the right, per pixel down.
var<private> uv_right: vec4f;
var<private> uv_down: vec4f;

// As `uv_of`, for differences.
fn uv_step(slot: u32, uv: vec4f) -> vec2f {
    if (MATERIAL_CLASS & HAS_UV_MAP) == 0u {
        return uv.xy;
    }
    let map = uv_map(slot);
    let p = select(uv.xy, uv.zw, map.x.w > 0.5);
    return vec2f(dot(map.x.xy, p), dot(map.y.xy, p));
}
