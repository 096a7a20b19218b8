//! Shaders: put together from their parts, one constant per module.

use crate::gpu::Gpu;

/// A shader's parts in the order in which they are joined.
pub(crate) type Parts = &'static [&'static str];

const FRAME: &str = include_str!("shared/frame.wgsl");
const SURFACE: &str = include_str!("shared/surface.wgsl");
const LIGHT: &str = include_str!("shared/light.wgsl");
const LIGHTING: &str = include_str!("shared/lighting.wgsl");
const VERTEX: &str = include_str!("shared/vertex.wgsl");
const MATERIAL: &str = include_str!("shared/material.wgsl");
const SHADING: &str = include_str!("shading/shading.wgsl");

pub(crate) const GBUFFER: Parts = &[
    FRAME,
    SURFACE,
    VERTEX,
    MATERIAL,
    include_str!("geometry/gbuffer.wgsl"),
];
pub(crate) const CLUSTERS: Parts = &[FRAME, LIGHT, include_str!("lights/clusters.wgsl")];
pub(crate) const SHADE_EVERY_PIXEL: Parts = &[
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    SHADING,
    include_str!("shading/every_pixel.wgsl"),
];
pub(crate) const SHADE_LIST: Parts = &[
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    SHADING,
    include_str!("shading/list.wgsl"),
];
pub(crate) const FORWARD: Parts = &[
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    VERTEX,
    MATERIAL,
    include_str!("forward/forward.wgsl"),
];
pub(crate) const TONE_MAP: Parts = &[FRAME, include_str!("output/tone_map.wgsl")];
pub(crate) const VIEW: Parts = &[FRAME, SURFACE, include_str!("output/view.wgsl")];
const AA_SAMPLES: &str = include_str!("antialias/samples.wgsl");
const AA_SURFACES: &str = include_str!("antialias/surfaces.wgsl");
const AA_WEIGHT: &str = include_str!("antialias/weight.wgsl");
const AA_QUEUE: &str = include_str!("antialias/queue.wgsl");
pub(crate) const AA_MERGE: Parts = &[
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    SHADING,
    AA_SAMPLES,
    AA_SURFACES,
    AA_QUEUE,
    include_str!("antialias/merge.wgsl"),
];
pub(crate) const AA_SHADE: Parts = &[
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    SHADING,
    AA_SAMPLES,
    AA_SURFACES,
    AA_WEIGHT,
    AA_QUEUE,
    include_str!("antialias/shade.wgsl"),
];
pub(crate) const AA_COMBINE: Parts = &[
    FRAME,
    AA_WEIGHT,
    AA_QUEUE,
    include_str!("antialias/combine.wgsl"),
];
pub(crate) const AA_STORE: Parts = &[AA_QUEUE, include_str!("antialias/store.wgsl")];
pub(crate) const AA_VIEW: Parts = &[include_str!("antialias/view.wgsl")];

const LEVEL: &str = include_str!("shared/level.wgsl");
const BLOCKS: &str = include_str!("shared/blocks.wgsl");

