//! Origin of what is on the device: the document or scene that it is a picture of, so that nothing is shown under the name of
//! something else.

use std::sync::{Arc, Weak};

use crate::state::document::Info;
use crate::state::session::Session;
use isophote_scene::Scene;

/// Origin of a picture.
#[derive(Clone, Debug)]
pub struct Origin {
    of: Thing,
    /// Size at which it is placed.
    size: (u32, u32),
    /// Number of the frame, where frames follow one another.
    frame: Option<i64>,
    /// True where they do so by themselves.
    is_playing: bool,
}

/// Content of the window. Its place in memory is nobody else's as long as it is known here.
#[derive(Clone, Debug)]
enum Thing {
    Scene(Weak<Scene>),
    Document(Weak<Info>),
}

impl Origin {
    /// Origin of pictures of what is open now.
    pub fn of(session: &Session) -> Option<Self> {
        let (open, size) = (&session.open, session.nominal_size());
        let (of, frame) = match (open.scenery(), open.playback()) {
            (Some(scenery), _) => (Thing::Scene(Arc::downgrade(&scenery.scene)), None),
            (None, Some(playback)) => {
                let frame = playback.frame(false).and_then(|(frame, _)| frame.number);
                (Thing::Document(Arc::downgrade(playback.info())), frame)
            }
            (None, None) => return None,
        };
        Some(Self { of, size, frame, is_playing: open.is_playing() })
    }

    /// True where both are of the same document or scene.
    pub fn is_of_same(&self, other: &Self) -> bool {
        match (&self.of, &other.of) {
            (Thing::Scene(a), Thing::Scene(b)) => a.ptr_eq(b),
            (Thing::Document(a), Thing::Document(b)) => a.ptr_eq(b),
            _ => false,
        }
    }

    /// True where a picture of it may stand for what is open `now` until there is a newer one: it is of the same size, and of
    /// the same frame but where time passes.
    pub fn stands_for(&self, now: &Self) -> bool {
        self.is_of_same(now) && self.size == now.size && (now.is_playing || self.frame == now.frame)
    }
}
