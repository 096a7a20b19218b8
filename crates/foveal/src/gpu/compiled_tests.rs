//! Renderers that find what they need compiled.

use super::Gpu;
use crate::testing::{picture, rendered_on, small};
use crate::{Shading, Shadows};

#[test]
fn a_second_renderer_compiles_nothing_and_draws_the_same() {
    let gpu = pollster::block_on(Gpu::open(None)).expect("the tests need a graphics adapter");
    let scene = foveal_generate::by_name("alpha").expect("it is generated");
    let settings = small(48, 32).with(|s| {
        s.shading.mode = Shading::Coarse;
        s.lighting.shadows = Shadows::Soft;
        s.lighting.shadow_atlas = 256;
    });
    let draw = || rendered_on(&gpu, &scene, &scene.cameras[0], &settings);
    let first = picture(&draw());
    let made = gpu.compiled.sizes();
    assert!(made.iter().all(|&n| n > 5), "{made:?}");
    assert!(picture(&draw()) == first);
    assert_eq!(gpu.compiled.sizes(), made);
    gpu.trim();
    assert_eq!(gpu.compiled.sizes(), [0; 5]);
    assert!(picture(&draw()) == first);
    assert_eq!(gpu.compiled.sizes(), made);
}
