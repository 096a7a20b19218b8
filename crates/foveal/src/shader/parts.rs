//! Which parts each shader is put together from.

use super::Parts;

const FRAME: &str = include_str!("../shared/frame.wgsl");
const SURFACE: &str = include_str!("../shared/surface.wgsl");
const LIGHT: &str = include_str!("../shared/light.wgsl");
const SURROUNDINGS: &str = include_str!("../shared/surroundings.wgsl");
const LIGHTING: &str = concat!(
    include_str!("../shared/light_list.wgsl"),
    include_str!("../shared/surroundings.wgsl"),
    include_str!("../shared/lighting.wgsl")
);
const VERTEX: &str = concat!(
    include_str!("../shared/instances.wgsl"),
    include_str!("../shared/vertex.wgsl")
);
const VERTEX_CLIPPED: &str = include_str!("../shared/vertex_clipped.wgsl");
const ENABLE_CLIP_DISTANCES: &str = "enable clip_distances;";
const MATERIAL: &str = concat!(
    include_str!("../shared/procedural.wgsl"),
    include_str!("../shared/material.wgsl")
);
const SAMPLE_IMPLICIT: &str = concat!(
    include_str!("../shared/material_bindings.wgsl"),
    include_str!("../shared/sample_implicit.wgsl")
);
const SAMPLE_GRADIENTS: &str = include_str!("../shared/sample_gradients.wgsl");
const FAMILY: &str = include_str!("../geometry/visibility/family.wgsl");
const ATTRIBUTES: &str = include_str!("../shared/attributes.wgsl");
const FULL_SCREEN: &str = include_str!("../shared/full_screen.wgsl");
const LAYERS: &str = include_str!("../shared/layers.wgsl");
const NORMAL_OF_SURFACE: &str = include_str!("../shared/normal_of_surface.wgsl");
const NORMAL_OF_DEPTH: &str = include_str!("../shared/normal_of_depth.wgsl");
const VERTEX_LAYERED: &str = include_str!("../shared/vertex_layered.wgsl");
const SHADING: &str = concat!(
    include_str!("../shading/input.wgsl"),
    include_str!("../shading/shading.wgsl")
);

