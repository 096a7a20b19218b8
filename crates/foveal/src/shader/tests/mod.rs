//! What must hold of every shader, checked without a device.

use super::{ROOTS, Shader};

mod branches;
mod layouts;

/// Every shader in each of its variants, with its source for tables in buffers and in textures.
fn every_source() -> impl Iterator<Item = (Shader, String)> {
    let shaders = ROOTS.iter().flat_map(|root| Shader::variants_of(root));
    shaders.flat_map(|s| [false, true].map(|texture_tables| (s, s.source(texture_tables))))
}

fn parse(shader: Shader, source: &str) -> naga::Module {
    naga::front::wgsl::parse_str(source)
        .unwrap_or_else(|e| panic!("{shader:?}: {}", e.emit_to_string(source)))
}

#[test]
fn every_shader_validates_without_optional_capabilities() {
    for (shader, source) in every_source() {
        let module = parse(shader, &source);
        // Packing to halves belongs to WebGPU itself; naga counts it as a capability.
        let mut capabilities = naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32;
        // These are used where the device has the feature; other shaders stand in for them
        // elsewhere.
        for (name, capability) in [
            ("indexed.wgsl", naga::valid::Capabilities::PRIMITIVE_INDEX),
            ("CLIPPED", naga::valid::Capabilities::CLIP_DISTANCES),
            ("LAYERED", naga::valid::Capabilities::MULTIVIEW),
            ("subgroups.wgsl", naga::valid::Capabilities::SUBGROUP),
        ] {
            if shader.is_named(name) {
                capabilities |= capability;
            }
        }
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), capabilities)
            .validate(&module)
            .unwrap_or_else(|e| panic!("{shader:?}: {}", e.emit_to_string(&source)));
    }
}
