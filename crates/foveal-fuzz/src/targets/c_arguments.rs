//! Arguments of calls of the C interface, and what every status must not be.

use core::ptr::null_mut;
use foveal_cull_c::FovealCullStatus as Status;

use crate::random::Choices;

/// Arguments.
pub(super) trait Arguments {
    fn number(&mut self) -> f64;
    fn numbers<const N: usize>(&mut self) -> [f64; N];
    fn place(&mut self) -> [f64; 12];
    fn or_null<T>(&mut self, pointer: *mut T) -> *mut T;
}

impl Arguments for Choices<'_> {
    /// Mostly a number of a world; now and then an odd one.
    fn number(&mut self) -> f64 {
        match self.below(400) {
            0 => f64::NAN,
            1 => f64::INFINITY,
            2 => -f64::INFINITY,
            3 => f64::MAX,
            4 => 1e-320,
            5 => f64::from_bits(self.bits()),
            6..30 => 0.0,
            _ => (self.bits() >> 11) as f64 / (1u64 << 53) as f64 * 20.0 - 10.0,
        }
    }

    fn numbers<const N: usize>(&mut self) -> [f64; N] {
        core::array::from_fn(|_| self.number())
    }

    fn place(&mut self) -> [f64; 12] {
        if self.one_in(3) {
            return self.numbers();
        }
        let [x, y, z] = self.numbers();
        [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, x, y, z]
    }

    /// Null now and then.
    fn or_null<T>(&mut self, pointer: *mut T) -> *mut T {
        if self.one_in(40) { null_mut() } else { pointer }
    }
}

/// Six numbers per box; few are odd.
pub(super) fn boxes(r: &mut Choices<'_>, count: usize) -> Vec<f32> {
    (0..count)
        .flat_map(|_| {
            let [x, y, z, a, b, c] = r.numbers().map(|v| v as f32);
            let size = 0.3;
            [
                x,
                y,
                z,
                x + size * a.abs(),
                y + size * b.abs(),
                z + size * c.abs(),
            ]
        })
        .collect()
}

/// Calls that were refused, and calls that were done.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Calls(pub(super) [u64; 2]);

impl Calls {
    pub(super) fn note(&mut self, status: Status) -> Status {
        self.0[usize::from(status == Status::Ok)] += 1;
        assert_ne!(status, Status::Internal);
        assert_ne!(status, Status::Busy);
        status
    }
}