pub(crate) const GBUFFER: Parts = &[
    FRAME,
    SURFACE,
    VERTEX,
    SAMPLE_IMPLICIT,
    MATERIAL,
    include_str!("../geometry/gbuffer.wgsl"),
];
const VISIBLE: &str = include_str!("../geometry/visibility/visible.wgsl");
const EVERY: &str = include_str!("../geometry/visibility/every.wgsl");
/// Needs [`wgpu::Features::PRIMITIVE_INDEX`].
pub(crate) const VISIBLE_INDEXED: Parts = &[
    "enable primitive_index;",
    FRAME,
    SURFACE,
    VERTEX,
    SAMPLE_IMPLICIT,
    MATERIAL,
    VISIBLE,
    include_str!("../geometry/visibility/indexed.wgsl"),
];
/// As [`VISIBLE_INDEXED`], each eye to a layer; needs [`wgpu::Features::MULTIVIEW`] too.
pub(crate) const VISIBLE_INDEXED_LAYERED: Parts = &[
    "enable primitive_index;",
    FRAME,
    SURFACE,
    VERTEX,
    SAMPLE_IMPLICIT,
    MATERIAL,
    VISIBLE,
    include_str!("../geometry/visibility/indexed.wgsl"),
    include_str!("../geometry/visibility/indexed_layered.wgsl"),
];
/// As [`VISIBLE_PULLED`], each eye to a layer; needs [`wgpu::Features::MULTIVIEW`].
pub(crate) const VISIBLE_PULLED_LAYERED: Parts = &[
    FRAME,
    SURFACE,
    VERTEX,
    SAMPLE_IMPLICIT,
    MATERIAL,
    VISIBLE,
    ATTRIBUTES,
    include_str!("../geometry/visibility/pulled.wgsl"),
    include_str!("../geometry/visibility/pulled_layered.wgsl"),
];
pub(crate) const VISIBLE_PULLED: Parts = &[
    FRAME,
    SURFACE,
    VERTEX,
    SAMPLE_IMPLICIT,
    MATERIAL,
    VISIBLE,
    ATTRIBUTES,
    include_str!("../geometry/visibility/pulled.wgsl"),
];
/// What sorts pixels by material: without subgroups, and with them, which needs [`wgpu::Features::SUBGROUP`].
macro_rules! bins {
    [$($part:expr),+] => {[
        &[
            FRAME, $($part,)+ FAMILY,
            include_str!("../geometry/visibility/bins.wgsl"),
            include_str!("../geometry/visibility/bins_table.wgsl"),
        ],
        &[
            FRAME, $($part,)+ FAMILY,
            include_str!("../geometry/visibility/bins.wgsl"),
            include_str!("../geometry/visibility/bins_subgroups.wgsl"),
        ],
    ]};
}
/// What evaluates triangles' materials: a family of them, one of them.
macro_rules! resolve {
    [$($rates:expr),+] => {[
        &[
            FRAME, SURFACE, VERTEX, ATTRIBUTES, SAMPLE_GRADIENTS,
            include_str!("../geometry/visibility/by_family.wgsl"),
            MATERIAL, $($rates,)+ FAMILY,
            include_str!("../geometry/visibility/resolve.wgsl"),
        ],
        &[
            FRAME, SURFACE, VERTEX, ATTRIBUTES, SAMPLE_GRADIENTS,
            include_str!("../shared/material_bindings.wgsl"),
            include_str!("../geometry/visibility/by_material.wgsl"),
            MATERIAL, $($rates,)+ FAMILY,
            include_str!("../geometry/visibility/resolve.wgsl"),
        ],
    ]};
}
pub(crate) const BINS: [Parts; 2] = bins![LAYERS, EVERY];
const RATED: &str = include_str!("../geometry/visibility/rated.wgsl");
/// As [`BINS`] and [`RESOLVE`], with a sample's upper left pixel for all of its pixels.
pub(crate) const BINS_RATED: [Parts; 2] = bins![
    RATES,
    "@group(1) @binding(6) var mask: texture_2d<u32>;",
    RATED,
    LAYERS
];
pub(crate) const RESOLVE_RATED: [Parts; 2] = resolve![
    RATES,
    "@group(3) @binding(6) var mask: texture_2d<u32>;",
    RATED,
    LAYERS
];
const TILED: &str = include_str!("../geometry/visibility/tiled.wgsl");
/// As [`BINS`] and [`RESOLVE`], where tiles are sampled alone.
pub(crate) const BINS_TILED: [Parts; 2] = bins![
    BLOCKS,
    "@group(1) @binding(6) var mask: texture_2d<u32>;",
    TILED,
    LAYERS
];
pub(crate) const RESOLVE_TILED: [Parts; 2] = resolve![
    BLOCKS,
    "@group(3) @binding(6) var mask: texture_2d<u32>;",
    TILED,
    LAYERS
];
pub(crate) const RESOLVE: [Parts; 2] = resolve![EVERY, LAYERS];
/// As [`RESOLVE`], for the further surfaces of pixels at edges.
pub(crate) const RESOLVE_FURTHER: [Parts; 2] = resolve![
    AA_QUARTERS,
    include_str!("../antialias/further.wgsl"),
    LAYERS
];
/// As [`GBUFFER`], with a clip plane between the eyes.
pub(crate) const GBUFFER_CLIPPED: Parts = &[
    ENABLE_CLIP_DISTANCES,
    FRAME,
    SURFACE,
    VERTEX,
    VERTEX_CLIPPED,
    SAMPLE_IMPLICIT,
    MATERIAL,
    include_str!("../geometry/gbuffer.wgsl"),
];
/// As [`GBUFFER`], each eye to a layer; needs [`wgpu::Features::MULTIVIEW`].
pub(crate) const GBUFFER_LAYERED: Parts = &[
    FRAME,
    SURFACE,
    VERTEX,
    VERTEX_LAYERED,
    SAMPLE_IMPLICIT,
    MATERIAL,
    include_str!("../geometry/gbuffer.wgsl"),
];
pub(crate) const CLUSTERS: Parts = &[FRAME, LIGHT, include_str!("../lights/clusters.wgsl")];
pub(crate) const SHADE_EVERY_PIXEL: Parts = &[
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    LAYERS,
    SHADING,
    FULL_SCREEN,
    include_str!("../shading/every_pixel.wgsl"),
];
pub(crate) const SHADE_LIST: Parts = &[
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    LAYERS,
    SHADING,
    include_str!("../shading/list.wgsl"),
];
pub(crate) const FORWARD: Parts = &[
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    VERTEX,
    SAMPLE_IMPLICIT,
    MATERIAL,
    include_str!("../forward/lights.wgsl"),
    include_str!("../forward/forward.wgsl"),
];
/// As [`FORWARD`], with a clip plane between the eyes.
pub(crate) const FORWARD_CLIPPED: Parts = &[
    ENABLE_CLIP_DISTANCES,
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    VERTEX,
    VERTEX_CLIPPED,
    SAMPLE_IMPLICIT,
    MATERIAL,
    include_str!("../forward/lights.wgsl"),
    include_str!("../forward/forward.wgsl"),
];
/// As [`FORWARD`], each eye to a layer; needs [`wgpu::Features::MULTIVIEW`].
pub(crate) const FORWARD_LAYERED: Parts = &[
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    VERTEX,
    VERTEX_LAYERED,
    SAMPLE_IMPLICIT,
    MATERIAL,
    include_str!("../forward/lights.wgsl"),
    include_str!("../forward/forward.wgsl"),
];
const TRIAL_EYES: &str = include_str!("../stereo/trial.wgsl");
pub(crate) const TRIAL: Parts = &[TRIAL_EYES];
/// As [`TRIAL`], with a clip plane between the eyes.
pub(crate) const TRIAL_CLIPPED: Parts = &[
    ENABLE_CLIP_DISTANCES,
    TRIAL_EYES,
    include_str!("../stereo/trial_clipped.wgsl"),
];
/// As [`TRIAL`], each eye to a layer; needs [`wgpu::Features::MULTIVIEW`].
pub(crate) const TRIAL_LAYERED: Parts = &[TRIAL_EYES, include_str!("../stereo/trial_layered.wgsl")];
pub(crate) const SHOW_EYES: Parts = &[FRAME, FULL_SCREEN, include_str!("../output/eyes.wgsl")];
pub(crate) const TONE_MAP: Parts = &[FRAME, FULL_SCREEN, include_str!("../output/tone_map.wgsl")];
pub(crate) const PRESENT: Parts = &[FRAME, include_str!("../output/present.wgsl")];
pub(crate) const VIEW: Parts = &[
    FRAME,
    SURFACE,
    LAYERS,
    FULL_SCREEN,
    include_str!("../output/view.wgsl"),
];
const AA_SAMPLES: &str = include_str!("../antialias/samples.wgsl");
const AA_SURFACES: &str = include_str!("../antialias/surfaces.wgsl");
const AA_STORED: &str = include_str!("../antialias/stored.wgsl");
const AA_WEIGHT: &str = include_str!("../antialias/weight.wgsl");
const AA_WEIGHTED: &str = include_str!("../antialias/weighted.wgsl");
const AA_QUEUE: &str = include_str!("../antialias/queue.wgsl");
const AA_COUNTERS: &str = include_str!("../antialias/counters.wgsl");
const AA_QUARTERS: &str = include_str!("../antialias/quarters.wgsl");
pub(crate) const AA_MERGE: Parts = &[
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    LAYERS,
    SHADING,
    AA_SAMPLES,
    AA_SURFACES,
    AA_STORED,
    AA_QUEUE,
    AA_COUNTERS,
    FULL_SCREEN,
    include_str!("../antialias/merge.wgsl"),
];
pub(crate) const AA_SHADE: Parts = &[
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    LAYERS,
    SHADING,
    AA_SAMPLES,
    AA_SURFACES,
    AA_STORED,
    AA_WEIGHT,
    AA_WEIGHTED,
    AA_QUEUE,
    include_str!("../antialias/shade.wgsl"),
];
const AA_IDS: &str = include_str!("../antialias/ids.wgsl");
pub(crate) const AA_CANDIDATES: Parts = &[
    FRAME,
    SURFACE,
    VERTEX,
    ATTRIBUTES,
    AA_SAMPLES,
    AA_SURFACES,
    AA_IDS,
    include_str!("../antialias/candidates.wgsl"),
];
pub(crate) const AA_SORT: Parts = &[
    FRAME,
    SURFACE,
    VERTEX,
    ATTRIBUTES,
    AA_SAMPLES,
    AA_SURFACES,
    AA_IDS,
    AA_QUEUE,
    AA_COUNTERS,
    AA_QUARTERS,
    include_str!("../antialias/sort.wgsl"),
];
pub(crate) const AA_CLASSIFY: Parts = &[
    FRAME,
    SURFACE,
    VERTEX,
    ATTRIBUTES,
    AA_SAMPLES,
    AA_SURFACES,
    AA_IDS,
    FULL_SCREEN,
    include_str!("../antialias/classify.wgsl"),
];
pub(crate) const AA_SHADE_FURTHER: Parts = &[
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    LAYERS,
    SHADING,
    "// Sub-samples per pixel.\noverride COUNT: u32 = 4u;",
    AA_WEIGHT,
    AA_WEIGHTED,
    AA_QUEUE,
    AA_QUARTERS,
    include_str!("../antialias/shade_further.wgsl"),
];
pub(crate) const AA_COMBINE: Parts = &[
    FRAME,
    AA_WEIGHT,
    AA_QUEUE,
    include_str!("../antialias/combine.wgsl"),
];
pub(crate) const AA_STORE: Parts = &[AA_QUEUE, include_str!("../antialias/store.wgsl")];
pub(crate) const AA_BLENDED: Parts = &[
    AA_SAMPLES,
    FULL_SCREEN,
    include_str!("../antialias/blended.wgsl"),
];
pub(crate) const AA_VIEW: Parts = &[FULL_SCREEN, include_str!("../antialias/view.wgsl")];

