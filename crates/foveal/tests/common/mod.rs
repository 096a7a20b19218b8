//! Drawing with the renderer as its users do, and comparing what comes.

use foveal::{Frame, Gpu, Renderer, Settings};
use foveal_scene::Scene;

/// The scene's first camera's picture, after `frames` frames from it.
pub(crate) fn drawn(
    gpu: &Gpu,
    scene: &Scene,
    settings: &Settings,
    frames: u32,
) -> nv_flip::FlipImageRgb8 {
    let camera = &scene.cameras[0];
    let rgba = pollster::block_on(async {
        let mut renderer = Renderer::new(gpu, settings, foveal::RendererOptions::default())
            .await
            .expect("settings fit");
        renderer.set_scene(scene).await.expect("scene fits");
        for _ in 0..frames {
            let frame = Frame::new(camera).with_previous(camera);
            renderer.render(&frame).await.expect("drawn");
        }
        renderer.read_picture().await.expect("read back")
    });
    let pixels = rgba.as_chunks::<4>().0;
    let rgb: Vec<u8> = pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
    let (width, height) = settings.picture_size();
    nv_flip::FlipImageRgb8::with_data(width, height, &rgb)
}

/// Mean FLIP error (Andersson et al. 2020).
pub(crate) fn mean_flip(a: &nv_flip::FlipImageRgb8, b: &nv_flip::FlipImageRgb8) -> f32 {
    let map = nv_flip::flip(a.clone(), b.clone(), nv_flip::DEFAULT_PIXELS_PER_DEGREE);
    nv_flip::FlipPool::from_image(&map).mean()
}
