//! Mode ATTRIBUTES: blocks of elements, each byte position a stream of its own, coded as
//! differences.
//!
//! Version 0 (both extensions) codes each byte's difference in groups of 16 with 0, 2, 4 or 8 bits.
//! Version 1 (KHR alone) adds groups of 1 bit, streams of zeros and of plain bytes, and differences
//! of 16 bits or by XOR.

use super::bytes::{Bytes, unzigzag};

const GROUP: usize = 16;
const MAX_BLOCK: usize = 256;
const BLOCK_BYTES: usize = 8192;

/// Bits per value that a group's two header bits name.
const BITS_V0: [u32; 4] = [0, 2, 4, 8];
const BITS_V1: [[u32; 4]; 2] = [[0, 1, 2, 4], [1, 2, 4, 8]];

/// `count` elements of `stride` bytes; `None` for a broken stream.
pub(super) fn decode(stream: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    let (&header, body) = stream.split_first()?;
    let version = header & 0x0F;
    if header & 0xF0 != 0xA0 || version > 1 {
        return None;
    }
    let channel_bytes = if version == 0 { 0 } else { stride / 4 };
    let tail = stride + channel_bytes;
    let padded = tail.max(if version == 0 { 32 } else { 24 });
    let tail_at = body.len().checked_sub(tail)?;
    let mut last = body[tail_at..tail_at + stride].to_vec();
    let channels = &body[tail_at + stride..];
    let mut bytes = Bytes(&body[..body.len().checked_sub(padded)?]);

    let block = (BLOCK_BYTES / stride / GROUP * GROUP).min(MAX_BLOCK);
    // Not all at once: a short stream for many elements ends before they are all there.
    let mut out = Vec::new();
    let mut done = 0;
    while done < count {
        let now = block.min(count - done);
        out.resize((done + now) * stride, 0);
        let elements = &mut out[done * stride..];
        let controls = if version == 0 {
            &[]
        } else {
            bytes.take(stride / 4)?
        };
        for k in (0..stride).step_by(4) {
            let streams = read_streams(&mut bytes, controls.get(k / 4).copied(), now)?;
            let before = [last[k], last[k + 1], last[k + 2], last[k + 3]];
            let channel = channels.get(k / 4).copied().unwrap_or(0);
            let columns = elements.chunks_exact_mut(stride).map(|e| &mut e[k..k + 4]);
            add_differences(&streams, channel, before, columns)?;
        }
        last.copy_from_slice(&elements[(now - 1) * stride..]);
        done += now;
    }
    bytes.0.is_empty().then_some(out)
}

/// The streams of four neighbouring bytes.
type Streams = [[u8; MAX_BLOCK]; 4];

fn read_streams(bytes: &mut Bytes<'_>, control: Option<u8>, count: usize) -> Option<Streams> {
    let mut streams = [[0; MAX_BLOCK]; 4];
    for (j, stream) in streams.iter_mut().enumerate() {
        let padded = &mut stream[..count.next_multiple_of(GROUP)];
        match control.map(|c| c >> (2 * j) & 3) {
            None => read_groups(bytes, padded, BITS_V0)?,
            Some(kind @ (0 | 1)) => read_groups(bytes, padded, BITS_V1[kind as usize])?,
            Some(2) => {}
            Some(_) => stream[..count].copy_from_slice(bytes.take(count)?),
        }
    }
    Some(streams)
}

fn read_groups(bytes: &mut Bytes<'_>, stream: &mut [u8], bits: [u32; 4]) -> Option<()> {
    let headers = bytes.take((stream.len() / GROUP).div_ceil(4))?;
    for (i, group) in stream.as_chunks_mut::<GROUP>().0.iter_mut().enumerate() {
        let bits = bits[usize::from(headers[i / 4] >> (i % 4 * 2) & 3)];
        read_group(bytes, group, bits)?;
    }
    Some(())
}

/// 16 values of `bits` each; the largest one stands for a whole byte after them.
fn read_group(bytes: &mut Bytes<'_>, group: &mut [u8; GROUP], bits: u32) -> Option<()> {
    if bits == 0 {
        *group = [0; GROUP];
        return Some(());
    }
    let packed = bytes.take(2 * bits as usize)?;
    if bits == 8 {
        group.copy_from_slice(packed);
        return Some(());
    }
    let (per_byte, mask) = (8 / bits, (1u8 << bits) - 1);
    for (i, value) in (0..).zip(group.iter_mut()) {
        let place = i % per_byte;
        // Single bits begin at the low end, others at the high end.
        let shift = if bits == 1 {
            place
        } else {
            8 - bits * (place + 1)
        };
        *value = packed[(i / per_byte) as usize] >> shift & mask;
        if *value == mask {
            *value = bytes.byte()?;
        }
    }
    Some(())
}

/// Turns differences into values, as the channel says.
fn add_differences<'a>(
    streams: &Streams,
    channel: u8,
    before: [u8; 4],
    columns: impl Iterator<Item = &'a mut [u8]>,
) -> Option<()> {
    let mut last = u32::from_le_bytes(before);
    let rotation = u32::from(channel >> 4);
    for (i, column) in columns.enumerate() {
        let coded =
            u32::from_le_bytes([streams[0][i], streams[1][i], streams[2][i], streams[3][i]]);
        last = match channel & 3 {
            0 => per_lane(coded, last, 8),
            1 => per_lane(coded, last, 16),
            2 => coded.rotate_right(rotation) ^ last,
            _ => return None,
        };
        column.copy_from_slice(&last.to_le_bytes());
    }
    Some(())
}

/// Zigzag differences to the values before, in lanes of 8 or 16 bits.
fn per_lane(coded: u32, last: u32, bits: u32) -> u32 {
    let mask = (1u32 << bits) - 1;
    (0..32 / bits).fold(0, |all, lane| {
        let shift = lane * bits;
        let value = unzigzag(coded >> shift & mask).wrapping_add(last >> shift);
        all | (value & mask) << shift
    })
}
