//! Every method of every instruction set that this machine has, against the portable one, lane by
//! lane.

use super::lanes::{Floats, Ints, Mask, Vectors};
use super::{Depths, Doubles, InstructionSet, Kernel, Lanes, Samples, Sixteen};
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

/// There is more than one NaN; which one comes out is left to the CPU.
fn float(v: f32) -> u64 {
    u64::from(if v.is_nan() { f32::NAN } else { v }.to_bits())
}

fn double(v: f64) -> u64 {
    if v.is_nan() { f64::NAN } else { v }.to_bits()
}

fn f<V: Vectors<N>, const N: usize>(v: Floats<V, N>) -> Vec<u64> {
    let mut to = [0.0; N];
    v.store(&mut to);
    to.map(float).to_vec()
}

fn i<V: Vectors<N>, const N: usize>(v: Ints<V, N>) -> Vec<u64> {
    let mut to = [0; N];
    v.store(&mut to);
    to.map(|v| v as u64).to_vec()
}

fn q<L: Lanes>(v: Doubles<L>) -> Vec<u64> {
    let mut to = [0.0; 4];
    v.store(&mut to);
    to.map(double).to_vec()
}

fn d<L: Lanes>(v: Depths<L>) -> Vec<u64> {
    let mut to = [0; 64];
    v.store(&mut to);
    to.map(|v| v as u64).to_vec()
}

/// Sets keep samples in an order of their own: seen is which pixels have all or any of them.
fn p<L: Lanes>(l: L, v: Samples<L>) -> Vec<u64> {
    let mut to = [0; 16];
    v.store(&mut to);
    let count = to.map(u64::count_ones).iter().sum::<u32>();
    vec![
        v.all(),
        v.any(),
        l.load_samples(&to).all(),
        u64::from(count),
    ]
}

/// What lanes of every width have.
#[inline(always)]
fn vectors<V: Vectors<N>, const N: usize>(l: V, n: &Inputs) -> Outputs {
    let [a, b] = [0, 1].map(|k| l.load(n.floats[k].first_chunk().unwrap()));
    let [x, y] = [0, 1].map(|k| l.load_ints(n.whole[k].first_chunk().unwrap()));
    let by = l.load_ints(n.by.first_chunk().unwrap());
    let counts = l.load_ints(n.counts.first_chunk().unwrap());
    let plain = l.load(n.plain[0].first_chunk().unwrap());
    let (one, int) = (n.floats[0][8], n.whole[0][8]);
    let (less, below) = (a.lt(b), x.lt(y));
    let m = |mask: Mask<V, N>| vec![u64::from(mask.bits())];
    let mut out: Outputs = vec![
        ("load", f(a)),
        ("splat", f(l.splat(one))),
        ("add", f(a + b)),
        ("sub", f(a - b)),
        ("mul", f(a * b)),
        ("mul, add", f(a * b + a)),
        ("with one", f((a + one) * one - one)),
        ("div", f(a / b)),
        ("min", f(a.min(b))),
        ("max", f(a.max(b))),
        ("abs", f(a.abs())),
        ("lt", m(less)),
        ("finite", m(a.is_finite())),
        ("select", f(less.select(a, b))),
        ("select ints", f(below.select(a, b))),
        ("trunc", i(a.trunc())),
        ("codes", i(plain.codes())),
        ("int", i(l.int(int))),
        ("iadd", i(x + y)),
        ("isub", i(x - y)),
        ("imul", i(x * y)),
        ("ishr", i(x >> by)),
        ("with one int", i(((x + int) * int - int) >> 3)),
        ("imin", i(x.min(y))),
        ("imax", i(x.max(y))),
        ("significant bits", i(counts.significant_bits())),
        ("ilt", m(below)),
        ("ilt of one", m(x.lt(l.int(int)))),
        ("all", m(l.all())),
        ("and", m(less & below)),
        ("or", m(less | below)),
        ("not", m(!less)),
        ("and not", m(below & !less)),
        ("select all", f(l.all().select(a, b))),
    ];
    let boxes = l.transpose(n.boxes.first_chunk().unwrap());
    out.extend(boxes.map(|v| ("transpose", f(v))));
    out
}

