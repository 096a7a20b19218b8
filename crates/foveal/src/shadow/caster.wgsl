// Depth of what casts shadows, as a tile of the atlas sees it.

#import shared/instances.wgsl
#import shared/material_at.wgsl
#import shared/material_bindings.wgsl
#import shared/vertex.wgsl

// Alpha cuts holes; without, the depth test may run before the shader.
override MASKED: bool = false;

struct TileView {
    clip_from_world: mat4x4f,
}

@group(2) @binding(0) var<uniform> tile: TileView;

struct CasterIn {
    @builtin(instance_index) drawn_index: u32,
    @location(0) position: vec3f,
    @location(3) uv: vec4f,
    @location(4) color: vec4f,
}

struct CasterVertex {
    @builtin(position) clip: vec4f,
    @location(0) uv: vec4f,
    @location(1) alpha: f32,
}

@vertex
fn vertex_of_caster(in: CasterIn) -> CasterVertex {
    let world = instance_position(instance_at(drawn_at(in.drawn_index)), in.position);
    return CasterVertex(tile.clip_from_world * vec4f(world, 1.0), in.uv, in.color.a);
}

@fragment
fn cast_shadow(in: CasterVertex) {
    if MASKED && alpha_at(in.uv, in.alpha) < material.alpha_cutoff {
        discard;
    }
}
