//! Looks beside each other, each on the whole picture: where their panes lie.

use std::sync::Arc;

use super::look::EditedLook;
use super::viewport::{Area, Compare};

/// Pixels of the window between and around panes.
const GAP: f32 = 8.0;

/// Looks that are compared, two to six.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The looks.
    pub panes: Vec<Arc<EditedLook>>,
    /// The way in which pictures were compared before.
    pub before: Compare,
    /// True where the browser was open before.
    pub from_browser: bool,
}

/// Columns and rows of so many panes in an area in which pictures of an aspect, width over height, are largest.
pub fn grid(count: usize, area: Area, aspect: f32) -> (usize, usize) {
    let height = |columns: usize| {
        let [across, down] = [columns, count.div_ceil(columns)].map(|n| n as f32);
        (area.width / across / aspect).min(area.height / down)
    };
    let columns = (1..=count.max(1)).max_by(|a, b| {
        // Of two that are as good, the one with the fewer empty places.
        let empty = |columns: usize| columns * count.div_ceil(columns) - count;
        height(*a).total_cmp(&height(*b)).then_with(|| empty(*b).cmp(&empty(*a)))
    });
    let columns = columns.unwrap_or(1);
    (columns, count.div_ceil(columns))
}

/// Areas of panes within an area, rows from the top; all are of the same size.
pub fn areas(count: usize, area: Area, aspect: f32) -> Vec<Area> {
    let side_within = |side: f32| (side - 2.0 * GAP).max(1.0);
    let (width, height) = (side_within(area.width), side_within(area.height));
    let area = Area { x: area.x + GAP, y: area.y + GAP, width, height };
    let (columns, rows) = grid(count, area, aspect);
    let side =
        |length: f32, parts: usize| ((length - GAP * (parts - 1) as f32) / parts as f32).floor().max(1.0);
    let (width, height) = (side(area.width, columns), side(area.height, rows));
    let place = |index: usize| {
        let (column, row) = ((index % columns) as f32, (index / columns) as f32);
        Area { x: area.x + column * (width + GAP), y: area.y + row * (height + GAP), width, height }
    };
    (0..count).map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: Area = Area { x: 0.0, y: 40.0, width: 1200.0, height: 800.0 };

    #[test]
    fn pictures_are_as_large_as_they_can_be() {
        for (count, aspect, wanted) in [
            (2, 1.6, (1, 2)),
            (2, 0.7, (2, 1)),
            (4, 1.5, (2, 2)),
            (6, 1.0, (3, 2)),
            (6, 1.6, (2, 3)),
            (3, 4.0, (1, 3)),
        ] {
            assert_eq!(grid(count, AREA, aspect), wanted, "{count} of {aspect}");
        }
    }

    #[test]
    fn panes_are_alike_and_do_not_overlap() {
        for count in 2..=6 {
            let areas = areas(count, AREA, 1.3);
            assert_eq!(areas.len(), count);
            for (index, a) in areas.iter().enumerate() {
                assert_eq!((a.width, a.height), (areas[0].width, areas[0].height));
                assert!(
                    a.x + a.width <= AREA.width && a.y >= AREA.y && a.y + a.height <= AREA.y + AREA.height
                );
                for b in &areas[index + 1..] {
                    assert!(
                        a.x + a.width <= b.x || b.x + b.width <= a.x || a.y + a.height <= b.y,
                        "{a:?} {b:?}"
                    );
                }
            }
        }
    }
}
