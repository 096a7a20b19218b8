//! The file format: little-endian, packed; see `Record` for its chunks.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use anyhow::{Context, bail};
use glam::Vec3;
use serde::Serialize;

const MAGIC: u32 = 0xA701_B600;

/// The longest file that is read, in bytes; recordings of whole games are some ten megabytes.
const MAX_BYTES: u64 = 1 << 30;

/// A file.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// In units of clip w.
    pub near: f32,
    /// Pixels of the recorder's depth buffer.
    pub width: u32,
    /// The same, downwards.
    pub height: u32,
    /// In the order of the file.
    pub records: Vec<Record>,
}

/// What the recorder answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// May be seen.
    Visible,
    /// Hidden by occluders.
    Occluded,
    /// Outside the frustum.
    ViewCulled,
    /// None of these.
    Unknown,
}

/// One chunk.
#[derive(Debug, Clone, PartialEq)]
pub enum Record {
    /// Occluders.
    Render(Verdict, Triangles),
    /// Screen rectangle (normalized device coordinates: x0, y0, x1, y1) at a clip w.
    TestRect(Verdict, [f32; 4], f32),
    /// Triangles as an occludee.
    TestTriangles(Verdict, Triangles),
    /// The depth buffer begins anew.
    Clear,
}

/// An indexed triangle list.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Triangles {
    /// x, y and z for those with a matrix; x, y and w of clip space otherwise.
    pub vertices: Vec<Vec3>,
    /// Three per triangle.
    pub indices: Vec<u32>,
    /// Clip from model, column by column.
    pub matrix: Option<[f32; 16]>,
    /// 0 none, 1 clockwise is back-facing, 2 counter-clockwise is.
    pub backface_winding: i32,
}

impl Recording {
    /// Reads a file.
    ///
    /// # Errors
    /// Names the file, the record and the cause.
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let bytes = read_limited(path)
            .with_context(|| format!("cannot read the recording '{}'", path.display()))?;
        Self::parse(&bytes).with_context(|| format!("the recording '{}' is wrong", path.display()))
    }

    /// Decodes a file's bytes.
    ///
    /// # Errors
    /// Names the record and the cause.
    pub fn parse(bytes: &[u8]) -> anyhow::Result<Self> {
        let mut reader = Reader { rest: bytes };
        if reader.u32()? != MAGIC {
            bail!("it does not begin with the magic number {MAGIC:#x}");
        }
        let near = reader.f32()?;
        let (width, height) = (reader.u32()?, reader.u32()?);
        if !(near.is_finite() && near > 0.0) {
            bail!("its near plane is {near}; it must be greater than 0");
        }
        let mut records = Vec::new();
        loop {
            let place = bytes.len() - reader.rest.len();
            let record = reader
                .record()
                .with_context(|| format!("record {} at byte {place}", records.len()))?;
            match record {
                Some(record) => records.push(record),
                None => break,
            }
        }
        Ok(Self {
            near,
            width,
            height,
            records,
        })
    }
}

/// A file's bytes; pipes and devices, which may never end, are no recordings.
fn read_limited(path: &Path) -> anyhow::Result<Vec<u8>> {
    if !path.metadata()?.is_file() {
        bail!("it is not a file");
    }
    let mut bytes = Vec::new();
    File::open(path)?
        .take(MAX_BYTES + 1)
        .read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MAX_BYTES {
        bail!("it is longer than {} MiB", MAX_BYTES >> 20);
    }
    Ok(bytes)
}

struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    fn record(&mut self) -> anyhow::Result<Option<Record>> {
        Ok(Some(match self.bytes(1)?[0] {
            0 => Record::Render(self.verdict()?, self.triangles()?),
            1 => {
                let verdict = self.verdict()?;
                let rect = [self.f32()?, self.f32()?, self.f32()?, self.f32()?];
                Record::TestRect(verdict, rect, self.f32()?)
            }
            2 => Record::TestTriangles(self.verdict()?, self.triangles()?),
            3 => Record::Clear,
            0x7F => return Ok(None),
            tag => bail!("there is no kind of record {tag:#x}"),
        }))
    }

    fn verdict(&mut self) -> anyhow::Result<Verdict> {
        Ok(match self.i32()? {
            0 => Verdict::Visible,
            1 => Verdict::Occluded,
            3 => Verdict::ViewCulled,
            _ => Verdict::Unknown,
        })
    }

    fn triangles(&mut self) -> anyhow::Result<Triangles> {
        let count = self.length("vertices")?;
        if count == 0 {
            return Ok(Triangles::default());
        }
        let stride = self.length("bytes per vertex")?;
        let size = count.checked_mul(stride).context("its size overflows")?;
        let vertices = self.bytes(size)?;
        let triangles = self.length("triangles")?;
        let size = triangles.checked_mul(12).context("its size overflows")?;
        let indices: Vec<u32> = self
            .bytes(size)?
            .chunks_exact(4)
            .map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]))
            .collect();
        if let Some(index) = indices.iter().find(|&&i| i as usize >= count) {
            bail!("index {index} is past the end of {count} vertices");
        }
        let matrix = if self.bytes(1)?[0] != 0 {
            let mut matrix = [0.0; 16];
            for m in &mut matrix {
                *m = self.f32()?;
            }
            Some(matrix)
        } else {
            None
        };
        let _clip_planes = self.i32()?;
        let backface_winding = self.i32()?;
        let _layout_stride = self.i32()?;
        let offsets = [
            0,
            self.length("offset of y")?,
            self.length("offset of z or w")?,
        ];
        if let Some(offset) = offsets.iter().find(|&&o| o + 4 > stride) {
            bail!("a coordinate at byte {offset} does not fit into vertices of {stride} bytes");
        }
        let vertices = vertices
            .chunks_exact(stride)
            .map(|v| {
                Vec3::from_array(
                    offsets.map(|o| f32::from_le_bytes([v[o], v[o + 1], v[o + 2], v[o + 3]])),
                )
            })
            .collect();
        Ok(Triangles {
            vertices,
            indices,
            matrix,
            backface_winding,
        })
    }

    fn bytes(&mut self, count: usize) -> anyhow::Result<&'a [u8]> {
        let (bytes, rest) = self
            .rest
            .split_at_checked(count)
            .context("the file ends in the middle of it")?;
        self.rest = rest;
        Ok(bytes)
    }

    fn word(&mut self) -> anyhow::Result<[u8; 4]> {
        let b = self.bytes(4)?;
        Ok([b[0], b[1], b[2], b[3]])
    }

    fn u32(&mut self) -> anyhow::Result<u32> {
        Ok(u32::from_le_bytes(self.word()?))
    }

    fn i32(&mut self) -> anyhow::Result<i32> {
        Ok(i32::from_le_bytes(self.word()?))
    }

    fn f32(&mut self) -> anyhow::Result<f32> {
        Ok(f32::from_le_bytes(self.word()?))
    }

    fn length(&mut self, what: &str) -> anyhow::Result<usize> {
        let length = self.i32()?;
        usize::try_from(length).with_context(|| format!("{length} {what}"))
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_device_without_an_end_is_no_recording() {
        let error = Recording::read(Path::new("/dev/zero")).expect_err("it has no end");
        let text = format!("{error:#}");
        assert_eq!(
            text,
            "cannot read the recording '/dev/zero': it is not a file"
        );
    }
}
