//! Import of glTF 2.0 files.
//!
//! [`import`] tells the story: container, JSON, checked document, buffers, materials, geometry,
//! textures, then nodes to objects, cameras and lights, and the rig for what moves. Nothing here
//! opens files; what the file names is asked of a resolver.

mod accessor;
mod animations;
mod basis;
mod budget;
mod buffers;
mod cameras;
mod container;
mod document;
mod draco;
mod extensions;
mod geometry;
mod image_lights;
mod images;
mod json;
mod lights;
mod lobes;
mod materials;
mod meshes;
mod meshopt;
mod morphs;
mod nodes;
mod normals;
mod objects;
mod parts;
mod pictures;
mod pointers;
mod reader;
mod rigging;
mod skins;
mod slots;
mod tangents;
mod textures;
mod topology;
mod unused;
mod uri;
mod wanted;

#[cfg(test)]
mod tests;

pub(crate) use budget::Budget;
pub(crate) use cameras::rigid;
#[cfg(not(target_arch = "wasm32"))]
pub(crate) use container::BYTE_ORDER_MARK;
pub(crate) use lights::place as place_light;
pub(crate) use nodes::{all_the_way_up, rotation};
pub(crate) use normals::plane_normal;

use std::collections::{HashMap, HashSet};
use std::panic::{AssertUnwindSafe, catch_unwind};

use buffers::Buffers;
use document::Document;
use glam::Mat4;
use json::Obj;
use nodes::Hierarchy;
use parts::Geometry;
use reader::Reader;
use wanted::Wanted;

use crate::error::{Flaw, FlawKind, Parsed};
use crate::timings::Stopwatch;
use crate::{Clip, Code, LoadOptions, Material, Scene, SceneError, Warning};

/// Gives the bytes of an external file by its path, or the reason why not.
pub(crate) type Resolver<'a> = dyn Fn(&str) -> Result<Vec<u8>, String> + Sync + 'a;

/// More warnings than this say no more.
const MAX_WARNINGS: usize = 100;

/// Reads a whole file. `file` is its name for messages, `warn` what is known of it before.
pub(crate) fn import(
    bytes: &[u8],
    file: &str,
    warn: Vec<Warning>,
    options: &LoadOptions,
    resolver: &Resolver<'_>,
) -> Result<Scene, SceneError> {
    // The last net. Bad input is found by checks; what slips through must still not end the
    // program.
    catch_unwind(AssertUnwindSafe(|| {
        import_checked(bytes, file, warn, options, resolver)
    }))
    .unwrap_or_else(|panic| {
        let text = panic
            .downcast_ref::<String>()
            .map(String::as_str)
            .or_else(|| panic.downcast_ref::<&str>().copied());
        Err(SceneError::Internal {
            file: file.to_owned(),
            cause: text.unwrap_or("no message").to_owned(),
        })
    })
}

fn import_checked(
    bytes: &[u8],
    file: &str,
    mut warn: Vec<Warning>,
    options: &LoadOptions,
    resolver: &Resolver<'_>,
) -> Result<Scene, SceneError> {
    let not_gltf = |cause: String| SceneError::NotGltf {
        file: file.to_owned(),
        cause,
    };
    let mut watch = Stopwatch::start();
    let container = container::split(bytes).map_err(not_gltf)?;
    let mut root = serde_json::from_slice(container.json)
        .map_err(|e| not_gltf(format!("its JSON is broken: {e}")))?;
    warn.extend(container.notes);
    let file_scenes = scene_names(&root);
    if let Some(wanted) = &options.file_scene {
        root["scene"] = chosen("scene", wanted, &file_scenes)
            .map_err(|e| e.in_file(file))?
            .into();
    }
    // Before they are read, with what is known of the files so far.
    let known = Budget::new(bytes.len() as u64, options);
    materials::take_memory(Obj::of(&root).map_or(0, |o| o.len_of("materials")), &known)
        .map_err(|e| e.in_file(file))?;
    let mut document = Document::parse(&root, &mut warn).map_err(|e| e.in_file(file))?;
    if let Some(variant) = &options.variant {
        document
            .choose_variant(variant)
            .map_err(|e| e.in_file(file))?;
    }
    // Freeing a large JSON tree takes as long as using it: give it back before the vertices come.
    drop(root);
    let parse_ms = watch.lap_ms();
    let mut buffers = Buffers::fetch(
        &document.buffers,
        container.json.len(),
        container.bin,
        options,
        resolver,
    );
    warn.extend(buffers.faults().map(Flaw::warning));
    let read_ms = watch.lap_ms();
    buffers
        .decompress(&document, options.parallel)
        .map_err(|e| e.in_file(file))?;
    let decompress_ms = watch.lap_ms();
    let reader = Reader {
        document: &document,
        buffers: &buffers,
    };
    let mut scene = build(reader, resolver, options, &mut warn).map_err(|e| e.in_file(file))?;
    file.clone_into(&mut scene.name);
    scene.timings.parse_ms += parse_ms;
    scene.timings.read_ms += read_ms;
    scene.timings.geometry_ms += decompress_ms;
    scene.variants.clone_from(&document.variants);
    scene.file_scenes = file_scenes;
    scene.warnings = limited(warn);
    Ok(scene)
}

