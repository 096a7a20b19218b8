//! Checks of what a file has and its shown nodes and materials do not use.
//!
//! One thing is read at a time and freed again; what is wrong with it is a warning, for the picture
//! does not need it.

use std::collections::HashSet;

use super::Resolver;
use super::image_lights::ImageLightDef;
use super::nodes::Hierarchy;
use super::objects;
use super::parts::Geometry;
use super::pictures;
use super::reader::Reader;
use super::wanted::Wanted;
use crate::error::{Flaw, Limit, Parsed, amount};
use crate::{Code, LoadOptions, Scene, Warning};

/// What follows from a fault here.
pub(super) const NOT_SHOWN: &str = "nothing shown uses it";

/// Reads meshes of no shown node and pictures of no material.
pub(crate) fn check(
    reader: Reader<'_>,
    resolver: &Resolver<'_>,
    options: &LoadOptions,
    hierarchy: &Hierarchy,
    wanted: &Wanted,
    warn: &mut Vec<Warning>,
) {
    let document = reader.document;
    let shown = objects::nodes_with_meshes(&document.nodes, hierarchy);
    let shown: HashSet<u32> = shown.map(|(_, _, mesh)| mesh).collect();
    for mesh in (0..document.meshes.len() as u32).filter(|mesh| !shown.contains(mesh)) {
        let mut notes = Vec::new();
        if let Err(flaw) = check_mesh(mesh, reader, options, &mut notes) {
            notes.push(flaw.warning());
        }
        warn.extend(notes.into_iter().map(|note| note.and(NOT_SHOWN)));
    }
    let around = document.image_light.iter().flatten();
    let used: HashSet<u32> = (wanted.images())
        .chain(around.flat_map(ImageLightDef::images))
        .collect();
    for image in (0..document.images.len() as u32).filter(|image| !used.contains(image)) {
        if let Err(flaw) = check_image(image, reader, resolver, options) {
            let label = document.images[image as usize].label(image as usize);
            let place = format!("images[{image}] ({label})");
            warn.push(flaw.warning().at(place).and(NOT_SHOWN));
        }
    }
}

fn check_mesh(
    mesh: u32,
    reader: Reader<'_>,
    options: &LoadOptions,
    notes: &mut Vec<Warning>,
) -> Parsed<()> {
    let mut geometry = Geometry::default();
    geometry.request_mesh(reader.document, mesh);
    geometry
        .build(reader, options, &mut Scene::default(), notes)
        .map(|_| ())
}

fn check_image(
    image: u32,
    reader: Reader<'_>,
    resolver: &Resolver<'_>,
    options: &LoadOptions,
) -> Parsed<()> {
    let broken = |cause: String| Flaw::new(Code::ImageUnreadable, cause);
    let bytes = pictures::fetch(Some(image), reader, resolver)?;
    let promise = pictures::promise(&bytes).map_err(broken)?;
    let needed = promise
        .decoding_bytes()
        .saturating_add(promise.rgba_bytes());
    let limit = options.max_texture_bytes.min(reader.buffers.budget.left());
    if needed > limit {
        let cause = format!(
            "wants {} to decode {} x {} texels; {} are left",
            amount(needed),
            promise.width,
            promise.height,
            amount(limit)
        );
        return Err(Flaw::beyond(Limit::TextureBytes, cause));
    }
    pictures::decode(&bytes, promise)
        .map(|_| ())
        .map_err(broken)
}
