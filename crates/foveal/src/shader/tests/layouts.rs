//! Structs that Rust and WGSL share.

use super::parse;
use crate::shader::*;

const RESOLVE: Shader = GEOMETRY_VISIBILITY_RESOLVE.variant(&["BY_FAMILY", "EVERY"]);

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
    ($shader:expr, $wgsl:literal, $rust:ty, [$($field:ident),+ $(,)?]) => {
        let (members, size) = layout_of(&parse($shader, &$shader.source(false)), $wgsl);
        let ours = vec![$((stringify!($field).to_owned(), std::mem::offset_of!($rust, $field) as u32)),+];
        assert_eq!(members, ours, "members of {}", $wgsl);
        assert_eq!(size as usize, size_of::<$rust>(), "size of {}", $wgsl);
    };
}

#[test]
fn shared_structs_lie_the_same_in_rust_and_wgsl() {
    use crate::ambient::OcclusionUniform;
    use crate::frame::{FrameUniform, ViewUniform};
    use crate::lights::LightUniform;
    use crate::rate::RequestUniform;
    use crate::scene::{InstanceUniform, MaterialUniform};
    assert_same_layout!(
        AMBIENT_EVERY,
        "AmbientOcclusion",
        OcclusionUniform,
        [radius, most_pixels, padding]
    );
    assert_same_layout!(
        GEOMETRY_GBUFFER,
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
            irradiance,
            environment_turn,
            environment_intensity,
            point_size,
            environment_levels,
            line_width,
            shadow_bias,
            light_radius,
            sun_tangent,
            resting_views,
            most_disagreement,
        ]
    );
    assert_same_layout!(
        GEOMETRY_GBUFFER,
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
            previous_eye,
            previous_half_width,
        ]
    );
    assert_same_layout!(
        SHADOW_CASTER,
        "TileView",
        crate::shadow::TileUniform,
        [clip_from_world]
    );
    assert_same_layout!(
        ANTIALIAS_MERGE,
        "Band",
        crate::antialias::BandUniform,
        [first_row, rows, reserved, offsets]
    );
    assert_same_layout!(
        ANTIALIAS_SHADE,
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
        RATE_REQUEST,
        "Request",
        RequestUniform,
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
        OUTPUT_EYES,
        "Shown",
        crate::output::ShownUniform,
        [screen, distortion, fringe]
    );
    assert_same_layout!(
        LIGHTS_CLUSTERS,
        "Light",
        LightUniform,
        [
            position,
            range,
            radiant,
            spot_offset,
            direction,
            spot_scale,
            cone_cos,
            cone_sin,
            kind,
            seen_m
        ]
    );
    assert_same_layout!(
        GEOMETRY_GBUFFER,
        "Instance",
        InstanceUniform,
        [
            world_x, world_y, world_z, previous_x, previous_y, previous_z
        ]
    );
    assert_same_layout!(
        GEOMETRY_GBUFFER,
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
            tangent_turn,
            procedural_frequency,
            specular_color,
            specular,
            without_lobes,
        ]
    );
    assert_same_layout!(
        FORWARD_FORWARD.variant(&["LOBES"]),
        "Lobes",
        crate::scene::LobesUniform,
        [
            sheen_color,
            sheen_roughness,
            clearcoat,
            clearcoat_roughness,
            clearcoat_normal_scale,
            anisotropy,
            anisotropy_turn,
            transmission,
            thickness,
            absorption,
            ior,
            iridescence,
            film_ior,
            film_thickness,
            uv
        ]
    );
    for shader in [
        GEOMETRY_VISIBILITY_BINS_TABLE.variant(&["EVERY"]),
        RESOLVE,
        GEOMETRY_VISIBILITY_RESOLVE.variant(&["BY_MATERIAL", "EVERY"]),
    ] {
        assert_same_layout!(
            shader,
            "Family",
            crate::scene::FamilyUniform,
            [
                groups_x, groups_y, groups_z, count, first, begin, end, reserved
            ]
        );
    }
    assert_same_layout!(
        SHADING_VARIABLE_MASK,
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
    for shader in [
        SHADING_HISTORY_REPROJECT,
        SHADING_HISTORY_TILES,
        SHADING_HISTORY_REST,
    ] {
        assert_same_layout!(
            shader,
            "HistoryParameters",
            crate::shading::HistoryParameters,
            [
                rounding,
                phase,
                reset,
                renewal,
                tolerance,
                change,
                whole_round
            ]
        );
    }
    assert_same_layout!(
        RESOLVE,
        "Windows",
        crate::geometry::WindowsUniform,
        [frames, parts]
    );
    assert_same_layout!(
        RESOLVE,
        "Place",
        crate::scene::PlaceUniform,
        [first_index, base_vertex, material, bin]
    );
}