/// Each warning once, and not more than anyone reads.
fn limited(mut warnings: Vec<Warning>) -> Vec<Warning> {
    let mut seen = HashSet::new();
    warnings.retain(|warning| seen.insert(warning.clone()));
    if warnings.len() > MAX_WARNINGS {
        let more = warnings.len() - MAX_WARNINGS;
        warnings.truncate(MAX_WARNINGS);
        warnings.push(Warning::new(
            Code::MoreWarnings,
            format!("{more} more warnings are not listed"),
        ));
    }
    warnings
}

/// From the checked document to the scene.
fn build(
    reader: Reader<'_>,
    resolver: &Resolver<'_>,
    options: &LoadOptions,
    warn: &mut Vec<Warning>,
) -> Parsed<Scene> {
    let mut watch = Stopwatch::start();
    let mut scene = Scene::default();
    let document = reader.document;
    let hierarchy = Hierarchy::of(document, warn)?;
    let budget = &reader.buffers.budget;
    materials::take_memory(document.materials.len(), budget)?;
    cameras::take_memory(&document.nodes, &hierarchy.reached, budget)?;

    let mut wanted = Wanted::default();
    scene.materials = document
        .materials
        .iter()
        .map(|def| wanted.material(def, document))
        .collect();
    warn_of_uv_sets(document, warn);
    warn_of_lobes(&scene.materials, warn);
    scene.timings.parse_ms = watch.lap_ms();

    let mut geometry = Geometry::default();
    let mut shown = geometry.request(reader, &hierarchy, options, &mut scene)?;
    let shapes = geometry.build(reader, options, &mut scene, warn)?;
    objects::check_elements(&shown, reader)?;
    let mut elements_left = options.max_instances;
    for one in &mut shown {
        let instancing = document.nodes[one.node as usize].instancing;
        let mut notes = Vec::new();
        let place = |flaw: Flaw| objects::in_instancing(flaw, one.node);
        let left = &mut elements_left;
        let elements = objects::elements(instancing, reader, left, options, &mut notes);
        one.elements = elements.map_err(place)?;
        warn.extend(notes.into_iter().map(|note| place(note).warning()));
    }
    let shapes = parts::drop_empty_meshes(&mut shown, shapes, &mut scene);
    if shown.is_empty() {
        warn.push(Warning::new(
            Code::SceneEmpty,
            "the scene shows no triangles, lines or points",
        ));
    }
    let mut rig = rigging::Rigging::begin(reader, &hierarchy, &shown, options, warn)?;
    rig.give_own_meshes(&mut shown, &shapes, &mut scene, reader, options, warn)?;
    scene.timings.geometry_ms = watch.lap_ms();

    scene.textures = textures::decode(&wanted, &scene.materials, reader, resolver, options, warn)?;
    image_lights::decode(&mut scene, reader, resolver, options, warn)?;
    if options.check_unused {
        unused::check(reader, resolver, options, &hierarchy, &wanted, warn);
    }
    scene.timings.decode_ms = watch.lap_ms();

    let world = rig.world_at_rest();
    let placed = objects::place(
        &shown,
        &document.nodes,
        &world,
        &scene.meshes,
        options,
        warn,
    )?;
    scene.objects = placed.objects;
    scene.instances = placed.instances;
    name_objects(&mut scene, document);
    let mut carriers = place_cameras_and_lights(&mut scene, document, &hierarchy, &world, warn);
    carriers.materials = geometry.copies;
    rig.finish(&mut scene, document, &shown, &placed.clouds, &carriers);
    scene.show(&hierarchy.visible);
    choose_clip(&mut scene, &options.clip)?;
    scene.keep_rest();
    scene.pose(options.time_s);
    scene.timings.bounds_ms = watch.lap_ms();
    Ok(scene)
}

/// Plays what the options ask for.
fn choose_clip(scene: &mut Scene, clip: &Clip) -> Parsed<()> {
    if scene.play(clip) {
        return Ok(());
    }
    let names = scene
        .clips()
        .enumerate()
        .map(|(i, (name, _))| format!("{i} '{name}'"));
    Err(no_such("clip", clip, names.collect()).under("animations"))
}

