//! What turns decoded elements into attributes (KHR_meshopt_compression, appendix B). In place,
//! little-endian.

/// Rounded away from zero at a half.
fn round(x: f32) -> i32 {
    (x + if x >= 0.0 { 0.5 } else { -0.5 }) as i32
}

/// Unit vectors whose third number holds the octahedron's scale; the fourth stays.
fn octahedron([x, y, z]: [f32; 3], max: f32) -> [i32; 3] {
    let z = z - x.abs() - y.abs();
    let fold = z.min(0.0);
    let x = x + if x >= 0.0 { fold } else { -fold };
    let y = y + if y >= 0.0 { fold } else { -fold };
    let scale = max / (x * x + y * y + z * z).sqrt();
    [x, y, z].map(|v| round(v * scale))
}

pub(super) fn words(element: &[u8; 8]) -> [i16; 4] {
    let [a, b, c, d, e, f, g, h] = *element;
    [[a, b], [c, d], [e, f], [g, h]].map(i16::from_le_bytes)
}

fn bytes_of(words: [i16; 4]) -> [u8; 8] {
    let [[a, b], [c, d], [e, f], [g, h]] = words.map(i16::to_le_bytes);
    [a, b, c, d, e, f, g, h]
}

pub(super) fn octahedral8(bytes: &mut [u8]) {
    for element in bytes.as_chunks_mut::<4>().0 {
        let [x, y, z, w] = *element;
        let [x, y, z] = octahedron([x, y, z].map(|v| f32::from(v as i8)), 127.0).map(|v| v as u8);
        *element = [x, y, z, w];
    }
}

pub(super) fn octahedral16(bytes: &mut [u8]) {
    for element in bytes.as_chunks_mut::<8>().0 {
        let [x, y, z, w] = words(element);
        let [x, y, z] = octahedron([x, y, z].map(f32::from), 32767.0).map(|v| v as i16);
        *element = bytes_of([x, y, z, w]);
    }
}

/// Three numbers over the scale in the fourth, whose two low bits say which one is left out.
pub(super) fn quaternion(bytes: &mut [u8]) {
    for element in bytes.as_chunks_mut::<8>().0 {
        let [x, y, z, last] = words(element);
        let largest = (last & 3) as usize;
        let s = f32::from(last | 3);
        let [x, y, z] = [x, y, z].map(f32::from);
        let w = (s * s * 2.0 - x * x - y * y - z * z).max(0.0).sqrt();
        let scale = 32767.0 / 2f32.sqrt() / s;
        let mut out = [0; 4];
        for (i, v) in [w, x, y, z].into_iter().enumerate() {
            out[(largest + i) & 3] = round(v * scale) as i16;
        }
        *element = bytes_of(out);
    }
}

/// Eight bits of exponent above 24 of mantissa.
pub(super) fn exponential(bytes: &mut [u8]) {
    for element in bytes.as_chunks_mut::<4>().0 {
        let v = i32::from_le_bytes(*element);
        let mantissa = (v << 8) >> 8;
        let power = f32::from_bits((((v >> 24) + 127) as u32) << 23);
        *element = (power * mantissa as f32).to_le_bytes();
    }
}

/// `top` is the largest value of a channel.
fn color([y, co, cg, a]: [i32; 4], top: i32) -> [i32; 4] {
    // The highest bit of alpha says how many bits all four have.
    let scale = (1..16).fold(a, |all, shift| all | a >> shift);
    let a = (a << 1 & scale) | (a & 1);
    let unit = top as f32 / scale as f32;
    [y + co - cg, y + cg, y - co - cg, a].map(|v| (v as f32 * unit + 0.5) as i32)
}

pub(super) fn color8(bytes: &mut [u8]) {
    for element in bytes.as_chunks_mut::<4>().0 {
        let [y, co, cg, a] = *element;
        let coded = [y.into(), (co as i8).into(), (cg as i8).into(), a.into()];
        *element = color(coded, 255).map(|v| v as u8);
    }
}

pub(super) fn color16(bytes: &mut [u8]) {
    for element in bytes.as_chunks_mut::<8>().0 {
        let [y, co, cg, a] = words(element);
        let coded = [(y as u16).into(), co.into(), cg.into(), (a as u16).into()];
        *element = bytes_of(color(coded, 65535).map(|v| v as u16 as i16));
    }
}