const LEVEL: &str = include_str!("../shared/level.wgsl");
const BLOCKS: &str = include_str!("../shared/blocks.wgsl");

const FOVEA: &str = include_str!("../rate/fovea.wgsl");
const RATES: &str = include_str!("../shading/variable/rates.wgsl");
const RATE_PASSES: &str = include_str!("../shading/variable/passes.wgsl");
const REPROJECT: &str = include_str!("../shading/variable/reproject.wgsl");

pub(crate) const VARIABLE_REPROJECT: Parts = &[FRAME, LAYERS, FOVEA, RATE_PASSES, REPROJECT];
pub(crate) const VARIABLE_MASK: Parts = &[
    FRAME,
    LAYERS,
    RATES,
    FOVEA,
    RATE_PASSES,
    REPROJECT,
    include_str!("../shading/variable/mask.wgsl"),
];
pub(crate) const VARIABLE_SIZE: Parts = &[include_str!("../shading/variable/size.wgsl")];
pub(crate) const VARIABLE_SHADE: Parts = &[
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    LAYERS,
    SHADING,
    RATES,
    include_str!("../shading/variable/shade.wgsl"),
];
pub(crate) const VARIABLE_VIEW: Parts = &[
    FRAME,
    RATES,
    FULL_SCREEN,
    include_str!("../shading/variable/view.wgsl"),
];