/// The scenes' names, as far as they can be read; what is wrong with them is found later.
fn scene_names(root: &serde_json::Value) -> Vec<String> {
    let scenes = root.get("scenes").and_then(serde_json::Value::as_array);
    let name = |scene: &serde_json::Value| {
        let name = scene.get("name").and_then(serde_json::Value::as_str);
        name.unwrap_or_default().to_owned()
    };
    scenes.into_iter().flatten().map(name).collect()
}

/// The number of what is asked for by name, or else by number.
fn chosen(what: &str, wanted: &str, names: &[String]) -> Parsed<usize> {
    let named = names.iter().position(|name| name == wanted);
    let numbered = || wanted.parse().ok().filter(|n| *n < names.len());
    named.or_else(numbered).ok_or_else(|| {
        let known = names.iter().enumerate();
        let known = known.map(|(i, name)| format!("{i} '{name}'"));
        no_such(what, wanted, known.collect())
    })
}

/// The fault of asking for what a file does not have.
fn no_such(what: &str, wanted: impl std::fmt::Display, known: Vec<String>) -> Flaw {
    let known = if known.is_empty() {
        "none".to_owned()
    } else {
        known.join(", ")
    };
    let mut flaw = Flaw::new(
        Code::NotInFile,
        format!("{what} '{wanted}'; there are: {known}"),
    );
    flaw.kind = FlawKind::Absent;
    flaw
}

fn warn_of_uv_sets(document: &Document, warn: &mut Vec<Warning>) {
    for (i, def) in document.materials.iter().enumerate() {
        if def.uv_sets().1 {
            warn.push(Warning::new(Code::TexcoordsTooMany, format!(
                "materials[{i}]: reads more than two sets of texture coordinates; the others read the first"
            )));
        }
    }
}

fn warn_of_lobes(materials: &[Material], warn: &mut Vec<Warning>) {
    for (i, material) in materials.iter().enumerate() {
        let slots = material.lobe_textures().into_iter().flatten();
        let textures: std::collections::BTreeSet<u32> = slots.map(|slot| slot.texture).collect();
        if textures.len() > Material::MAX_LOBE_TEXTURES {
            let text = format!(
                "materials[{i}]: its clear coat, sheen, anisotropy, iridescence and transmission read {} textures; the first {} are read",
                textures.len(),
                Material::MAX_LOBE_TEXTURES
            );
            warn.push(Warning::new(Code::MaterialIgnored, text));
        }
    }
}

/// Objects without a name take their mesh's.
fn name_objects(scene: &mut Scene, document: &Document) {
    for object in &mut scene.objects {
        if object.name.is_empty() {
            let node = &document.nodes[object.node as usize];
            let mesh = node
                .mesh
                .and_then(|m| document.meshes[m as usize].name.clone());
            object.name = mesh
                .filter(|n| !n.is_empty())
                .unwrap_or_else(|| format!("node {}", object.node));
        }
    }
}

/// Nodes of the scene's cameras, and numbers of cameras, lights and materials in the file.
#[derive(Default)]
struct Carriers {
    /// Of each camera: its node, and its number.
    cameras: Vec<(u32, u32)>,
    /// Of each light: its number.
    lights: Vec<u32>,
    /// Of each copied material: its number, and the copy's.
    materials: HashMap<u32, u32>,
}

/// Places the cameras of all nodes that the scene reaches, and the lights of those that are shown:
/// KHR_node_visibility hides no camera.
fn place_cameras_and_lights(
    scene: &mut Scene,
    document: &Document,
    hierarchy: &Hierarchy,
    world: &[Mat4],
    warn: &mut Vec<Warning>,
) -> Carriers {
    let mut carriers = Carriers::default();
    let nodes = document.nodes.iter().enumerate();
    for (i, node) in nodes.filter(|(i, _)| hierarchy.reached[*i]) {
        if let Some(camera) = node.camera {
            let def = &document.cameras[camera as usize];
            match &def.projection {
                Ok(projection) => {
                    let number = scene.cameras.len();
                    let placed = def.place(*projection, node.name.as_deref(), number, world[i]);
                    scene.cameras.push(placed);
                    carriers.cameras.push((i as u32, camera));
                }
                Err(flaw) => warn.push(
                    flaw.warning()
                        .within(format_args!("cameras[{camera}]"))
                        .and("this camera is left out"),
                ),
            }
        }
        if let Some(light) = node.light.filter(|_| hierarchy.shown[i]) {
            match &document.lights[light as usize].light {
                Ok(found) => {
                    let mut placed = found.clone();
                    placed.node = Some(i as u32);
                    place_light(&mut placed, world[i]);
                    scene.lights.push(placed);
                    carriers.lights.push(light);
                }
                Err(flaw) => warn.push(
                    flaw.warning()
                        .within(format_args!(
                            "extensions.KHR_lights_punctual.lights[{light}]"
                        ))
                        .and("this light is left out"),
                ),
            }
        }
    }
    carriers
}
