//! A stroke of the brush, from where it is put down to where it is taken up.

use std::sync::Arc;

use super::brush::Brush;
use super::maps::Maps;
use super::tiles::Tiles;

/// A stroke: however often it passes over a place, it paints that once.
#[derive(Debug)]
pub struct Stroke {
    brush: Brush,
    /// The maps without it.
    before: Arc<Maps>,
    /// The maps with it.
    maps: Maps,
    /// The share of each pixel that it has painted.
    share: Tiles,
    /// The place where it is, in pixels of the picture.
    last: [f32; 2],
}

impl Stroke {
    /// A stroke that begins at a place, in pixels of the picture.
    pub fn begin(brush: &Brush, before: &Arc<Maps>, at: [f32; 2]) -> Self {
        let (brush, maps) = (brush.clone(), Maps::clone(before));
        let share = Tiles::new(before.size(), 0);
        let mut stroke = Self { brush, before: Arc::clone(before), maps, share, last: at };
        stroke.go_to(at);
        stroke
    }

    /// The maps as they are with it.
    pub fn maps(&self) -> &Maps {
        &self.maps
    }

    /// The brush that paints it.
    pub fn brush(&self) -> &Brush {
        &self.brush
    }

    /// Goes on, straight to a place.
    pub fn go_to(&mut self, at: [f32; 2]) {
        let (from, reach) = (std::mem::replace(&mut self.last, at), self.brush.size * 0.5 + 1.0);
        let [least, most] = [f32::min, f32::max].map(|of| [of(from[0], at[0]), of(from[1], at[1])]);
        let low = |v: f32| (v - reach).floor().max(0.0) as u32;
        let high = |v: f32| (v + reach).ceil().max(0.0) as u32;
        let part = [low(least[0]), low(least[1]), high(most[0]), high(most[1])];
        let Self { brush, before, maps, share, .. } = self;
        let (channel, value) = (brush.channel, i32::from(brush.value()));
        let before = before.layer(channel);
        share.change(part, |x, y, old| {
            let distance = distance([x as f32 + 0.5, y as f32 + 0.5], from, at);
            old.max((brush.share(distance) * 255.0).round() as u8)
        });
        maps.layer_mut(channel).change(part, |x, y, _| {
            let old = i32::from(before.get(x, y));
            let more = (value - old) * i32::from(share.get(x, y));
            // Rounded to the nearest, away from 0.
            (old + (more + 127 * more.signum()) / 255) as u8
        });
    }

    /// Takes the brush up; the maps with what it has painted.
    pub fn end(mut self) -> Maps {
        self.maps.layer_mut(self.brush.channel).tidy();
        self.maps
    }
}

/// Distance of a place from a straight way.
fn distance(at: [f32; 2], from: [f32; 2], to: [f32; 2]) -> f32 {
    let way = [to[0] - from[0], to[1] - from[1]];
    let length = way[0] * way[0] + way[1] * way[1];
    let along = (at[0] - from[0]) * way[0] + (at[1] - from[1]) * way[1];
    let share = if length > 0.0 { (along / length).clamp(0.0, 1.0) } else { 0.0 };
    (at[0] - from[0] - way[0] * share).hypot(at[1] - from[1] - way[1] * share)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::painted::channel::Channel;

    fn brush(hardness: f32) -> Brush {
        let mut brush = Brush { size: 8.0, hardness, ..Brush::default() };
        brush.strengths[0] = 1.0;
        brush
    }

    #[test]
    fn a_stroke_paints_a_place_once_and_nothing_beside_it() {
        let plain = Arc::new(Maps::new((64, 32)));
        let mut stroke = Stroke::begin(&brush(0.0), &plain, [10.0, 16.0]);
        let once = stroke.maps().layer(Channel::Detail).get(12, 16);
        assert!(once > 127 && once < 254);
        stroke.go_to([10.0, 16.0]);
        stroke.go_to([10.0, 16.0]);
        assert_eq!(stroke.maps().layer(Channel::Detail).get(12, 16), once);
        // Straight to the other side, and beyond the picture.
        stroke.go_to([90.0, 16.0]);
        let maps = stroke.end();
        let layer = maps.layer(Channel::Detail);
        assert!((12..64).all(|x| layer.get(x, 16) > 220), "the way between");
        assert!((0..64).all(|x| layer.get(x, 8) == 127 && layer.get(x, 24) == 127));
        assert!(Channel::ALL[1..].iter().all(|channel| maps.layer(*channel).is_plain()));
    }

    #[test]
    fn what_is_erased_is_as_it_was() {
        let plain = Arc::new(Maps::new((64, 32)));
        let painted = Arc::new(Stroke::begin(&brush(1.0), &plain, [20.0, 20.0]).end());
        assert_eq!(painted.layer(Channel::Detail).get(20, 20), 254);
        let eraser = Brush { erases: true, size: 20.0, ..brush(1.0) };
        assert_eq!(Stroke::begin(&eraser, &painted, [20.0, 20.0]).end(), *plain);
    }
}
