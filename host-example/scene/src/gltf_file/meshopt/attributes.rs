//! Vertex attributes as meshopt compresses them: bytes of elements are kept apart, as differences from the element
//! before, in groups of sixteen of 0 to 8 bits each. Versions 0 and 1 of "Mode 0: attributes" of KHR_meshopt_compression.

/// Elements of a group.
const GROUP: usize = 16;

/// Most elements of a block.
const BLOCK: usize = 256;

/// Bytes at one place of the elements of a block.
type Plane = [u8; BLOCK];

/// Bits of a difference by the two bits of a group's header.
type Widths = [u8; 4];

/// Decodes elements of `stride` bytes, which are 4 to 256 and a multiple of 4; `None` where the data is damaged.
pub fn decode(data: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    let (header, body) = data.split_first()?;
    let (newer, least) = match header {
        0xa0 => (false, 32),
        0xa1 => (true, 24),
        _ => return None,
    };
    let tail = stride + if newer { stride / 4 } else { 0 };
    let (mut rest, end) = body.split_at(body.len().checked_sub(tail.max(least))?);
    let (base, modes) = end[end.len() - tail..].split_at(stride);
    let mut previous = base.to_vec();
    let mut out = Vec::with_capacity(count * stride);
    let most = ((8192 / stride) & !(GROUP - 1)).min(BLOCK);
    let mut left = count;
    while left > 0 {
        let elements = left.min(most);
        let controls = if newer { Some(take(&mut rest, stride / 4)?) } else { None };
        let start = out.len();
        out.resize(start + elements * stride, 0);
        for channel in 0..stride / 4 {
            let mut planes = [[0; BLOCK]; 4];
            for (k, plane) in planes.iter_mut().enumerate() {
                let control = controls.map(|controls| controls[channel] >> (2 * k) & 3);
                read_plane(&mut rest, control, elements, plane)?;
            }
            let mode = modes.get(channel).copied().unwrap_or(0);
            let previous = previous[channel * 4..].first_chunk_mut::<4>()?;
            let places = out[start + channel * 4..].chunks_mut(stride);
            for (element, place) in places.enumerate() {
                *previous = applied(mode, *previous, planes.each_ref().map(|plane| plane[element]))?;
                place[..4].copy_from_slice(previous);
            }
        }
        left -= elements;
    }
    rest.is_empty().then_some(out)
}

fn take<'a>(rest: &mut &'a [u8], count: usize) -> Option<&'a [u8]> {
    let (taken, left) = rest.split_at_checked(count)?;
    *rest = left;
    Some(taken)
}

/// Reads one byte of each element of a block. Version 0 has no `control`.
fn read_plane(rest: &mut &[u8], control: Option<u8>, elements: usize, plane: &mut Plane) -> Option<()> {
    let widths: Widths = match control {
        None => [0, 2, 4, 8],
        Some(0) => [0, 1, 2, 4],
        Some(1) => [1, 2, 4, 8],
        Some(2) => return Some(()),
        Some(_) => {
            plane[..elements].copy_from_slice(take(rest, elements)?);
            return Some(());
        }
    };
    let groups = elements.div_ceil(GROUP);
    let header = take(rest, groups.div_ceil(4))?;
    for (group, bytes) in plane.as_chunks_mut::<GROUP>().0[..groups].iter_mut().enumerate() {
        let width = widths[usize::from(header[group / 4] >> (group % 4 * 2) & 3)];
        read_group(rest, width, bytes)?;
    }
    Some(())
}

fn read_group(rest: &mut &[u8], width: u8, bytes: &mut [u8; GROUP]) -> Option<()> {
    if width == 8 {
        bytes.copy_from_slice(take(rest, GROUP)?);
        return Some(());
    }
    let width = usize::from(width);
    let packed = take(rest, GROUP * width / 8)?;
    // All bits set stand for a byte of its own, behind those of the group.
    let escape = (1u8 << width) - 1;
    for (i, byte) in bytes.iter_mut().enumerate().filter(|_| width > 0) {
        let bit = i * width % 8;
        // Single bits begin at the lowest, all else at the highest.
        let shift = if width == 1 { bit } else { 8 - width - bit };
        *byte = packed[i * width / 8] >> shift & escape;
        if *byte == escape {
            *byte = take(rest, 1)?[0];
        }
    }
    Some(())
}

/// Four bytes of an element from those of the one before and their difference.
fn applied(mode: u8, previous: [u8; 4], delta: [u8; 4]) -> Option<[u8; 4]> {
    match mode {
        0 => Some(
            [0, 1, 2, 3].map(|k| previous[k].wrapping_add(delta[k] >> 1 ^ (delta[k] & 1).wrapping_neg())),
        ),
        1 => {
            let [low, high] = [0, 2].map(|k| {
                let [previous, delta] = [previous, delta].map(|v| u16::from_le_bytes([v[k], v[k + 1]]));
                previous.wrapping_add(delta >> 1 ^ (delta & 1).wrapping_neg()).to_le_bytes()
            });
            Some([low[0], low[1], high[0], high[1]])
        }
        _ if mode & 15 == 2 => {
            let [previous, delta] = [previous, delta].map(u32::from_le_bytes);
            Some((previous ^ delta.rotate_right(u32::from(mode >> 4))).to_le_bytes())
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_example_of_the_specification() {
        let bytes = [0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5];
        let mut group = [0; GROUP];
        let mut rest = &bytes[..];
        read_group(&mut rest, 4, &mut group).unwrap();
        assert!(rest.is_empty());
        let deltas = group.map(|byte| applied(0, [0; 4], [byte, 0, 0, 0]).unwrap()[0] as i8);
        assert_eq!(deltas, [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0]);
    }

    #[test]
    fn differences_of_two_and_four_bytes() {
        // The zigzag form of -1 is 1, whose low byte comes first.
        assert_eq!(applied(1, [0, 1, 5, 0], [1, 0, 4, 0]), Some([0xff, 0, 7, 0]));
        assert_eq!(applied(0x32, [1, 0, 0, 0], [0x10, 0, 0, 0]), Some([3, 0, 0, 0]));
        assert_eq!([0x10, 0x11, 3].map(|mode| applied(mode, [0; 4], [0; 4])), [None; 3]);
    }

    #[test]
    fn every_stride_of_zeros() {
        for stride in (4..=256).step_by(4) {
            let data = [vec![0xa1; 1], vec![0xaa; stride / 4], vec![0; 24.max(stride + stride / 4)]].concat();
            assert_eq!(decode(&data, 16, stride), Some(vec![0; 16 * stride]));
            assert_eq!(decode(&data[..data.len() - 1], 16, stride), None);
            assert_eq!(decode(&data, 300, stride), None);
        }
    }
}
