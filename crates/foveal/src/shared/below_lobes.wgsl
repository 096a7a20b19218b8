// What the G-buffer holds of a surface with lobes. With anti-aliasing the forward pass adds the part
// of a pixel that such a surface covers: without it nothing must come of that part.

#import shared/surface.wgsl

// Surfaces with lobes are black.
override BLACK_BELOW_LOBES: bool = false;

// `k`: `Material.without_lobes`.
fn below_lobes(s: Surface, k: f32) -> Surface {
    if BLACK_BELOW_LOBES {
        return Surface(
            s.position, s.normal, s.vertex_normal, k * s.base_color, k * s.metallic, s.roughness, s.occlusion,
            k * s.emissive, k * s.dielectric,
        );
    }
    return s;
}
