//! KTX2 pictures.

use foveal_seeds::{ETC1S, KTX2_SIZE, UASTC, UASTC_ZSTD, ktx2_file, ktx2_texel};

use super::{Loads, warnings};
use crate::{Encoding, LoadOptions, Scene};

/// With a word of the file replaced.
fn changed(file: &[u8], at: usize, word: u32) -> Vec<u8> {
    let mut file = file.to_vec();
    file[at..at + 4].copy_from_slice(&word.to_le_bytes());
    file
}

/// FNV-1a of 64 bits.
fn hash(bytes: &[u8]) -> u64 {
    let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, step)
}

#[test]
fn ktx2_pictures_of_either_codec_are_read_as_by_the_reference_transcoder() {
    // Hash of the texels that Basis Universal's transcoder gives, and their distance from those
    // that were encoded.
    let uastc = 0x0b6f_8597_ba7c_4a0d;
    for (bytes, reference, rms) in [
        (ETC1S, 0x99b4_01f6_0e61_47dd, 11.93),
        (UASTC, uastc, 4.23),
        (UASTC_ZSTD, uastc, 4.23),
    ] {
        let scene = ktx2_file(bytes).load();
        assert_eq!(warnings(&scene), "");
        let texture = &scene.textures[0];
        assert_eq!((texture.width, texture.height), (18, 10));
        let read = &texture.levels[0];
        assert_eq!(hash(read), reference);
        let (width, height) = KTX2_SIZE;
        let squares = (0..width * height).flat_map(|i| {
            let wanted = ktx2_texel(i % width, i / width);
            [0, 1, 2, 3].map(|c| f64::from(read[4 * i + c].abs_diff(wanted[c])).powi(2))
        });
        let mean = squares.sum::<f64>() / (4 * width * height) as f64;
        assert!((mean.sqrt() - rms).abs() < 0.01, "{}", mean.sqrt());
    }
}

#[test]
fn a_plain_picture_is_preferred_to_the_ktx2_beside_it() {
    let mut file = ktx2_file(ETC1S);
    let plain = file.texture(&image::RgbaImage::from_pixel(1, 1, image::Rgba([9; 4])));
    let source = file.json["textures"][plain]["source"].clone();
    file.json["textures"][0]["source"] = source;
    assert_eq!(file.load().textures[0].levels[0], [9; 4]);
}

#[test]
fn what_is_no_basis_universal_picture_says_so() {
    let cases = [
        // VK_FORMAT_BC7_SRGB_BLOCK.
        (changed(UASTC, 12, 146), "not of Basis Universal's"),
        (changed(UASTC, 28, 2), "several pictures"),
        (changed(UASTC, 32, 6), "several pictures"),
        (changed(UASTC, 36, 6), "several pictures"),
        (changed(UASTC, 20, 0), "0 x 10 texels"),
        (changed(UASTC, 24, 70_000), "18 x 70000 texels"),
        (changed(UASTC, 44, 3), "not of Basis Universal's"),
        (UASTC[..300].to_vec(), "cut off"),
        (UASTC[..90].to_vec(), "cut off"),
        (changed(UASTC, 48, u32::MAX), "cut off"),
        (b"\xABKTX 11\xBB\r\n\x1A\n".to_vec(), "version 1"),
    ];
    for (bytes, cause) in cases {
        let said = warnings(&ktx2_file(&bytes).load());
        assert!(said.contains(cause), "{cause}: {said}");
    }
}

#[test]
fn stated_lengths_that_the_blocks_do_not_need_are_refused_before_they_are_allocated() {
    // The first level's uncompressed length, which a decoder would allocate.
    for (at, word) in [(96, 1 << 30), (100, 1 << 20)] {
        let said = warnings(&ktx2_file(&changed(UASTC_ZSTD, at, word)).load());
        assert!(said.contains("first level has"), "{said}");
    }
    // 65,536 x 65,536 texels of ETC1S in 700 bytes.
    let large = changed(&changed(ETC1S, 20, 1 << 16), 24, 1 << 16);
    let said = ktx2_file(&large).refusal();
    assert!(said.contains("the limit"), "{said}");
}

