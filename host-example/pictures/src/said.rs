//! Facts in files that decoders keep to themselves: the kind of alpha and the shape of pixels.

use crate::exr::Picture;
use crate::meaning::Alpha;
use crate::png;
use crate::tiff::{self, Fourth};

/// Width of a pixel over its height, where a file of this kind says that they differ.
pub fn pixel_aspect(kind: &str, bytes: &[u8]) -> Option<f32> {
    match kind {
        "PNG" => png::pixel_aspect(bytes),
        "TIFF" => tiff::said(bytes).pixel_aspect,
        _ => None,
    }
}

/// Takes in what a file of this kind says of a picture.
pub fn add(kind: &str, bytes: &[u8], picture: &mut Picture) {
    let meaning = &mut picture.meaning;
    meaning.pixel_aspect = pixel_aspect(kind, bytes).unwrap_or(1.0);
    if kind != "TIFF" {
        return;
    }
    let has_alpha = picture.pixels.channels() == 4;
    match tiff::said(bytes).fourth {
        Some(Fourth::Associated) if has_alpha => meaning.alpha = Alpha::Premultiplied,
        Some(Fourth::Unassociated) if has_alpha => meaning.alpha = Alpha::Straight,
        Some(Fourth::Other) => {
            let problem =
                "has samples beside its colours that are no alpha (ExtraSamples 0), which are not kept";
            meaning.warnings.push(problem.to_owned());
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;
    use std::path::Path;

    use ::tiff::encoder::{TiffEncoder, colortype};
    use ::tiff::tags::{ExtraSamples, Tag};

    use super::*;
    use crate::exr::Selection;
    use crate::meaning::Meaning;
    use crate::pixels::{Pixels, Samples};
    use crate::read;
    use crate::tiff_write;

    fn read(folder: &Path, bytes: &[u8]) -> Picture {
        let path = folder.join("a.tif");
        std::fs::write(&path, bytes).unwrap();
        read::read(&path, &Selection::default()).unwrap().pictures.remove(0)
    }

    #[test]
    fn kinds_of_alpha_in_tiff_files_are_known() {
        let folder = tempfile::tempdir().unwrap();
        let samples = [200, 100, 50, 128, 10, 20, 30, 0];
        for (kind, alpha, channels) in [
            (ExtraSamples::AssociatedAlpha, Alpha::Premultiplied, 4),
            (ExtraSamples::UnassociatedAlpha, Alpha::Straight, 4),
            (ExtraSamples::Unspecified, Alpha::None, 3),
        ] {
            let mut bytes = Cursor::new(Vec::new());
            let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
            let mut image = encoder.new_image::<colortype::RGBA8>(2, 1).unwrap();
            image.encoder().write_tag(Tag::ExtraSamples, kind.to_u16()).unwrap();
            image.write_data(&samples).unwrap();
            let Picture { pixels, meaning, .. } = read(folder.path(), bytes.get_ref());
            assert_eq!((meaning.alpha, pixels.channels()), (alpha, channels), "{kind:?}");
            assert_eq!(meaning.warnings.len(), usize::from(channels == 3));
            let Samples::U8(found) = pixels.samples() else { panic!("8 bits") };
            let expected: Vec<u8> =
                samples.chunks(4).flat_map(|pixel| &pixel[..channels as usize]).copied().collect();
            assert_eq!(*found, expected);
        }
    }

    #[test]
    fn floats_may_have_alpha_apart_from_colour() {
        let folder = tempfile::tempdir().unwrap();
        for (kind, alpha) in [(1_u16, Alpha::Premultiplied), (2, Alpha::Straight)] {
            let mut bytes = Cursor::new(Vec::new());
            let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
            let mut image = encoder.new_image::<colortype::RGBA32Float>(1, 1).unwrap();
            image.encoder().write_tag(Tag::ExtraSamples, kind).unwrap();
            image.write_data(&[4.0, 2.0, 1.0, 0.5]).unwrap();
            let picture = read(folder.path(), bytes.get_ref());
            assert_eq!(picture.meaning.alpha, alpha);
            assert_eq!(picture.meaning.state, Meaning::light().state);
        }
    }

    fn written(pixels: &Pixels, meaning: &Meaning) -> Vec<u8> {
        let mut file = Cursor::new(Vec::new());
        tiff_write::write(&mut file, pixels, meaning, None).unwrap();
        file.into_inner()
    }

    #[test]
    fn the_kind_of_alpha_and_the_shape_of_pixels_are_said() {
        let pixels = Pixels::new(2, 1, 4, Samples::U8(vec![200, 100, 0, 255, 50, 25, 0, 64])).unwrap();
        for (alpha, fourth) in
            [(Alpha::Premultiplied, Fourth::Associated), (Alpha::Straight, Fourth::Unassociated)]
        {
            let meaning = Meaning { alpha, pixel_aspect: 1.5, ..Meaning::display() };
            let said = tiff::said(&written(&pixels, &meaning));
            assert_eq!((said.fourth, said.pixel_aspect), (Some(fourth), Some(1.5)));
        }
        let grey = Pixels::new(2, 1, 1, Samples::U16(vec![0, 65535])).unwrap();
        let said = tiff::said(&written(&grey, &Meaning::display()));
        assert_eq!((said.fourth, said.pixel_aspect), (None, None));
        let floats = Pixels::new(1, 1, 1, Samples::F32(vec![0.0])).unwrap();
        let refused = tiff_write::write(&mut Cursor::new(Vec::new()), &floats, &Meaning::light(), None);
        assert!(refused.unwrap_err().contains("1 channels"));
    }
}
