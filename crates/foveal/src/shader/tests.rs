//! What must hold of every shader, checked without a device.

use super::*;

const ALL: &[(&str, Parts)] = &[
    ("gbuffer", GBUFFER),
    ("visible, indexed", VISIBLE_INDEXED),
    ("visible, pulled", VISIBLE_PULLED),
    ("bins", BINS[0]),
    ("bins, subgroups", BINS[1]),
    ("resolve", RESOLVE[0]),
    ("resolve, one by one", RESOLVE[1]),
    ("bins, rated", BINS_RATED[0]),
    ("bins, rated, subgroups", BINS_RATED[1]),
    ("resolve, rated", RESOLVE_RATED[0]),
    ("resolve, rated, one by one", RESOLVE_RATED[1]),
    ("bins, tiled", BINS_TILED[0]),
    ("bins, tiled, subgroups", BINS_TILED[1]),
    ("resolve, tiled", RESOLVE_TILED[0]),
    ("resolve, tiled, one by one", RESOLVE_TILED[1]),
    ("variable reproject", VARIABLE_REPROJECT),
    ("variable mask", VARIABLE_MASK),
    ("variable size", VARIABLE_SIZE),
    ("variable shade", VARIABLE_SHADE),
    ("variable view", VARIABLE_VIEW),
    ("gbuffer, clipped", GBUFFER_CLIPPED),
    ("gbuffer, layered", GBUFFER_LAYERED),
    ("forward, layered", FORWARD_LAYERED),
    ("visible, indexed, layered", VISIBLE_INDEXED_LAYERED),
    ("visible, pulled, layered", VISIBLE_PULLED_LAYERED),
    ("trial", TRIAL),
    ("trial, clipped", TRIAL_CLIPPED),
    ("trial, layered", TRIAL_LAYERED),
    ("clusters", CLUSTERS),
    ("shade every pixel", SHADE_EVERY_PIXEL),
    ("shade list", SHADE_LIST),
    ("forward", FORWARD),
    ("forward, clipped", FORWARD_CLIPPED),
    ("eyes", SHOW_EYES),
    ("tone map", TONE_MAP),
    ("present", PRESENT),
    ("view", VIEW),
    ("merge", AA_MERGE),
    ("edge shading", AA_SHADE),
    ("candidates", AA_CANDIDATES),
    ("sorting", AA_SORT),
    ("classification", AA_CLASSIFY),
    ("further shading", AA_SHADE_FURTHER),
    ("materials of further triangles", RESOLVE_FURTHER[0]),
    (
        "materials of further triangles, one by one",
        RESOLVE_FURTHER[1],
    ),
    ("combination", AA_COMBINE),
    ("combination, store", AA_STORE),
    ("tally", AA_VIEW),
    ("coarse light, draw", COARSE_LIGHT_DRAW),
    ("coarse light, list", COARSE_LIGHT_LIST),
    ("composite of light", COMPOSITE_LIGHT),
    ("history, tiles", HISTORY_TILES),
    ("history, carrying", HISTORY_CARRY),
    ("history, dispatches", HISTORY_SIZE),
    ("history, shading", HISTORY_SHADE),
    ("history, gathering", HISTORY_GATHER),
    ("history, scattering", HISTORY_SCATTER),
    ("history, rest", HISTORY_REST),
    ("rate wish", RATE_WISH[0]),
    ("rate wish, by depth", RATE_WISH[1]),
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
    ("composite fit", COMPOSITE_FIT),
    ("composite smooth", COMPOSITE_SMOOTH[0]),
    ("composite smooth, by depth", COMPOSITE_SMOOTH[1]),
    ("reduced geometry", REDUCED_GBUFFER),
    ("reduced shading", REDUCED_SHADE),
    ("reduced forward", REDUCED_FORWARD),
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
        let mut capabilities = naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32;
        // These are used where the device has the feature; others stand in for them where not.
        if name.starts_with("visible, indexed") {
            capabilities |= naga::valid::Capabilities::PRIMITIVE_INDEX;
        }
        if name.ends_with(", clipped") {
            capabilities |= naga::valid::Capabilities::CLIP_DISTANCES;
        }
        if name.ends_with(", layered") {
            capabilities |= naga::valid::Capabilities::MULTIVIEW;
        }
        if name.ends_with(", subgroups") {
            capabilities |= naga::valid::Capabilities::SUBGROUP;
        }
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
    use crate::frame::{FrameUniform, ViewUniform};
    use crate::lights::LightUniform;
    use crate::rate::WishUniform;
    use crate::scene::{InstanceUniform, MaterialUniform};
    assert_same_layout!(
        GBUFFER,
        "Frame",
        FrameUniform,
        [
            views,
            zenith,
            near,
            horizon,
            depth_range,
            nadir,
            cluster_near,
            cluster_counts,
            cluster_scale,
            size,
            target_size,
            cluster_tile,
            eye_stride,
            exposure,
            orthographic,
        ]
    );
    assert_same_layout!(
        GBUFFER,
        "View",
        ViewUniform,
        [
            clip_from_world,
            previous_clip_from_world,
            world_from_view,
            view_from_ndc,
            eye,
            cluster_shift_x,
            forward,
            cluster_shift_y,
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
        RATE_WISH[0],
        "Wish",
        WishUniform,
        [
            gaze,
            squared_radii,
            lens_squared_radii,
            eye_width,
            coarsest,
            constant_level,
            refine_up_to,
            edges_up_to,
            refine_by,
            block_at_gaze,
            block_growth,
            display_from_ndc,
            gaze_direction
        ]
    );
    assert_same_layout!(
        SHOW_EYES,
        "Shown",
        crate::output::ShownUniform,
        [screen, distortion, fringe]
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
            layers,
            number,
            procedural_seed,
            procedural_frequency,
            reserved_0,
            reserved_1,
            reserved_2,
        ]
    );
    for parts in [BINS[0], RESOLVE[0], RESOLVE[1]] {
        assert_same_layout!(
            parts,
            "Family",
            crate::scene::FamilyUniform,
            [
                groups_x, groups_y, groups_z, count, first, begin, end, reserved
            ]
        );
    }
    for parts in [VARIABLE_REPROJECT, VARIABLE_MASK] {
        assert_same_layout!(
            parts,
            "Rates",
            crate::shading::RatesUniform,
            [
                threshold,
                velocity_gain,
                probe_mask,
                probe_x,
                probe_y,
                reset,
                reserved_0,
                reserved_1
            ]
        );
    }
    for parts in [HISTORY_CARRY, HISTORY_TILES, HISTORY_REST] {
        assert_same_layout!(
            parts,
            "History",
            crate::shading::HistoryParameters,
            [
                rounding,
                phase,
                reset,
                renewal,
                tolerance,
                change,
                changed_count,
                changed
            ]
        );
    }
    assert_same_layout!(
        RESOLVE[0],
        "Windows",
        crate::geometry::WindowsUniform,
        [frames, parts]
    );
    assert_same_layout!(
        RESOLVE[0],
        "Place",
        crate::scene::PlaceUniform,
        [first_index, base_vertex, material, bin]
    );
}
