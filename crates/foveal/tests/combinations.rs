//! Every way of shading with every anti-aliasing, over both geometries, for one eye and for two:
//! nothing is refused, and all draw nearly what full shading of the same kind draws.
#![allow(clippy::print_stdout, reason = "a test says what it measured")]

mod common;

use common::{drawn, mean_flip};
use foveal::{
    AmbientOcclusion, Antialiasing, EnvironmentSource, Geometry, Gpu, Output, RateSource, Settings,
    Shading, Shadows, Stereo,
};
use foveal_generate as generate;

/// Until rates that follow the picture have settled.
const FRAMES: u32 = 4;

/// All shadings and geometries for one anti-aliasing.
fn compare(aa: Antialiasing, stereo: Stereo, shadows: Shadows) {
    compare_in(EnvironmentSource::Gradient, aa, stereo, shadows);
}

/// The same in another environment.
fn compare_in(environment: EnvironmentSource, aa: Antialiasing, stereo: Stereo, shadows: Shadows) {
    let gpu = pollster::block_on(Gpu::open(None)).expect("the tests need a graphics adapter");
    let mut scene = generate::cornell();
    generate::add_point_lights(&mut scene, 8, 3);
    let plain = Settings::default().with(|s| {
        s.picture.width = 160;
        s.picture.height = 90;
        s.antialiasing.mode = aa;
        s.lighting.shadows = shadows;
        s.lighting.environment = environment;
        // Its own sums differ with the samples, too.
        if environment == EnvironmentSource::Sky {
            s.lighting.ambient_occlusion = AmbientOcclusion::Screen;
        }
        s.stereo.mode = stereo;
        s.stereo.output = match stereo {
            Stereo::Off => Output::Flat,
            _ => Output::SideBySide,
        };
    });
    let reference = drawn(&gpu, &scene, &plain, FRAMES);
    for geometry in [Geometry::Gbuffer, Geometry::Visibility] {
        for shading in [Shading::Full, Shading::Coarse, Shading::Variable] {
            let settings = plain.clone().with(|s| {
                s.geometry.path = geometry;
                s.shading.mode = shading;
                s.coarse.source = match shading {
                    Shading::Variable => RateSource::Content,
                    _ => RateSource::Foveated,
                };
                s.rate.force = true;
                // Blocks as large as 4 x 4: the picture is small.
                s.coarse.coarsest_level = 2;
            });
            let error = mean_flip(&reference, &drawn(&gpu, &scene, &settings, FRAMES));
            println!("{geometry:?}, {shading:?}, {aa:?}, {stereo:?}, {shadows:?}: {error:.4}");
            // Over a visibility buffer a pixel's materials are averaged by surface, not by
            // sub-sample.
            let most = match shading {
                Shading::Full => 0.003,
                Shading::Coarse => 0.045,
                Shading::Variable => 0.02,
            };
            assert!(
                error <= most,
                "{geometry:?}, {shading:?}, {aa:?}, {stereo:?}: {error}"
            );
        }
    }
}

#[test]
fn all_shadings_without_antialiasing() {
    compare(Antialiasing::None, Stereo::Off, Shadows::Off);
}

#[test]
fn all_shadings_with_msaa() {
    compare(Antialiasing::Msaa, Stereo::Off, Shadows::Off);
}

#[test]
fn all_shadings_with_ssaa() {
    compare(Antialiasing::Ssaa, Stereo::Off, Shadows::Off);
}

#[test]
fn all_shadings_for_two_eyes() {
    compare(Antialiasing::None, Stereo::Instanced, Shadows::Off);
}

#[test]
fn all_shadings_for_two_eyes_with_msaa() {
    compare(Antialiasing::Msaa, Stereo::Instanced, Shadows::Off);
}

#[test]
fn all_shadings_with_shadows() {
    compare(Antialiasing::None, Stereo::Off, Shadows::Soft);
}

#[test]
fn all_shadings_for_two_eyes_with_msaa_and_shadows() {
    compare(Antialiasing::Msaa, Stereo::Instanced, Shadows::Soft);
}

#[test]
fn all_shadings_in_a_filtered_sky_with_ambient_occlusion() {
    let sky = EnvironmentSource::Sky;
    compare_in(sky, Antialiasing::None, Stereo::Off, Shadows::Off);
}

#[test]
fn all_shadings_for_two_eyes_with_msaa_in_a_filtered_sky_with_ambient_occlusion() {
    let sky = EnvironmentSource::Sky;
    compare_in(sky, Antialiasing::Msaa, Stereo::Instanced, Shadows::Off);
}
