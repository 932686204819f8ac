//! Textures of the last frames, which take turns: what a plan found on them, and what the host had bound.
//!
//! [`Past`] says which a plan reads, and how many take turns.

use isophote_files::error::Result;
use isophote_loader::history::Past;

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
        let count = self.past.images(name, self.turns);
        let views = (0..count).map(|_| make()).collect::<Result<Vec<_>>>()?;
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
