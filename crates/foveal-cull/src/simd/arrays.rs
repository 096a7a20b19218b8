//! Arrays of two to four equal expressions, and minimum and maximum without NaN.

/// `[e(0), e(1), e(2), e(3)]`. Kernels use this and `#[inline(always)]` functions in place of
/// closures: code that is not inlined loses the instruction set.
macro_rules! four {
    ($k:ident => $e:expr) => {
        [
            {
                let $k = 0usize;
                $e
            },
            {
                let $k = 1usize;
                $e
            },
            {
                let $k = 2usize;
                $e
            },
            {
                let $k = 3usize;
                $e
            },
        ]
    };
}
pub(crate) use four;

/// `[e(0), e(1), e(2)]`, as [`four!`].
macro_rules! three {
    ($k:ident => $e:expr) => {
        [
            {
                let $k = 0usize;
                $e
            },
            {
                let $k = 1usize;
                $e
            },
            {
                let $k = 2usize;
                $e
            },
        ]
    };
}
pub(crate) use three;

/// The smaller of two numbers: one instruction, where `f64::min` takes three to handle NaN.
#[inline(always)]
pub(crate) fn smaller<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

/// The larger of two numbers, in the same way.
#[inline(always)]
pub(crate) fn larger<T: PartialOrd>(a: T, b: T) -> T {
    if a > b { a } else { b }
}

/// `[e(0), e(1)]`, as [`four!`].
macro_rules! two {
    ($k:ident => $e:expr) => {
        [
            {
                let $k = 0usize;
                $e
            },
            {
                let $k = 1usize;
                $e
            },
        ]
    };
}
pub(crate) use two;