/// By surfaces, and by depth.
pub(crate) const RATE_WISH: [Parts; 2] = [
    &[
        FRAME,
        SURFACE,
        LEVEL,
        BLOCKS,
        FOVEA,
        LAYERS,
        include_str!("../rate/crease_of_surface.wgsl"),
        include_str!("../rate/wish.wgsl"),
    ],
    &[
        FRAME,
        SURFACE,
        LEVEL,
        BLOCKS,
        FOVEA,
        LAYERS,
        NORMAL_OF_DEPTH,
        include_str!("../rate/crease_of_depth.wgsl"),
        include_str!("../rate/wish.wgsl"),
    ],
];
pub(crate) const RATE_PYRAMID: Parts =
    &[FRAME, LEVEL, BLOCKS, include_str!("../rate/pyramid.wgsl")];
pub(crate) const RATE_OWNER: Parts = &[FRAME, LEVEL, BLOCKS, include_str!("../rate/owner.wgsl")];
pub(crate) const COARSE_MARK: Parts = &[
    FRAME,
    LEVEL,
    BLOCKS,
    include_str!("../shading/coarse/mark.wgsl"),
];
pub(crate) const COARSE_LIST: Parts = &[FRAME, BLOCKS, include_str!("../shading/coarse/list.wgsl")];
pub(crate) const COARSE_DISPATCH: Parts = &[include_str!("../shading/coarse/dispatch.wgsl")];
pub(crate) const COARSE_SHADE_DRAW: Parts = &[
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    LAYERS,
    SHADING,
    LEVEL,
    BLOCKS,
    include_str!("../shading/coarse/block.wgsl"),
    include_str!("../shading/coarse/shade_draw.wgsl"),
];
pub(crate) const COARSE_SHADE_LIST: Parts = &[
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    LAYERS,
    SHADING,
    BLOCKS,
    include_str!("../shading/coarse/block.wgsl"),
    LISTED,
    include_str!("../shading/coarse/shade_list.wgsl"),
];
const LISTED: &str = include_str!("../shading/coarse/listed.wgsl");
const SAMPLE_LIGHT: &str = include_str!("../shading/coarse/light.wgsl");
/// As the two above, with the samples' light.
pub(crate) const COARSE_LIGHT_DRAW: Parts = &[
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    LAYERS,
    SHADING,
    LEVEL,
    BLOCKS,
    include_str!("../shading/coarse/block.wgsl"),
    SAMPLE_LIGHT,
    include_str!("../shading/coarse/block_light.wgsl"),
    include_str!("../shading/coarse/light_draw.wgsl"),
];
pub(crate) const COARSE_LIGHT_LIST: Parts = &[
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    LAYERS,
    SHADING,
    BLOCKS,
    include_str!("../shading/coarse/block.wgsl"),
    SAMPLE_LIGHT,
    include_str!("../shading/coarse/block_light.wgsl"),
    LISTED,
    include_str!("../shading/coarse/light_list.wgsl"),
];
/// As [`COARSE_SHADE_DRAW`] and [`COARSE_SHADE_LIST`], radiance being an affine function of the position.
#[cfg(test)]
pub(crate) const COARSE_AFFINE: [Parts; 2] = [
    &[
        FRAME,
        SURFACE,
        LAYERS,
        include_str!("../shading/coarse/affine.wgsl"),
        LEVEL,
        BLOCKS,
        include_str!("../shading/coarse/block.wgsl"),
        include_str!("../shading/coarse/shade_draw.wgsl"),
    ],
    &[
        FRAME,
        SURFACE,
        LAYERS,
        include_str!("../shading/coarse/affine.wgsl"),
        BLOCKS,
        include_str!("../shading/coarse/block.wgsl"),
        LISTED,
        include_str!("../shading/coarse/shade_list.wgsl"),
    ],
];
const TILING: &str = include_str!("../composite/tiling.wgsl");
const SEEN: &str = include_str!("../composite/seen.wgsl");
const PATCHES: &str = include_str!("../composite/patches.wgsl");

