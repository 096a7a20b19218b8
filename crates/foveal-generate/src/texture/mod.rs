//! Pictures made by code: each surface is a function from a place to a texel, baked into colour,
//! normal and occlusion-roughness-metallic textures with full mip chains.

mod bake;
mod cloth;
mod glow;
mod leaf;
mod metal;
mod noise;
mod plaster;
mod roof;
mod stone;
mod wood;

pub(super) use bake::{Baked, Texel, bake, paint_masked};
pub(super) use cloth::{canvas, rug, stripes};
pub(super) use glow::{clock, moon, paper, steam, window};
pub(super) use leaf::leaves;
pub(super) use metal::{hammered, iron};
pub(crate) use noise::dent;
pub(super) use plaster::{clay, plaster};
pub(super) use roof::roof_tiles;
pub(super) use stone::{ashlar, bricks, cobbles};
pub(super) use wood::{planks, wicker};