/// Lanes of both widths, and blocks.
struct All<'a>(&'a Inputs);

impl Kernel for All<'_> {
    type Output = Outputs;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Outputs {
        let (w, n) = (l.wide(), self.0);
        let mut out = vectors(l, n);
        out.extend(vectors(w, n));
        let pair = w.pair(
            n.floats[0].last_chunk().unwrap(),
            n.floats[1].first_chunk().unwrap(),
        );
        let [s, t] = n.doubles.each_ref().map(|v| l.load_doubles(v));
        let [g, h] = n.pixels.each_ref().map(|v| l.load_depths(v));
        let [j, k] = [0, 1].map(|k| {
            let edges = l.load_doubles(&n.slopes[k]).edge_rows();
            let limits = n.bits.is_multiple_of(3).then_some(n.limits);
            let spans = l.load_doubles(&n.at[k]).spans(&edges, limits);
            l.within(&spans, n.left)
        });
        let [a, b] = [0, 1].map(|k| l.load(n.floats[k].first_chunk().unwrap()));
        let [x, y] = [0, 1].map(|k| l.load_ints(n.whole[k].first_chunk().unwrap()));
        let by = l.load_ints(n.by.first_chunk().unwrap());
        let [one, two] = [n.floats[0][8], n.plain[0][0]];
        let (cap, double) = (n.pixels[0][0], n.doubles[0][0]);
        let mut lanes = [0; 8];
        (x.lt(y) & !a.lt(b)).store(&mut lanes);
        let loaded = u64::from(l.load_mask(&lanes).bits());
        out.extend([
            ("pair", f(pair)),
            ("mask", vec![u64::from(w.mask(n.bits as u32).bits())]),
            (
                "flipped",
                vec![u64::from(w.all().flipped(n.bits as u32).bits())],
            ),
            ("mask stored", lanes.map(|v| v as u64).to_vec()),
            ("mask loaded", vec![loaded]),
            ("gather", f(l.gather(&n.table, &n.places))),
            ("qload", q(s)),
            ("double", q(l.double(double))),
            ("qadd", q(s + t)),
            ("qsub", q(s - t)),
            ("qmul", q(s * t)),
            ("qdiv", q(s / t)),
            ("with one double", q((s + double) * double - double)),
            ("qabs", q(s.abs())),
            ("qlt", vec![u64::from(s.lt(t))]),
            ("plane", d(a.plane(two, one, cap))),
            (
                "plane of depths",
                d(b.abs().plane(two * 1e-3, 1e-6, i16::MAX)),
            ),
            ("depth", d(l.depth(cap))),
            ("dmin", d(g.min(h))),
            ("dmax", d(g.max(h))),
            ("gt", vec![g.gt(h)]),
            ("apart", vec![g.apart(h, (cap & 0x7fff).min(0x7ffe))]),
            ("dselect", d(Depths::select(n.bits, g, h))),
            ("farthest", vec![g.farthest() as u64]),
            ("within", p(l, j.0)),
            ("within, centers", vec![j.1, k.1]),
            ("rows", vec![(x >> by).rows_to(y >> by)]),
            ("keep", p(l, j.0.keep(n.bits))),
            ("union", p(l, j.0 | k.0)),
            ("union of parts", p(l, j.0.keep(n.bits) | k.0.keep(!n.bits))),
        ]);
        // What these choose has to come from numbers that are known only at run time.
        let from = n.places.first_chunk::<4>().unwrap();
        out.push(("pick", q(s.pick(*from))));
        out.push(("qgather", q(l.gather_doubles(&n.doubles_table, *from))));
        out
    }
}

#[test]
fn every_instruction_set_gives_the_same_bits_as_the_portable_one() {
    let (mut some, mut all) = (0, 0);
    for seed in 0..3000 {
        let n = Inputs::new(seed);
        let portable = InstructionSet::Portable;
        let expected = portable.run(All(&n));
        for (_, covered) in expected.iter().filter(|(name, _)| *name == "union") {
            some += u32::from(covered[0] != covered[1]);
            all += u32::from(covered[0] != 0);
        }
        for set in InstructionSet::available().skip(1) {
            let found = set.run(All(&n));
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
