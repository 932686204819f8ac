//! Segments of a picture: rows in which tiles share what neighbouring frames have in common, since it is computed and
//! kept for all of a segment at once. They lie where the picture has them, whatever tiles a host asks for.

use isophote::engine::Rect;

/// Rows of a segment, about. Fewer would compute more of what lies around each anew, more would read and keep more for
/// a single tile.
const ROWS: u32 = 540;
/// Widest picture that has segments. Pictures without bounds are wider.
const WIDEST: u32 = 16_384;

/// Part of a picture that is rendered at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// The pixels that are wanted.
    pub inside: Rect,
    /// The segment that they lie in; none where nothing is shared.
    pub segment: Option<Rect>,
}

impl Part {
    /// A part that shares nothing.
    pub fn alone(inside: Rect) -> Self {
        Self { inside, segment: None }
    }

    /// True where no more than a part of a picture of this size is wanted.
    pub fn is_strip(&self, size: [u32; 2]) -> bool {
        self.inside != Rect::of_size(size[0], size[1])
    }
}

/// The parts of `inside` of a picture of this size: one for each of the segments that it lies in, or one for all of the
/// picture.
pub fn parts(size: [u32; 2], inside: Rect) -> Vec<Part> {
    let whole = Rect::of_size(size[0], size[1]);
    if inside == whole {
        return vec![Part { inside, segment: Some(whole) }];
    }
    if size[0] > WIDEST {
        return vec![Part::alone(inside)];
    }
    let part = |segment: Rect| Part { inside: inside.intersection(&segment), segment: Some(segment) };
    segments(size).map(part).filter(|part| !part.inside.is_empty()).collect()
}

/// All segments of a picture of this size, from the top.
pub fn segments(size: [u32; 2]) -> impl Iterator<Item = Rect> {
    let count = ((size[1] + ROWS / 2) / ROWS).max(1);
    let edge = move |index: u32| (u64::from(size[1]) * u64::from(index) / u64::from(count)) as i32;
    let whole = Rect::of_size(size[0], size[1]);
    (0..count).map(move |index| Rect { y0: edge(index), y1: edge(index + 1), ..whole })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_cover_what_is_wanted_once_and_do_not_move() {
        let size = [1920, 1080];
        let halves = [0, 540].map(|y0| Rect { y0, y1: y0 + 540, ..Rect::of_size(1920, 1080) });
        let of = |y0, y1| parts(size, Rect { x0: 7, y0, x1: 1913, y1 });
        assert_eq!(parts(size, Rect::of_size(1920, 1080)).len(), 1);
        for y0 in (0..1080).step_by(60) {
            let all = of(y0, (y0 + 100).min(1080));
            assert_eq!(all.iter().map(|part| part.inside.height()).sum::<u32>(), 100.min(1080 - y0 as u32));
            assert!(all.iter().all(|part| halves.contains(&part.segment.unwrap())));
        }
        let small = Rect { x0: 1, y0: 1, x1: 2, y1: 2 };
        assert_eq!(parts([64, 48], small), [Part { inside: small, segment: Some(Rect::of_size(64, 48)) }]);
        assert_eq!(parts([32_768, 32_768], small), [Part::alone(small)]);
    }
}
