//! Changed recordings: an error or a subject, never a panic.

use super::mocrec;
use crate::mutate::{self, mutate};

/// Two draws (one with a matrix), both kinds of query, a clear.
fn recording() -> Vec<u8> {
    let mut bytes = 0xA701_B600_u32.to_le_bytes().to_vec();
    let floats = |bytes: &mut Vec<u8>, values: &[f32]| {
        bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    };
    let words = |bytes: &mut Vec<u8>, values: &[i32]| {
        bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    };
    let triangle = |bytes: &mut Vec<u8>, tag: u8, matrix: bool| {
        bytes.push(tag);
        words(bytes, &[-1, 4, 12]);
        floats(bytes, &[0., 0., 1., 1., 0., 1., 0., 1., 1., 1., 1., 2.]);
        words(bytes, &[2, 0, 1, 2, 2, 1, 3]);
        bytes.push(u8::from(matrix));
        if matrix {
            let m = [
                1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 1., 0.5, 0., 0., 1.,
            ];
            floats(bytes, &m);
        }
        words(bytes, &[0, 1, 12, 4, 8]);
    };
    floats(&mut bytes, &[0.1]);
    words(&mut bytes, &[64, 64]);
    triangle(&mut bytes, 0, false);
    triangle(&mut bytes, 0, true);
    triangle(&mut bytes, 2, false);
    bytes.push(3);
    triangle(&mut bytes, 0, true);
    bytes.push(1);
    words(&mut bytes, &[0]);
    floats(&mut bytes, &[-0.5, -0.5, 0.5, 0.5, 2.0]);
    bytes.push(0x7F);
    bytes
}

#[test]
fn fuzz_records() {
    let seeds = [recording()];
    let whole = mocrec::Recording::parse(&seeds[0]).unwrap();
    assert_eq!(whole.records.len(), 6);
    mutate::run("records", &seeds, mutate, |bytes| {
        if let Ok(recording) = mocrec::Recording::parse(bytes) {
            let _ = mocrec::subjects("fuzz", &recording);
        }
    });
}
