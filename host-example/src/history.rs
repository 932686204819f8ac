//! Textures of the last frames, which take turns: what a plan found on them, and what the host had bound.
//!
//! A plan for frames in order writes outputs `stage0`, `stage1` and so on, and reads inputs such as `stage0@-1` and
//! `depth@-1`. Of each there are as many textures as frames that are known at the same time. Frame by frame the next one
//! is written, so that nothing is copied but the host's own textures, which it draws into anew.

use isophote_files::error::{Error, Result};

/// Textures of a frame that later frames will read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Past {
    /// Frames before the one at hand that plans read at most.
    pub frames: usize,
    /// Stages and inputs of the host's, such as `depth`, that are read of them, and of how many frames before at most.
    depths: Vec<(String, usize)>,
}

impl Past {
    /// Of a plan that knows as many frames before as may count, by the names of its inputs.
    pub fn of<'n>(names: impl Iterator<Item = &'n str>) -> Self {
        let mut depths: Vec<(String, usize)> = Vec::new();
        for (base, before) in names.filter_map(split) {
            match depths.iter_mut().find(|(known, _)| known == base) {
                Some((_, most)) => *most = before.max(*most),
                None => depths.push((base.to_owned(), before)),
            }
        }
        let frames = depths.iter().map(|(_, depth)| *depth).max().unwrap_or(0);
        Self { frames, depths }
    }

    /// Inputs of the host's that are read of frames before.
    pub fn inputs(&self) -> impl Iterator<Item = &str> {
        self.depths.iter().map(|(name, _)| name.as_str()).filter(|name| !is_stage(name))
    }

    /// Number of textures of a name that take turns, where there are so many turns: one for each frame that it is
    /// read of and one for the frame at hand, and no number that does not go into the turns.
    fn textures(&self, name: &str, turns: usize) -> usize {
        let depth = self.depths.iter().find(|(known, _)| known == name).map_or(0, |(_, depth)| *depth);
        (depth + 1..turns).find(|count| turns.is_multiple_of(*count)).unwrap_or(turns)
    }

    /// Number of turns that takes the fewest textures.
    fn turns(&self) -> usize {
        let least = self.frames + 1;
        let all =
            |turns: usize| self.depths.iter().map(|(name, _)| self.textures(name, turns)).sum::<usize>();
        (least..2 * least).min_by_key(|turns| all(*turns)).unwrap_or(least)
    }
}

/// The name of an input and how many frames before it belongs to: `depth@-2` is of 2 before.
pub fn split(name: &str) -> Option<(&str, usize)> {
    let (base, frame) = name.split_once("@-")?;
    Some((base, frame.parse().ok()?))
}

/// True where an output is kept for later frames.
pub fn is_stage(name: &str) -> bool {
    name.strip_prefix("stage").is_some_and(|number| number.parse::<u32>().is_ok())
}

/// The textures of one stage or input, as many as go into the turns.
#[derive(Debug)]
struct Ring {
    name: String,
    views: Vec<wgpu::TextureView>,
    /// The host's texture that is copied at the end of each frame.
    host: Option<wgpu::Texture>,
}

/// All textures of the last frames.
#[derive(Debug, Default)]
pub struct Rings {
    rings: Vec<Ring>,
    past: Past,
    /// After so many frames all rings begin anew.
    turns: usize,
    /// Index of the turn.
    turn: usize,
}

impl Rings {
    /// None yet, for plans that read `past`.
    pub fn new(past: &Past) -> Self {
        Self { rings: Vec::new(), past: past.clone(), turns: past.turns(), turn: 0 }
    }

    /// Number of turns.
    pub fn turns(&self) -> usize {
        self.turns
    }

    /// Index of the turn.
    pub fn turn(&self) -> usize {
        self.turn
    }

    /// The textures of a name by turns, as they are written or, so many frames later, read.
    pub fn views(&self, name: &str, later: usize) -> Option<Vec<wgpu::TextureView>> {
        let ring = self.rings.iter().find(|ring| ring.name == name)?;
        let at = |turn: usize| ring.views[(turn + self.turns - later) % ring.views.len()].clone();
        Some((0..self.turns).map(at).collect())
    }

    /// Makes textures for a name, unless it has them in this format and size.
    ///
    /// # Errors
    /// The errors of `make`.
    pub fn hold(
        &mut self,
        name: &str,
        format: wgpu::TextureFormat,
        size: [u32; 2],
        host: Option<wgpu::Texture>,
        make: impl Fn() -> Result<wgpu::TextureView>,
    ) -> Result<()> {
        let is_like = |ring: &Ring| {
            let texture = ring.views[0].texture();
            ring.name == name && texture.format() == format && [texture.width(), texture.height()] == size
        };
        if let Some(ring) = self.rings.iter_mut().find(|ring| is_like(ring)) {
            ring.host = host;
            return Ok(());
        }
        self.rings.retain(|ring| ring.name != name);
        let count = self.past.textures(name, self.turns);
        let views = (0..count).map(|_| make()).collect::<Result<Vec<_>>>()?;
        if views.is_empty() {
            let problem = format!("no frames are held of '{name}'");
            return Err(Error::failure(problem, "this is a mistake in the program; please report it"));
        }
        self.rings.push(Ring { name: name.to_owned(), views, host });
        Ok(())
    }

    /// Forgets names that are not among these.
    pub fn retain(&mut self, is_needed: impl Fn(&str) -> bool) {
        self.rings.retain(|ring| is_needed(&ring.name));
    }

    /// Copies what the host will draw into anew.
    pub fn encode_copies(&self, encoder: &mut wgpu::CommandEncoder) {
        for ring in &self.rings {
            if let Some(host) = &ring.host {
                let to = ring.views[self.turn % ring.views.len()].texture();
                encoder.copy_texture_to_texture(host.as_image_copy(), to.as_image_copy(), to.size());
            }
        }
    }

    /// The next frame begins.
    pub fn advance(&mut self) {
        self.turn = (self.turn + 1) % self.turns.max(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_what_is_kept() {
        let names = ["color", "stage0@-1", "depth@-1", "motion@-1", "depth@-2", "stage1@-2"];
        let past = Past::of(names.into_iter());
        assert_eq!((past.frames, past.inputs().collect::<Vec<_>>()), (2, vec!["depth", "motion"]));
        assert!(is_stage("stage12") && !is_stage("stages") && !is_stage("result"));
        assert_eq!(split("depth@-2"), Some(("depth", 2)));
        assert_eq!(split("depth"), None);
    }

    #[test]
    fn what_is_read_of_few_frames_is_kept_of_few() {
        let few = Past::of(["stage0@-1", "stage0@-2", "depth@-2"].into_iter());
        assert_eq!((few.turns(), few.textures("stage0", 3), few.textures("stage1", 3)), (3, 3, 1));
        // Motion of six frames, all else of two.
        let names = ["stage0@-2", "stage1@-2", "stage2@-2", "depth@-2", "motion@-6"];
        let past = Past::of(names.into_iter());
        let turns = past.turns();
        assert_eq!(turns, 9);
        assert_eq!((past.textures("stage0", turns), past.textures("motion", turns)), (3, 9));
    }
}
