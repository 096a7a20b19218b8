//! Eyes and views.
#![allow(unsafe_code, reason = "functions for C; see the SAFETY lines")]

use crate::border::{self, Plain};
use crate::status::{Fault, FovealCullStatus, guard};
use foveal_cull::{
    Affine, ClipDepth, CullError, Eye, MAX_SIDE_PX, Matrix4, Projection, Quantity, View,
};

/// The depths of the near and the far plane in clip space, z / w.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub enum FovealCullDepth {
    /// 0 at the near plane, 1 at the far plane: Vulkan, Direct3D, Metal, WebGPU.
    ZeroToOne = 0,
    /// 1 at the near plane, 0 at the far plane or at infinity: reversed depth.
    OneToZero = 1,
    /// -1 at the near plane, 1 at the far plane: OpenGL.
    MinusOneToOne = 2,
}

impl FovealCullDepth {
    fn from_number(number: u32) -> Result<ClipDepth, Fault> {
        Ok(match number {
            0 => ClipDepth::ZeroToOne,
            1 => ClipDepth::OneToZero,
            2 => ClipDepth::MinusOneToOne,
            _ => return Err(Fault::argument("'depth' is no FovealCullDepth")),
        })
    }
}

/// One eye: a rigid pose and a frustum.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct FovealCullEye {
    /// Columns: the eye's right, up and backward axes and its position (world, metres).
    pub world_from_eye: [f64; 12],
    /// Edges: tangents, or metres if orthographic.
    pub left: f64,
    /// As `left`.
    pub right: f64,
    /// As `left`.
    pub bottom: f64,
    /// As `left`.
    pub top: f64,
    /// Near distance, metres.
    pub near_m: f64,
    /// Far distance, metres; may be infinite unless orthographic.
    pub far_m: f64,
    /// 1: rays are parallel. 0: they meet in the eye.
    pub orthographic: u32,
    /// 0.
    pub reserved: u32,
}

// SAFETY: numbers.
unsafe impl Plain for FovealCullEye {}

/// The camera view of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct FovealCullView {
    /// sizeof(FovealCullView).
    pub size: u32,
    /// 1 or 2.
    pub eye_count: u32,
    /// The eye, or the left and the right one.
    pub eyes: [FovealCullEye; 2],
    /// Distance that each eye may move while the results hold, metres; 0 for the given places.
    pub validity_radius_m: f64,
}

// SAFETY: numbers.
unsafe impl Plain for FovealCullView {}

/// Size of the first version, which ends with the last field that it had.
const FIRST_VIEW: usize =
    core::mem::offset_of!(FovealCullView, validity_radius_m) + size_of::<f64>();

impl FovealCullEye {
    const NONE: Self = Self {
        world_from_eye: [0.0; 12],
        left: 0.0,
        right: 0.0,
        bottom: 0.0,
        top: 0.0,
        near_m: 0.0,
        far_m: 0.0,
        orthographic: 0,
        reserved: 0,
    };

    fn of(eye: &Eye) -> Self {
        let a = eye.world_from_eye;
        let columns = [a.x_axis, a.y_axis, a.z_axis, a.translation];
        let [left, right, bottom, top] = eye.projection.extents();
        let [near_m, far_m] = eye.projection.near_far_m();
        Self {
            world_from_eye: core::array::from_fn(|i| columns[i / 3][i % 3]),
            left,
            right,
            bottom,
            top,
            near_m,
            far_m,
            orthographic: eye.projection.is_orthographic().into(),
            reserved: 0,
        }
    }

    fn eye(&self) -> Result<Eye, Fault> {
        let &Self {
            left,
            right,
            bottom,
            top,
            near_m,
            far_m,
            ..
        } = self;
        if self.reserved != 0 {
            return Err(Fault::argument("'reserved' of an eye is not 0"));
        }
        let projection = match self.orthographic {
            0 => Projection::Perspective {
                left,
                right,
                bottom,
                top,
                near_m,
                far_m,
            },
            1 => Projection::Orthographic {
                left,
                right,
                bottom,
                top,
                near_m,
                far_m,
            },
            _ => return Err(Fault::argument("'orthographic' is neither 0 nor 1")),
        };
        let m = &self.world_from_eye;
        let pose: [[f64; 3]; 4] = core::array::from_fn(|c| core::array::from_fn(|r| m[3 * c + r]));
        Ok(Eye::new(Affine::from(pose), projection))
    }
}

impl FovealCullView {
    /// Reads a view as it is.
    ///
    /// # Safety
    /// The pointer is null, or names as many bytes as the struct says.
    unsafe fn read(pointer: *const Self) -> Result<Self, Fault> {
        let default = Self {
            size: 0,
            eye_count: 0,
            eyes: [FovealCullEye::NONE; 2],
            validity_radius_m: 0.0,
        };
        // SAFETY: the caller's word.
        unsafe { border::sized(pointer, FIRST_VIEW, default, "view") }
    }

    fn view(&self) -> Result<View, Fault> {
        let first = self.eyes[0].eye()?;
        let eyes = match self.eye_count {
            1 => View::mono(first),
            2 => View::stereo(first, self.eyes[1].eye()?),
            _ => return Err(Fault::argument("'eye_count' is neither 1 nor 2")),
        };
        Ok(eyes.with_validity_radius(self.validity_radius_m))
    }
}

/// Reads a view.
///
/// # Safety
/// The pointer is null, or names as many bytes as the struct says.
pub(crate) unsafe fn view(pointer: *const FovealCullView) -> Result<View, Fault> {
    // SAFETY: the caller's word.
    unsafe { FovealCullView::read(pointer) }?.view()
}

