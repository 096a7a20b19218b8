//! Sets of placed occluders.
#![allow(unsafe_code, reason = "functions for C; see the SAFETY lines")]

use crate::border::{self, Plain};
use crate::mesh::FovealCullMesh;
use crate::numbers::set_number;
use crate::status::{Fault, FovealCullStatus, guard};
use foveal_cull::{CullError, OccluderId, OccluderSet, Quantity};
use std::sync::{Arc, RwLock};

/// A set of occluders.
#[derive(Debug)]
pub struct FovealCullOccluders {
    /// No other set of this process has this number.
    number: u64,
    pub(crate) set: RwLock<OccluderSet>,
}

/// The id of one occluder. All zero: none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct FovealCullOccluderId {
    /// The set that it belongs to.
    pub set: u64,
    /// The occluder in it.
    pub occluder: u64,
}

// SAFETY: two numbers.
unsafe impl Plain for FovealCullOccluderId {}

impl FovealCullOccluders {
    fn own(&self, id: FovealCullOccluderId) -> Result<OccluderId, Fault> {
        let occluder = OccluderId::from_bits(id.occluder);
        match occluder {
            Some(occluder) if id.set == self.number => Ok(occluder),
            Some(_) if id.set != 0 => Err(Fault::new(
                FovealCullStatus::OtherSet,
                "the id belongs to another set of occluders",
            )),
            _ => Err(CullError::UnknownOccluder.into()),
        }
    }
}

/// Makes an empty set.
///
/// # Safety
/// `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occluders_create(
    out: *mut *mut FovealCullOccluders,
) -> FovealCullStatus {
    guard(|| {
        let set = || {
            Ok(FovealCullOccluders {
                number: set_number(),
                set: RwLock::default(),
            })
        };
        // SAFETY: the caller's word.
        unsafe { border::give(out, set) }
    })
}

/// Drops a set with its occluders. Null is nothing.
///
/// # Safety
/// `occluders` is null or comes from this library, and is used no more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occluders_destroy(occluders: *mut FovealCullOccluders) {
    // SAFETY: the caller's word.
    unsafe { border::take(occluders) };
}

/// Places a mesh in the world.
///
/// # Safety
/// Handles are null or live; `world_from_mesh` is null or twelve numbers; `out` is null or can be
/// written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occluders_add(
    occluders: *mut FovealCullOccluders,
    mesh: *const FovealCullMesh,
    world_from_mesh: *const f64,
    out: *mut FovealCullOccluderId,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            border::check_out(out, "out")?;
            border::put(
                out,
                FovealCullOccluderId {
                    set: 0,
                    occluder: 0,
                },
                "out",
            )?;
            let occluders = border::object(occluders, "occluders")?;
            let mesh = border::object(mesh, "mesh")?;
            let place = crate::place::affine(world_from_mesh)?;
            let id = border::write(&occluders.set)?.add(Arc::clone(&mesh.0), place)?;
            let id = FovealCullOccluderId {
                set: occluders.number,
                occluder: id.to_bits(),
            };
            border::put(out, id, "out")
        }
    })
}

/// Moves occluders. Everything is checked first: after an error none has moved.
///
/// # Safety
/// `occluders` is null or lives; `ids` is null or `count` ids; `world_from_mesh` is null or `12 *
/// count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occluders_move(
    occluders: *mut FovealCullOccluders,
    ids: *const FovealCullOccluderId,
    world_from_mesh: *const f64,
    count: usize,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let (occluders, ids, places) = unsafe {
            (
                border::object(occluders, "occluders")?,
                border::list(ids, count, "ids")?,
                border::list(
                    world_from_mesh.cast::<[[f64; 3]; 4]>(),
                    count,
                    "world_from_mesh",
                )?,
            )
        };
        let numbers = places.as_flattened().as_flattened();
        if !numbers.iter().all(|v| v.is_finite()) {
            return Err(CullError::NotFinite(Quantity::Transform).into());
        }
        let mut set = border::write(&occluders.set)?;
        for id in ids {
            if !set.contains(occluders.own(*id)?) {
                return Err(CullError::UnknownOccluder.into());
            }
        }
        for (id, place) in ids.iter().zip(places) {
            set.set_transform(occluders.own(*id)?, *place)?;
        }
        Ok(())
    })
}

/// Gives an occluder of a deformable mesh another shape: all positions of the mesh in their order,
/// `stride` bytes apart. Other occluders of the mesh keep theirs. After an error it keeps its shape.
///
/// # Safety
/// `occluders` is null or lives; `positions` is null or `count` vertices.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occluders_deform(
    occluders: *mut FovealCullOccluders,
    id: FovealCullOccluderId,
    positions: *const f32,
    count: usize,
    stride: usize,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let (occluders, positions) = unsafe {
            (
                border::object(occluders, "occluders")?,
                crate::mesh::vertices(positions, count, stride)?,
            )
        };
        let id = occluders.own(id)?;
        let mut set = border::write(&occluders.set)?;
        let expected = set.mesh(id)?.position_count();
        let expected = expected.ok_or(CullError::NotDeformable)?;
        // Before they are read.
        if count != expected {
            return Err(Fault::new(
                FovealCullStatus::WrongLength,
                format!("the mesh has {expected} positions, and {count} are given"),
            ));
        }
        let positions: Vec<[f32; 3]> = positions.collect();
        Ok(set.set_positions(id, &positions)?)
    })
}

/// Switches an occluder off (0) or on (1).
///
/// # Safety
/// `occluders` is null or lives.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occluders_enable(
    occluders: *mut FovealCullOccluders,
    id: FovealCullOccluderId,
    enabled: u32,
) -> FovealCullStatus {
    guard(|| {
        if enabled > 1 {
            return Err(Fault::argument("'enabled' is neither 0 nor 1"));
        }
        // SAFETY: the caller's word.
        let occluders = unsafe { border::object(occluders, "occluders") }?;
        let id = occluders.own(id)?;
        Ok(border::write(&occluders.set)?.set_enabled(id, enabled == 1)?)
    })
}

/// Removes an occluder. Its id names nothing from then on.
///
/// # Safety
/// `occluders` is null or lives.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occluders_remove(
    occluders: *mut FovealCullOccluders,
    id: FovealCullOccluderId,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let occluders = unsafe { border::object(occluders, "occluders") }?;
        let id = occluders.own(id)?;
        Ok(border::write(&occluders.set)?.remove(id)?)
    })
}

/// Writes the number of occluders, whether on or off.
///
/// # Safety
/// `occluders` is null or lives; `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_occluders_count(
    occluders: *const FovealCullOccluders,
    out: *mut usize,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            let occluders = border::object(occluders, "occluders")?;
            border::put(out, border::read(&occluders.set)?.len(), "out")
        }
    })
}
