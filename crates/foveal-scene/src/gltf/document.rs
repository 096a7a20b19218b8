//! The checked document: every index that another part uses is known to be in range.
//!
//! Reading is strict about types and references and lenient about everything else that does not
//! stand in the way of a picture (empty arrays, missing `min`/`max`, undeclared extensions).

use std::collections::HashSet;

use serde_json::Value;

use super::accessor::Accessor;
use super::animations::AnimationDef;
use super::cameras::CameraDef;
use super::draco::DracoDef;
use super::images::{ImageDef, TextureDef};
use super::json::Obj;
use super::lights::LightDef;
use super::materials::MaterialDef;
use super::meshes::MeshDef;
use super::meshopt::Coded;
use super::nodes::NodeDef;
use super::skins::SkinDef;
use crate::error::{Flaw, Parsed};
use crate::pose::{MaterialPart, Target, UvPart};
use crate::{Code, Sampler, Warning};

/// How many of each thing there are; references are checked against these.
pub(crate) struct Counts {
    pub(crate) views: usize,
    pub(crate) accessors: usize,
    pub(crate) images: usize,
    pub(crate) samplers: usize,
    pub(crate) textures: usize,
    pub(crate) materials: usize,
    pub(crate) meshes: usize,
    pub(crate) skins: usize,
    pub(crate) cameras: usize,
    pub(crate) nodes: usize,
    pub(crate) scenes: usize,
    pub(crate) lights: usize,
    pub(crate) variants: usize,
}

/// A buffer before its bytes are fetched.
pub(crate) struct BufferDef {
    pub(crate) uri: Option<String>,
    pub(crate) len: u64,
    /// Only for readers that know nothing of compression; it may have no bytes.
    pub(crate) fallback: bool,
}

/// A slice of a buffer, known to lie within the buffer's declared length.
pub(crate) struct View {
    pub(crate) buffer: u32,
    pub(crate) offset: u64,
    pub(crate) len: u64,
    pub(crate) stride: Option<u64>,
    /// How its bytes are compressed, where they are.
    pub(crate) coded: Option<Coded>,
}

/// All parts of a glTF file, in the file's order.
pub(crate) struct Document {
    pub(crate) buffers: Vec<BufferDef>,
    pub(crate) views: Vec<View>,
    pub(crate) accessors: Vec<Accessor>,
    pub(crate) images: Vec<ImageDef>,
    pub(crate) samplers: Vec<Sampler>,
    pub(crate) textures: Vec<TextureDef>,
    pub(crate) materials: Vec<MaterialDef>,
    pub(crate) meshes: Vec<MeshDef>,
    pub(crate) skins: Vec<SkinDef>,
    pub(crate) cameras: Vec<CameraDef>,
    pub(crate) lights: Vec<LightDef>,
    pub(crate) nodes: Vec<NodeDef>,
    pub(crate) animations: Vec<AnimationDef>,
    /// Names of variants of materials.
    pub(crate) variants: Vec<String>,
    /// Root nodes of the scene to show.
    pub(crate) roots: Vec<u32>,
    /// The environment of the scene to show.
    pub(crate) image_light: super::image_lights::Chosen,
}

