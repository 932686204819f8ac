//! Data that is known of a frame beside its picture: guides, the frames around it, and motion between them; with the
//! graph for that.

use super::clips::{MOTION, MOTION_FORWARD, SOURCE, guide_clip, is_connected};
use super::effects::{Effect, is_local};
use super::host::{Host, Outcome};
use super::image::Clip;
use super::motion::{MotionFrom, estimate};
use super::settings::Settings;
use isophote::Graph;
use isophote::frames::Frames;
use isophote::graph::GraphInput;
use isophote::request::Guides;
use isophote_abi::openfx::*;
use isophote_motion::Way;

/// Data that is known of a frame.
#[derive(Clone, Debug)]
pub struct Known {
    /// The effect's graph, with optical flow where motion is estimated.
    pub graph: Graph,
    /// The guides that there are.
    pub guides: Guides,
    /// The frames around.
    pub frames: Frames,
}

impl Known {
    /// Data for a graph whose guides with an image are `has`. Motion and neighbours count where they are read,
    /// in hosts that give them.
    ///
    /// # Errors
    /// Failed, when no graph comes of it.
    pub fn of(graph: &Graph, from: MotionFrom, has: Guides, temporal: bool) -> Outcome<Self> {
        let has_clip = has.motion || has.motion_forward;
        let still = Guides { motion: false, motion_forward: false, ..has };
        let mut known = Self { graph: graph.clone(), guides: still, frames: Frames::NONE };
        if !temporal || graph.frames() == [0, 0] {
            return Ok(known);
        }
        if from.is_estimated(has_clip) {
            estimate(&mut known.graph).map_err(|_| kOfxStatFailed)?;
        } else if has_clip {
            // Vectors of one way stand for the other, too.
            (known.guides.motion, known.guides.motion_forward) = (true, true);
        } else {
            return Ok(known);
        }
        let [past, future] = known.graph.frames();
        known.frames = Frames::around(past, future);
        Ok(known)
    }

    /// Data that is known by the clips that are connected, of the frame at a time. Two of them for hosts that call
    /// every clip connected: with vectors and without.
    ///
    /// # Errors
    /// As [`Known::of`].
    pub fn connected(
        effect: &Effect,
        host: &Host,
        instance: Handle,
        settings: &Settings,
    ) -> Outcome<Vec<Self>> {
        let has = connected_guides(effect, host, instance);
        let mut all = vec![has];
        if host.quirks.all_connected && (has.motion || has.motion_forward) {
            all.push(Guides { motion: false, motion_forward: false, ..has });
        }
        let of = |has| Self::of(&settings.graph, settings.motion_from, has, host.temporal);
        all.into_iter().map(of).collect()
    }

    /// True where a tile needs only the pixels around it, by the clips that are connected; at all times, since hosts
    /// ask once for all.
    ///
    /// # Errors
    /// Failed, when no graph comes of it or it cannot be planned.
    pub fn is_local_for(
        effect: &Effect,
        host: &Host,
        instance: Handle,
        settings: &Settings,
    ) -> Outcome<bool> {
        for known in Self::connected(effect, host, instance, settings)? {
            if !known.is_local()? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// True where motion is estimated somewhere.
    pub fn is_estimated(&self) -> bool {
        let spec = |index| self.graph.node(index).and_then(|node| self.graph.spec(node));
        (0..self.graph.len()).any(|index| spec(index).is_ok_and(|spec| spec.id == "optical_flow"))
    }

    /// Forgets the frames that the source says it has not around a time.
    pub fn limit_to_source(&mut self, host: &Host, instance: Handle, time: f64) {
        if let Some(source) = Clip::of(host, instance, SOURCE) {
            self.limit(|offset| source.has_frame(time + f64::from(offset)));
        }
    }

    /// Forgets the neighbours that there are not, and those behind them.
    fn limit(&mut self, exists: impl Fn(i32) -> bool) {
        let count =
            |most: u32, towards: i32| (1..=most).take_while(|n| exists(towards * *n as i32)).count() as u32;
        self.frames = Frames::around(count(self.frames.past, -1), count(self.frames.future, 1));
    }

    /// Forgets a frame, counted from the one that is rendered, and those behind it.
    pub fn forget_from(&mut self, missing: i32) {
        self.limit(|offset| offset.signum() != missing.signum() || offset.abs() < missing.abs());
    }

    /// True where a tile needs only the pixels around it.
    ///
    /// # Errors
    /// Failed, when the graph cannot be planned.
    pub fn is_local(&self) -> Outcome<bool> {
        is_local(&self.graph, self.guides, self.frames).map_err(|_| kOfxStatFailed)
    }
}

/// The guides whose clips are connected.
pub fn connected_guides(effect: &Effect, host: &Host, instance: Handle) -> Guides {
    Guides::of(|guide| {
        effect.guides.contains(&guide)
            && guide_clip(guide).is_some_and(|name| is_connected(host, instance, name))
    })
}

/// The clip that an input of a plan is read from. Vectors of one way may come from the clip of the other.
pub fn clip_of(
    settings: &Settings,
    host: &Host,
    instance: Handle,
    input: GraphInput,
) -> Option<&'static std::ffi::CStr> {
    let way = match input {
        GraphInput::Color => return Some(SOURCE),
        GraphInput::Motion => Way::Backward,
        GraphInput::MotionForward => Way::Forward,
        guide => return guide_clip(guide),
    };
    let channels = [MOTION, MOTION_FORWARD].map(|name| {
        let clip = Clip::of(host, instance, name).filter(|clip| !clip.is_open());
        clip.map_or(0, |clip| clip.channels())
    });
    let (from, ..) = settings.convention.among(way, channels)?;
    Some(if from == Way::Forward { MOTION_FORWARD } else { MOTION })
}
