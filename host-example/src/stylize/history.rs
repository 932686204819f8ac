//! Textures of the last frames, which take turns: what a plan found on them, and what the host had bound.
//!
//! A plan for frames in order writes outputs `stage0`, `stage1` and so on, and reads inputs such as `stage0@-1` and
//! `depth@-1`. Of each there are as many textures as frames that are known at the same time. Frame by frame the next one
//! is written, so that nothing is copied but the host's own textures, which it draws into anew.

use crate::error::{Error, Result};

/// What later frames will read of a frame.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Past {
    /// Frames before the one at hand that plans know at most.
    pub frames: usize,
    /// Inputs of the host's, such as `depth`, that are read of them.
    pub inputs: Vec<String>,
}

impl Past {
    /// Of a plan that knows so many frames before, by the names of its inputs.
    pub fn of<'n>(frames: usize, names: impl Iterator<Item = &'n str>) -> Self {
        let mut inputs: Vec<String> = Vec::new();
        for (base, _) in names.filter_map(split).filter(|(base, _)| !is_stage(base)) {
            if inputs.iter().all(|known| known != base) {
                inputs.push(base.to_owned());
            }
        }
        Self { frames, inputs }
    }
}

/// The name of an input and how many frames before it belongs to: `depth@-2` is of 2 before.
pub fn split(name: &str) -> Option<(&str, usize)> {
    let (base, frame) = name.split_once("@-")?;
    Some((base, frame.parse().ok()?))
}

/// Whether an output is kept for later frames.
pub fn is_stage(name: &str) -> bool {
    name.strip_prefix("stage").is_some_and(|number| number.parse::<u32>().is_ok())
}

/// The textures of one stage or input.
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
    /// Frames of which textures are held.
    frames: usize,
    /// Which of a ring's textures belongs to the frame at hand.
    turn: usize,
}

impl Rings {
    /// None yet, for plans that read `past`.
    pub fn new(past: &Past) -> Self {
        Self { rings: Vec::new(), frames: past.frames + 1, turn: 0 }
    }

    /// How many turns there are.
    pub fn turns(&self) -> usize {
        self.frames
    }

    /// Which turn it is.
    pub fn turn(&self) -> usize {
        self.turn
    }

    /// The textures of a name by turns, as they are written or, so many frames later, read.
    pub fn views(&self, name: &str, later: usize) -> Option<Vec<wgpu::TextureView>> {
        let ring = self.rings.iter().find(|ring| ring.name == name)?;
        let at = |turn: usize| ring.views[(turn + self.frames - later) % self.frames].clone();
        Some((0..self.frames).map(at).collect())
    }

    /// Makes textures for a name, unless it has them in this format and size; returns how many were made.
    ///
    /// # Errors
    /// What `make` says.
    pub fn hold(
        &mut self,
        name: &str,
        format: wgpu::TextureFormat,
        size: [u32; 2],
        host: Option<wgpu::Texture>,
        make: impl Fn() -> Result<wgpu::TextureView>,
    ) -> Result<u64> {
        let is_like = |ring: &Ring| {
            let texture = ring.views[0].texture();
            ring.name == name && texture.format() == format && [texture.width(), texture.height()] == size
        };
        if let Some(ring) = self.rings.iter_mut().find(|ring| is_like(ring)) {
            ring.host = host;
            return Ok(0);
        }
        self.rings.retain(|ring| ring.name != name);
        let views = (0..self.frames).map(|_| make()).collect::<Result<Vec<_>>>()?;
        if views.is_empty() {
            let problem = format!("no frames are held of '{name}'");
            return Err(Error::failure(problem, "this is a mistake in the program; please report it"));
        }
        self.rings.push(Ring { name: name.to_owned(), views, host });
        Ok(self.frames as u64)
    }

    /// Forgets names that are not among these.
    pub fn retain(&mut self, is_needed: impl Fn(&str) -> bool) {
        self.rings.retain(|ring| is_needed(&ring.name));
    }

    /// Copies what the host will draw into anew.
    pub fn encode_copies(&self, encoder: &mut wgpu::CommandEncoder) {
        for ring in &self.rings {
            if let Some(host) = &ring.host {
                let to = ring.views[self.turn].texture();
                encoder.copy_texture_to_texture(host.as_image_copy(), to.as_image_copy(), to.size());
            }
        }
    }

    /// The next frame begins.
    pub fn advance(&mut self) {
        self.turn = (self.turn + 1) % self.frames.max(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_what_is_kept() {
        let names = ["color", "stage0@-1", "depth@-1", "motion@-1", "depth@-2", "stage1@-2"];
        let past = Past::of(2, names.into_iter());
        assert_eq!(past, Past { frames: 2, inputs: vec!["depth".into(), "motion".into()] });
        assert!(is_stage("stage12") && !is_stage("stages") && !is_stage("result"));
        assert_eq!(split("depth@-2"), Some(("depth", 2)));
        assert_eq!(split("depth"), None);
    }
}
