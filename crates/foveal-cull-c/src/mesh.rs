//! Baked meshes.
#![allow(unsafe_code, reason = "functions for C; see the SAFETY lines")]

use crate::border::{self, Plain};
use crate::status::{Fault, FovealCullStatus, guard};
use core::ffi::c_void;
use foveal_cull::{Aabb, BakeOptions, OccluderMesh};
use std::sync::Arc;

/// A baked mesh.
#[derive(Debug)]
pub struct FovealCullMesh(pub(crate) Arc<OccluderMesh>);

/// Triangles to be baked.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct FovealCullMeshSource {
    /// sizeof(FovealCullMeshSource).
    pub size: u32,
    /// Bytes of an index: 2 or 4.
    pub index_bytes: u32,
    /// x, y and z of the first vertex, metres. Need not be aligned.
    pub positions: *const f32,
    /// Number of vertices.
    pub position_count: usize,
    /// Bytes from one vertex to the next, at least 12.
    pub position_stride: usize,
    /// Three indices per triangle. Need not be aligned.
    pub indices: *const c_void,
    /// Number of indices.
    pub index_count: usize,
    /// 1: triangles occlude from behind too. 0: only from the front.
    pub two_sided: u32,
    /// 1: bake what results for two eyes or a radius need. 0: less memory and time.
    pub adjacency: u32,
    /// 1: occluders of the mesh can be given other positions. Then only vertices with the same index
    /// are one. 0: they cannot.
    pub deformable: u32,
    /// 1: bake boxes inside a closed mesh in its place where they are the better occluder. 0: the
    /// mesh itself.
    pub inner_shape: u32,
}

// SAFETY: numbers and pointers.
unsafe impl Plain for FovealCullMeshSource {}

/// Size of the first version, which ends with the last field that it had.
const FIRST_SOURCE: usize =
    core::mem::offset_of!(FovealCullMeshSource, adjacency) + size_of::<u32>();

impl FovealCullMeshSource {
    const DEFAULT: Self = Self {
        size: size_of::<Self>() as u32,
        index_bytes: 4,
        positions: core::ptr::null(),
        position_count: 0,
        position_stride: 12,
        indices: core::ptr::null(),
        index_count: 0,
        two_sided: 0,
        adjacency: 1,
        deformable: 0,
        inner_shape: 0,
    };
}

/// The bytes of `count` elements of `size` bytes, `stride` bytes apart.
///
/// # Safety
/// The pointer is null, or that many bytes are there and nothing changes them during `'a`.
unsafe fn bytes<'a>(
    pointer: *const c_void,
    count: usize,
    stride: usize,
    size: usize,
    name: &str,
) -> Result<&'a [u8], Fault> {
    let all = count
        .saturating_sub(1)
        .checked_mul(stride)
        .and_then(|before| before.checked_add(if count == 0 { 0 } else { size }))
        .ok_or_else(|| Fault::argument(format!("'{name}' has too many elements")))?;
    // SAFETY: the caller's word.
    unsafe { border::list(pointer.cast::<u8>(), all, name) }
}

/// `N` bytes at an offset that is within the list.
fn at<const N: usize>(bytes: &[u8], offset: usize) -> [u8; N] {
    core::array::from_fn(|i| bytes[offset + i])
}

/// Three numbers of each of `count` vertices, `stride` bytes apart.
///
/// # Safety
/// The pointer is null, or that many vertices are there and nothing changes them meanwhile.
pub(crate) unsafe fn vertices<'a>(
    positions: *const f32,
    count: usize,
    stride: usize,
) -> Result<impl ExactSizeIterator<Item = [f32; 3]> + 'a, Fault> {
    if stride < 12 {
        return Err(Fault::argument("'position_stride' is less than 12 bytes"));
    }
    // SAFETY: the caller's word.
    let vertices = unsafe { bytes(positions.cast(), count, stride, 12, "positions") }?;
    let position =
        move |i: usize| [0, 4, 8].map(|a| f32::from_ne_bytes(at(vertices, i * stride + a)));
    Ok((0..count).map(position))
}

/// # Safety
/// Arrays and counts of the source belong together.
unsafe fn bake(source: &FovealCullMeshSource) -> Result<OccluderMesh, Fault> {
    let index_bytes = match source.index_bytes {
        2 => 2,
        4 => 4,
        _ => return Err(Fault::argument("'index_bytes' is neither 2 nor 4")),
    };
    for (value, name) in [
        (source.two_sided, "two_sided"),
        (source.adjacency, "adjacency"),
        (source.deformable, "deformable"),
        (source.inner_shape, "inner_shape"),
    ] {
        if value > 1 {
            return Err(Fault::argument(format!("'{name}' is neither 0 nor 1")));
        }
    }
    // SAFETY: the caller's word.
    let positions = unsafe {
        vertices(
            source.positions,
            source.position_count,
            source.position_stride,
        )
    }?;
    let positions: Vec<[f32; 3]> = positions.collect();
    // SAFETY: the caller's word.
    let indices = unsafe {
        bytes(
            source.indices,
            source.index_count,
            index_bytes,
            index_bytes,
            "indices",
        )
    }?;
    let indices: Vec<u32> = if index_bytes == 2 {
        indices
            .chunks_exact(2)
            .map(|c| u16::from_ne_bytes(at(c, 0)).into())
            .collect()
    } else {
        indices
            .chunks_exact(4)
            .map(|c| u32::from_ne_bytes(at(c, 0)))
            .collect()
    };
    let options = BakeOptions::default()
        .with_two_sided(source.two_sided == 1)
        .with_adjacency(source.adjacency == 1)
        .with_deformable(source.deformable == 1)
        .with_inner_shape(source.inner_shape == 1);
    Ok(OccluderMesh::bake(&positions, &indices, options)?)
}