pub(crate) const COMPOSITE_NEAREST: Parts = &[
    FRAME,
    LEVEL,
    BLOCKS,
    TILING,
    include_str!("../composite/nearest.wgsl"),
];
pub(crate) const COMPOSITE_PAPER: Parts = &[
    FRAME,
    LEVEL,
    BLOCKS,
    TILING,
    include_str!("../composite/paper.wgsl"),
];
const GATHER_LIGHT: &str = include_str!("../composite/gather.wgsl");
pub(crate) const COMPOSITE_LIGHT: Parts = &[
    FRAME,
    SURFACE,
    SURROUNDINGS,
    BLOCKS,
    TILING,
    LAYERS,
    SAMPLE_LIGHT,
    GATHER_LIGHT,
    include_str!("../composite/light.wgsl"),
];
pub(crate) const COMPOSITE_FIT: Parts = &[
    FRAME,
    SURFACE,
    BLOCKS,
    TILING,
    LAYERS,
    NORMAL_OF_SURFACE,
    SEEN,
    PATCHES,
    include_str!("../composite/raise.wgsl"),
    include_str!("../composite/fit.wgsl"),
];
/// By the surfaces' normals, and by those of depth where only samples have surfaces.
pub(crate) const COMPOSITE_SMOOTH: [Parts; 2] = [
    &[
        FRAME,
        SURFACE,
        LEVEL,
        BLOCKS,
        TILING,
        LAYERS,
        NORMAL_OF_SURFACE,
        SEEN,
        PATCHES,
        include_str!("../composite/curve.wgsl"),
        include_str!("../composite/smooth.wgsl"),
    ],
    &[
        FRAME,
        SURFACE,
        LEVEL,
        BLOCKS,
        TILING,
        LAYERS,
        NORMAL_OF_DEPTH,
        SEEN,
        PATCHES,
        include_str!("../composite/curve.wgsl"),
        include_str!("../composite/smooth.wgsl"),
    ],
];

