//! The decoders against the encoders of the C++ library, and against broken streams.

use proptest::prelude::*;

use super::{Coded, Filter, Mode, filters, indices, vertices};

/// Neither smooth nor random: runs, steps, and noise in some bytes.
fn pattern(count: usize, stride: usize) -> Vec<u8> {
    let noise = |i: usize| (i.wrapping_mul(2_654_435_761) >> 13) as u8;
    (0..count * stride)
        .map(|i| match (i / stride, i % stride) {
            (_, k) if k % 5 == 4 => 7,
            (n, k) if k % 3 == 0 => (n * (k + 1)) as u8,
            (n, k) if k % 3 == 1 => noise(n * stride + k) & 15,
            (n, k) => noise(n / 40 + k),
        })
        .collect()
}

fn encoded<const N: usize>(bytes: &[u8], level: i32, version: i32) -> Vec<u8> {
    let (elements, _) = bytes.as_chunks::<N>();
    meshopt::encode_vertex_buffer_level(elements, level, Some(version)).unwrap()
}

#[test]
fn elements_of_every_size_come_back_byte_by_byte() {
    fn check<const N: usize>() {
        for count in [1, 2, 15, 16, 17, 255, 256, 257, 1000] {
            let bytes = pattern(count, N);
            for (level, version) in [(0, 0), (2, 0), (0, 1), (1, 1), (2, 1), (3, 1)] {
                let stream = encoded::<N>(&bytes, level, version);
                let decoded = vertices::decode(&stream, count, N);
                assert!(
                    decoded.as_deref() == Some(&bytes),
                    "{count} elements of {N} bytes, level {level}, version {version}"
                );
            }
        }
    }
    check::<4>();
    check::<8>();
    check::<12>();
    check::<16>();
    check::<24>();
    check::<64>();
    check::<256>();
}

/// A grid's triangles, then strays.
fn triangles() -> Vec<u32> {
    let mut list = Vec::new();
    for y in 0..20 {
        for x in 0..20 {
            let a = y * 21 + x;
            list.extend([a, a + 1, a + 21, a + 21, a + 1, a + 22]);
        }
    }
    for i in 0..200u32 {
        list.extend([i * 7919 % 441, i * 104_729 % 441, i % 441]);
    }
    list.extend([0, 100_000, 440]);
    list
}

fn to_bytes(indices: &[u32]) -> Vec<u8> {
    indices.iter().flat_map(|i| i.to_le_bytes()).collect()
}

/// Each triangle begins with its smallest corner: the codec may turn triangles.
fn turned(bytes: &[u8]) -> Vec<[u32; 3]> {
    let indices: Vec<u32> = bytes
        .as_chunks::<4>()
        .0
        .iter()
        .map(|b| u32::from_le_bytes(*b))
        .collect();
    indices
        .chunks_exact(3)
        .map(|t| {
            let first = (0..3).min_by_key(|&i| t[i]).unwrap();
            [t[first], t[(first + 1) % 3], t[(first + 2) % 3]]
        })
        .collect()
}

#[test]
fn triangles_come_back_in_order_and_winding() {
    let list = triangles();
    let stream = meshopt::encode_index_buffer(&list, 100_001).unwrap();
    let decoded = indices::triangles(&stream, list.len(), 4).unwrap();
    assert_eq!(turned(&decoded), turned(&to_bytes(&list)));
    // As the library decodes them, corner by corner.
    let theirs: Vec<u32> = meshopt::decode_index_buffer(&stream, list.len()).unwrap();
    assert!(decoded == to_bytes(&theirs));
    // 16 bits lose nothing where the numbers are small.
    let small = &list[..2400];
    let stream = meshopt::encode_index_buffer(small, 441).unwrap();
    let wide = indices::triangles(&stream, small.len(), 4).unwrap();
    let narrow = indices::triangles(&stream, small.len(), 2).unwrap();
    let low = wide.chunks_exact(4).flat_map(|b| [b[0], b[1]]);
    assert!(narrow.into_iter().eq(low));
}

#[test]
fn sequences_come_back() {
    let list = triangles();
    let stream = meshopt::encode_index_sequence(&list, 100_001).unwrap();
    let decoded = indices::sequence(&stream, list.len(), 4).unwrap();
    assert!(decoded == to_bytes(&list));
}

