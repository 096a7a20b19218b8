//! Pictures as KTX2 files of Basis Universal, encoded by the npm package ktx2-encoder 0.6.0 (its
//! authors' own encoder) from the texels of [`ktx2_texel`].

use serde_json::json;

use crate::file::File;

/// Width and height of the pictures.
pub const KTX2_SIZE: (usize, usize) = (18, 10);

/// By ETC1S, with mip levels.
pub const ETC1S: &[u8] = include_bytes!("ktx2/etc1s.ktx2");
/// By UASTC, without supercompression.
pub const UASTC: &[u8] = include_bytes!("ktx2/uastc.ktx2");
/// By UASTC and Zstandard, with mip levels.
pub const UASTC_ZSTD: &[u8] = include_bytes!("ktx2/uastc-zstd.ktx2");

/// The texel that was encoded, RGBA.
#[must_use]
pub fn ktx2_texel(x: usize, y: usize) -> [u8; 4] {
    [20 + 12 * x, 30 + 20 * y, 200 - 8 * x - 2 * y, 255 - 10 * y].map(|v| v as u8)
}

/// A triangle that emits this KTX2 picture.
#[must_use]
pub fn ktx2_file(picture: &[u8]) -> File {
    let mut file = File::with_triangle();
    let view = file.view(picture);
    let image = file.push(
        "images",
        json!({ "bufferView": view, "mimeType": "image/ktx2" }),
    );
    let basis = json!({ "KHR_texture_basisu": { "source": image } });
    let texture = file.push("textures", json!({ "extensions": basis }));
    file.json["extensionsRequired"] = json!(["KHR_texture_basisu"]);
    file.attribute("TEXCOORD_0", &[0., 0., 1., 0., 0., 1.], "VEC2");
    file.material(json!({ "emissiveTexture": { "index": texture } }));
    file
}
