//! Size at which pictures are rendered while something moves: where the processor draws, small ones keep up with the
//! mouse, and the whole one follows when it rests.

use std::time::{Duration, Instant};

use crate::drawing::stage::Drawn;
use crate::state::look::EditedLook;
use crate::state::scenery::Scenery;
use crate::state::session::{Session, Which};
use isophote_render::lighting::Lighting as Light;
use isophote_scene::camera::View;

/// Time that nothing must move before the whole picture is rendered.
const REST: Duration = Duration::from_millis(150);
/// Time that a picture may take while something moves.
const GOAL: f32 = 0.08;
/// Sizes over that of the whole picture.
const SCALES: [f32; 4] = [1.0, 0.5, 1.0 / 3.0, 0.25];

/// Appearance of a picture, as far as an artist can change it.
#[derive(Clone, Debug, PartialEq)]
struct Appearance {
    look: EditedLook,
    view: Option<View>,
    light: Option<Light>,
    shown: [Which; 2],
}

/// Measured speed of the device.
#[derive(Debug, Default)]
pub struct Pace {
    /// True where a processor draws, or computes looks.
    pub is_slow: bool,
    /// Seconds that a whole picture would take.
    whole: Option<f32>,
    scale: f32,
    appearance: Option<Appearance>,
    moved: Option<Instant>,
}

impl Pace {
    /// The size over that of the whole picture at which the next one is rendered.
    pub fn scale(&mut self, session: &Session) -> f32 {
        if !self.is_slow {
            return 1.0;
        }
        let scenery = session.open.scenery();
        let appearance = Some(Appearance {
            look: session.looks.seen().into_owned(),
            view: scenery.map(Scenery::view),
            light: scenery.map(|scenery| *scenery.light()),
            shown: session.shown(),
        });
        if self.appearance.is_some() && self.appearance != appearance {
            self.moved = Some(Instant::now());
        }
        self.appearance = appearance;
        let rests = self.moved.is_none_or(|at| at.elapsed() >= REST) && !session.open.is_playing();
        let whole = self.whole.unwrap_or(GOAL * 2.0);
        let fits = |scale: &&f32| whole * **scale * **scale <= GOAL;
        let moving = SCALES.iter().find(fits).copied().unwrap_or(SCALES[SCALES.len() - 1]);
        self.scale = if rests { 1.0 } else { moving };
        self.scale
    }

    /// A frame was drawn, its picture in so much time; says when the next one is wanted at the latest.
    pub fn next(&mut self, drawn: Drawn, took: Duration) -> Option<Duration> {
        if !self.is_slow {
            return None;
        }
        if drawn == Drawn::Picture {
            self.whole = Some(took.as_secs_f32() / (self.scale * self.scale));
        }
        let left = self.moved.and_then(|at| REST.checked_sub(at.elapsed()));
        left.or((self.scale < 1.0).then_some(Duration::ZERO))
    }
}
