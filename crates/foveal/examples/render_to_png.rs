//! Renders a scene headless: `cargo run --release -p foveal --example render_to_png -- cornell
//! out.png`. The scene is a glTF file or the name of a generated one.

#![allow(clippy::print_stdout, reason = "an example says what it made")]

use foveal::{Frame, Gpu, Renderer, Settings};
use foveal_generate as generate;
use foveal_scene::LoadOptions;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "cornell".to_owned());
    let path = arguments.next().unwrap_or_else(|| "out.png".to_owned());
    pollster::block_on(async {
        let file = std::path::Path::new(&name);
        let mut scene = if file.exists() {
            foveal_scene::load(file, &LoadOptions::default())?
        } else {
            generate::by_name(&name)?
        };
        scene.light_by_default();
        let camera = scene
            .cameras
            .first()
            .cloned()
            .unwrap_or_else(|| scene.overview_camera());
        let settings = Settings::default().with(|s| {
            s.picture.width = 960;
            s.picture.height = 540;
        });

        let gpu = Gpu::open(None).await?;
        let mut renderer =
            Renderer::new(&gpu, &settings, foveal::RendererOptions::default()).await?;
        renderer.set_scene(&scene).await?;
        let stats = renderer.render(&Frame::new(&camera)).await?;
        let pixels = renderer.read_picture().await?;

        image::save_buffer(
            &path,
            &pixels,
            settings.picture.width,
            settings.picture.height,
            image::ColorType::Rgba8,
        )?;
        println!(
            "{path}: {} draws, {} triangles",
            stats.draws, stats.triangles
        );
        for pass in &stats.gpu_ms {
            println!("{:>20} {:8.2} ms", pass.name, pass.ms);
        }
        Ok(())
    })
}
