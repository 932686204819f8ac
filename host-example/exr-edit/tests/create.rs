//! New files: what stands in them, as other programs read it.

use std::io::{Cursor, Seek};

use exr::prelude::read_first_flat_layer_from_file;
use half::f16;
use isophote_exr_edit::{Error, File, Limits, Plane, create};

/// Rows of several groups of chunks that are compressed at once, and of a last chunk that is not full.
const SIZE: [usize; 2] = [7, 16 * 4 * 64 + 5];

fn picture() -> create::Picture {
    let pixels = SIZE[0] * SIZE[1];
    let noise = |at: usize| ((at as u32).wrapping_mul(2_654_435_761) >> 8) as f32 / 16_777_216.0;
    let channels = vec![
        ("R".to_owned(), Plane::Half((0..pixels).map(|at| f16::from_f32(at as f32 / 999.0)).collect())),
        ("A".to_owned(), Plane::Float((0..pixels).map(noise).collect())),
        ("id of a thing whose name is a long one".to_owned(), Plane::Uint((0..pixels as u32).collect())),
    ];
    let texts = (0..20).rev().map(|number| (format!("note {number:02}"), number.to_string())).collect();
    let [width, height] = SIZE;
    let matrix = std::array::from_fn(|at| at as f32);
    create::Picture {
        world_to_camera: Some(matrix),
        pixel_aspect: Some(2.0),
        ..create::Picture { width, height, channels, texts, ..create::Picture::default() }
    }
}

fn written(picture: &create::Picture) -> Vec<u8> {
    let mut out = Cursor::new(Vec::new());
    create::write(picture, &mut out).expect("it can be written");
    assert_eq!(out.stream_position().expect("in memory"), out.get_ref().len() as u64, "more may follow");
    out.into_inner()
}

#[test]
fn new_files_have_what_was_given() {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, picture) = (folder.path().join("new.exr"), picture());
    std::fs::write(&path, written(&picture)).expect("it can be written");
    let image = read_first_flat_layer_from_file(&path).expect("other programs read it");
    assert_eq!(image.attributes.pixel_aspect, 2.0);
    let layer = &image.layer_data;
    assert_eq!(layer.attributes.world_to_camera, picture.world_to_camera);
    assert_eq!(layer.attributes.other.len(), 20);
    let list = &layer.channel_data.list;
    assert_eq!(list.len(), 3);
    for (name, plane) in &picture.channels {
        let channel = list.iter().find(|channel| channel.name.eq(name.as_str())).expect("the channel");
        let (found, expected) = (channel.sample_data.values_as_f32(), plane.to_f32());
        assert!(found.eq(expected), "{name}");
    }
    // And it is one that is read here.
    let file = File::parse(written(&picture), Limits::default()).expect("it is whole");
    let decoded = file.decode(0).expect("it reads");
    assert_eq!(decoded.plane(0).expect("A").to_f32(), picture.channels[1].1.to_f32());
}

#[test]
fn files_of_the_same_content_are_the_same() {
    let first = written(&picture());
    for _ in 0..4 {
        assert!(written(&picture()) == first);
    }
    let place = |text: &str| first.windows(text.len()).position(|bytes| bytes == text.as_bytes());
    let places: Vec<_> = ["channels", "compression", "note 00", "note 19", "worldToCamera"].map(place).into();
    assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{places:?}");
}

#[test]
fn what_cannot_be_written_is_refused() {
    let refused = |change: &dyn Fn(&mut create::Picture)| {
        let mut picture = picture();
        change(&mut picture);
        let refusal =
            create::write(&picture, &mut Cursor::new(Vec::new())).expect_err("it cannot be written");
        assert!(matches!(refusal, Error::Argument(_)), "{refusal}");
    };
    refused(&|picture| picture.channels[1].0 = "R".into());
    refused(&|picture| picture.channels[1].1 = Plane::Half(vec![f16::ONE; 3]));
    refused(&|picture| picture.channels[1].0 = "名".into());
    refused(&|picture| picture.channels[1].0 = String::new());
    refused(&|picture| picture.texts[1].1 = "名".into());
    refused(&|picture| picture.height = 0);
}