pub(crate) const RATE_WISH: Parts = &[
    FRAME,
    SURFACE,
    LEVEL,
    BLOCKS,
    include_str!("rate/wish.wgsl"),
];
pub(crate) const RATE_PYRAMID: Parts = &[FRAME, LEVEL, BLOCKS, include_str!("rate/pyramid.wgsl")];
pub(crate) const RATE_OWNER: Parts = &[FRAME, LEVEL, BLOCKS, include_str!("rate/owner.wgsl")];
pub(crate) const COARSE_MARK: Parts = &[
    FRAME,
    LEVEL,
    BLOCKS,
    include_str!("shading/coarse/mark.wgsl"),
];
pub(crate) const COARSE_LIST: Parts = &[FRAME, BLOCKS, include_str!("shading/coarse/list.wgsl")];
pub(crate) const COARSE_DISPATCH: Parts = &[include_str!("shading/coarse/dispatch.wgsl")];
pub(crate) const COARSE_SHADE_DRAW: Parts = &[
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    SHADING,
    LEVEL,
    BLOCKS,
    include_str!("shading/coarse/block.wgsl"),
    include_str!("shading/coarse/shade_draw.wgsl"),
];
pub(crate) const COARSE_SHADE_LIST: Parts = &[
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    SHADING,
    BLOCKS,
    include_str!("shading/coarse/block.wgsl"),
    include_str!("shading/coarse/shade_list.wgsl"),
];
/// As the two above, radiance being an affine function of the position.
#[cfg(test)]
pub(crate) const COARSE_AFFINE: [Parts; 2] = [
    &[
        FRAME,
        SURFACE,
        include_str!("shading/coarse/affine.wgsl"),
        LEVEL,
        BLOCKS,
        include_str!("shading/coarse/block.wgsl"),
        include_str!("shading/coarse/shade_draw.wgsl"),
    ],
    &[
        FRAME,
        SURFACE,
        include_str!("shading/coarse/affine.wgsl"),
        BLOCKS,
        include_str!("shading/coarse/block.wgsl"),
        include_str!("shading/coarse/shade_list.wgsl"),
    ],
];
const TILING: &str = include_str!("composite/tiling.wgsl");
const SEEN: &str = include_str!("composite/seen.wgsl");
const PATCHES: &str = include_str!("composite/patches.wgsl");

pub(crate) const COMPOSITE_NEAREST: Parts = &[
    FRAME,
    LEVEL,
    BLOCKS,
    TILING,
    include_str!("composite/nearest.wgsl"),
];
pub(crate) const COMPOSITE_PAPER: Parts = &[
    FRAME,
    LEVEL,
    BLOCKS,
    TILING,
    include_str!("composite/paper.wgsl"),
];
pub(crate) const COMPOSITE_PATCH: Parts = &[
    FRAME,
    SURFACE,
    LEVEL,
    BLOCKS,
    TILING,
    SEEN,
    PATCHES,
    include_str!("composite/patch.wgsl"),
];
pub(crate) const COMPOSITE_RAISE: Parts = &[
    FRAME,
    SURFACE,
    LEVEL,
    BLOCKS,
    TILING,
    SEEN,
    PATCHES,
    include_str!("composite/raise.wgsl"),
];
pub(crate) const COMPOSITE_SMOOTH: Parts = &[
    FRAME,
    SURFACE,
    LEVEL,
    BLOCKS,
    TILING,
    SEEN,
    PATCHES,
    include_str!("composite/smooth.wgsl"),
];

pub(crate) const OVERLAY: Parts = &[
    FRAME,
    LEVEL,
    BLOCKS,
    TILING,
    include_str!("output/overlay.wgsl"),
];

/// Joins a shader's parts.
pub(crate) fn source(parts: Parts) -> String {
    parts.join("\n")
}

/// Compiles a shader.
pub(crate) fn module(gpu: &Gpu, label: &str, parts: Parts) -> wgpu::ShaderModule {
    gpu.device
        .create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(label),
            source: wgpu::ShaderSource::Wgsl(source(parts).into()),
        })
}

/// The layout of a pipeline whose bind groups are `groups` in order.
pub(crate) fn pipeline_layout(
    gpu: &Gpu,
    label: &str,
    groups: &[&wgpu::BindGroupLayout],
) -> wgpu::PipelineLayout {
    let groups: Vec<_> = groups.iter().map(|&g| Some(g)).collect();
    gpu.device
        .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &groups,
            immediate_size: 0,
        })
}

/// A compute pipeline; `constants` sets the module's overrides.
pub(crate) fn compute(
    gpu: &Gpu,
    label: &str,
    module: &wgpu::ShaderModule,
    entry_point: &str,
    groups: &[&wgpu::BindGroupLayout],
    constants: &[(&str, f64)],
) -> wgpu::ComputePipeline {
    gpu.device
        .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(label),
            layout: Some(&pipeline_layout(gpu, label, groups)),
            module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants,
                ..Default::default()
            },
            cache: None,
        })
}

