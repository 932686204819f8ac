//! Indices as meshopt compresses them: "Mode 1: triangles" and "Mode 2: indices" of KHR_meshopt_compression.

/// Decodes the indices of a list of triangles, each of `stride` bytes; `None` where the data is damaged.
pub fn triangles(data: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    let (&0xe1, body) = data.split_first()? else { return None };
    let (codes, body) = body.split_at_checked(count / 3)?;
    let (rest, table) = body.split_last_chunk::<16>()?;
    let mut state = Triangles {
        rest,
        next: 0,
        last: 0,
        edges: Recent::new([u32::MAX; 2]),
        corners: Recent::new(u32::MAX),
    };
    let mut out = Vec::with_capacity(count * stride);
    for code in codes {
        for index in state.triangle(*code, table)? {
            out.extend_from_slice(&index.to_le_bytes()[..stride]);
        }
    }
    state.rest.is_empty().then_some(out)
}

/// Decodes a sequence of indices, each of `stride` bytes; `None` where the data is damaged.
pub fn sequence(data: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    let (&0xd1, body) = data.split_first()? else { return None };
    let (mut rest, _) = body.split_last_chunk::<4>()?;
    // Each index has a byte at least.
    if rest.len() < count {
        return None;
    }
    let mut last = [0u32; 2];
    let mut out = Vec::with_capacity(count * stride);
    for _ in 0..count {
        let value = number(&mut rest)?;
        let last = &mut last[(value & 1) as usize];
        *last = last.wrapping_add(unzigzag(value >> 1));
        out.extend_from_slice(&last.to_le_bytes()[..stride]);
    }
    rest.is_empty().then_some(out)
}

/// A number of seven bits a byte, the lowest first.
fn number(rest: &mut &[u8]) -> Option<u32> {
    let mut value = 0;
    for place in 0..5 {
        let (byte, left) = rest.split_first()?;
        *rest = left;
        value |= u32::from(byte & 0x7f) << (7 * place);
        if byte & 0x80 == 0 {
            return Some(value);
        }
    }
    None
}

fn unzigzag(value: u32) -> u32 {
    value >> 1 ^ (value & 1).wrapping_neg()
}

/// The sixteen things that were pushed last.
struct Recent<T> {
    things: [T; 16],
    at: usize,
}

impl<T: Copy> Recent<T> {
    fn new(thing: T) -> Self {
        Self { things: [thing; 16], at: 0 }
    }

    fn push(&mut self, thing: T) {
        self.things[self.at % 16] = thing;
        self.at += 1;
    }

    /// The thing that was pushed so many before the last.
    fn get(&self, before: usize) -> T {
        self.things[(self.at + 31 - before) % 16]
    }
}

struct Triangles<'a> {
    rest: &'a [u8],
    /// Index that follows the highest so far.
    next: u32,
    /// Index that was stored as a difference last.
    last: u32,
    edges: Recent<[u32; 2]>,
    corners: Recent<u32>,
}

impl Triangles<'_> {
    fn triangle(&mut self, code: u8, table: &[u8; 16]) -> Option<[u32; 3]> {
        let (high, low) = (usize::from(code >> 4), usize::from(code & 15));
        if high < 15 { self.on_an_edge(high, low) } else { self.apart(low, table) }
    }

    /// A triangle on an edge of another.
    fn on_an_edge(&mut self, edge: usize, corner: usize) -> Option<[u32; 3]> {
        let [a, b] = self.edges.get(edge);
        let c = match corner {
            0 => self.fresh(),
            13 => self.moved(self.last.wrapping_sub(1)),
            14 => self.moved(self.last.wrapping_add(1)),
            15 => self.stored()?,
            _ => self.corners.get(corner),
        };
        if !(1..13).contains(&corner) {
            self.corners.push(c);
        }
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        Some([a, b, c])
    }

    /// A triangle of three corners.
    fn apart(&mut self, code: usize, table: &[u8; 16]) -> Option<[u32; 3]> {
        let listed = code < 14;
        let pair = if listed {
            table[code]
        } else {
            let (byte, left) = self.rest.split_first()?;
            self.rest = left;
            if *byte == 0 {
                self.next = 0;
            }
            *byte
        };
        let places = [if code == 15 { 15 } else { 0 }, usize::from(pair >> 4), usize::from(pair & 15)];
        if listed && places.contains(&15) {
            return None;
        }
        // Those that are next come before those that are stored.
        let known = places.map(|place| match place {
            0 => self.fresh(),
            15 => 0,
            _ => self.corners.get(place - 1),
        });
        let mut corners = known;
        for (corner, _) in corners.iter_mut().zip(places).filter(|(_, place)| *place == 15) {
            *corner = self.stored()?;
        }
        for (corner, _) in corners.into_iter().zip(places).filter(|(_, place)| matches!(place, 0 | 15)) {
            self.corners.push(corner);
        }
        let [a, b, c] = corners;
        for edge in [[b, a], [c, b], [a, c]] {
            self.edges.push(edge);
        }
        Some(corners)
    }

    /// The index that was not used yet.
    fn fresh(&mut self) -> u32 {
        let fresh = self.next;
        self.next = fresh.wrapping_add(1);
        fresh
    }

    fn moved(&mut self, to: u32) -> u32 {
        self.last = to;
        to
    }

    /// An index that is stored as a difference.
    fn stored(&mut self) -> Option<u32> {
        let delta = unzigzag(number(&mut self.rest)?);
        Some(self.moved(self.last.wrapping_add(delta)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_seven_bits() {
        for (bytes, value) in [(&[0x7f][..], 0x7f), (&[0x81, 0x04], 0x201), (&[0xff, 0xa0, 0x05], 0x1_507f)] {
            assert_eq!(number(&mut &bytes[..]), Some(value));
        }
        assert_eq!(number(&mut &[0x80; 6][..]), None);
        assert_eq!(number(&mut &[0x80][..]), None);
    }

    #[test]
    fn data_that_is_too_short_or_too_long_is_damaged() {
        let two = [&[0xd1, 4, 4][..], &[0; 4]].concat();
        assert_eq!(sequence(&two, 2, 2), Some(vec![1, 0, 2, 0]));
        assert_eq!([1, 3].map(|count| sequence(&two, count, 2)), [None, None]);
        let one = [&[0xe1, 0xf0][..], &[0; 16]].concat();
        assert_eq!(triangles(&one, 3, 2), Some(vec![0, 0, 1, 0, 2, 0]));
        assert_eq!([0, 6].map(|count| triangles(&one, count, 2)), [None, None]);
    }
}