pub(crate) const OVERLAY: Parts = &[
    FRAME,
    LEVEL,
    BLOCKS,
    TILING,
    include_str!("../output/overlay.wgsl"),
];

const MISSING: &str = include_str!("../reduced/missing.wgsl");
const TABLE: &str = include_str!("../reduced/table.wgsl");
const REDUCED_LIGHTING: &str = concat!(
    include_str!("../reduced/lights.wgsl"),
    include_str!("../shared/surroundings.wgsl"),
    include_str!("../shared/lighting.wgsl")
);
const REDUCED_VERTEX: &str = concat!(
    include_str!("../reduced/instances.wgsl"),
    include_str!("../shared/vertex.wgsl")
);

/// As [`GBUFFER`], for devices without storage buffers.
pub(crate) const REDUCED_GBUFFER: Parts = &[
    MISSING,
    TABLE,
    FRAME,
    SURFACE,
    REDUCED_VERTEX,
    SAMPLE_IMPLICIT,
    MATERIAL,
    include_str!("../reduced/gbuffer.wgsl"),
];
/// As [`SHADE_EVERY_PIXEL`], likewise.
pub(crate) const REDUCED_SHADE: Parts = &[
    MISSING,
    TABLE,
    FRAME,
    SURFACE,
    LIGHT,
    REDUCED_LIGHTING,
    include_str!("../reduced/input.wgsl"),
    include_str!("../shading/shading.wgsl"),
    FULL_SCREEN,
    include_str!("../shading/every_pixel.wgsl"),
];
/// As [`FORWARD`], likewise.
pub(crate) const REDUCED_FORWARD: Parts = &[
    MISSING,
    TABLE,
    FRAME,
    SURFACE,
    LIGHT,
    REDUCED_LIGHTING,
    REDUCED_VERTEX,
    SAMPLE_IMPLICIT,
    MATERIAL,
    include_str!("../reduced/forward.wgsl"),
    include_str!("../forward/forward.wgsl"),
];

const REMEMBERED: &str = include_str!("../shading/history/remembered.wgsl");
const ORDER: &str = include_str!("../shading/history/order.wgsl");
const MEASURED: &str = include_str!("../shading/history/measured.wgsl");
pub(crate) const HISTORY_TILES: Parts = &[
    FRAME,
    REMEMBERED,
    MEASURED,
    include_str!("../shading/history/tiles.wgsl"),
];
pub(crate) const HISTORY_CARRY: Parts = &[
    FRAME,
    SURFACE,
    SURROUNDINGS,
    BLOCKS,
    TILING,
    LAYERS,
    SAMPLE_LIGHT,
    REMEMBERED,
    ORDER,
    include_str!("../shading/history/carry.wgsl"),
];
pub(crate) const HISTORY_SIZE: Parts = &[
    FRAME,
    REMEMBERED,
    include_str!("../shading/history/size.wgsl"),
];
pub(crate) const HISTORY_SHADE: Parts = &[
    FRAME,
    SURFACE,
    LIGHT,
    LIGHTING,
    LAYERS,
    SHADING,
    BLOCKS,
    include_str!("../shading/coarse/block.wgsl"),
    SAMPLE_LIGHT,
    include_str!("../shading/coarse/block_light.wgsl"),
    REMEMBERED,
    MEASURED,
    include_str!("../shading/history/shade.wgsl"),
];
pub(crate) const HISTORY_GATHER: Parts = &[
    FRAME,
    SURFACE,
    SURROUNDINGS,
    BLOCKS,
    TILING,
    LAYERS,
    SAMPLE_LIGHT,
    GATHER_LIGHT,
    REMEMBERED,
    include_str!("../shading/history/gather.wgsl"),
];
pub(crate) const HISTORY_SCATTER: Parts = &[
    FRAME,
    REMEMBERED,
    include_str!("../shading/history/scatter.wgsl"),
];
pub(crate) const HISTORY_REST: Parts = &[
    FRAME,
    BLOCKS,
    LAYERS,
    REMEMBERED,
    ORDER,
    include_str!("../shading/history/rest.wgsl"),
];