impl Document {
    /// Reads the document; `warn` takes what is odd but harmless.
    pub(crate) fn parse(root: &Value, warn: &mut Vec<Warning>) -> Parsed<Self> {
        let file = root;
        let root = Obj::of(root)?;
        check_version(root)?;
        super::extensions::check(root, warn)?;
        let lights = root.extension("KHR_lights_punctual")?;
        let variants = parse_variants(root)?;
        let counts = Counts {
            views: root.len_of("bufferViews"),
            accessors: root.len_of("accessors"),
            images: root.len_of("images"),
            samplers: root.len_of("samplers"),
            textures: root.len_of("textures"),
            materials: root.len_of("materials"),
            meshes: root.len_of("meshes"),
            skins: root.len_of("skins"),
            cameras: root.len_of("cameras"),
            nodes: root.len_of("nodes"),
            scenes: root.len_of("scenes"),
            lights: lights.map_or(0, |l| l.len_of("lights")),
            variants: variants.len(),
        };
        let buffers = root.objects("buffers", parse_buffer)?;
        let views = root.objects("bufferViews", |o| parse_view(o, &buffers))?;
        let nodes: Vec<NodeDef> = {
            let mut numbers = 0..;
            root.objects("nodes", |o| {
                let number = numbers.next().unwrap_or(0);
                NodeDef::parse(o, number, &counts, warn)
            })?
        };
        let light_defs = match lights {
            Some(lights) => lights
                .objects("lights", LightDef::parse)
                .map_err(|e| e.under("extensions.KHR_lights_punctual"))?,
            None => Vec::new(),
        };
        let images = root.objects("images", |o| ImageDef::parse(o, &counts))?;
        let mut textures = root.objects("textures", |o| TextureDef::parse(o, &counts))?;
        let first = super::images::first_of_equal(&images, &views);
        for texture in &mut textures {
            texture.image = texture.image.map(|i| first[i as usize]);
        }
        let mut accessors = root.objects("accessors", |o| Accessor::parse(o, &counts))?;
        let mut meshes = root.objects("meshes", |o| MeshDef::parse(o, &counts))?;
        let first = super::accessor::first_of_equal(&accessors);
        for mesh in &mut meshes {
            mesh.renumber_accessors(&first);
        }
        for def in meshes.iter().flat_map(|m| &m.primitives) {
            for accessor in def.draco.iter().flat_map(DracoDef::accessors) {
                let accessor = &mut accessors[accessor as usize];
                accessor.draco = accessor.view.is_none();
            }
        }
        let mut materials = root.objects("materials", |o| MaterialDef::parse(o, &counts))?;
        let animations = {
            let mut numbers = 0..;
            root.each("animations", |value| {
                let number: usize = numbers.next().unwrap_or(0);
                let def = Obj::of(value).and_then(|o| AnimationDef::parse(o, file, &counts));
                Ok(def.unwrap_or_else(|flaw| {
                    let note = flaw.under(format_args!("animations[{number}]")).warning();
                    warn.push(note.and("this animation is not played"));
                    AnimationDef::default()
                }))
            })?
        };
        for pointed in animations.iter().flat_map(AnimationDef::targets) {
            if let Target::Material(part) = pointed.target {
                materials[pointed.number as usize].animate(part);
            }
        }
        for material in &mut materials {
            material.drop_unseen_lobes();
        }
        Ok(Self {
            accessors,
            images,
            samplers: root.objects("samplers", super::images::parse_sampler)?,
            textures,
            materials,
            meshes,
            skins: root.objects("skins", |o| Ok(SkinDef::parse(o, &counts)))?,
            cameras: root.objects("cameras", CameraDef::parse)?,
            animations,
            lights: light_defs,
            variants,
            roots: parse_roots(root, &counts, warn)?,
            image_light: super::image_lights::parse(root, &counts)?,
            buffers,
            views,
            nodes,
        })
    }
}

impl Document {
    /// Gives each primitive the material that it has in a variant, by name or by number.
    pub(crate) fn choose_variant(&mut self, wanted: &str) -> Parsed<()> {
        let number = super::chosen("variant", wanted, &self.variants)?;
        for mesh in &mut self.meshes {
            mesh.choose_variant(number as u32);
        }
        Ok(())
    }

    /// Materials whose generated tangents an animation turns: an offset turns nothing.
    pub(crate) fn turning_materials(&self) -> HashSet<u32> {
        let meshes = self.meshes.iter();
        let pairs = meshes.flat_map(|mesh| mesh.primitives.iter().zip(&mesh.materials));
        let generated = pairs.filter(|(primitive, _)| !primitive.has_tangents());
        let generated: HashSet<u32> = generated.filter_map(|(_, material)| *material).collect();
        let turns = |number: u32, slot| {
            let followed = || self.materials[number as usize].tangent_slot();
            generated.contains(&number) && followed() == Some(slot)
        };
        let targets = self.animations.iter().flat_map(AnimationDef::targets);
        let turned = targets.filter_map(|pointed| match pointed.target {
            Target::Material(MaterialPart::Uv(slot, UvPart::Rotation | UvPart::Scale)) => {
                Some(pointed.number).filter(|number| turns(*number, slot))
            }
            _ => None,
        });
        turned.collect()
    }
}

fn parse_variants(root: Obj<'_>) -> Parsed<Vec<String>> {
    let Some(extension) = root.extension("KHR_materials_variants")? else {
        return Ok(Vec::new());
    };
    extension
        .objects("variants", |o| {
            Ok(o.string("name")?.unwrap_or_default().to_owned())
        })
        .map_err(|e| e.under("extensions.KHR_materials_variants"))
}

