//! Which quads are shaded in full for the sake of measuring them.

/// Quads whose number's bits under `mask` equal `class`, across and down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Probe {
    pub(crate) mask: u32,
    pub(crate) class: [u32; 2],
}

impl Probe {
    /// No quad.
    pub(crate) const NONE: Self = Self {
        mask: 0,
        class: [1, 1],
    };

    /// Class `n` of `side * side`, `side` a power of two.
    fn class(n: u32, side: u32) -> Self {
        Self {
            mask: side - 1,
            class: [n % side, n / side % side],
        }
    }
}

/// Frames that it takes to measure each quad again after a movement.
const SETTLING: u32 = 4;

/// The order of probes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Probes {
    moving: bool,
    /// Frames that still measure what a movement left.
    settling: u32,
    turn: u32,
}

impl Probes {
    /// Something moves in the next frame.
    pub(crate) fn disturb(&mut self) {
        self.moving = true;
    }

    /// Whether something moves in the next frame.
    pub(crate) fn are_disturbed(&self) -> bool {
        self.moving
    }

    /// The next frame is shaded in full anyway.
    pub(crate) fn settle(&mut self) {
        *self = Self::default();
    }

    /// The next frame's.
    pub(crate) fn next(&mut self) -> Probe {
        if std::mem::take(&mut self.moving) {
            self.settling = SETTLING;
            self.turn = self.turn.wrapping_add(1);
            return Probe::class(self.turn % 16, 4);
        }
        if self.settling == 0 {
            return Probe::NONE;
        }
        self.settling -= 1;
        Probe::class(self.settling, 2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hits(probe: Probe, x: u32, y: u32) -> bool {
        x & probe.mask == probe.class[0] && y & probe.mask == probe.class[1]
    }

    #[test]
    fn a_still_start_probes_nothing() {
        let mut probes = Probes::default();
        assert!((0..100).all(|_| probes.next() == Probe::NONE));
        assert!(!hits(Probe::NONE, 0, 0) && !hits(Probe::NONE, 1, 1));
    }

    #[test]
    fn after_a_movement_each_quad_is_probed_once_within_four_frames() {
        let mut probes = Probes::default();
        probes.disturb();
        probes.next();
        let after: Vec<Probe> = (0..10).map(|_| probes.next()).collect();
        for (x, y) in (0..7).flat_map(|x| (0..7).map(move |y| (x, y))) {
            let frames: Vec<usize> = (0..10).filter(|&f| hits(after[f], x, y)).collect();
            assert_eq!(frames.len(), 1, "quad {x}, {y}");
            assert!(frames[0] < 4);
        }
    }

    #[test]
    fn while_things_move_each_quad_is_probed_every_sixteen_frames() {
        let mut probes = Probes::default();
        let moving: Vec<Probe> = (0..16)
            .map(|_| {
                probes.disturb();
                probes.next()
            })
            .collect();
        for (x, y) in (0..9).flat_map(|x| (0..9).map(move |y| (x, y))) {
            assert_eq!(moving.iter().filter(|p| hits(**p, x, y)).count(), 1);
        }
    }
}
