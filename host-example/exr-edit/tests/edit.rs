//! Content that is not changed is kept: bytes of files without edits, samples of channels without new ones.

mod support;

use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding as ExrEncoding, FlatSamples, Image, IntegerBounds,
    Layer, LayerAttributes, Vec2, WritableImage,
};
use isophote_exr_edit::{Channel, Edit, Error, File, Limits, PartEdit, Plane, Sample};
use isophote_tests::two_parts;
use support::{assets, encodings, file, lossy};

fn parse(bytes: Vec<u8>) -> File {
    File::parse(bytes, Limits::default()).expect("the file is whole")
}

/// Bits and not values, so that what is no number counts too.
fn bits(plane: &Plane) -> Vec<u32> {
    match plane {
        Plane::Uint(v) => v.clone(),
        Plane::Half(v) => v.iter().map(|s| u32::from(s.to_bits())).collect(),
        Plane::Float(v) => v.iter().map(|s| s.to_bits()).collect(),
    }
}

#[test]
fn a_file_without_edits_keeps_its_bytes() {
    let folders = ["ScanLines", "Tiles", "MultiResolution", "MultiView", "Beachball", "DisplayWindow", "v2"];
    let others = folders.into_iter().flat_map(assets).filter(|p| p.extension().is_some_and(|e| e == "exr"));
    let others = others.map(|path| std::fs::read(path).expect("the file can be read"));
    for bytes in encodings().into_iter().map(|e| file(e, (37, 41), 1.0)).chain(others) {
        let Ok(file) = File::parse(bytes.clone(), Limits::default()) else { continue };
        let mut out = Vec::new();
        file.write(&[], &mut out).unwrap();
        // Some writers leave room between chunks; what is read is the same then.
        if out.len() == bytes.len() {
            assert!(out == bytes);
        } else {
            assert_eq!(parse(out).parts().len(), file.parts().len());
        }
    }
}

#[test]
fn other_channels_keep_their_bits() {
    for encoding in encodings() {
        let before = parse(file(encoding, (37, 41), 1.0));
        let part = &before.parts()[0];
        let decoded = before.decode(0).unwrap();
        let mut edit = Edit::of(part);
        edit.replace("G", vec![2.0; 37 * 41]).unwrap();
        let added = Channel { name: "a.new".into(), sample: Sample::Float, flags: [0; 4], sampling: (1, 1) };
        edit.insert(added, vec![0.125; 37 * 41]).unwrap();
        let mut out = Vec::new();
        before.write(&[PartEdit { decoded: &decoded, edit: &edit }], &mut out).unwrap();

        let after = parse(out);
        let again = after.decode(0).unwrap();
        let named = &after.parts()[0];
        assert_eq!(named.channels.len(), part.channels.len() + 1);
        for name in ["B", "R", "Z", "id"] {
            let (old, new) = (part.channel(name).unwrap(), named.channel(name).unwrap());
            let (old, new) = (decoded.plane(old).unwrap(), again.plane(new).unwrap());
            assert!(bits(&old) == bits(&new), "{encoding:?}, {name}");
        }
        for (name, value) in [("G", 2.0), ("a.new", 0.125)] {
            let plane = again.plane(named.channel(name).unwrap()).unwrap().to_f32();
            assert!(plane.iter().all(|v| *v == value), "{encoding:?}, {name}");
        }
    }
}

/// Compressions that are not read, with the scan lines of a chunk as OpenEXR's header `ImfCompression.h` has them.
const NOT_READ: [(u8, usize); 2] = [(10, 256), (11, 32)];

/// Channels that nobody changes lose nothing more: they are written with ZIP, whose chunks of lines are smaller.
#[test]
fn what_was_lossy_is_written_without_loss() {
    for encoding in lossy() {
        let (width, height) = (67, 301);
        let before = parse(file(encoding, (width, height), 1.0));
        assert_eq!(before.recompressed(0).map(|names| names[1]), Some("ZIP"));
        let part = &before.parts()[0];
        let decoded = before.decode(0).unwrap();
        let mut edit = Edit::of(part);
        edit.replace("G", vec![2.0; width * height]).unwrap();
        let mut out = Vec::new();
        before.write(&[PartEdit { decoded: &decoded, edit: &edit }], &mut out).unwrap();
        // The crate's own reader finds every chunk.
        let read = exr::prelude::read_first_flat_layer_from_file;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.exr");
        std::fs::write(&path, &out).unwrap();
        assert_eq!(read(&path).unwrap().layer_data.size, Vec2(width, height), "{encoding:?}");

        let after = parse(out);
        assert_eq!((after.parts()[0].compression, after.recompressed(0)), (3, None));
        let again = after.decode(0).unwrap();
        for name in ["B", "R", "Z", "id"] {
            let channel = part.channel(name).unwrap();
            let (old, new) = (decoded.plane(channel).unwrap(), again.plane(channel).unwrap());
            assert!(bits(&old) == bits(&new), "{encoding:?}, {name}");
        }
        let green = again.plane(part.channel("G").unwrap()).unwrap().to_f32();
        assert!(green.iter().all(|v| *v == 2.0), "{encoding:?}");
        // Nothing is decoded where nothing changes.
        let bytes = file(encoding, (width, height), 1.0);
        let mut same = Vec::new();
        parse(bytes.clone()).write(&[], &mut same).unwrap();
        assert!(bytes == same, "{encoding:?}");
    }
}

