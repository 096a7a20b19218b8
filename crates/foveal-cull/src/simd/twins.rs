//! Every method of every instruction set that this machine has, against the portable one, lane by
//! lane.

use super::{InstructionSet, Kernel, Lanes, Wide};
use crate::Aabb;

/// Numbers at which instruction sets tend to differ.
const ODD: [f32; 20] = [
    0.0,
    -0.0,
    0.5,
    -0.5,
    1.0,
    -1.0,
    7.999_999_5,
    8.5,
    31.5,
    32.0,
    32.5,
    1e-40,
    1e6,
    2_147_483_500.0,
    2_147_483_648.0,
    -2_147_483_648.0,
    -3e9,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
];

struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: u64) -> u64 {
        (self.bits() >> 33) % n
    }

    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.bits() >> 40) as f32 / (1 << 24) as f32
    }

    /// One in eight is odd; of the others half lie where coverage is decided.
    fn float(&mut self) -> f32 {
        match self.below(8) {
            0 => ODD[self.below(ODD.len() as u64) as usize],
            1..4 => self.between(-1e5, 1e5),
            _ => self.between(-2.0, 35.0),
        }
    }

    /// All kinds of bits, and small numbers.
    fn bits32(&mut self) -> i32 {
        (self.bits() as i32) >> self.below(32)
    }
}

struct Inputs {
    floats: [[f32; 16]; 2],
    plain: [[f32; 16]; 2],
    whole: [[i32; 16]; 2],
    by: [i32; 16],
    counts: [i32; 16],
    doubles: [[f64; 4]; 2],
    pixels: [[i16; 64]; 2],
    at: [[f64; 4]; 2],
    slopes: [[f64; 4]; 2],
    limits: [f64; 2],
    left: u32,
    bits: u64,
    boxes: [Aabb; 16],
    places: [u8; 8],
    table: [f32; 256],
    doubles_table: [f64; 256],
}

fn array<T, const N: usize>(mut one: impl FnMut() -> T) -> [T; N] {
    core::array::from_fn(|_| one())
}

impl Inputs {
    fn new(seed: u64) -> Self {
        let mut r = Random(seed);
        let vec = |r: &mut Random| -> [f32; 3] { array(|| r.between(-9.0, 9.0)) };
        // Whether pixels are alike decides what a comparison is worth.
        let shift = r.below(15);
        // Here, or at the right edge of the widest buffer.
        let right = 32 * [0, 507][r.below(2) as usize];
        Self {
            floats: array(|| array(|| r.float())),
            plain: array(|| array(|| r.between(-100.0, 100.0))),
            whole: array(|| array(|| r.bits32())),
            by: array(|| r.below(32) as i32),
            counts: array(|| (r.below(1 << 24) >> r.below(25)) as i32),
            doubles: array(|| array(|| f64::from(r.float()) + f64::from(r.float()) * 1e-8)),
            pixels: array(|| array(|| (r.bits() as i16) >> shift)),
            // Left edges to the left of right ones in most rows; some far off, and some right at a
            // sample.
            at: array(|| {
                core::array::from_fn(|e| {
                    let at = f64::from(right)
                        + f64::from(r.between(120.0, 155.0))
                        + [-10.0, 12.0][e / 2];
                    match r.below(8) {
                        0 => f64::from(r.between(-1e9, 1e9)) * 1e3,
                        1 => at.floor(),
                        _ => at,
                    }
                })
            }),
            slopes: array(|| array(|| f64::from(r.between(-2.0, 2.0)).powi(3))),
            limits: [r.between(-2.0, 9.0), r.between(20.0, 33.0)].map(|v| f64::from(v.floor())),
            left: right + 96 + 32 * r.below(3) as u32,
            bits: r.bits(),
            boxes: array(|| Aabb {
                min: vec(&mut r),
                max: vec(&mut r),
            }),
            places: array(|| r.bits() as u8),
            table: array(|| r.float()),
            doubles_table: array(|| f64::from(r.float())),
        }
    }
}

/// What came out, by the method's name.
type Outputs = Vec<(&'static str, Vec<u64>)>;

struct Eight<'a>(&'a Inputs);

/// There is more than one NaN; which one comes out is left to the CPU.
fn float(v: f32) -> u64 {
    u64::from(if v.is_nan() { f32::NAN } else { v }.to_bits())
}

fn double(v: f64) -> u64 {
    if v.is_nan() { f64::NAN } else { v }.to_bits()
}

fn f<L: Lanes>(l: L, v: L::F) -> Vec<u64> {
    let mut to = [0.0; 8];
    l.store(v, &mut to);
    to.map(float).to_vec()
}

fn i<L: Lanes>(l: L, v: L::I) -> Vec<u64> {
    let mut to = [0; 8];
    l.istore(v, &mut to);
    to.map(|v| v as u64).to_vec()
}