#[test]
fn a_bomb_of_zstandard_is_refused_before_it_is_decoded() {
    // A window of 2^40 bytes, then blocks of 4 bytes that stand for 128 KiB each: 2 GiB in all.
    let window = [0x28, 0xB5, 0x2F, 0xFD, 0x00, 0xF0];
    let block = ((131_072u32 << 3) | 1 << 1).to_le_bytes();
    let mut stream = window.to_vec();
    for _ in 0..16_384 {
        stream.extend_from_slice(&block[..3]);
        stream.push(7);
    }
    let (at, length) = (UASTC_ZSTD.len() as u32, stream.len() as u32);
    let mut bomb = changed(&changed(UASTC_ZSTD, 80, at), 88, length);
    bomb.extend(&stream);
    let started = std::time::Instant::now();
    let said = warnings(&ktx2_file(&bomb).load());
    assert!(said.contains("cannot be decoded"), "{said}");
    // 2 GiB take seconds: a bound on work, not a measure of speed.
    assert!(started.elapsed().as_secs() < 20);
    // The same with the largest window that is allowed: the first blocks are more than the level.
    bomb[at as usize + 5] = 0x68;
    let said = warnings(&ktx2_file(&bomb).load());
    assert!(said.contains("cannot be decoded"), "{said}");
}

#[test]
fn any_byte_may_be_wrong() {
    for original in [ETC1S, UASTC, UASTC_ZSTD] {
        for at in 12..original.len() {
            for value in [0, 0xFF, original[at] ^ 1] {
                let mut bytes = original.to_vec();
                bytes[at] = value;
                // A picture, a warning or a refusal.
                let _ = ktx2_file(&bytes).load_with(&LoadOptions::default());
            }
        }
        for end in (0..original.len()).step_by(7) {
            let _ = ktx2_file(&original[..end]).load_with(&LoadOptions::default());
        }
    }
}

/// With the options that keep blocks.
fn in_blocks() -> LoadOptions {
    LoadOptions {
        texture_compression: crate::TextureCompression::Fine,
        ..LoadOptions::default()
    }
}

/// The file's scene, where only the first level is read if not `mips`.
fn loaded(bytes: &[u8], mips: bool, options: &LoadOptions) -> Scene {
    let mut file = ktx2_file(bytes);
    if !mips {
        file.json["samplers"] = serde_json::json!([{ "minFilter": 9729 }]);
        file.json["textures"][0]["sampler"] = serde_json::json!(0);
    }
    let scene = file.load_with(options).unwrap();
    assert_eq!(warnings(&scene), "");
    scene
}

/// A KTX2 file of 16 x 8 texels with all mip levels, of the blocks of `UASTC`.
fn chain() -> Vec<u8> {
    let word = |at: usize| u32::from_le_bytes(*UASTC[at..].first_chunk().unwrap()) as usize;
    let (descriptor, blocks) = (&UASTC[word(48)..word(48) + word(52)], &UASTC[word(80)..]);
    let counts = [8, 2, 1, 1, 1];
    let mut file = changed(&changed(UASTC, 20, 16), 24, 8);
    file = changed(&changed(&file, 40, 5), 48, 200);
    // Neither keys nor global data.
    file.truncate(56);
    file.resize(80, 0);
    let mut at = 200 + descriptor.len() as u64;
    for count in counts {
        for value in [at, 16 * count, 16 * count] {
            file.extend(value.to_le_bytes());
        }
        at += 16 * count;
    }
    file.extend(descriptor);
    for (first, count) in [(0, 8), (2, 2), (5, 1), (6, 1), (7, 1)] {
        file.extend(&blocks[16 * first..16 * (first + count)]);
    }
    file
}

