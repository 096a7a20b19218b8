//! `foveal scene info`: what a scene holds, without drawing it.

use std::fmt::Write;

use foveal_scene::{Camera, Code, LoadOptions, Projection, Scene};
use glam::Vec3;
use serde::Serialize;

use foveal_host::console::grouped;
use foveal_host::import_args::{ImportArgs, code_of};
use foveal_host::{console, scene_source};

/// Arguments of `foveal scene info`.
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// A glTF 2.0, OBJ or PLY file, or a generated scene, as for `foveal render`
    #[arg(default_value = scene_source::DEFAULT_SCENE)]
    scene: String,

    #[command(flatten)]
    import: ImportArgs,

    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

/// Prints what the scene holds.
pub(crate) fn run(args: &Args) -> anyhow::Result<()> {
    let options = LoadOptions {
        check_unused: true,
        ..args.import.options()
    };
    let scene = match scene_source::load_with(&args.scene, &options) {
        Ok(scene) => scene,
        Err(error) => {
            if args.json {
                print_fault(&error)?;
            }
            return Err(error);
        }
    };
    let info = SceneInfo::of(&scene);
    let text = if args.json {
        serde_json::to_string_pretty(&info)? + "\n"
    } else {
        info.text()
    };
    console::print_result(&text)
}

/// What is wrong with a file, as JSON; without a code where the fault is not the file's.
fn print_fault(error: &anyhow::Error) -> anyhow::Result<()> {
    #[derive(Serialize)]
    struct Fault {
        error: Note,
    }
    let fault = Fault {
        error: Note {
            code: code_of(error).map(Code::name),
            text: format!("{error:#}"),
        },
    };
    console::print_result(&(serde_json::to_string_pretty(&fault)? + "\n"))
}

/// A warning or an error; docs/gltf-codes.md lists the codes.
#[derive(Debug, Serialize)]
struct Note {
    code: Option<&'static str>,
    text: String,
}

/// The JSON's fields; docs/program.md describes them.
#[derive(Debug, Serialize)]
struct SceneInfo {
    name: String,
    meshes: usize,
    materials: usize,
    textures: usize,
    texture_texels: u64,
    objects: usize,
    instances: usize,
    triangles: u64,
    lines: u64,
    points: u64,
    vertices: u64,
    lights: usize,
    /// Texels a side of the file's own environment, a cube.
    environment: Option<u32>,
    animated: bool,
    clips: Vec<ClipInfo>,
    /// Names of variants of materials.
    variants: Vec<String>,
    /// Names of the file's scenes.
    file_scenes: Vec<String>,
    /// Metres in world space; `None` without geometry.
    bounds: Option<Bounds>,
    cameras: Vec<CameraInfo>,
    warnings: Vec<Note>,
}

#[derive(Debug, Serialize)]
struct ClipInfo {
    number: usize,
    name: String,
    duration_s: f32,
}

#[derive(Debug, Serialize)]
struct Bounds {
    min: Vec3Json,
    max: Vec3Json,
}

#[derive(Debug, Serialize)]
struct CameraInfo {
    number: usize,
    name: String,
    eye: Vec3Json,
    forward: Vec3Json,
    /// `None` for orthographic cameras.
    fov_y_deg: Option<f32>,
    /// `None` for perspective cameras.
    height_m: Option<f32>,
}

type Vec3Json = [f32; 3];

impl SceneInfo {
    fn of(scene: &Scene) -> Self {
        let bounds = scene.bounds();
        Self {
            name: scene.name.clone(),
            meshes: scene.meshes.len(),
            materials: scene.materials.len(),
            textures: scene.textures.len(),
            texture_texels: scene
                .textures
                .iter()
                .map(|t| u64::from(t.width) * u64::from(t.height))
                .sum(),
            objects: scene.objects.len(),
            instances: scene.instances.len(),
            triangles: scene.triangle_count(),
            lines: scene.line_count(),
            points: scene.point_count(),
            vertices: scene.meshes.iter().map(|m| m.vertices.len() as u64).sum(),
            lights: scene.lights.len(),
            environment: scene.image_light.as_ref().map(|light| light.side),
            animated: scene.is_animated(),
            clips: scene
                .clips()
                .enumerate()
                .map(|(number, (name, duration_s))| ClipInfo {
                    number,
                    name: name.to_owned(),
                    duration_s,
                })
                .collect(),
            variants: scene.variants.clone(),
            file_scenes: scene.file_scenes.clone(),
            bounds: (!bounds.is_empty()).then(|| Bounds {
                min: bounds.min.into(),
                max: bounds.max.into(),
            }),
            cameras: scene
                .cameras
                .iter()
                .enumerate()
                .map(CameraInfo::of)
                .collect(),
            warnings: scene
                .warnings
                .iter()
                .map(|warning| Note {
                    code: Some(warning.code.name()),
                    text: warning.text.clone(),
                })
                .collect(),
        }
    }

