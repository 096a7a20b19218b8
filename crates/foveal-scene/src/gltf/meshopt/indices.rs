//! Modes TRIANGLES and INDICES.
//!
//! Triangles name edges and vertices of those before them, from queues of 16 each; both sides keep
//! the queues alike.

use super::bytes::{Bytes, unzigzag};

/// The last 16 of something.
struct Queue<T> {
    items: [T; 16],
    next: usize,
}

impl<T: Copy> Queue<T> {
    fn new(filler: T) -> Self {
        Self {
            items: [filler; 16],
            next: 0,
        }
    }

    fn push(&mut self, item: T) {
        self.push_if(item, true);
    }

    /// Written in either case, but kept only if `keep`.
    fn push_if(&mut self, item: T, keep: bool) {
        self.items[self.next] = item;
        self.next = (self.next + usize::from(keep)) & 15;
    }

    /// The item that was pushed `ago` pushes before the last (0: the last one).
    fn ago(&self, ago: u8) -> T {
        self.items[self.next.wrapping_sub(1 + usize::from(ago)) & 15]
    }
}

/// Numbers that follow each other closely.
struct Deltas<'a> {
    bytes: Bytes<'a>,
    last: u32,
}

impl Deltas<'_> {
    fn free(&mut self) -> Option<u32> {
        let delta = unzigzag(self.bytes.number()?);
        self.last = self.last.wrapping_add(delta);
        Some(self.last)
    }
}

struct Output {
    bytes: Vec<u8>,
    wide: bool,
}

impl Output {
    fn new(stride: usize) -> Self {
        Self {
            bytes: Vec::new(),
            wide: stride == 4,
        }
    }

    fn push(&mut self, index: u32) {
        if self.wide {
            self.bytes.extend(index.to_le_bytes());
        } else {
            self.bytes.extend((index as u16).to_le_bytes());
        }
    }
}

/// A triangle list of `count` indices; `None` for a broken stream.
pub(super) fn triangles(stream: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    let (&header, body) = stream.split_first()?;
    let version = header & 0x0F;
    if header & 0xF0 != 0xE0 || version > 1 {
        return None;
    }
    let (codes, data) = body.split_at_checked(count / 3)?;
    let (data, table) = data.split_at_checked(data.len().checked_sub(16)?)?;
    let most_recent = if version == 0 { 15 } else { 13 };

    let mut out = Output::new(stride);
    let mut edges = Queue::new([u32::MAX; 2]);
    let mut vertices = Queue::new(u32::MAX);
    let mut next = 0u32;
    let mut deltas = Deltas {
        bytes: Bytes(data),
        last: 0,
    };
    let fresh = |next: &mut u32| {
        let index = *next;
        *next = next.wrapping_add(1);
        index
    };
    for &code in codes {
        let (a, b, c);
        if code < 0xF0 {
            [a, b] = edges.ago(code >> 4);
            let third = code & 15;
            if third < most_recent {
                c = match third {
                    0 => fresh(&mut next),
                    third => vertices.ago(third),
                };
                vertices.push_if(c, third == 0);
            } else {
                c = match third {
                    15 => deltas.free()?,
                    // 13 and 14: the last free index less and plus one.
                    third => {
                        let step = u32::from(third).wrapping_mul(2).wrapping_sub(27);
                        deltas.last = deltas.last.wrapping_add(step);
                        deltas.last
                    }
                };
                vertices.push(c);
            }
        } else {
            let aux = match code {
                0xFE.. => deltas.bytes.byte()?,
                _ => table[usize::from(code & 15)],
            };
            if code >= 0xFE && aux == 0 {
                next = 0;
            }
            let recent = [aux >> 4, aux & 15];
            let is_new = |kind: u8| kind == 0 || (code >= 0xFE && kind == 15);
            let first = if code == 0xFF {
                None
            } else {
                Some(fresh(&mut next))
            };
            // Queue entries are taken before anything of this triangle is pushed.
            let mut pick = |kind: u8| match kind {
                0 => Some(fresh(&mut next)),
                15 if code >= 0xFE => None,
                kind => Some(vertices.ago(kind - 1)),
            };
            let (second, third) = (pick(recent[0]), pick(recent[1]));
            let mut or_free = |index: Option<u32>| index.map_or_else(|| deltas.free(), Some);
            a = or_free(first)?;
            b = or_free(second)?;
            c = or_free(third)?;
            vertices.push(a);
            vertices.push_if(b, is_new(recent[0]));
            vertices.push_if(c, is_new(recent[1]));
            edges.push([b, a]);
        }
        [a, b, c].into_iter().for_each(|index| out.push(index));
        edges.push([c, b]);
        edges.push([a, c]);
    }
    deltas.bytes.0.is_empty().then_some(out.bytes)
}

/// A sequence of `count` indices; `None` for a broken stream.
pub(super) fn sequence(stream: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    let (&header, body) = stream.split_first()?;
    if header & 0xF0 != 0xD0 || header & 0x0F > 1 {
        return None;
    }
    let mut bytes = Bytes(&body[..body.len().checked_sub(4)?]);
    let mut out = Output::new(stride);
    let mut last = [0u32; 2];
    for _ in 0..count {
        let coded = bytes.number()?;
        let line = &mut last[(coded & 1) as usize];
        *line = line.wrapping_add(unzigzag(coded >> 1));
        out.push(*line);
    }
    bytes.0.is_empty().then_some(out.bytes)
}
