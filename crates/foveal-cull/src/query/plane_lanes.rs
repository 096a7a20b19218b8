//! The planes of boxes by lane: what all boxes of a query have in common.

/// Relative error of a plane's depth, of the largest term. Generous.
pub(super) const ROUNDING: f32 = 4e-6;

/// A value that is affine over the screen (samples), and a bound on its rounding.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Affine {
    pub(super) x: f32,
    pub(super) y: f32,
    pub(super) at_zero: f32,
    pub(super) error: f32,
}

/// Lanes of gaps: front minus back planes, above zero where a ray may meet the box. Lane
/// `4 a + 2 b + near` is from the front plane across axis `a` to a back plane across axis
/// `a + 1 + b`: the farther of its two planes, or the nearer one (`near`), which is a back plane
/// too where neither faces the eye.
pub(super) const GAPS: u32 = 0xfff;
/// Lanes of gaps to nearer planes.
pub(super) const NEARER: u32 = 0xaaa;
/// Lanes of the front planes themselves, by axis.
pub(super) const FRONTS: u32 = 7 << FIRST_FRONT;
const FIRST_FRONT: usize = 12;

/// Axis of each lane's front plane, and of its back plane; three for none.
const AXES: [[usize; 16]; 2] = {
    let mut axes = [[3; 16]; 2];
    let mut lane = 0;
    while lane < FIRST_FRONT {
        axes[0][lane] = lane / 4;
        axes[1][lane] = (lane / 4 + 1 + lane / 2 % 2) % 3;
        lane += 1;
    }
    while lane < FIRST_FRONT + 3 {
        axes[0][lane] = lane - FIRST_FRONT;
        lane += 1;
    }
    axes
};

/// By front or back and by axis: one in the lanes that have the axis.
pub(super) const OF_AXIS: [[[f32; 16]; 3]; 2] = {
    let mut of = [[[0.0; 16]; 3]; 2];
    let mut n = 0;
    while n < 2 * 16 {
        let axis = AXES[n / 16][n % 16];
        if axis < 3 {
            of[n / 16][axis][n % 16] = 1.0;
        }
        n += 1;
    }
    of
};

/// The planes of all boxes of a query, by lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AxisPlaneLanes {
    /// Front and back: change to the right and downwards, depth at zero, and error.
    pub(super) affine: [[[f32; 16]; 4]; 2],
    pub(super) parallel: Option<Parallel>,
}

/// Further data of orthographic views, where the direction to the box does not say which of its
/// planes face the eye.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parallel {
    /// Change of depth per metre, front and back.
    pub(super) per_metre: [[f32; 16]; 2],
    /// Bit per lane: the upper plane across the front's (the back's) axis faces the eye.
    pub(super) down: [u32; 2],
    /// Bit per lane: its planes are known.
    pub(super) known: u32,
}

impl AxisPlaneLanes {
    pub(super) fn new(axes: &[Affine; 3], per_metre: Option<[f32; 3]>) -> Self {
        let mut affine = [[[0.0; 16]; 4]; 2];
        for (affine, of) in affine.iter_mut().zip(&AXES) {
            for (lane, &axis) in of.iter().enumerate() {
                if let Some(a) = axes.get(axis) {
                    affine[0][lane] = a.x;
                    affine[1][lane] = a.y;
                    affine[2][lane] = a.at_zero;
                    affine[3][lane] = a.error;
                }
            }
        }
        let parallel = per_metre.map(|per_metre| {
            let per_metre =
                AXES.map(|of| of.map(|axis| per_metre.get(axis).copied().unwrap_or(0.0)));
            let bits = |of: &[f32; 16], is: fn(f32) -> bool| {
                (0..16).fold(0, |bits, n| bits | u32::from(is(of[n])) << n)
            };
            Parallel {
                // Depth falls with distance.
                down: per_metre
                    .each_ref()
                    .map(|of| bits(of, f32::is_sign_positive)),
                known: !per_metre
                    .each_ref()
                    .map(|of| bits(of, f32::is_nan))
                    .into_iter()
                    .fold(0, |a, b| a | b),
                per_metre,
            }
        });
        Self { affine, parallel }
    }
}
