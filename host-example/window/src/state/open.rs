//! Content of the window: the scene or the pictures that are open, or nothing.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::document::kind::Kind;
use super::playback::Playback;
use super::scenery::Scenery;
use super::things::{Sampled, Things};
use isophote_pictures::exr::Guide;

/// Content of the window.
#[derive(Default)]
pub struct Open {
    content: Content,
    file: Option<PathBuf>,
    name: String,
    /// True where a scene was opened before its place in the window was known.
    is_unframed: bool,
}

#[derive(Default)]
enum Content {
    #[default]
    Nothing,
    Scene(Box<Scenery>),
    /// A picture, sequence or video.
    Pictures(Box<Playback>),
}

impl Open {
    /// A scene of this name.
    pub fn scene(scenery: Scenery, file: Option<PathBuf>, name: String) -> Self {
        let is_unframed = scenery.camera().is_none();
        Self { content: Content::Scene(Box::new(scenery)), file, name, is_unframed }
    }

    /// A picture, sequence or video.
    pub fn pictures(playback: Playback) -> Self {
        let file = playback.path().to_owned();
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let content = Content::Pictures(Box::new(playback));
        Self { content, file: Some(file), name, is_unframed: false }
    }

    /// The same pictures, read in another way, in the place of those that are open.
    pub fn read_again(&mut self, mut playback: Playback) {
        if let Content::Pictures(old) = &self.content {
            playback.rate = old.rate;
            playback.seek(old.number());
            playback.paint(old.keys().cloned());
        }
        self.content = Content::Pictures(Box::new(playback));
    }

    /// The scene, if it is one.
    pub fn scenery(&self) -> Option<&Scenery> {
        match &self.content {
            Content::Scene(scenery) => Some(scenery),
            _ => None,
        }
    }

    /// The scene, to be changed.
    pub fn scenery_mut(&mut self) -> Option<&mut Scenery> {
        match &mut self.content {
            Content::Scene(scenery) => Some(scenery),
            _ => None,
        }
    }

    /// The pictures, if it is such.
    pub fn playback(&self) -> Option<&Playback> {
        match &self.content {
            Content::Pictures(playback) => Some(playback),
            _ => None,
        }
    }

    /// The pictures, to be changed.
    pub fn playback_mut(&mut self) -> Option<&mut Playback> {
        match &mut self.content {
            Content::Pictures(playback) => Some(playback),
            _ => None,
        }
    }

    /// The file, if it has one.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// Its name for people; empty where nothing is open.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Kind of document.
    pub fn kind(&self) -> Kind {
        self.playback().map_or(Kind::Scene, |playback| playback.info().kind)
    }

    /// True where there is anything to look at.
    pub fn has_picture(&self) -> bool {
        !matches!(self.content, Content::Nothing)
    }

    /// True where a guide is known of it.
    pub fn has_guide(&self, guide: Guide) -> bool {
        match &self.content {
            Content::Nothing => false,
            Content::Scene(_) => true,
            Content::Pictures(playback) => {
                playback.frame(false).is_some_and(|(frame, _)| frame.guide(guide).is_some())
            }
        }
    }

    /// True where it is known what things cover of it.
    pub fn has_things(&self) -> bool {
        match &self.content {
            Content::Nothing => false,
            Content::Scene(_) => true,
            Content::Pictures(playback) => playback.info().has_things(),
        }
    }

    /// Things in what is shown of it, where it is known what they cover; of a scene as its pixels were `sampled`.
    pub fn things(&self, sampled: Option<Arc<Sampled>>) -> Option<Things> {
        match &self.content {
            Content::Nothing => None,
            Content::Scene(scenery) => {
                let name = self.file().unwrap_or(Path::new(self.name())).to_owned();
                Some(Things::Scene { scene: Arc::clone(&scenery.scene), name, sampled })
            }
            Content::Pictures(playback) => playback.things(),
        }
    }

    /// True while time passes.
    pub fn is_playing(&self) -> bool {
        match &self.content {
            Content::Nothing => false,
            Content::Scene(scenery) => scenery.playing,
            Content::Pictures(playback) => playback.playing,
        }
    }

    /// Starts or stops time.
    pub fn toggle_playing(&mut self) {
        match &mut self.content {
            Content::Nothing => {}
            Content::Scene(scenery) => scenery.toggle_playing(),
            Content::Pictures(playback) => playback.toggle_playing(),
        }
    }

    /// Lets time pass.
    pub fn advance(&mut self) {
        match &mut self.content {
            Content::Nothing => {}
            Content::Scene(scenery) => scenery.advance(),
            Content::Pictures(playback) => playback.advance(),
        }
    }

    /// True, once, where a scene is to be framed by the place that it has in the window.
    pub fn wants_framing(&mut self) -> bool {
        std::mem::take(&mut self.is_unframed)
    }
}
