//! Everything that is painted over a picture, as looks and files have it.

use rayon::prelude::*;

use super::channel::{Channel, Kind};
use super::tiles::Tiles;
use crate::state::document::frame::GuideImage;
use isophote_pictures::exr::Guide;

/// Everything that is painted over a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Maps {
    layers: [Tiles; Channel::ALL.len()],
    /// True where the control map stands for one of the file, also where nothing is painted.
    covers_own: bool,
}

impl Maps {
    /// Maps of a picture on which nothing is painted.
    pub fn new(size: (u32, u32)) -> Self {
        Self { layers: Channel::ALL.map(|channel| Tiles::new(size, channel.plain())), covers_own: false }
    }

    /// Pixels across and down.
    pub fn size(&self) -> (u32, u32) {
        self.layers[0].size()
    }

    /// Bytes of what is painted.
    pub fn bytes_held(&self) -> usize {
        self.layers.iter().map(Tiles::bytes_held).sum()
    }

    /// What is painted of a channel.
    pub fn layer(&self, channel: Channel) -> &Tiles {
        &self.layers[channel as usize]
    }

    /// The same, to be painted.
    pub fn layer_mut(&mut self, channel: Channel) -> &mut Tiles {
        &mut self.layers[channel as usize]
    }

    /// Maps over a picture whose file has a control map, by the numbers of that.
    pub fn over(size: (u32, u32), control: &[f32]) -> Self {
        let mut maps = Self { covers_own: true, ..Self::new(size) };
        maps.take(Kind::Control, control, size);
        maps
    }

    /// True where something of a map is painted, or it stands for one of the file.
    pub fn has(&self, kind: Kind) -> bool {
        let is_in_place = self.covers_own && kind == Kind::Control;
        is_in_place
            || Channel::ALL.iter().any(|channel| channel.kind() == kind && !self.layer(*channel).is_plain())
    }

    /// Numbers of a map, 4 a pixel of a control map and 1 of a mask, for pictures of a size: those in the middle of each pixel.
    pub fn bytes(&self, kind: Kind, (width, height): (u32, u32)) -> Vec<u8> {
        let channels: Vec<&Tiles> =
            Channel::ALL.iter().filter(|c| c.kind() == kind).map(|c| self.layer(*c)).collect();
        let (across, down) = self.size();
        let columns: Vec<u32> = (0..width as usize).map(|x| middle(x, across, width)).collect();
        let row = width as usize * channels.len();
        let mut bytes = vec![0; row * height as usize];
        bytes.par_chunks_exact_mut(row.max(1)).enumerate().for_each(|(y, line)| {
            let y = middle(y, down, height);
            for (pixel, x) in line.chunks_exact_mut(channels.len()).zip(&columns) {
                for (value, tiles) in pixel.iter_mut().zip(&channels) {
                    *value = tiles.get(*x, y);
                }
            }
        });
        bytes
    }

    /// The control map as looks read it, for pictures of a size; nothing where none is painted.
    pub fn control(&self, size: (u32, u32)) -> Option<GuideImage> {
        let data = self.has(Kind::Control).then(|| shares(&self.bytes(Kind::Control, size)))?;
        Some(GuideImage { guide: Guide::Control, channels: 4, data })
    }

    /// The mask as looks read it, likewise.
    pub fn mask(&self, size: (u32, u32)) -> Option<Vec<f32>> {
        self.has(Kind::Mask).then(|| shares(&self.bytes(Kind::Mask, size)))
    }

    /// Takes over a map from a picture of a size, by numbers of 0 to 1, as many a pixel as the map has.
    pub fn take(&mut self, kind: Kind, numbers: &[f32], (width, height): (u32, u32)) {
        let size = self.size();
        let channels: Vec<Channel> = Channel::ALL.into_iter().filter(|c| c.kind() == kind).collect();
        for (at, channel) in channels.iter().enumerate() {
            let number = |x: u32, y: u32| {
                let [x, y] = [middle(x as usize, width, size.0), middle(y as usize, height, size.1)];
                let pixel = y as usize * width as usize + x as usize;
                numbers.get(pixel * channels.len() + at).copied().unwrap_or(f32::NAN)
            };
            let tiles = self.layer_mut(*channel);
            tiles.change([0, 0, size.0, size.1], |x, y, _| channel.stored(number(x, y)));
            tiles.tidy();
        }
    }
}

/// The pixel of `own` pixels across that lies in the middle of one of `of`.
pub fn middle(at: usize, own: u32, of: u32) -> u32 {
    ((2 * at as u64 + 1) * u64::from(own) / (2 * u64::from(of.max(1)))) as u32
}

/// Bytes as shares, as files with 8 bits are read.
fn shares(bytes: &[u8]) -> Vec<f32> {
    bytes.par_iter().map(|byte| f32::from(*byte) / 255.0).collect()
}

#[cfg(test)]
mod tests {
    use super::super::channel::MOST;
    use super::*;

    #[test]
    fn maps_are_read_as_looks_read_files_and_come_back_from_them() {
        let mut maps = Maps::new((4, 2));
        assert!(maps.control((4, 2)).is_none() && maps.mask((4, 2)).is_none());
        maps.layer_mut(Channel::LineWidth).change([1, 0, 2, 1], |_, _, _| MOST);
        let control = maps.control((4, 2)).unwrap();
        let plain = 127.0 / 255.0;
        assert_eq!(control.data[..8], [plain, plain, plain, plain, plain, 254.0 / 255.0, plain, plain]);
        assert!(maps.mask((4, 2)).is_none() && !maps.has(Kind::Mask));
        // Half as large, from the middle of each pixel; twice as large.
        assert_eq!(maps.bytes(Kind::Control, (2, 1))[1], 127);
        assert_eq!(maps.bytes(Kind::Control, (8, 4))[4 * 3 + 1], MOST);
        let mut read = Maps::new((4, 2));
        read.take(Kind::Control, &control.data, (4, 2));
        assert_eq!(read, maps);
        read.take(Kind::Mask, &[1.0, 0.0, f32::NAN, 2.0, -1.0, 0.5, 1.0, 1.0], (4, 2));
        assert_eq!(read.bytes(Kind::Mask, (4, 2)), [255, 0, 255, 255, 0, 128, 255, 255]);
        assert!(read.layer(Channel::Detail).is_plain());
        // What is cleared is clear, also over a map of the file.
        let mut over = Maps::over((4, 2), &control.data);
        over.layer_mut(Channel::LineWidth).fill(127);
        assert!(over.control((4, 2)).unwrap().data.iter().all(|v| *v == plain));
        // Of pixels that are twice as wide.
        read.take(Kind::Mask, &[0.2, 0.4, 0.6, 0.8], (2, 2));
        assert_eq!(read.bytes(Kind::Mask, (2, 2)), [51, 102, 153, 204]);
        assert_eq!(read.bytes(Kind::Mask, (4, 2))[..4], [51, 51, 102, 102]);
    }
}
