//! Pictures that were rendered or stylized one by one, into a video of their own.

use std::path::Path;

use super::closed::Ratio;
use super::encode::{Encoder, Encoding};
use super::opaque::on_black;
use super::stream::Stream;
use isophote_files::error::{Error, Result};
use isophote_pictures::floats::Picture;
use isophote_pictures::pixels::{Pixels, Samples};
use isophote_pictures::transfer::srgb_encode;

/// A video that is being made. It is opaque: what is transparent is put on black. A last odd row or column, which most videos
/// cannot have, is left out.
#[derive(Debug)]
pub struct Film<'a> {
    output: &'a Path,
    /// Size of the frames as they are handed over.
    size: (u32, u32),
    channels: u32,
    encoder: Encoder,
}

impl<'a> Film<'a> {
    /// Starts to encode frames like `first`, so many a second and of pixels of this aspect, into the file `place`, which will
    /// become `output`; `options` are those of the encoder instead of the usual ones.
    ///
    /// # Errors
    /// [`Error::Input`] for pictures of a single row or column, [`Error::Failure`] without ffmpeg.
    pub fn start(
        first: &Pixels,
        (rate, aspect): (f64, f64),
        (output, place): (&'a Path, &Path),
        options: Option<&'a str>,
    ) -> Result<Self> {
        let size = (first.width(), first.height());
        if size.0 < 2 || size.1 < 2 {
            return Err(Error::file(output, "has frames of a single row or column", "use a larger size"));
        }
        let channels = if first.channels() == 1 { 1 } else { 3 };
        let rate = Ratio::of_rate(rate)
            .ok_or_else(|| Error::file(output, format!("cannot have {rate} frames a second"), "use 24"))?;
        let usual = Stream::of_frames((size.0 & !1, size.1 & !1), rate);
        let stream = Stream { aspect: Ratio::of_aspect(aspect).unwrap_or(Ratio::ONE), ..usual };
        let encoding = Encoding { stream: &stream, channels, more: None, times: None, output, options };
        Ok(Self { output, size, channels, encoder: Encoder::start(&encoding, place)? })
    }

    /// Adds a display-referred frame, and says whether more are taken; [`Film::end`] says why not.
    ///
    /// # Errors
    /// [`Error::Input`] for a frame of another size than the first.
    pub fn put(&mut self, frame: &Pixels) -> Result<bool> {
        if (frame.width(), frame.height()) != self.size || (frame.channels() == 1) != (self.channels == 1) {
            let problem = format!(
                "cannot hold frames of {}x{} and {}x{} pixels or of colour and grey",
                self.size.0,
                self.size.1,
                frame.width(),
                frame.height()
            );
            return Err(Error::file(self.output, problem, "use frames of one kind"));
        }
        Ok(self.encoder.put(&opaque(frame)))
    }

    /// Waits for the end of a video, and makes sure that it holds every frame.
    ///
    /// # Errors
    /// [`Error::Input`] where ffmpeg refuses to begin or there was no frame, [`Error::Failure`] for a video that is not whole.
    pub fn end(film: Option<Self>, output: &Path) -> Result<()> {
        match film {
            Some(film) => film.encoder.end(),
            None => Err(Error::file(output, "would have no frames", "choose frames that are there")),
        }
    }
}

/// A rendered picture as displays have it: linear light with premultiplied alpha is put on black and encoded, numbers are grey.
pub fn shown(picture: &Picture) -> Option<Pixels> {
    let word = |v: f32| (v.clamp(0.0, 1.0) * 65535.0 + 0.5) as u16;
    let (channels, samples): (u32, Vec<u16>) = match picture.channels {
        4 => {
            let pixels = picture.data.as_chunks::<4>().0;
            (3, pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b].map(|v| word(srgb_encode(v)))).collect())
        }
        _ => (1, picture.data.iter().copied().map(word).collect()),
    };
    Pixels::new(picture.width, picture.height, channels, Samples::U16(samples))
}

/// 16 bits on black, of an even number of rows and columns.
fn opaque(frame: &Pixels) -> Pixels {
    let (width, height) = (frame.width() & !1, frame.height() & !1);
    let pixels = on_black(frame);
    let count = pixels.channels() as usize;
    let Samples::U16(samples) = pixels.samples() else { return pixels };
    let rows = samples.chunks_exact(frame.width() as usize * count).take(height as usize);
    let kept: Vec<u16> = rows.flat_map(|row| &row[..width as usize * count]).copied().collect();
    // As many samples as the size says.
    Pixels::new(width, height, pixels.channels(), Samples::U16(kept)).unwrap_or(pixels)
}

#[cfg(test)]
mod tests {
    use isophote_pictures::pixels::Precision;

    use super::*;

    #[test]
    fn frames_are_even_and_on_black() {
        let samples: Vec<u8> = (0..3 * 3 * 4).map(|i| if i % 4 == 3 { 0 } else { 200 }).collect();
        let frame = opaque(&Pixels::new(3, 3, 4, Samples::U8(samples)).unwrap());
        assert_eq!(frame, Pixels::zeroed(2, 2, 3, Precision::U16));
        let grey = Pixels::new(2, 3, 1, Samples::U8((0..6).collect())).unwrap();
        assert_eq!(opaque(&grey).samples(), &Samples::U16(vec![0, 257, 514, 771]));
    }

    #[test]
    fn light_is_encoded() {
        let picture = Picture { width: 1, height: 1, channels: 4, data: vec![1.0, 0.0, 0.214_041_14, 0.5] };
        let Some(Samples::U16(samples)) = shown(&picture).map(|p| p.samples().clone()) else { panic!() };
        assert_eq!((samples[0], samples[1]), (65535, 0));
        assert!(samples[2].abs_diff(32768) < 8, "{samples:?}");
    }
}