#[test]
fn ktx2_pictures_of_whole_blocks_become_bc7_without_going_through_texels() {
    let whole = |bytes| changed(&changed(bytes, 20, 20), 24, 12);
    let cases = [
        (whole(ETC1S), false, 2.0),
        (whole(UASTC), false, 2.0),
        (whole(UASTC_ZSTD), false, 2.0),
        (chain(), true, 2.0),
    ];
    for (number, (bytes, mips, most)) in cases.iter().enumerate() {
        let plain = &loaded(bytes, *mips, &LoadOptions::default()).textures[0];
        let blocks = &loaded(bytes, *mips, &in_blocks()).textures[0];
        assert_eq!(plain.encoding, Encoding::Rgba8);
        assert_eq!(blocks.encoding, Encoding::Bc7);
        assert_eq!((blocks.width, blocks.height), (plain.width, plain.height));
        assert_eq!(blocks.levels.len(), plain.levels.len());
        let (a, b) = (plain.decoded_level(0), blocks.decoded_level(0));
        let squares = a.iter().zip(b.iter());
        let squares = squares.map(|(a, b)| f64::from(a.abs_diff(*b)).powi(2));
        let off = (squares.sum::<f64>() / a.len() as f64).sqrt();
        assert!(off < *most, "{number}: {off}");
    }
}

#[test]
fn mip_levels_are_the_files_own_where_it_has_them_all() {
    let blocks = &loaded(&chain(), true, &in_blocks()).textures[0];
    assert_eq!(blocks.levels.len(), 5);
    // Levels of 8 x 4 texels are the third and fourth block of the first level.
    assert_eq!(blocks.levels[1], blocks.levels[0][32..64]);
    assert_eq!(blocks.levels[4], blocks.levels[0][112..]);
    // One that is cut off, or has another length, makes them anew.
    let file = chain();
    for broken in [
        file[..file.len() - 1].to_vec(),
        changed(&file, 80 + 4 * 24 + 8, 15),
        changed(&file, 40, 4),
    ] {
        let made = &loaded(&broken, true, &in_blocks()).textures[0];
        assert_eq!((made.encoding, made.levels.len()), (Encoding::Bc7, 5));
        assert_ne!(made.levels[1], blocks.levels[1]);
    }
    // 18 x 10 texels are no whole blocks.
    let odd = &loaded(UASTC, true, &in_blocks()).textures[0];
    assert_eq!(
        odd,
        &loaded(UASTC, true, &LoadOptions::default()).textures[0]
    );
}

#[test]
fn opaque_blocks_stay_opaque() {
    // Blocks of UASTC's mode 0, which has no alpha, and of any other bits.
    let mut file = changed(&changed(UASTC, 20, 20), 24, 12);
    let at = u32::from_le_bytes(*file[80..].first_chunk().unwrap()) as usize;
    let mut bits = 1u32;
    for block in file[at..at + 15 * 16].chunks_exact_mut(16) {
        for byte in &mut *block {
            bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *byte = (bits >> 24) as u8;
        }
        block[0] = block[0] & 0xF0 | 1;
    }
    for options in [LoadOptions::default(), in_blocks()] {
        let texels = loaded(&file, false, &options).textures[0]
            .decoded_level(0)
            .into_owned();
        assert!(texels.iter().skip(3).step_by(4).all(|&alpha| alpha == 255));
    }
}

#[test]
fn mip_levels_of_alpha_masks_are_made_anew_to_keep_their_coverage() {
    let base = |alpha_mode: &str| {
        let mut file = ktx2_file(&chain());
        file.json["materials"][0] = serde_json::json!({
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } },
            "alphaMode": alpha_mode,
        });
        file.load_with(&in_blocks()).unwrap().textures.remove(0)
    };
    let (blend, mask) = (base("BLEND"), base("MASK"));
    let own = |texture: &crate::Texture| texture.levels[1] == texture.levels[0][32..64];
    for texture in [&blend, &mask] {
        assert_eq!((texture.encoding, texture.levels.len()), (Encoding::Bc7, 5));
    }
    assert!(own(&blend) && !own(&mask));
}

#[test]
fn any_byte_may_be_wrong_where_blocks_are_kept() {
    for original in [changed(&changed(ETC1S, 20, 20), 24, 12), chain()] {
        for at in 12..original.len() {
            for value in [0, 0xFF, original[at] ^ 1] {
                let mut bytes = original.clone();
                bytes[at] = value;
                let _ = ktx2_file(&bytes).load_with(&in_blocks());
            }
        }
    }
}