/// Whether a culler's buffer can fit a picture.
pub(crate) fn check_picture(width_px: u32, height_px: u32) -> Result<(), Fault> {
    let most = 4 * MAX_SIDE_PX;
    if [width_px, height_px]
        .iter()
        .all(|side| (1..=most).contains(side))
    {
        return Ok(());
    }
    Err(Fault::new(
        FovealCullStatus::BadSize,
        format!("picture of {width_px} x {height_px} pixels: each side must be 1 to {most} pixels"),
    ))
}

fn from_matrix(matrix: Matrix4, depth: u32) -> Result<FovealCullEye, Fault> {
    let depth = FovealCullDepth::from_number(depth)?;
    Ok(FovealCullEye::of(&Eye::from_clip_from_world(
        matrix, depth,
    )?))
}

/// The eye of a matrix from the world to clip space, column-major.
///
/// # Safety
/// `clip_from_world` is null or 16 numbers; `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_eye_from_matrix(
    clip_from_world: *const f64,
    depth: u32,
    out: *mut FovealCullEye,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            let matrix = border::object(clip_from_world.cast::<[f64; 16]>(), "clip_from_world")?;
            border::put(out, from_matrix((*matrix).into(), depth)?, "out")
        }
    })
}

/// The same with a matrix of floats.
///
/// # Safety
/// `clip_from_world` is null or 16 numbers; `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_eye_from_matrix_f32(
    clip_from_world: *const f32,
    depth: u32,
    out: *mut FovealCullEye,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            let matrix = border::object(clip_from_world.cast::<[f32; 16]>(), "clip_from_world")?;
            border::put(out, from_matrix((*matrix).into(), depth)?, "out")
        }
    })
}

/// Whether a lens is one: `fov_y_rad` in radians.
fn check_lens(fov_y_rad: f64, aspect: f64, near_m: f64, lens: &Projection) -> Result<(), Fault> {
    let numbers = [[fov_y_rad, aspect, near_m, 0.0], lens.extents()].concat();
    if !numbers.iter().all(|v| v.is_finite()) {
        return Err(CullError::NotFinite(Quantity::Projection).into());
    }
    let bad = |text: String| Err(Fault::new(FovealCullStatus::BadView, text));
    if !(0.0 < fov_y_rad && fov_y_rad < core::f64::consts::PI) {
        return bad(format!(
            "'fov_y_rad' is {fov_y_rad}: an angle in radians, above 0 and below pi, is needed"
        ));
    }
    for (name, value) in [("aspect", aspect), ("near_m", near_m)] {
        if value <= 0.0 {
            return bad(format!("'{name}' is {value}, which must be above 0"));
        }
    }
    let [left, right, bottom, top] = lens.extents();
    if left < right && bottom < top {
        Ok(())
    } else {
        bad(format!(
            "'fov_y_rad' {fov_y_rad} and 'aspect' {aspect} show nothing"
        ))
    }
}

/// A symmetric perspective eye without a far plane, along -z where the target is the position. The
/// angle is above 0 and below pi, the aspect and the near distance are above 0.
///
/// # Safety
/// `position`, `target` and `up` are null or three numbers each; `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_eye_look_at(
    position: *const f64,
    target: *const f64,
    up: *const f64,
    fov_y_rad: f64,
    aspect: f64,
    near_m: f64,
    out: *mut FovealCullEye,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            let position = *border::object(position.cast::<[f64; 3]>(), "position")?;
            let target = *border::object(target.cast::<[f64; 3]>(), "target")?;
            let up = *border::object(up.cast::<[f64; 3]>(), "up")?;
            let frustum = Projection::perspective(fov_y_rad, aspect, near_m, f64::INFINITY);
            let pose = [position, target, up].concat();
            if !pose.iter().all(|v| v.is_finite()) {
                return Err(CullError::NotFinite(Quantity::Pose).into());
            }
            check_lens(fov_y_rad, aspect, near_m, &frustum)?;
            let eye = Eye::look_at(position, target, up, frustum);
            border::put(out, FovealCullEye::of(&eye), "out")
        }
    })
}

/// A view of one eye at its exact place. `size` is the caller's sizeof(FovealCullView).
///
/// # Safety
/// `eye` is null or an eye; `out` is null, or `size` bytes can be written to it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_view_init_sized(
    eye: *const FovealCullEye,
    out: *mut FovealCullView,
    size: usize,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        unsafe {
            let eye = *border::object(eye, "eye")?;
            let view = FovealCullView {
                size: size_of::<FovealCullView>() as u32,
                eye_count: 1,
                eyes: [eye, FovealCullEye::NONE],
                validity_radius_m: 0.0,
            };
            border::init_sized(out, size, FIRST_VIEW, &view, "out")
        }
    })
}

/// Widens a view of a picture, for a culler of `foveal_culler_create_for_picture`.
///
/// # Safety
/// `view` is null, or names as many bytes as the struct says, which can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn foveal_cull_view_for_picture(
    view: *mut FovealCullView,
    width_px: u32,
    height_px: u32,
) -> FovealCullStatus {
    guard(|| {
        // SAFETY: the caller's word.
        let mut changed = unsafe { FovealCullView::read(view) }?;
        check_picture(width_px, height_px)?;
        let wide = changed.view()?.for_picture(width_px, height_px);
        let eyes = [Some(wide.eye), wide.second_eye];
        for (eye, wide) in changed.eyes.iter_mut().zip(eyes.iter().flatten()) {
            let [_, right, bottom, _] = wide.projection.extents();
            (eye.right, eye.bottom) = (right, bottom);
        }
        let allowed = FIRST_VIEW..=border::LARGEST_STRUCT;
        // SAFETY: the caller's word.
        unsafe { border::put_sized(view, allowed, &changed, "view") }
    })
}