/// A pipeline that draws one level of a mip chain (`shared/level.wgsl`).
#[expect(
    clippy::too_many_arguments,
    reason = "what a pipeline differs in, by name"
)]
pub(crate) fn level_screen(
    gpu: &Gpu,
    label: &str,
    module: &wgpu::ShaderModule,
    entry_point: &str,
    groups: &[&wgpu::BindGroupLayout],
    targets: &[Option<wgpu::ColorTargetState>],
    depth_stencil: Option<wgpu::DepthStencilState>,
    constants: &[(&str, f64)],
) -> wgpu::RenderPipeline {
    let compilation_options = wgpu::PipelineCompilationOptions {
        constants,
        ..Default::default()
    };
    gpu.device
        .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(label),
            layout: Some(&pipeline_layout(gpu, label, groups)),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some("level_screen"),
                compilation_options: compilation_options.clone(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some(entry_point),
                compilation_options,
                targets,
            }),
            multiview_mask: None,
            cache: None,
        })
}

/// A pipeline that draws one full-screen triangle into one target.
pub(crate) fn full_screen(
    gpu: &Gpu,
    label: &str,
    module: &wgpu::ShaderModule,
    entry_point: &str,
    groups: &[&wgpu::BindGroupLayout],
    target: wgpu::TextureFormat,
    constants: &[(&str, f64)],
) -> wgpu::RenderPipeline {
    let compilation_options = wgpu::PipelineCompilationOptions {
        constants,
        ..Default::default()
    };
    gpu.device
        .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(label),
            layout: Some(&pipeline_layout(gpu, label, groups)),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some("full_screen"),
                compilation_options: compilation_options.clone(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some(entry_point),
                compilation_options,
                targets: &[Some(target.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: &[(&str, Parts)] = &[
        ("gbuffer", GBUFFER),
        ("clusters", CLUSTERS),
        ("shade every pixel", SHADE_EVERY_PIXEL),
        ("shade list", SHADE_LIST),
        ("forward", FORWARD),
        ("tone map", TONE_MAP),
        ("view", VIEW),
        ("merge", AA_MERGE),
        ("edge shading", AA_SHADE),
        ("combination", AA_COMBINE),
        ("combination, store", AA_STORE),
        ("tally", AA_VIEW),
        ("rate wish", RATE_WISH),
        ("rate pyramid", RATE_PYRAMID),
        ("rate owner", RATE_OWNER),
        ("coarse mark", COARSE_MARK),
        ("coarse list", COARSE_LIST),
        ("coarse dispatch", COARSE_DISPATCH),
        ("coarse shade draw", COARSE_SHADE_DRAW),
        ("coarse shade list", COARSE_SHADE_LIST),
        ("overlay", OVERLAY),
        ("composite nearest", COMPOSITE_NEAREST),
        ("composite paper", COMPOSITE_PAPER),
        ("composite patch", COMPOSITE_PATCH),
        ("composite raise", COMPOSITE_RAISE),
        ("composite smooth", COMPOSITE_SMOOTH),
    ];

    fn parse(name: &str, parts: Parts) -> naga::Module {
        let source = source(parts);
        naga::front::wgsl::parse_str(&source)
            .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(&source)))
    }

    #[test]
    fn every_shader_validates_without_optional_capabilities() {
        for (name, parts) in ALL {
            let module = parse(name, parts);
            // Packing to halves belongs to WebGPU itself; naga counts it as a capability.
            let capabilities = naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32;
            naga::valid::Validator::new(naga::valid::ValidationFlags::all(), capabilities)
                .validate(&module)
                .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(&source(parts))));
        }
    }

    /// What a value is made from.
    #[derive(Clone, Copy, PartialEq)]
    enum Origin {
        /// Literals, constants, overrides.
        Constant,
        /// At least one uniform, else constants.
        Uniform,
        /// Anything else.
        Varying,
    }

    fn origin(
        module: &naga::Module,
        function: &naga::Function,
        handle: naga::Handle<naga::Expression>,
    ) -> Origin {
        use naga::Expression as E;
        let all = |handles: &[naga::Handle<naga::Expression>]| {
            handles
                .iter()
                .map(|&h| origin(module, function, h))
                .fold(Origin::Constant, |a, b| match (a, b) {
                    (Origin::Varying, _) | (_, Origin::Varying) => Origin::Varying,
                    (Origin::Uniform, _) | (_, Origin::Uniform) => Origin::Uniform,
                    _ => Origin::Constant,
                })
        };
        match &function.expressions[handle] {
            E::Literal(_) | E::Constant(_) | E::Override(_) | E::ZeroValue(_) => Origin::Constant,
            E::GlobalVariable(g)
                if module.global_variables[*g].space == naga::AddressSpace::Uniform =>
            {
                Origin::Uniform
            }
            E::Load { pointer } => all(&[*pointer]),
            E::AccessIndex { base, .. } => all(&[*base]),
            E::Access { base, index } => all(&[*base, *index]),
            E::Splat { value, .. } => all(&[*value]),
            E::Swizzle { vector, .. } => all(&[*vector]),
            E::Compose { components, .. } => all(components),
            E::Unary { expr, .. } | E::As { expr, .. } => all(&[*expr]),
            E::Binary { left, right, .. } => all(&[*left, *right]),
            E::Select {
                condition,
                accept,
                reject,
            } => all(&[*condition, *accept, *reject]),
            E::Relational { argument, .. } => all(&[*argument]),
            E::Math {
                arg,
                arg1,
                arg2,
                arg3,
                ..
            } => {
                let rest: Vec<_> = [*arg1, *arg2, *arg3]
                    .into_iter()
                    .flatten()
                    .chain([*arg])
                    .collect();
                all(&rest)
            }
            _ => Origin::Varying,
        }
    }

    /// A uniform alone, or a uniform against a local variable (a loop's counter), decides the condition.
    fn is_decided_by_uniforms(
        module: &naga::Module,
        function: &naga::Function,
        condition: naga::Handle<naga::Expression>,
    ) -> bool {
        use naga::Expression as E;
        let counter = |h| match &function.expressions[h] {
            E::Load { pointer } => matches!(function.expressions[*pointer], E::LocalVariable(_)),
            _ => false,
        };
        match &function.expressions[condition] {
            E::Binary { left, right, .. } => {
                let (l, r) = (
                    origin(module, function, *left),
                    origin(module, function, *right),
                );
                (l == Origin::Uniform && (r != Origin::Varying || counter(*right)))
                    || (r == Origin::Uniform && (l != Origin::Varying || counter(*left)))
            }
            _ => origin(module, function, condition) == Origin::Uniform,
        }
    }

    fn visit(
        module: &naga::Module,
        function: &naga::Function,
        block: &naga::Block,
        found: &mut Vec<String>,
    ) {
        use naga::Statement as S;
        let mut check = |condition| {
            if is_decided_by_uniforms(module, function, condition) {
                found.push(function.name.clone().unwrap_or_default());
            }
        };
        for statement in block {
            match statement {
                S::If { condition, .. } => check(*condition),
                S::Switch { selector, .. } => check(*selector),
                S::Loop {
                    break_if: Some(condition),
                    ..
                } => check(*condition),
                _ => {}
            }
        }
        for statement in block {
            match statement {
                S::Block(inner) => visit(module, function, inner, found),
                S::If { accept, reject, .. } => {
                    visit(module, function, accept, found);
                    visit(module, function, reject, found);
                }
                S::Switch { cases, .. } => cases
                    .iter()
                    .for_each(|c| visit(module, function, &c.body, found)),
                S::Loop {
                    body, continuing, ..
                } => {
                    visit(module, function, body, found);
                    visit(module, function, continuing, found);
                }
                _ => {}
            }
        }
    }

    fn branches_on_uniforms(module: &naga::Module) -> Vec<String> {
        let mut found = Vec::new();
        let functions = module.functions.iter().map(|(_, f)| f);
        for function in functions.chain(module.entry_points.iter().map(|e| &e.function)) {
            visit(module, function, &function.body, &mut found);
        }
        found
    }

    /// Mesa's lavapipe takes the values of such uniforms into the shader and compiles it anew whenever their
    /// buffer changes, which is every frame; the old one's memory is never given back (seen with 22.3.6).
    #[test]
    fn no_branch_is_decided_by_uniforms_alone() {
        for (name, parts) in ALL {
            let found = branches_on_uniforms(&parse(name, parts));
            assert!(
                found.is_empty(),
                "{name}: in {found:?}; use select, an override or a storage buffer"
            );
        }
        for bad in [
            "if u.x > 1u { o = 1u; }",
            "for (var i = 0u; i < u.y; i++) { o += i; }",
            "switch u.x { case 1u: { o = 2u; } default: {} }",
        ] {
            let source = format!(
                "@group(0) @binding(0) var<uniform> u: vec4u;
                @compute @workgroup_size(1) fn main() {{ var o = 0u; {bad} }}"
            );
            let module = naga::front::wgsl::parse_str(&source).expect("the example parses");
            assert!(
                !branches_on_uniforms(&module).is_empty(),
                "must be found: {bad}"
            );
        }
    }

    /// Name and offset of each member, and the size, of a WGSL struct.
    fn layout_of(module: &naga::Module, name: &str) -> (Vec<(String, u32)>, u32) {
        let (_, ty) = module
            .types
            .iter()
            .find(|(_, t)| t.name.as_deref() == Some(name))
            .expect("struct is there");
        let naga::TypeInner::Struct { members, span } = &ty.inner else {
            panic!("{name} is no struct")
        };
        let members = members
            .iter()
            .map(|m| (m.name.clone().unwrap_or_default(), m.offset))
            .collect();
        (members, *span)
    }

    macro_rules! assert_same_layout {
        ($parts:expr, $wgsl:literal, $rust:ty, [$($field:ident),+ $(,)?]) => {
            let (members, size) = layout_of(&parse($wgsl, $parts), $wgsl);
            let ours = vec![$((stringify!($field).to_owned(), std::mem::offset_of!($rust, $field) as u32)),+];
            assert_eq!(members, ours, "members of {}", $wgsl);
            assert_eq!(size as usize, size_of::<$rust>(), "size of {}", $wgsl);
        };
    }

    #[test]
    fn shared_structs_lie_the_same_in_rust_and_wgsl() {
        use crate::frame::FrameUniform;
        use crate::lights::LightUniform;
        use crate::rate::WishUniform;
        use crate::scene::{InstanceUniform, MaterialUniform};
        assert_same_layout!(
            GBUFFER,
            "Frame",
            FrameUniform,
            [
                clip_from_world,
                previous_clip_from_world,
                world_from_view,
                view_from_ndc,
                eye,
                orthographic,
                forward,
                exposure,
                zenith,
                near,
                horizon,
                depth_range,
                nadir,
                cluster_near,
                cluster_counts,
                cluster_scale,
                size,
                cluster_tile,
                reserved,
            ]
        );
        assert_same_layout!(
            AA_MERGE,
            "Band",
            crate::antialias::BandUniform,
            [first_row, rows, reserved, offsets]
        );
        assert_same_layout!(
            AA_SHADE,
            "Queue",
            crate::antialias::QueueUniform,
            [
                band_groups,
                start,
                all_groups,
                total,
                edge_pixels,
                evaluations,
                reserved
            ]
        );
        assert_same_layout!(
            RATE_WISH,
            "Wish",
            WishUniform,
            [
                gaze,
                squared_radii,
                eye_width,
                coarsest,
                constant_level,
                refine_up_to,
                edges_up_to,
                reserved_0,
                reserved_1,
                reserved_2
            ]
        );
        assert_same_layout!(
            CLUSTERS,
            "Light",
            LightUniform,
            [
                position,
                range,
                radiant,
                kind,
                direction,
                spot_scale,
                spot_offset,
                cone_cos,
                cone_sin,
                reserved
            ]
        );
        assert_same_layout!(
            GBUFFER,
            "Instance",
            InstanceUniform,
            [
                world_x, world_y, world_z, previous_x, previous_y, previous_z
            ]
        );
        assert_same_layout!(
            GBUFFER,
            "Material",
            MaterialUniform,
            [
                base_color,
                emissive,
                metallic,
                roughness,
                normal_scale,
                occlusion_strength,
                alpha_cutoff,
                uv,
            ]
        );
    }
}
