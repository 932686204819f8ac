//! Frames made smaller: colours and hatching are averaged over the area that each pixel covers, other guides picked in its
//! middle.

use std::sync::Arc;

use rayon::prelude::*;

use super::frame::{Frame, GuideImage};
use isophote_loader::process::Part;
use isophote_pictures::exr::Guide;

/// The pixels that one of the smaller frame covers along an axis: the first, and the share of each.
struct Span {
    first: usize,
    shares: Vec<f32>,
}

/// All of a picture of a size.
pub fn whole(size: (u32, u32)) -> Part {
    [[0; 2], [size.0 as i32, size.1 as i32]]
}

/// A part of a frame that is made as small as `size`, which is not larger than the frame. The part must lie within it.
pub fn reduced(frame: &Frame, size: (u32, u32), [first, last]: Part) -> Frame {
    let columns = spans(frame.width, size.0, first[0], last[0]);
    let rows = spans(frame.height, size.1, first[1], last[1]);
    let straight = !frame.is_premultiplied();
    let mut color = vec![[0.0; 4]; columns.len() * rows.len()];
    color.par_chunks_mut(columns.len().max(1)).zip(&rows).for_each(|(line, row)| {
        for (pixel, column) in line.iter_mut().zip(&columns) {
            *pixel = average((&frame.color, frame.width), column, row, straight);
        }
    });
    Frame {
        width: columns.len() as u32,
        height: rows.len() as u32,
        color: Arc::new(color),
        guides: frame.guides.iter().map(|image| Arc::new(picked(frame, image, &columns, &rows))).collect(),
        mask: frame.mask.as_ref().map(|mask| Arc::new(cells(mask, frame.width, 1, &columns, &rows))),
        ..*frame
    }
}

/// Numbers of the pixels of a picture, one each, as the pixels of a part of it that is made as small as `size` have them.
pub fn numbers(data: &[f32], before: (u32, u32), size: (u32, u32), [first, last]: Part) -> Vec<f32> {
    let columns = spans(before.0, size.0, first[0], last[0]);
    let rows = spans(before.1, size.1, first[1], last[1]);
    cells(data, before.0, 1, &columns, &rows)
}

/// Spans of `before` that pixels from `first` to `last`, of `after` in all, cover.
fn spans(before: u32, after: u32, first: i32, last: i32) -> Vec<Span> {
    let step = f64::from(before) / f64::from(after.max(1));
    let most = before.saturating_sub(1) as usize;
    let span = |at: i32| {
        let [from, to] = [f64::from(at) * step, f64::from(at + 1) * step];
        let first = (from.floor() as usize).min(most);
        let end = (to.ceil() as usize).clamp(first + 1, most + 1);
        let covered = |cell: usize| ((cell + 1) as f64).min(to) - (cell as f64).max(from);
        let sum: f64 = (first..end).map(covered).sum();
        Span { first, shares: (first..end).map(|cell| (covered(cell) / sum) as f32).collect() }
    };
    (first..last).map(span).collect()
}

fn average((colors, width): (&[[f32; 4]], u32), column: &Span, row: &Span, straight: bool) -> [f32; 4] {
    let at = |x: usize, y: usize| colors[y * width as usize + x];
    if let ([_], [_]) = (&column.shares[..], &row.shares[..]) {
        return at(column.first, row.first);
    }
    let mut sum = [0.0_f32; 4];
    for (y, down) in row.shares.iter().enumerate() {
        for (x, across) in column.shares.iter().enumerate() {
            let [r, g, b, a] = at(column.first + x, row.first + y);
            let share = across * down;
            let weight = if straight { a * share } else { share };
            for (sum, part) in sum.iter_mut().zip([r * weight, g * weight, b * weight, a * share]) {
                *sum += part;
            }
        }
    }
    let [r, g, b, a] = sum;
    let divisor = if straight { a.max(1e-12) } else { 1.0 };
    [r / divisor, g / divisor, b / divisor, a]
}

fn picked(frame: &Frame, image: &GuideImage, columns: &[Span], rows: &[Span]) -> GuideImage {
    let is_averaged = image.guide.is_colour() || image.guide == Guide::Hatching;
    if let (true, (colors, [])) = (is_averaged, image.data.as_chunks::<4>()) {
        let straight = image.guide.is_colour() && !frame.is_premultiplied();
        let colors = (colors, frame.width);
        let all = rows.iter().flat_map(|row| columns.iter().map(move |column| (column, row)));
        let data = all.flat_map(|(column, row)| average(colors, column, row, straight)).collect();
        return GuideImage { data, ..*image };
    }
    let data = cells(&image.data, frame.width, image.channels as usize, columns, rows);
    GuideImage { data, ..*image }
}

/// Numbers in the middle of each pixel, so many a pixel, of rows of a width.
fn cells(data: &[f32], width: u32, channels: usize, columns: &[Span], rows: &[Span]) -> Vec<f32> {
    let middle = |span: &Span| span.first + span.shares.len() / 2;
    let cells = rows.iter().flat_map(|row| columns.iter().map(move |column| (middle(column), middle(row))));
    let numbers = cells.flat_map(|(x, y)| {
        let at = (y * width as usize + x) * channels;
        data[at..][..channels].iter().copied()
    });
    numbers.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_pictures::meaning::Meaning;
    use isophote_pictures::pixels::{Pixels, Samples};
    use isophote_pictures::read::Source;

    fn frame(width: u32, height: u32, values: Vec<u8>) -> Frame {
        let pixels = Pixels::new(width, height, 4, Samples::U8(values)).unwrap();
        Frame::of("a", Source::alone(pixels, Meaning::display()), None, None).unwrap()
    }

    #[test]
    fn areas_are_averaged_by_what_they_cover() {
        let grey = |values: &[u8]| {
            frame(values.len() as u32, 1, values.iter().flat_map(|v| [*v, *v, *v, 255]).collect())
        };
        let half = reduced(&grey(&[0, 255, 51, 51]), (2, 1), whole((2, 1)));
        assert_eq!((half.width, half.height), (2, 1));
        assert!((half.color[0][0] - 0.5).abs() < 1e-6 && (half.color[1][0] - 0.2).abs() < 1e-6);
        // Of three pixels on two, the middle one belongs to both.
        let two = reduced(&grey(&[0, 255, 0]), (2, 1), whole((2, 1)));
        assert!(two.color.iter().all(|pixel| (pixel[0] - 1.0 / 3.0).abs() < 1e-6), "{:?}", two.color);
    }

    #[test]
    fn a_part_is_cut_from_the_whole_and_the_same_size_is_the_same_frame() {
        let frame = frame(6, 4, (0..96).map(|n| n * 2).collect());
        let all = reduced(&frame, (3, 2), whole((3, 2)));
        let part = reduced(&frame, (3, 2), [[1, 1], [3, 2]]);
        assert_eq!((part.width, part.height), (2, 1));
        assert_eq!(**part.color, all.color[4..6]);
        assert_eq!(reduced(&frame, (6, 4), whole((6, 4))), frame);
    }

    #[test]
    fn what_is_not_covered_lends_no_colour() {
        let frame = frame(2, 1, vec![255, 0, 0, 0, 0, 255, 0, 255]);
        assert_eq!(reduced(&frame, (1, 1), whole((1, 1))).color[..], [[0.0, 1.0, 0.0, 0.5]]);
    }
}
