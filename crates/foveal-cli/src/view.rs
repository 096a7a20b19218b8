//! `foveal view`: the window, with the program's scenes, files and flags behind it.

mod folders;
mod recordings;

use foveal_generate as generate;
use foveal_scene::{Clip, Scene};
use foveal_view::{Host, Loaded};

use foveal_host::camera::{CameraArgs, Viewpoint};
use foveal_host::environment::environment;
use foveal_host::failure::usage;
use foveal_host::import_args::ImportArgs;
use foveal_host::rate_image::rate_image;
use foveal_host::settings::{SettingsArgs, flags, read as read_settings};
use foveal_host::{atomic_file, command_line, gpu, scene_source, values};

/// Arguments of `foveal view`.
#[derive(Debug, clap::Args)]
#[command(after_help = foveal_view::keys_help())]
pub(crate) struct Args {
    /// A glTF 2.0, OBJ or PLY file, or a generated scene, as for `foveal render`
    #[arg(default_value = scene_source::DEFAULT_SCENE)]
    scene: String,

    #[command(flatten)]
    camera: CameraArgs,

    /// Number of coloured point lights to add to the scene
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::point_lights)]
    point_lights: u32,

    /// Graphics adapter: part of its name, or its number in `foveal adapters`
    #[arg(long, value_name = "NAME|NUMBER")]
    adapter: Option<String>,

    /// Size of the window in pixels, at most 16384 a side; it opens at no less than 960x540 points
    #[arg(long, value_name = "WxH", value_parser = values::window, default_value = "1280x720")]
    window: (u32, u32),

    #[command(flatten)]
    import: ImportArgs,

    #[command(flatten)]
    settings: SettingsArgs,
}

/// Opens the window and stays until it is closed.
pub(crate) fn run(args: &Args) -> anyhow::Result<()> {
    foveal_view::run(host(args)?)
}

fn host(args: &Args) -> anyhow::Result<Host> {
    refuse_stdin(&args.scene)?;
    args.camera.check()?;
    let (settings, is_sized) = args.settings.resolve_sized()?;
    gpu::check(args.adapter.as_deref())?;
    let (first, camera) = (args.scene.clone(), args.camera.clone());
    let point_lights = args.point_lights;
    let options = args.import.options();
    let (shown, adapter) = (clipless(args.import.shown_flags()), args.adapter.clone());
    let named = first.clone();
    let reading = args.import.reading_flags();
    let scene_flags = move |name: &str| {
        let mut flags = if name == named {
            shown.clone()
        } else {
            Vec::new()
        };
        flags.extend(reading.iter().cloned());
        if point_lights > 0 {
            flags.extend(["--point-lights".to_owned(), point_lights.to_string()]);
        }
        if let Some(adapter) = &adapter {
            flags.extend(["--adapter".to_owned(), adapter.clone()]);
        }
        flags
    };
    let load = move |name: &str| {
        refuse_stdin(name)?;
        // What was asked for by name holds for the first scene; limits hold for all.
        let mut options = options.clone();
        if name != first {
            options.clip = Clip::default();
            options.variant = None;
            options.file_scene = None;
        }
        let scene = scene_source::load_with(name, &options)?;
        let camera = if name == first {
            camera.clone()
        } else {
            CameraArgs::default()
        };
        let camera = Viewpoint::choose(&camera, &scene, name)?.at(&scene, 0.0);
        let clip = scene.find_clip(&options.clip).unwrap_or_default();
        foveal_host::memory::give_back();
        Ok(Loaded {
            scene,
            camera,
            clip,
        })
    };
    let light = move |scene: &mut Scene| {
        if point_lights > 0 {
            scene_source::add_point_lights(scene, point_lights, 0);
        }
        scene.light_by_default();
    };
    Ok(Host {
        scene: args.scene.clone(),
        generated: generate::NAMES.map(str::to_owned).to_vec(),
        fit: !is_sized,
        settings,
        adapter: args.adapter.clone(),
        window: args.window,
        load: Box::new(load),
        light: Box::new(light),
        files: Box::new(folders::Folders::new()),
        record: Box::new(recordings::start),
        no_video: recordings::no_video(),
        read_settings,
        write_file: atomic_file::write,
        rate_image,
        environment,
        flags,
        exact_camera: command_line::exact_camera,
        read_camera: |text| values::exact_camera(text).ok(),
        quoted: command_line::quoted,
        scene_flags: Box::new(scene_flags),
    })
}

/// Standard input may never end, and the window would wait for it.
fn refuse_stdin(scene: &str) -> anyhow::Result<()> {
    if scene == scene_source::STDIN {
        return usage("a window does not read its scene from standard input; name a file");
    }
    Ok(())
}

/// Flags without `--clip`: the window says which one plays.
fn clipless(flags: Vec<String>) -> Vec<String> {
    let mut rest = Vec::new();
    let mut flags = flags.into_iter();
    while let Some(flag) = flags.next() {
        if flag == "--clip" {
            flags.next();
        } else {
            rest.push(flag);
        }
    }
    rest
}

#[cfg(test)]
mod tests;