/// A picture of one colour takes hardly any bytes.
#[test]
fn flat_pictures_of_lossy_kinds_are_read() {
    for encoding in lossy() {
        let file = parse(file(encoding, (1024, 256), 0.0));
        let decoded = file.decode(0).unwrap();
        let red = decoded.plane(file.parts()[0].channel("R").unwrap()).unwrap().to_f32();
        assert!(red.iter().all(|v| (v - 0.25).abs() < 0.01), "{encoding:?}");
    }
}

#[test]
fn newer_compressions_are_named() {
    for (compression, name) in [(10, "HTJ2K256"), (11, "HTJ2K32"), (12, "LJ2K"), (13, "ZSTD"), (14, "14")] {
        let mut bytes = file(encodings()[0], (8, 8), 1.0);
        let at = bytes.windows(12).position(|b| b == b"compression\0").unwrap() + 28;
        bytes[at] = compression;
        let error =
            File::parse(bytes, Limits::default()).and_then(|file| file.decode(0)).unwrap_err().to_string();
        // HTJ2K has other chunks than these lines.
        let is_named = error.contains(name) && !error.contains("damaged");
        assert!(is_named || compression < 12, "{compression}: {error}");
    }
}

#[test]
fn parts_that_are_not_read_pass_untouched() {
    for (compression, lines) in NOT_READ {
        let (bytes, chunks) = two_parts::file(compression, lines);
        let before = parse(bytes.clone());
        assert!(before.can_decode(0) && !before.can_decode(1), "{compression}");
        assert!(matches!(before.decode(1), Err(Error::Unsupported { .. })), "{compression}");
        let decoded = before.decode(0).unwrap();
        let mut edit = Edit::of(&before.parts()[0]);
        edit.replace("G", vec![2.0; two_parts::SIZE.0 * two_parts::SIZE.1]).unwrap();
        let mut out = Vec::new();
        before.write(&[PartEdit { decoded: &decoded, edit: &edit }], &mut out).unwrap();
        // Nothing is compressed, so that every chunk lies where it lay.
        assert_eq!(out.len(), bytes.len());
        let tail: usize = chunks.iter().map(|chunk| 12 + chunk.len()).sum();
        assert!(out[out.len() - tail..] == bytes[bytes.len() - tail..], "{compression}");
        assert!(out != bytes, "{compression}");
        assert_eq!(parse(out).parts()[1].compression, compression);
        // As many lines a chunk as another compression has.
        let (bytes, _) = two_parts::file(compression, if lines == 32 { 256 } else { 32 });
        assert!(matches!(File::parse(bytes, Limits::default()), Err(Error::Damaged(_))), "{compression}");
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let first = parse(file(encodings()[3], (8, 8), 1.0));
    let other = parse(file(encodings()[3], (9, 8), 1.0));
    let mut edit = Edit::of(&first.parts()[0]);
    let refused =
        |result: Result<(), Error>| assert!(matches!(result, Err(Error::Argument(_))), "{result:?}");
    refused(edit.replace("none", vec![0.0; 64]));
    refused(edit.replace("R", vec![0.0; 63]));
    let channel =
        |name: &str, sampling| Channel { name: name.into(), sample: Sample::Half, flags: [0; 4], sampling };
    refused(edit.insert(channel("R", (1, 1)), vec![0.0; 64]));
    refused(edit.insert(channel("", (1, 1)), vec![0.0; 64]));
    refused(edit.insert(channel("a\0b", (1, 1)), vec![0.0; 64]));
    refused(edit.insert(channel("a", (0, 1)), vec![0.0; 64]));
    refused(edit.insert(channel("a", (3, 1)), vec![0.0; 16]));
    let decoded = first.decode(0).unwrap();
    let twice = [PartEdit { decoded: &decoded, edit: &edit }; 2];
    refused(first.write(&twice, &mut Vec::new()));
    refused(other.write(&twice[..1], &mut Vec::new()));
    let wrong = Edit::of(&other.parts()[0]);
    refused(first.write(&[PartEdit { decoded: &decoded, edit: &wrong }], &mut Vec::new()));
    assert!(matches!(first.decode(1), Err(Error::Argument(_))));
    assert!(matches!(decoded.plane(9), Err(Error::Argument(_))));
}

#[test]
fn texts_and_windows_of_headers_are_told() {
    let mut layer = Layer::new(
        (3, 2),
        LayerAttributes { layer_position: Vec2(4, -5), ..Default::default() },
        ExrEncoding::UNCOMPRESSED,
        AnyChannels::sort(std::iter::once(AnyChannel::new("Y", FlatSamples::F32(vec![0.5; 6]))).collect()),
    );
    let other = &mut layer.attributes.other;
    other.insert("cryptomatte/1/name".into(), AttributeValue::Text("objects".into()));
    other.insert("seed".into(), AttributeValue::I32(7));
    let mut image = Image::from_layer(layer);
    image.attributes.display_window = IntegerBounds::new((-1, -9), (30, 20));
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).unwrap();

    let file = parse(bytes.into_inner());
    let texts: Vec<_> = file.texts(0).filter(|(name, _)| name.starts_with("crypto")).collect();
    assert_eq!(texts, [("cryptomatte/1/name", &b"objects"[..])]);
    assert!(file.texts(0).all(|(name, _)| name != "seed"));
    assert_eq!(file.texts(1).count(), 0);
    let part = &file.parts()[0];
    let display = part.display.unwrap();
    assert_eq!((part.window.x, part.window.y), (4, -5));
    assert_eq!((display.x, display.y, display.width, display.height), (-1, -9, 30, 20));
}
