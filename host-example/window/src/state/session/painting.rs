//! Painting over the pictures that are open: strokes, and maps as a whole.

use std::path::PathBuf;
use std::sync::Arc;

use super::Session;
use crate::state::document::kind::Kind as Document;
use crate::state::painted::channel::{Channel, Kind};
use crate::state::painted::key_frames::{CarriedMaps, KeyFrames};
use crate::state::painted::maps::Maps;
use crate::state::painted::stroke::Stroke;
use crate::state::work::Request;
use isophote_pictures::exr::Guide;

impl Session {
    /// True where the pointer paints on what is shown.
    pub fn is_painting(&self) -> bool {
        self.painting.is_on && self.open.playback().is_some() && !self.is_covered()
    }

    /// Maps over the pictures as they are now, with the stroke that is being painted.
    pub fn maps(&self) -> Option<&Maps> {
        let stroke = self.painting.stroke.as_ref().map(Stroke::maps);
        stroke.or_else(|| self.open.playback()?.maps().map(|maps| &**maps))
    }

    /// Puts the brush down on a place, in pixels of the picture; one that is `turned` erases where it paints otherwise.
    pub fn begin_stroke(&mut self, at: [f32; 2], turned: bool) {
        let Some(maps) = self.maps_to_paint() else { return };
        if let Some(playback) = self.open.playback_mut() {
            playback.playing = false;
            self.painting.frame = playback.key();
        }
        let mut brush = self.painting.brush.clone();
        brush.erases ^= turned;
        self.painting.stroke = Some(Stroke::begin(&brush, &maps, at));
        self.painting.revision += 1;
    }

    /// Goes on with the stroke.
    pub fn go_on_stroke(&mut self, at: [f32; 2]) {
        if let Some(stroke) = &mut self.painting.stroke {
            stroke.go_to(at);
            self.painting.revision += 1;
        }
    }

    /// Takes the brush up: the look follows what it has painted, as one step.
    pub fn end_stroke(&mut self) {
        if let Some(stroke) = self.painting.stroke.take() {
            self.paint(self.painting.frame, stroke.end());
        }
    }

    /// Paints all of the picture as the brush would.
    pub fn fill_map(&mut self) {
        let Some(maps) = self.maps_to_paint() else { return };
        let (mut maps, brush) = (Maps::clone(&maps), &self.painting.brush);
        maps.layer_mut(brush.channel).fill(brush.value());
        self.paint_shown(maps);
    }

    /// Takes back all that was painted of the brush's channel.
    pub fn clear_map(&mut self) {
        let Some(maps) = self.maps_to_paint() else { return };
        let (mut maps, channel) = (Maps::clone(&maps), self.painting.brush.channel);
        maps.layer_mut(channel).fill(channel.plain());
        self.paint_shown(maps);
    }

    /// A map was read from a file, which takes the place of what is painted of it.
    pub(super) fn take_map(&mut self, kind: Kind, file: PathBuf, maps: &Arc<Maps>) {
        let Some(own) = self.maps_to_paint() else { return };
        let mut taken = Maps::clone(&own);
        for channel in Channel::ALL.into_iter().filter(|channel| channel.kind() == kind) {
            *taken.layer_mut(channel) = maps.layer(channel).clone();
        }
        self.paint_shown(taken);
        // Of several key frames a file holds only this one's map.
        let keys =
            self.open.playback().and_then(|playback| playback.keys()).filter(|keys| keys.is_one()).cloned();
        if let Some(keys) = keys {
            self.map_saved(kind, file, keys);
        }
    }

    /// A file, or one for each frame, holds a map as it was painted then.
    pub(super) fn map_saved(&mut self, kind: Kind, file: PathBuf, keys: Arc<KeyFrames>) {
        self.painting.saved.retain(|(_, known, _)| *known != file);
        self.painting.saved.push((kind, file, keys));
    }

    /// Lays other maps over the pictures.
    pub(super) fn lay(&mut self, keys: Option<Arc<KeyFrames>>) {
        let Some(playback) = self.open.playback_mut() else { return };
        if playback.keys() != keys.as_ref() {
            playback.paint(keys);
            self.painting.revision += 1;
        }
    }

