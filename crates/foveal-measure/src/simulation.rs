//! Comparisons of simulated machines: equal sides are equal, unequal ones are not, whatever the
//! noise.

use crate::series::{Series, mixed, turn};
use crate::{Comparison, Finding, Pair};

/// A fair source of numbers, by a seed.
struct Lot(u64);

impl Lot {
    /// From 0 to 1.
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(1);
        (mixed(self.0) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Of mean 0 and deviation 1, nearly normal (a sum of twelve).
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// What else a machine does, as a factor of each frame's time.
#[derive(Clone, Copy, Debug)]
enum Noise {
    /// Independent, by this deviation.
    White(f64),
    /// A frame in ten takes up to five times as long.
    Outliers,
    /// It becomes warm: half as fast at the end as in the beginning.
    Drift,
    /// What slows a frame slows the next ones, too.
    Correlated,
    /// The clock steps between two rates.
    Steps,
    /// Something else runs in every other frame.
    Periodic,
    /// A clock of a tenth of a millisecond, as browsers have.
    CoarseClock,
}

const ALL: [Noise; 8] = [
    Noise::White(0.05),
    Noise::White(0.3),
    Noise::Outliers,
    Noise::Drift,
    Noise::Correlated,
    Noise::Steps,
    Noise::Periodic,
    Noise::CoarseClock,
];

/// A machine that takes frames one after the other.
struct Machine {
    noise: Noise,
    lot: Lot,
    frame: usize,
    state: f64,
}

impl Machine {
    fn new(noise: Noise, seed: u64) -> Self {
        Self {
            noise,
            lot: Lot(mixed(seed) >> 1),
            frame: 0,
            state: 0.0,
        }
    }

    fn draw(&mut self, ms: f64) -> f64 {
        let (frame, lot) = (self.frame as f64, &mut self.lot);
        self.frame += 1;
        let small = (0.02 * lot.normal()).exp();
        match self.noise {
            Noise::White(deviation) => ms * (deviation * lot.normal()).exp(),
            Noise::Outliers if lot.uniform() < 0.1 => ms * small * (1.0 + 4.0 * lot.uniform()),
            Noise::Outliers => ms * small,
            Noise::Drift => ms * small * (1.0 + frame / 100.0),
            Noise::Correlated => {
                self.state = 0.95 * self.state + 0.05 * lot.normal();
                ms * small * self.state.exp()
            }
            Noise::Steps => {
                if lot.uniform() < 0.05 {
                    self.state = 0.4 - self.state;
                }
                ms * small * (1.0 + self.state)
            }
            Noise::Periodic => ms * small * (1.0 + 0.3 * (frame % 2.0)),
            Noise::CoarseClock => (10.0 * ms * small).round() / 10.0,
        }
    }
}

impl Machine {
    fn pair(&mut self, reference_ms: f64, chosen_ms: f64, order: &[usize]) -> Pair {
        let mut ms = [reference_ms, chosen_ms];
        for &side in order {
            ms[side] = self.draw(ms[side]);
        }
        Pair {
            reference_ms: ms[0],
            chosen_ms: ms[1],
            reference_first: order[0] == 0,
        }
    }
}

/// Draws in turn until there is an answer, as the window does.
fn compared(machine: &mut Machine, reference_ms: f64, chosen_ms: f64, first: u64) -> Comparison {
    let mut series = Series::default();
    let mut frame = first;
    while !series.is_done() {
        series.push(machine.pair(reference_ms, chosen_ms, &turn(frame, 2)));
        frame += 1;
    }
    series.found().unwrap().clone()
}

#[test]
fn equal_sides_are_no_difference_whatever_the_noise() {
    for noise in ALL {
        let tries = 1000;
        let equal = (0..tries).filter(|&seed| {
            let found = compared(&mut Machine::new(noise, seed), 3.0, 3.0, 64 * seed);
            found.finding == Finding::NoDifference
        });
        let equal = equal.count();
        assert!(equal >= 990, "{noise:?}: {equal} of {tries}");
    }
}

#[test]
fn a_side_that_is_a_tenth_faster_is_found() {
    for noise in ALL {
        // Noise of three tenths hides it, as it should: it is never found the other way round.
        let least = match noise {
            Noise::White(0.3) => 0,
            Noise::Outliers => 95,
            _ => 100,
        };
        let found: Vec<_> = (0..100)
            .map(|seed| compared(&mut Machine::new(noise, seed), 3.3, 3.0, 64 * seed))
            .collect();
        let faster = found.iter().filter(|c| c.finding == Finding::Faster);
        let faster = faster.count();
        assert!(faster >= least, "{noise:?}: {faster}");
        assert!(
            found.iter().all(|c| c.finding != Finding::Slower),
            "{noise:?}"
        );
    }
}

#[test]
fn intervals_hold_the_true_ratio() {
    for noise in ALL {
        let held = (0..1000).filter(|&seed| {
            let mut machine = Machine::new(noise, seed);
            let turns = (0..24).map(|frame| turn(24 * seed + frame, 2));
            let pairs: Vec<_> = turns.map(|order| machine.pair(3.0, 2.0, &order)).collect();
            let [low, high] = Comparison::of(&pairs).unwrap().interval.unwrap();
            // A coarse clock rounds what is measured.
            low <= 1.5 * 1.02 && 1.5 / 1.02 <= high
        });
        let held = held.count();
        assert!(held >= 990, "{noise:?}: {held}");
    }
}

#[test]
fn without_a_lot_nothing_is_found() {
    let mut machine = Machine::new(Noise::Periodic, 1);
    let pairs: Vec<_> = (0..24).map(|_| machine.pair(3.0, 2.0, &[0, 1])).collect();
    // It may as well be the place in the turn.
    let found = Comparison::of(&pairs).unwrap();
    assert_eq!(found.finding, Finding::NoDifference);
}