#[test]
fn filters_do_what_the_library_does() {
    let words: Vec<u8> = (0..4000u32)
        .flat_map(|i| (i.wrapping_mul(40_503) as i16).to_le_bytes())
        .collect();
    let elements = || -> Vec<[i16; 4]> {
        let bytes = words.as_chunks::<8>().0.iter();
        bytes.map(filters::words).collect()
    };
    let bytes_of = |e: &[[i16; 4]]| -> Vec<u8> {
        let words = e.as_flattened().iter();
        words.flat_map(|w| w.to_le_bytes()).collect()
    };
    // The library's vector units round otherwise at a half.
    let close = |ours: &[u8], theirs: &[[i16; 4]]| {
        let ours = ours.as_chunks::<8>().0.iter().map(filters::words);
        ours.zip(theirs)
            .all(|(a, b)| a.iter().zip(b).all(|(a, b)| a.abs_diff(*b) <= 1))
    };
    let mut theirs = elements();
    // A valid third number: the scale of the octahedron.
    theirs.iter_mut().for_each(|e| {
        e[0] /= 2;
        e[1] /= 2;
        e[2] = 32767;
    });
    let mut ours = bytes_of(&theirs);
    meshopt::decode_filter_oct(&mut theirs);
    filters::octahedral16(&mut ours);
    assert!(close(&ours, &theirs), "octahedra");

    let mut theirs = elements();
    theirs.iter_mut().for_each(|e| {
        e[..3].iter_mut().for_each(|v| *v /= 2);
        e[3] = (e[3] | 0x4000) & 0x7FFF;
    });
    let mut ours = bytes_of(&theirs);
    meshopt::decode_filter_quat(&mut theirs);
    filters::quaternion(&mut ours);
    assert!(close(&ours, &theirs), "quaternions");

    let values: Vec<[f32; 4]> = (0..100)
        .map(|i| [i as f32 * 0.37, -0.001 * i as f32, 1e6, 0.0])
        .collect();
    let mut theirs = meshopt::encode_filter_exp::<4>(&values, 15, meshopt::EncodeExpMode::Separate);
    let flat32 = |e: &[[u32; 4]]| -> Vec<u8> {
        e.as_flattened()
            .iter()
            .flat_map(|v| v.to_le_bytes())
            .collect()
    };
    let mut ours = flat32(&theirs);
    meshopt::decode_filter_exp(&mut theirs);
    filters::exponential(&mut ours);
    assert!(ours == flat32(&theirs), "exponents");

    let colors: Vec<[f32; 4]> = (0..256)
        .map(|i| [i as f32 / 255.0, 0.5, 1.0 - i as f32 / 255.0, 0.25])
        .collect();
    let mut theirs = meshopt::encode_filter_color::<u8>(&colors, 8);
    let mut ours = theirs.as_flattened().to_vec();
    meshopt::decode_filter_color(&mut theirs);
    filters::color8(&mut ours);
    assert!(ours == theirs.as_flattened(), "colours");
}

#[test]
fn octahedra_of_eight_bits_become_unit_vectors() {
    let mut up = [0, 0, 127, 9];
    filters::octahedral8(&mut up);
    assert_eq!(up, [0, 0, 127, 9]);
    let mut down = [127, 127, 127, 0];
    filters::octahedral8(&mut down);
    assert_eq!(down.map(|v| v as i8), [0, 0, -127, 0]);
}

fn coded(mode: Mode, stride: usize, count: usize) -> Coded {
    Coded {
        buffer: 0,
        offset: 0,
        len: 0,
        stride,
        count,
        mode,
        filter: Filter::None,
    }
}

#[test]
fn every_truncation_and_every_extension_is_refused() {
    let bytes = pattern(300, 12);
    for version in [0, 1] {
        let stream = encoded::<12>(&bytes, 2, version);
        for end in 0..stream.len() {
            assert!(vertices::decode(&stream[..end], 300, 12).is_none(), "{end}");
        }
        assert!(vertices::decode(&[&stream[..], &[0]].concat(), 300, 12).is_none());
    }
    let list = triangles();
    let stream = meshopt::encode_index_buffer(&list, 100_001).unwrap();
    for end in 0..stream.len() {
        assert!(indices::triangles(&stream[..end], list.len(), 4).is_none());
    }
    let stream = meshopt::encode_index_sequence(&list, 100_001).unwrap();
    for end in 0..stream.len() {
        assert!(indices::sequence(&stream[..end], list.len(), 4).is_none());
    }
}

proptest! {
    #[test]
    fn broken_streams_never_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        version in 0..2i32,
        kind in 0..3usize,
    ) {
        let list = triangles();
        let (mut stream, one) = match kind {
            0 => (encoded::<16>(&pattern(300, 16), 2, version), coded(Mode::Attributes, 16, 300)),
            1 => (
                meshopt::encode_index_buffer(&list, 100_001).unwrap(),
                coded(Mode::Triangles, 4, list.len()),
            ),
            _ => (
                meshopt::encode_index_sequence(&list, 100_001).unwrap(),
                coded(Mode::Indices, 2, list.len()),
            ),
        };
        for (at, value) in changes {
            let at = at.index(stream.len());
            stream[at] = value;
        }
        if let Ok(decoded) = one.decode(&stream) {
            prop_assert_eq!(decoded.len() as u64, one.decoded_len());
        }
    }
}