fn q<L: Lanes>(l: L, v: L::Q) -> Vec<u64> {
    let mut to = [0.0; 4];
    l.qstore(v, &mut to);
    to.map(double).to_vec()
}

fn d<L: Lanes>(l: L, v: L::D) -> Vec<u64> {
    let mut to = [0; 64];
    l.dstore(v, &mut to);
    to.map(|v| v as u64).to_vec()
}

/// Sets keep samples in an order of their own: seen is which pixels have all or any of them.
fn p<L: Lanes>(l: L, v: L::P) -> Vec<u64> {
    let mut to = [0; 16];
    l.pstore(v, &mut to);
    let count = to.map(u64::count_ones).iter().sum::<u32>();
    vec![l.pall(v), l.pany(v), l.pall(l.pload(&to)), u64::from(count)]
}

impl Kernel for Eight<'_> {
    type Output = Outputs;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Outputs {
        let n = self.0;
        let [a, b] = n
            .floats
            .each_ref()
            .map(|v| l.load(v.first_chunk().unwrap()));
        let [x, y] = n
            .whole
            .each_ref()
            .map(|v| l.iload(v.first_chunk().unwrap()));
        let by = l.iload(n.by.first_chunk().unwrap());
        let counts = l.iload(n.counts.first_chunk().unwrap());
        let [s, t] = n.doubles.each_ref().map(|v| l.qload(v));
        let [g, h] = n.pixels.each_ref().map(|v| l.dload(v));
        let [j, k] = [0, 1].map(|k| {
            let borders = l.edge_rows(l.qload(&n.slopes[k]));
            let limits = n.bits.is_multiple_of(3).then_some(n.limits);
            let spans = l.spans(l.qload(&n.at[k]), &borders, limits);
            l.within(&spans, n.left)
        });
        let [one, two] = [n.floats[0][8], n.plain[0][0]];
        let cap = n.pixels[0][0];
        let mut out: Outputs = vec![
            ("load", f(l, a)),
            ("splat", f(l, l.splat(one))),
            ("add", f(l, l.add(a, b))),
            ("sub", f(l, l.sub(a, b))),
            ("mul", f(l, l.mul(a, b))),
            ("mul, add", f(l, l.add(l.mul(a, b), a))),
            ("div", f(l, l.div(a, b))),
            ("min", f(l, l.min(a, b))),
            ("max", f(l, l.max(a, b))),
            ("abs", f(l, l.abs(a))),
            ("lt", i(l, l.lt(a, b))),
            ("select", f(l, l.select(l.lt(b, a), a, b))),
            ("trunc", i(l, l.trunc(a))),
            (
                "codes",
                i(l, l.codes(l.load(n.plain[0].first_chunk().unwrap()))),
            ),
            ("gather", f(l, l.gather(&n.table, &n.places))),
            ("isplat", i(l, l.isplat(n.whole[0][8]))),
            ("iadd", i(l, l.iadd(x, y))),
            ("isub", i(l, l.isub(x, y))),
            ("imul", i(l, l.imul(x, y))),
            ("imin", i(l, l.imin(x, y))),
            ("imax", i(l, l.imax(x, y))),
            ("ishr", i(l, l.ishr(x, by))),
            ("ibits", i(l, l.ibits(counts))),
            ("iand", i(l, l.iand(x, y))),
            ("ior", i(l, l.ior(x, y))),
            ("iandnot", i(l, l.iandnot(x, y))),
            ("movemask", vec![u64::from(l.movemask(x))]),
            ("qload", q(l, s)),
            ("qsplat", q(l, l.qsplat(n.doubles[0][0]))),
            ("qadd", q(l, l.qadd(s, t))),
            ("qsub", q(l, l.qsub(s, t))),
            ("qmul", q(l, l.qmul(s, t))),
            ("qdiv", q(l, l.qdiv(s, t))),
            ("qabs", q(l, l.qabs(s))),
            ("qlt", vec![u64::from(l.qlt(s, t))]),
            ("depths", d(l, l.depths(a, two, one, cap))),
            (
                "depths of depths",
                d(l, l.depths(l.abs(b), two * 1e-3, 1e-6, i16::MAX)),
            ),
            ("dsplat", d(l, l.dsplat(cap))),
            ("dmin", d(l, l.dmin(g, h))),
            ("dmax", d(l, l.dmax(g, h))),
            ("dgt", vec![l.dgt(g, h)]),
            ("dapart", vec![l.dapart(g, h, cap)]),
            ("dselect", d(l, l.dselect(n.bits, g, h))),
            ("dreduce_min", vec![l.dreduce_min(g) as u64]),
            ("within", p(l, j.0)),
            ("within, centers", vec![j.1, k.1]),
            ("bit_rows", vec![l.bit_rows(l.ishr(x, by), l.ishr(y, by))]),
            ("pkeep", p(l, l.pkeep(j.0, n.bits))),
            ("por", p(l, l.por(j.0, k.0))),
            (
                "por, pkeep",
                p(l, l.por(l.pkeep(j.0, n.bits), l.pkeep(k.0, !n.bits))),
            ),
        ];
        let boxes = l.transpose(n.boxes.first_chunk().unwrap());
        out.extend(boxes.map(|v| ("transpose", f(l, v))));
        // What these choose has to come from numbers that are known only at run time.
        let from = n.places.first_chunk::<4>().unwrap();
        out.push(("qpick", q(l, l.qpick(s, *from))));
        out.push(("qgather", q(l, l.qgather(&n.doubles_table, *from))));
        out
    }
}

