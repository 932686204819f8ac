//! Things in what is open, which rules of looks may be for.

use std::path::PathBuf;
use std::sync::Arc;

use super::document::Info;
use isophote_scene::Scene;

/// Things in a picture.
#[derive(Clone, Debug)]
pub enum Things {
    /// Those of a scene.
    Scene {
        /// The scene.
        scene: Arc<Scene>,
        /// Its file, or what it is called.
        name: PathBuf,
        /// Things that samples of its pixels show; nothing where it was drawn with one sample, which the frame has.
        sampled: Option<Arc<Sampled>>,
    },
    /// Those that an EXR file has.
    File {
        /// The document.
        info: Arc<Info>,
        /// Number of the frame, where it has several.
        number: Option<i64>,
    },
}

impl Things {
    /// True where both are of the same scene or document, whichever frame of it.
    pub fn are_of_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Scene { scene, .. }, Self::Scene { scene: other, .. }) => Arc::ptr_eq(scene, other),
            (Self::File { info, .. }, Self::File { info: other, .. }) => Arc::ptr_eq(info, other),
            _ => false,
        }
    }

    /// The same without what samples of it show.
    #[must_use]
    pub fn unsampled(&self) -> Self {
        match self.clone() {
            Self::Scene { scene, name, .. } => Self::Scene { scene, name, sampled: None },
            file @ Self::File { .. } => file,
        }
    }
}

/// Numbers of the things that samples of each pixel show, from 1, and 0 of none. Nearly everywhere all of a pixel show the same.
#[derive(Debug)]
pub struct Sampled {
    first: Vec<f32>,
    /// By sample after the first: pixels that show something else there, and its number.
    others: Vec<Vec<(usize, f32)>>,
}

impl Sampled {
    /// The first of the samples.
    pub fn new(first: Vec<f32>) -> Self {
        Self { first, others: Vec::new() }
    }

    /// Adds another one.
    pub fn add(&mut self, numbers: &[f32]) {
        let others =
            self.first.iter().zip(numbers).enumerate().filter(|(_, (first, number))| first != number);
        self.others.push(others.map(|(pixel, (_, number))| (pixel, *number)).collect());
    }

    /// Number of samples.
    pub fn count(&self) -> u32 {
        1 + self.others.len() as u32
    }

    /// Shows the numbers of all samples, one after the other.
    pub fn each(&self, mut see: impl FnMut(&[f32])) {
        see(&self.first);
        let mut numbers = self.first.clone();
        for others in &self.others {
            for (pixel, number) in others {
                numbers[*pixel] = *number;
            }
            see(&numbers);
            for (pixel, _) in others {
                numbers[*pixel] = self.first[*pixel];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_those_that_were_added() {
        let samples = [[1.0, 0.0, 2.0], [1.0, 2.0, 0.0], [3.0, 0.0, 2.0], [1.0, 0.0, 2.0]];
        let mut sampled = Sampled::new(samples[0].to_vec());
        samples[1..].iter().for_each(|numbers| sampled.add(numbers));
        let mut seen = Vec::new();
        sampled.each(|numbers| seen.push(numbers.to_vec()));
        assert_eq!((seen, sampled.count()), (samples.map(Vec::from).to_vec(), 4));
    }
}
