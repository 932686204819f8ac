//! What files say of themselves and decoders keep to themselves: the kind of alpha and the shape of pixels.

use crate::exr::Picture;
use crate::meaning::Alpha;
use crate::tiff::{Fourth, said};
use crate::{png, tiff};

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
    match said(bytes).fourth {
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

    use tiff::encoder::{TiffEncoder, colortype};
    use tiff::tags::{ExtraSamples, Tag};

    use super::*;
    use crate::exr::Selection;
    use crate::meaning::Meaning;
    use crate::pixels::Samples;
    use crate::read;

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
        for (kind, alpha) in [(1, Alpha::Premultiplied), (2, Alpha::Straight)] {
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
}