/// Only glTF 2 is understood; a minor version above ours may be, unless the file says otherwise.
fn check_version(root: Obj<'_>) -> Parsed<()> {
    let asset = root.need("asset", root.object("asset")?)?;
    let version = |key| -> Parsed<Option<(u32, u32)>> {
        let Some(text) = asset.string(key)? else {
            return Ok(None);
        };
        let parts = text
            .split_once('.')
            .and_then(|(major, minor)| Some((major.parse().ok()?, minor.parse().ok()?)));
        match parts {
            Some(parts) => Ok(Some(parts)),
            None => Err(
                Flaw::new(Code::ValueUnknown, format!("\"{text}\" is not a version")).under(key),
            ),
        }
    };
    let needed = version("minVersion").map_err(|e| e.under("asset"))?;
    let written = asset
        .need("version", version("version").map_err(|e| e.under("asset"))?)
        .map_err(|e| e.under("asset"))?;
    let (major, minor) = needed.unwrap_or((written.0, 0));
    if written.0 != 2 || major != 2 || minor > 0 {
        return Err(Flaw::new(
            Code::VersionUnsupported,
            format!(
                "the file is glTF {}.{} and needs {major}.{minor}; only 2.0 is read",
                written.0, written.1
            ),
        )
        .under("asset"));
    }
    Ok(())
}

fn parse_buffer(o: Obj<'_>) -> Parsed<BufferDef> {
    let len = o.need("byteLength", o.uint("byteLength")?)?;
    Ok(BufferDef {
        uri: o.string("uri")?.map(str::to_owned),
        len,
        fallback: match meshopt_extension(o)? {
            Some((e, name)) => e
                .boolean("fallback")
                .map_err(|e| e.under(format_args!("extensions.{name}")))?
                .unwrap_or(false),
            None => false,
        },
    })
}

/// The object of either name that meshopt's compression goes by.
fn meshopt_extension(o: Obj<'_>) -> Parsed<Option<(Obj<'_>, &'static str)>> {
    for name in ["KHR_meshopt_compression", "EXT_meshopt_compression"] {
        if let Some(found) = o.extension(name)? {
            return Ok(Some((found, name)));
        }
    }
    Ok(None)
}

fn parse_view(o: Obj<'_>, buffers: &[BufferDef]) -> Parsed<View> {
    let buffer = o.need("buffer", o.index("buffer", buffers.len())?)?;
    let offset = o.uint("byteOffset")?.unwrap_or(0);
    let len = o.need("byteLength", o.uint("byteLength")?)?;
    let available = buffers[buffer as usize].len;
    if offset.checked_add(len).is_none_or(|end| end > available) {
        return Err(Flaw::new(
            Code::BufferTooShort,
            format!("ends beyond buffers[{buffer}], which has {available} bytes"),
        ));
    }
    // The specification has none below 4; exporters have written the packed size of small elements.
    let stride = o.uint("byteStride")?;
    if let Some(stride) = stride
        && !(1..=252).contains(&stride)
    {
        return Err(Flaw::new(
            Code::ValueOutOfRange,
            format!("is {stride}, outside 1 to 252"),
        )
        .under("byteStride"));
    }
    let coded = match meshopt_extension(o)? {
        Some((e, name)) => Some(
            Coded::parse(e, buffers.len())
                .map_err(|e| e.under(format_args!("extensions.{name}")))?,
        ),
        None => None,
    };
    Ok(View {
        buffer,
        offset,
        len,
        stride,
        coded,
    })
}

/// The roots of the default scene; of the first one where none is named; all parentless nodes where
/// there is none.
fn parse_roots(root: Obj<'_>, counts: &Counts, warn: &mut Vec<Warning>) -> Parsed<Vec<u32>> {
    let scenes = root.objects("scenes", |o| o.indices("nodes", counts.nodes))?;
    let scene = root.index("scene", counts.scenes)?;
    if let Some(roots) = scenes.into_iter().nth(scene.unwrap_or(0) as usize) {
        return Ok(roots);
    }
    if counts.nodes > 0 {
        warn.push(Warning::new(
            Code::SceneMissing,
            "the file has no scenes; all its nodes are shown",
        ));
    }
    let mut is_child = vec![false; counts.nodes];
    root.objects("nodes", |o| {
        for child in o.indices("children", counts.nodes)? {
            is_child[child as usize] = true;
        }
        Ok(())
    })?;
    Ok((0..counts.nodes as u32)
        .filter(|&i| !is_child[i as usize])
        .collect())
}