    fn text(&self) -> String {
        let mut text = String::new();
        let mut line = |name: &str, value: String| {
            let _ = writeln!(text, "{name:10} {}", foveal_scene::printable(&value));
        };
        let count = |n: usize| grouped(n as u64);
        line("scene", self.name.clone());
        line(
            "objects",
            format!(
                "{}, {} instances",
                count(self.objects),
                count(self.instances)
            ),
        );
        line("triangles", grouped(self.triangles));
        for (name, count) in [("lines", self.lines), ("points", self.points)] {
            if count > 0 {
                line(name, grouped(count));
            }
        }
        line(
            "meshes",
            format!(
                "{}, {} vertices",
                count(self.meshes),
                grouped(self.vertices)
            ),
        );
        line("materials", count(self.materials));
        line(
            "textures",
            format!(
                "{}, {} texels",
                count(self.textures),
                grouped(self.texture_texels)
            ),
        );
        line("lights", count(self.lights));
        if let Some(side) = self.environment {
            line("around", format!("6 x {side} x {side} texels"));
        }
        line(
            "animated",
            if self.animated { "yes" } else { "no" }.to_owned(),
        );
        for ClipInfo {
            number,
            name,
            duration_s,
        } in &self.clips
        {
            let title = if *number == 0 { "clips" } else { "" };
            line(title, format!("{number}: '{name}', {duration_s:.3} s"));
        }
        for (number, name) in self.variants.iter().enumerate() {
            let title = if number == 0 { "variants" } else { "" };
            line(title, format!("{number}: '{name}'"));
        }
        // One alone need not be chosen.
        for (number, name) in self.file_scenes.iter().enumerate() {
            let title = if number == 0 { "scenes" } else { "" };
            if self.file_scenes.len() > 1 {
                line(title, format!("{number}: '{name}'"));
            }
        }
        match &self.bounds {
            Some(Bounds { min, max }) => {
                line("bounds", format!("{} to {} m", point(*min), point(*max)))
            }
            None => line("bounds", "none: there is no geometry".to_owned()),
        }
        for camera in &self.cameras {
            line(
                if camera.number == 0 { "cameras" } else { "" },
                camera.text(),
            );
        }
        if self.cameras.is_empty() {
            line("cameras", "none".to_owned());
        }
        for (i, warning) in self.warnings.iter().enumerate() {
            let label = if i == 0 { "warnings" } else { "" };
            line(
                label,
                format!("{} [{}]", warning.text, warning.code.unwrap_or_default()),
            );
        }
        text
    }
}

impl CameraInfo {
    fn of((number, camera): (usize, &Camera)) -> Self {
        let (fov_y_deg, height_m) = match camera.projection {
            Projection::Perspective { fov_y_rad, .. } => (Some(fov_y_rad.to_degrees()), None),
            Projection::Orthographic { height_m, .. } => (None, Some(height_m)),
        };
        Self {
            number,
            name: camera.name.clone(),
            eye: camera.eye().into(),
            forward: (-camera.world_from_view.z_axis.truncate())
                .normalize_or_zero()
                .into(),
            fov_y_deg,
            height_m,
        }
    }

    fn text(&self) -> String {
        let opening = match (self.fov_y_deg, self.height_m) {
            (Some(degrees), _) => format!("{degrees:.1}° high"),
            (None, Some(metres)) => format!("orthographic, {metres:.3} m high"),
            (None, None) => String::new(),
        };
        format!(
            "{}: '{}' at {}, looking {}, {opening}",
            self.number,
            self.name,
            point(self.eye),
            point(self.forward)
        )
    }
}

/// As the flags take it: x,y,z.
fn point(point: Vec3Json) -> String {
    let [x, y, z] = Vec3::from(point).to_array().map(|v| {
        let text = format!("{v:.3}");
        let text = text.trim_end_matches('0').trim_end_matches('.');
        if text == "-0" {
            "0".to_owned()
        } else {
            text.to_owned()
        }
    });
    format!("{x},{y},{z}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_read_as_the_flags_take_them() {
        assert_eq!(point([1.0, -2.5, -0.00001]), "1,-2.5,0");
        assert_eq!(
            foveal_host::values::vec3(&point([100.0, 0.125, 3.0])),
            Ok(Vec3::new(100.0, 0.125, 3.0))
        );
    }

    #[test]
    fn an_empty_scene_has_no_bounds() {
        let info = SceneInfo::of(&Scene::default());
        assert!(info.bounds.is_none() && info.text().contains("no geometry"));
    }
}
