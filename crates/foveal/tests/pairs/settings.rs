//! Settings by chance.

use foveal::{
    AmbientOcclusion, Antialiasing, Background, CoarseBackend, CoarseSample, Composite, Contrast,
    Culling, Display, EdgeTest, EnvironmentSource, Geometry, LightAssignment, LightingModel,
    LightingPass, Output, RateCombine, RateSource, RefineEdges, SamplePattern, Settings, Shading,
    ShadowSizes, Shadows, Stereo, ToneMap,
};

/// Numbers by which settings are chosen.
pub(crate) const NUMBERS: usize = 64;

/// Choices in turn; where numbers end, the first of each list.
pub(crate) struct Chance<'a>(pub(crate) std::slice::Iter<'a, u8>);

impl Chance<'_> {
    pub(crate) fn of<T: Copy>(&mut self, list: &[T]) -> T {
        let number = self.0.next().copied().unwrap_or(0);
        list[usize::from(number) % list.len()]
    }
}

/// What is set on both sides. The first of each list is the default, or simplest.
pub(crate) fn settings(chance: &mut Chance<'_>) -> Settings {
    Settings::default().with(|s| {
        (s.picture.width, s.picture.height) = chance.of(&[(64, 48), (97, 61), (33, 90)]);
        s.picture.exposure_stops = chance.of(&[0.0, 2.0, -3.0]);
        s.picture.render_scale = chance.of(&[1.0, 1.0, 0.7]);
        s.picture.tone_map = chance.of(&[ToneMap::Aces, ToneMap::Linear]);
        s.culling.mode = chance.of(&[Culling::Auto, Culling::Frustum, Culling::Occlusion]);
        s.geometry.path = chance.of(&[Geometry::Gbuffer, Geometry::Visibility]);
        lighting(chance, s);
        s.antialiasing.mode = chance.of(&[
            Antialiasing::None,
            Antialiasing::Msaa,
            Antialiasing::None,
            Antialiasing::Ssaa,
        ]);
        s.antialiasing.samples = chance.of(&[4, 4, 9, 8]);
        s.antialiasing.pattern = chance.of(&[SamplePattern::Grid, SamplePattern::Rotated]);
        if s.antialiasing.samples == 9 {
            s.antialiasing.pattern = SamplePattern::Grid;
        } else if s.antialiasing.samples == 8 {
            s.antialiasing.pattern = SamplePattern::Rotated;
        }
        s.antialiasing.edge_test = chance.of(&[EdgeTest::Surface, EdgeTest::Paper]);
        s.shading.mode = chance.of(&[Shading::Full, Shading::Coarse, Shading::Variable]);
        s.rate.force = true;
        s.eye.quality_jod = chance.of(&[9.5, 8.0, 10.0]);
        s.eye.display = chance.of(&[Display::Camera, Display::Fhd24, Display::Degrees(110.0)]);
        s.eye.gaze = chance.of(&[[0.5, 0.5], [0.0, 1.0], [0.8, 0.3]]);
        coarse(chance, s);
        s.variable.blocks_4x4 = chance.of(&[false, true]);
        s.variable.contrast = chance.of(&[Contrast::Quad, Contrast::Neighbors, Contrast::Sobel]);
        s.variable.threshold = chance.of(&[0.04, 0.0, 0.3]);
        s.stereo.mode = chance.of(&[Stereo::Off, Stereo::Off, Stereo::Instanced]);
        s.stereo.output = chance.of(&[
            Output::Flat,
            Output::SideBySide,
            Output::Headset,
            Output::Anaglyph,
        ]);
        s.stereo.ipd_m = chance.of(&[0.063, 0.2]);
    })
}

fn lighting(chance: &mut Chance<'_>, s: &mut Settings) {
    let s = &mut s.lighting;
    s.shadow_atlas = 512;
    s.shadows = chance.of(&[Shadows::Off, Shadows::Soft, Shadows::Hard, Shadows::Contact]);
    s.shadow_texel_px = chance.of(&[2.0, 0.5, 8.0]);
    s.shadow_sizes = chance.of(&[ShadowSizes::View, ShadowSizes::Rate]);
    s.light_radius_m = chance.of(&[0.05, 0.4]);
    s.environment = chance.of(&[
        EnvironmentSource::Scene,
        EnvironmentSource::Sky,
        EnvironmentSource::None,
    ]);
    s.environment_intensity = chance.of(&[1.0, 3.0]);
    s.background = chance.of(&[
        Background::Environment,
        Background::Blurred,
        Background::None,
    ]);
    s.ambient_occlusion = chance.of(&[AmbientOcclusion::Off, AmbientOcclusion::Screen]);
    s.model = chance.of(&[LightingModel::Ggx, LightingModel::BlinnPhong]);
    s.multiple_scattering = chance.of(&[true, false]);
    s.assignment = chance.of(&[LightAssignment::Clustered, LightAssignment::Brute]);
    s.pass = chance.of(&[LightingPass::Fragment, LightingPass::Compute]);
}

fn coarse(chance: &mut Chance<'_>, s: &mut Settings) {
    let s = &mut s.coarse;
    s.backend = chance.of(&[CoarseBackend::Compute, CoarseBackend::Stencil]);
    s.composite = chance.of(&[
        Composite::Light,
        Composite::Light,
        Composite::Smooth,
        Composite::Paper,
        Composite::Nearest,
    ]);
    s.history = chance.of(&[true, false]);
    s.source = chance.of(&[
        RateSource::Foveated,
        RateSource::Radii,
        RateSource::Constant,
        RateSource::Content,
    ]);
    s.other_source = chance.of(&[RateSource::Constant, RateSource::Radii]);
    s.combine = chance.of(&[RateCombine::First, RateCombine::Coarser, RateCombine::Finer]);
    s.constant_level = chance.of(&[0, 2, 8]);
    s.coarsest_level = chance.of(&[8, 0, 3]);
    s.balance = chance.of(&[true, false]);
    s.refine_edges = chance.of(&[
        RefineEdges::Graded,
        RefineEdges::Inner,
        RefineEdges::Everywhere,
        RefineEdges::Off,
    ]);
    s.sample = chance.of(&[CoarseSample::Center, CoarseSample::Typical]);
}
