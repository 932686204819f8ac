//! Painting over the pictures that are open: strokes, and maps as a whole.

use std::path::PathBuf;
use std::sync::Arc;

use super::Session;
use crate::state::document::kind::Kind as Document;
use crate::state::painted::channel::{Channel, Kind};
use crate::state::painted::maps::Maps;
use crate::state::painted::stroke::Stroke;
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
            self.paint(stroke.end());
        }
    }

    /// Paints all of the picture as the brush would.
    pub fn fill_map(&mut self) {
        let Some(maps) = self.maps_to_paint() else { return };
        let (mut maps, brush) = (Maps::clone(&maps), &self.painting.brush);
        maps.layer_mut(brush.channel).fill(brush.value());
        self.paint(maps);
    }

    /// Takes back all that was painted of the brush's channel.
    pub fn clear_map(&mut self) {
        let Some(maps) = self.maps_to_paint() else { return };
        let (mut maps, channel) = (Maps::clone(&maps), self.painting.brush.channel);
        maps.layer_mut(channel).fill(channel.plain());
        self.paint(maps);
    }

    /// A map was read from a file, which takes the place of what is painted of it.
    pub(super) fn take_map(&mut self, kind: Kind, file: PathBuf, maps: &Arc<Maps>) {
        let Some(own) = self.maps_to_paint() else { return };
        let mut taken = Maps::clone(&own);
        for channel in Channel::ALL.into_iter().filter(|channel| channel.kind() == kind) {
            *taken.layer_mut(channel) = maps.layer(channel).clone();
        }
        self.paint(taken);
        self.map_saved(kind, file, maps);
    }

    /// A file holds a map as it was painted then.
    pub(super) fn map_saved(&mut self, kind: Kind, file: PathBuf, maps: &Arc<Maps>) {
        self.painting.saved.retain(|(_, known, _)| *known != file);
        self.painting.saved.push((kind, file, Arc::clone(maps)));
    }

    /// Lays other maps over the pictures.
    pub(super) fn lay(&mut self, maps: Option<Arc<Maps>>) {
        let Some(playback) = self.open.playback_mut() else { return };
        if playback.maps() != maps.as_ref() {
            playback.paint(maps);
            self.painting.revision += 1;
        }
    }

    /// Names of files over which something is painted that is not saved, and what that is.
    pub fn unsaved_maps(&self) -> Vec<(String, Kind)> {
        let own = self.open.playback().and_then(|playback| Some((self.open.name(), playback.maps()?)));
        let kept =
            self.painting.kept.iter().map(|(file, maps)| {
                (file.file_name().and_then(|name| name.to_str()).unwrap_or_default(), maps)
            });
        let all = own.into_iter().chain(kept);
        let unsaved = |kind: &Kind, maps: &Maps| maps.has(*kind) && self.painting.file(*kind, maps).is_none();
        all.flat_map(|(name, maps)| {
            let kinds = Kind::ALL.into_iter().filter(|kind| unsaved(kind, maps));
            kinds.map(|kind| (name.to_owned(), kind)).collect::<Vec<_>>()
        })
        .collect()
    }

    /// Keeps what is painted over the file that is open, which is to be another.
    pub(super) fn keep_maps(&mut self) {
        self.painting.stroke = None;
        let Some(playback) = self.open.playback() else { return };
        let file = playback.path().to_owned();
        let maps = playback.maps().filter(|maps| Kind::ALL.iter().any(|kind| maps.has(*kind))).cloned();
        self.painting.kept.retain(|(known, _)| *known != file);
        self.painting.kept.extend(maps.map(|maps| (file, maps)));
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

    /// Lays what was painted over the pictures, as one step.
    fn paint(&mut self, maps: Maps) {
        self.let_go();
        let before = self.state();
        self.lay(Some(Arc::new(maps)));
        self.edits.record("map", &before);
        self.let_go();
    }
}