/// Fills a source with defaults: one-sided, with adjacency, 32-bit indices, no triangles. `size` is
/// the caller's sizeof(FovealCullMeshSource).
///
/// # Safety
/// `source` is null, or `size` bytes can be written to it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_mesh_source_init_sized(
    source: *mut FovealCullMeshSource,
    size: usize,
) -> FovealCullStatus {
    let default = FovealCullMeshSource::DEFAULT;
    // SAFETY: the caller's word.
    guard(|| unsafe { border::init_sized(source, size, FIRST_SOURCE, &default, "source") })
}

/// Bakes a mesh.
///
/// # Safety
/// `source` is null or as described, and its arrays are as long as it says. `out` is null or can be
/// written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_mesh_bake(
    source: *const FovealCullMeshSource,
    out: *mut *mut FovealCullMesh,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            border::give(out, || {
                let default = FovealCullMeshSource::DEFAULT;
                let source = border::sized(source, FIRST_SOURCE, default, "source")?;
                Ok(FovealCullMesh(Arc::new(bake(&source)?)))
            })
        }
    })
}

/// Bakes a box whose faces look outwards, `min` to `max` in mesh space, metres.
///
/// # Safety
/// `min` and `max` are null or three numbers each. `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_mesh_from_box(
    min: *const f32,
    max: *const f32,
    out: *mut *mut FovealCullMesh,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            border::give(out, || {
                let min = *border::object(min.cast::<[f32; 3]>(), "min")?;
                let max = *border::object(max.cast::<[f32; 3]>(), "max")?;
                if (0..3).any(|k| min[k] > max[k]) {
                    return Err(Fault::argument("'min' is larger than 'max'"));
                }
                Ok(FovealCullMesh(Arc::new(OccluderMesh::from_box(Aabb {
                    min,
                    max,
                })?)))
            })
        }
    })
}

/// Bakes a terrain of a grid of heights that is seen from above: sample `i` of row `j` lies at x =
/// `i as f32 * spacing_x`, y = `heights[j * columns + i]`, z = `j as f32 * spacing_z`, metres. Every
/// `step`th sample is kept, and the surface lies under the terrain everywhere. NaN is a hole; the
/// ground is solid besides.
///
/// # Safety
/// `heights` is null or `columns * rows` numbers. `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_mesh_from_heights(
    heights: *const f32,
    columns: usize,
    rows: usize,
    spacing_x: f32,
    spacing_z: f32,
    step: usize,
    out: *mut *mut FovealCullMesh,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            border::give(out, || {
                let count = columns.saturating_mul(rows);
                let heights = border::list(heights, count, "heights")?;
                let (spacing, options) = ([spacing_x, spacing_z], BakeOptions::default());
                let mesh = OccluderMesh::from_heights(heights, columns, spacing, step, options)?;
                Ok(FovealCullMesh(Arc::new(mesh)))
            })
        }
    })
}

/// Copies a baked mesh as bytes, for a file: at most `size` of them, or none of them if they are
/// more. Returns how many it has; 0 for null. `bytes` may be null to ask for that.
///
/// # Safety
/// `mesh` is null or lives. `bytes` is null, or `size` bytes can be written to it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_mesh_to_bytes(
    mesh: *const FovealCullMesh,
    bytes: *mut u8,
    size: usize,
) -> usize {
    let mut needed = 0;
    guard(|| {
        // SAFETY: the caller's word.
        let mesh = &unsafe { border::object(mesh, "mesh") }?.0;
        let all = mesh.bytes_len();
        if !bytes.is_null() && all <= size {
            // SAFETY: the caller says that there are `size` bytes.
            let to = unsafe { border::zeroed_list(bytes, all, "bytes") }?;
            to.copy_from_slice(&mesh.to_bytes());
        }
        needed = all;
        Ok(())
    });
    needed
}

/// The mesh of foveal_cull_mesh_to_bytes. The bytes are checked, and not needed afterwards.
///
/// # Safety
/// `bytes` is null or `size` bytes. `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_mesh_from_bytes(
    bytes: *const u8,
    size: usize,
    out: *mut *mut FovealCullMesh,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            border::give(out, || {
                let bytes = border::list(bytes, size, "bytes")?;
                Ok(FovealCullMesh(Arc::new(OccluderMesh::from_bytes(bytes)?)))
            })
        }
    })
}

/// Drops a mesh. Occluders that were made of it keep it. Null is nothing.
///
/// # Safety
/// `mesh` is null or comes from this library, and is used no more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_mesh_destroy(mesh: *mut FovealCullMesh) {
    // SAFETY: the caller's word.
    unsafe { border::take(mesh) };
}

/// The number of triangles, without degenerate ones; of an inner shape those of its boxes; 0 for
/// null.
///
/// # Safety
/// `mesh` is null or lives.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_mesh_triangle_count(mesh: *const FovealCullMesh) -> usize {
    // SAFETY: the caller's word.
    unsafe { border::object(mesh, "mesh") }.map_or(0, |m| m.0.triangle_count())
}