    /// Takes back all that was painted on the key frame that is shown.
    pub fn remove_key_frame(&mut self) {
        let Some(playback) = self.open.playback() else { return };
        let keys = playback.keys().and_then(|keys| keys.without(playback.key()));
        self.step(keys.map(Arc::new));
    }

    /// Asks for the maps of all frames, carried along the motion from the key frames.
    pub fn carry_maps(&mut self) {
        self.work.ask(Request::CarryMaps);
    }

    /// The maps of `keys` were carried to all frames; nothing where something else is painted now.
    pub(super) fn take_carried(&mut self, keys: &KeyFrames, carried: Arc<CarriedMaps>) {
        let own = self.open.playback().and_then(|playback| playback.keys());
        if own.is_some_and(|own| **own == *keys) {
            self.step(Some(Arc::new(keys.with_carried(carried))));
        } else if own.is_some() {
            self.notes.say("What was painted meanwhile is not carried yet".to_owned());
        }
    }

    /// Names of files over which something is painted that is not saved, and what that is.
    pub fn unsaved_maps(&self) -> Vec<(String, Kind)> {
        let own = self.open.playback().and_then(|playback| Some((self.open.name(), playback.keys()?)));
        let kept =
            self.painting.kept.iter().map(|(file, keys)| {
                (file.file_name().and_then(|name| name.to_str()).unwrap_or_default(), keys)
            });
        let all = own.into_iter().chain(kept);
        let unsaved =
            |kind: &Kind, keys: &KeyFrames| keys.has(*kind) && self.painting.file(*kind, keys).is_none();
        all.flat_map(|(name, keys)| {
            let kinds = Kind::ALL.into_iter().filter(|kind| unsaved(kind, keys));
            kinds.map(|kind| (name.to_owned(), kind)).collect::<Vec<_>>()
        })
        .collect()
    }

    /// Keeps what is painted over the file that is open, which is to be another.
    pub(super) fn keep_maps(&mut self) {
        self.painting.stroke = None;
        let Some(playback) = self.open.playback() else { return };
        let file = playback.path().to_owned();
        let keys = playback.keys().filter(|keys| Kind::ALL.iter().any(|kind| keys.has(*kind))).cloned();
        self.painting.kept.retain(|(known, _)| *known != file);
        self.painting.kept.extend(keys.map(|keys| (file, keys)));
    }

    /// Paints over the file that is open now what was painted over it before.
    pub(super) fn restore_maps(&mut self) {
        let Some(playback) = self.open.playback_mut() else { return };
        let file = playback.path().to_owned();
        if let Some(at) = self.painting.kept.iter().position(|(known, _)| *known == file) {
            playback.paint(Some(self.painting.kept.swap_remove(at).1));
        }
        self.painting.revision += 1;
    }

    /// The maps that are to be painted on: those that there are, or new ones, in which the control map is that of the file.
    fn maps_to_paint(&self) -> Option<Arc<Maps>> {
        let playback = self.open.playback()?;
        if let Some(maps) = playback.maps() {
            return Some(Arc::clone(maps));
        }
        let size = playback.size();
        let read = playback.read().filter(|read| (read.width, read.height) == size);
        // Each frame of a sequence has its own.
        let own = read.filter(|_| playback.info().kind == Document::Picture);
        let control = own.and_then(|read| read.guide(Guide::Control));
        Some(Arc::new(control.map_or_else(|| Maps::new(size), |control| Maps::over(size, &control.data))))
    }

    /// Lays what was painted over the frame that is shown, as one step.
    fn paint_shown(&mut self, maps: Maps) {
        let frame = self.open.playback().map_or(0, |playback| playback.key());
        self.paint(frame, maps);
    }

    /// Lays what was painted over a frame, which is a key frame from then on, as one step.
    fn paint(&mut self, frame: i64, maps: Maps) {
        let Some(playback) = self.open.playback() else { return };
        let maps = Arc::new(maps);
        let keys = playback.keys().map(|keys| keys.with(frame, Arc::clone(&maps)));
        self.step(Some(Arc::new(keys.unwrap_or_else(|| KeyFrames::new(frame, maps)))));
    }

    /// Lays other maps over the pictures, as one step.
    fn step(&mut self, keys: Option<Arc<KeyFrames>>) {
        self.let_go();
        let before = self.state();
        self.lay(keys);
        self.edits.record("map", &before);
        self.let_go();
    }
}
