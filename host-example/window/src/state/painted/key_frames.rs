//! What is painted over a document, by the frames that it was painted on.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::channel::{Channel, Kind};
use super::maps::Maps;

/// Maps of the frames that were painted on, at least one; those of pictures and videos, which are painted on as a whole, have one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyFrames {
    maps: BTreeMap<i64, Arc<Maps>>,
    carried: Option<Arc<CarriedMaps>>,
}

/// Maps of all frames of a sequence, carried along its motion from the key frames.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CarriedMaps {
    maps: BTreeMap<i64, Arc<Maps>>,
    /// Thousandths of frames that no key frame shows, where nothing is painted.
    unknown: BTreeMap<i64, u32>,
}

impl CarriedMaps {
    /// Takes the map of a frame, of which a share is seen on no key frame.
    pub fn insert(&mut self, frame: i64, maps: Maps, unknown: f32) {
        self.maps.insert(frame, Arc::new(maps));
        self.unknown.insert(frame, (unknown * 1000.0).round() as u32);
    }

    /// Bytes that the maps take; those of all maps share what is plain.
    pub fn bytes(&self) -> usize {
        self.maps.values().map(|maps| maps.bytes_held()).sum()
    }
}

impl KeyFrames {
    /// A map that was painted on a frame, and lies on all others as it is.
    pub fn new(frame: i64, maps: Arc<Maps>) -> Self {
        Self { maps: BTreeMap::from([(frame, maps)]), carried: None }
    }

    /// The same with the map of a frame in the place of what is there. What was carried no longer holds.
    #[must_use]
    pub fn with(&self, frame: i64, maps: Arc<Maps>) -> Self {
        let mut all = self.maps.clone();
        all.insert(frame, maps);
        Self { maps: all, carried: None }
    }

    /// The same without the map of a frame; nothing where there is no other.
    pub fn without(&self, frame: i64) -> Option<Self> {
        let mut maps = self.maps.clone();
        maps.remove(&frame);
        (!maps.is_empty()).then_some(Self { maps, carried: None })
    }

    /// The same with the maps of all frames.
    #[must_use]
    pub fn with_carried(&self, carried: Arc<CarriedMaps>) -> Self {
        Self { maps: self.maps.clone(), carried: Some(carried) }
    }

    /// The map that lies on a frame: its own, or what was carried to it, or that of the nearest key frame as it is.
    pub fn seen(&self, frame: i64) -> Option<&Arc<Maps>> {
        let carried = || self.carried.as_ref()?.maps.get(&frame);
        let nearest = || {
            let distance = |(key, _): &(&i64, &Arc<Maps>)| key.abs_diff(frame);
            self.maps.iter().min_by_key(distance).map(|(_, maps)| maps)
        };
        self.maps.get(&frame).or_else(carried).or_else(nearest)
    }

    /// Frames that were painted on, with their maps.
    pub fn iter(&self) -> impl Iterator<Item = (i64, &Arc<Maps>)> {
        self.maps.iter().map(|(frame, maps)| (*frame, maps))
    }

    /// True for a frame that was painted on.
    pub fn is_key(&self, frame: i64) -> bool {
        self.maps.contains_key(&frame)
    }

    /// True where one map lies on all frames as it is.
    pub fn is_one(&self) -> bool {
        self.maps.len() == 1 && self.carried.is_none()
    }

    /// True where the maps were carried to all frames.
    pub fn is_carried(&self) -> bool {
        self.carried.is_some()
    }

    /// Share of a frame that is seen on no key frame, where nothing is painted.
    pub fn unknown(&self, frame: i64) -> f32 {
        let known = self.carried.as_ref().and_then(|carried| carried.unknown.get(&frame));
        known.map_or(0.0, |thousandths| *thousandths as f32 / 1000.0)
    }

    /// True where something of a map is painted.
    pub fn has(&self, kind: Kind) -> bool {
        self.maps.values().any(|maps| maps.has(kind))
    }

    /// True where a map of all frames is the same as by others.
    pub fn has_same(&self, kind: Kind, other: &Self) -> bool {
        let is_same = |own: &Maps, other: &Maps| {
            let mut channels = Channel::ALL.iter().filter(|channel| channel.kind() == kind);
            channels.all(|channel| own.layer(*channel) == other.layer(*channel))
        };
        let mut pairs = self.maps.iter().zip(&other.maps);
        self.maps.len() == other.maps.len()
            && self.carried.is_some() == other.carried.is_some()
            && pairs.all(|((frame, own), (of, known))| frame == of && is_same(own, known))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn maps(value: u8) -> Arc<Maps> {
        let mut maps = Maps::new((4, 2));
        maps.layer_mut(Channel::Mask).fill(value);
        Arc::new(maps)
    }

    fn seen(keys: &KeyFrames, frame: i64) -> Option<u8> {
        keys.seen(frame).map(|maps| maps.layer(Channel::Mask).get(0, 0))
    }

    #[test]
    fn frames_have_their_own_maps_or_carried_ones_or_the_nearest() {
        let one = KeyFrames::new(5, maps(50));
        assert!(one.is_one() && one.has(Kind::Mask) && !one.has(Kind::Control));
        assert_eq!([1, 5, 90].map(|frame| seen(&one, frame)), [Some(50); 3]);
        let two = one.with(11, maps(110));
        assert_eq!([7, 8, 9, 11].map(|frame| seen(&two, frame)), [50, 50, 110, 110].map(Some));
        assert!(!two.is_one() && two.is_key(11) && !two.is_key(10));
        let mut carried = CarriedMaps::default();
        for frame in 5..=11 {
            carried.insert(frame, Maps::clone(&maps(frame as u8)), if frame == 8 { 0.25 } else { 0.0 });
        }
        let all = two.with_carried(Arc::new(carried));
        // Painted on, a frame has what was painted; beyond the sequence there is the nearest.
        assert_eq!([5, 6, 10, 11, 12].map(|frame| seen(&all, frame)), [50, 6, 10, 110, 110].map(Some));
        assert_eq!([8, 9].map(|frame| all.unknown(frame)), [0.25, 0.0]);
        assert!(all.is_carried() && !all.has_same(Kind::Mask, &two));
        // What is painted then is carried no more.
        let changed = all.with(6, maps(60));
        assert!(!changed.is_carried() && seen(&changed, 7) == Some(60));
        assert_eq!(changed.without(6), Some(two.clone()));
        assert!(two.has_same(Kind::Mask, &changed.without(6).unwrap()) && one.without(5).is_none());
    }
}