struct Sixteen<'a>(&'a Inputs);

impl Kernel for Sixteen<'_> {
    type Output = Outputs;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Outputs {
        let (w, n) = (l.wide(), self.0);
        let f = |v| {
            let mut to = [0.0; 16];
            w.store(v, &mut to);
            to.map(float).to_vec()
        };
        let i = |v| {
            let mut to = [0; 16];
            w.istore(v, &mut to);
            to.map(|v| v as u64).to_vec()
        };
        let [a, b] = n.floats.each_ref().map(|v| w.load(v));
        let pair = w.pair(
            n.floats[0].last_chunk().unwrap(),
            n.floats[1].first_chunk().unwrap(),
        );
        let [x, y] = n.whole.each_ref().map(|v| w.iload(v));
        let mut out: Outputs = vec![
            ("wide load", f(a)),
            ("wide splat", f(w.splat(n.floats[0][0]))),
            ("wide pair", f(pair)),
            ("wide add", f(w.add(a, b))),
            ("wide sub", f(w.sub(a, b))),
            ("wide mul", f(w.mul(a, b))),
            ("wide mul, add", f(w.add(w.mul(a, b), a))),
            ("wide div", f(w.div(a, b))),
            ("wide min", f(w.min(a, b))),
            ("wide max", f(w.max(a, b))),
            ("wide abs", f(w.abs(a))),
            ("wide lt", vec![u64::from(w.lt(a, b))]),
            ("wide select", f(w.select(n.bits as u32 & 0xffff, a, b))),
            ("wide trunc", i(w.trunc(a))),
            ("wide codes", i(w.codes(w.load(&n.plain[0])))),
            ("wide isplat", i(w.isplat(n.whole[0][0]))),
            ("wide iadd", i(w.iadd(x, y))),
            ("wide isub", i(w.isub(x, y))),
            ("wide imul", i(w.imul(x, y))),
            ("wide imin", i(w.imin(x, y))),
            ("wide imax", i(w.imax(x, y))),
            ("wide ishr", i(w.ishr(x, w.iload(&n.by)))),
            ("wide ibits", i(w.ibits(w.iload(&n.counts)))),
            ("wide negative", vec![u64::from(w.negative(x))]),
        ];
        out.extend(w.transpose(&n.boxes).map(|v| ("wide transpose", f(v))));
        out
    }
}

#[test]
fn every_instruction_set_gives_the_same_bits_as_the_portable_one() {
    let (mut some, mut all) = (0, 0);
    for seed in 0..3000 {
        let n = Inputs::new(seed);
        let portable = InstructionSet::Portable;
        let expected = [portable.run(Eight(&n)), portable.run(Sixteen(&n))].concat();
        for (_, covered) in expected.iter().filter(|(name, _)| *name == "por") {
            some += u32::from(covered[0] != covered[1]);
            all += u32::from(covered[0] != 0);
        }
        for set in InstructionSet::available().skip(1) {
            let found = [set.run(Eight(&n)), set.run(Sixteen(&n))].concat();
            for ((name, found), (_, expected)) in found.iter().zip(&expected) {
                assert_eq!(found, expected, "{set:?}, {name}, seed {seed}");
            }
        }
    }
    assert!(some > 1000 && all > 1000, "{some} {all}");
}

#[test]
fn what_the_target_always_has_is_there() {
    let sets: Vec<InstructionSet> = InstructionSet::available().collect();
    assert_eq!(sets[0], InstructionSet::Portable);
    assert_eq!(sets.last(), Some(&InstructionSet::detect()));
    let of_target = if cfg!(target_arch = "x86_64") {
        InstructionSet::Sse2
    } else if cfg!(all(target_arch = "aarch64", target_endian = "little")) {
        InstructionSet::Neon
    } else if cfg!(target_feature = "simd128") {
        InstructionSet::Simd128
    } else {
        InstructionSet::Portable
    };
    assert!(sets.contains(&of_target), "{sets:?}");
}
