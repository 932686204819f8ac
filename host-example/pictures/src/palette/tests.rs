//! Files of palettes, and pictures whose colours are found.

use std::fs;
use std::path::PathBuf;

use image::{Luma, Rgb, RgbImage, Rgba, RgbaImage};
use tempfile::TempDir;

use super::*;

const THREE: [Colour; 3] = [[16, 32, 48], [240, 232, 216], [176, 64, 40]];
const SIXTEEN: Wanted = Wanted { count: None, most: 16 };

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn file(folder: &TempDir, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    path
}

fn problem(path: &Path) -> String {
    read(path, SIXTEEN).unwrap_err().to_string()
}

#[test]
fn files_are_known_by_their_first_bytes() {
    let folder = folder();
    let aco: Vec<u8> = [1_u16, 2, 0, 65535, 0, 0, 0, 0, 0, 0, 65535, 0].map(u16::to_be_bytes).concat();
    for (bytes, colours) in [
        (&b"GIMP Palette\n16 32 48\n240 232 216 caf\xe9\n176 64 40\n16 32 48"[..], &THREE[..]),
        (b"\xef\xbb\xbf102030\nf0e8d8\nb04028", &THREE),
        (b"JASC-PAL\r\n0100\r\n2\r\n16 32 48\r\n240 232 216\r\n", &THREE[..2]),
        (b"\n [\"#102030\", \"#f0e8d8\", \"#b04028\"]", &THREE),
        (&aco, &[[255, 0, 0], [0, 0, 255]]),
    ] {
        let read = read(&file(&folder, "own.any", bytes), SIXTEEN).unwrap();
        assert_eq!((read.name.as_str(), &read.colours[..]), ("own", colours));
        assert!(read.notes.is_empty());
    }
}

#[test]
fn what_is_written_is_read() {
    let folder = folder();
    let palette = Palette { name: "own".into(), colours: THREE.to_vec(), notes: vec![] };
    for name in ["own.gpl", "own.hex", "own.JSON"] {
        let path = folder.path().join(name);
        write(&path, Existing::Keep, &palette).unwrap();
        assert_eq!(read(&path, SIXTEEN).unwrap(), palette, "{name}");
        assert!(write(&path, Existing::Keep, &palette).is_err());
    }
    let problem = write(&folder.path().join("own.ase"), Existing::Keep, &palette).unwrap_err().to_string();
    assert!(problem.contains(".gpl, .hex or .json"), "{problem}");
}

#[test]
fn what_is_no_palette_is_refused_with_a_reason() {
    let folder = folder();
    let many: String = (0..=MOST).map(|i| format!("{i:06x}\n")).collect();
    let aseprite = [0, 0, 0, 0, 0xe0, 0xa5, 1, 0];
    for (bytes, words) in [
        (&b""[..], "is empty"),
        (b"\n\n", "has no colours"),
        (b"GIMP Palette\n#\n", "has no colours"),
        (b"102030\n#102030", "has one colour alone"),
        (
            b"yellow\nblue",
            "cannot be read as a list of colours: it has no colour such as 1a2b3c in line 1, 'yellow'",
        ),
        (b"{\"style\": \"ink\"}", "cannot be read as a palette in JSON"),
        (b"ASEF\0\x01", "swatches for exchange: it ends within its head"),
        (b"\0\x01\xff\xff\0\0", "Photoshop's swatches: it ends within colour 1 of 65535"),
        (b"\x7fELF\x02\x01\x01\0\0\0\xff", "is no palette of a kind that is read, and no picture"),
        (&aseprite, "export its palette from Aseprite"),
        (many.as_bytes(), "has 4097 colours"),
    ] {
        let problem = problem(&file(&folder, "own.any", bytes));
        assert!(problem.contains(words), "{problem}");
    }
    let cut = problem(&file(&folder, "own.any", b"ASEF\0\x01\0\0\0\0\0\x01\0\x01"));
    assert!(
        cut.ends_with(
            "it ends within block 1 of 1; use an intact file, or export the palette again, such as .gpl"
        ),
        "{cut}"
    );
    assert!(problem(folder.path()).contains("is a folder"));
    assert!(problem(&folder.path().join("none.gpl")).contains("cannot be read"));
    let large = file(&folder, "large.txt", vec![b' '; MOST_BYTES as usize + 9]);
    assert!(problem(&large).contains("too large for a palette"));
    let cut = file(&folder, "cut.png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR");
    assert!(problem(&cut).contains("PNG"));
}

#[test]
fn larger_palettes_are_reduced_and_said_to_be() {
    let folder = folder();
    let text: String = (0..64).map(|i| format!("{:06x}\n", i * 0x03_0507)).collect();
    let path = file(&folder, "many.hex", text);
    let read = |count, most| read(&path, Wanted { count, most }).unwrap();
    assert_eq!(read(None, 64).colours.len(), 64);
    let few = read(None, 16);
    assert_eq!(few.colours.len(), 16);
    assert_eq!(few.notes, ["has 64 colours, and 16 of them are taken"]);
    assert_eq!(read(Some(5), 16).colours.len(), 5);
    assert_eq!(read(Some(99), 16).colours.len(), 16);
}

#[test]
fn inks_and_books_of_inks_are_spoken_of() {
    let folder = folder();
    let colours: [[u16; 5]; 4] =
        [[2, 0, 65535, 65535, 65535], [2, 65535, 0, 65535, 65535], [3, 1, 2, 3, 4], [2, 0, 0, 0, 0]];
    let bytes = [1, 4].into_iter().chain(colours.into_iter().flatten()).flat_map(u16::to_be_bytes);
    let path = file(&folder, "inks.aco", bytes.collect::<Vec<_>>());
    let read = read(&path, SIXTEEN).unwrap();
    assert_eq!(read.colours, [[0, 255, 255], [255, 0, 255], [0, 0, 0]]);
    assert!(read.notes[0].contains("3 colours of inks") && read.notes[1].contains("1 colours of books"));
}

#[test]
fn strips_give_all_their_colours_by_rows() {
    let folder = folder();
    let path = folder.path().join("strip.png");
    // Two rows of squares, each four pixels wide; one is transparent.
    let place = |x: u32, y: u32| [[0, 1], [2, 3]][(y / 4) as usize][(x / 4) as usize];
    let strip = RgbaImage::from_fn(8, 8, |x, y| match THREE.get(place(x, y)) {
        Some([r, g, b]) => Rgba([*r, *g, *b, 255]),
        None => Rgba([9, 9, 9, 0]),
    });
    strip.save(&path).unwrap();
    assert_eq!(read(&path, SIXTEEN).unwrap().colours, THREE);
    let grey = image::GrayImage::from_fn(3, 1, |x, _| Luma([[40, 0, 200][x as usize]]));
    grey.save(&path).unwrap();
    assert_eq!(read(&path, SIXTEEN).unwrap().colours, [[40; 3], [0; 3], [200; 3]]);
    RgbImage::from_pixel(5, 5, Rgb([1, 2, 3])).save(&path).unwrap();
    assert!(problem(&path).contains("one colour alone"));
    RgbaImage::from_pixel(5, 5, Rgba([1, 2, 3, 0])).save(&path).unwrap();
    assert!(problem(&path).contains("no colours"));
}

#[test]
fn pictures_give_the_middles_of_their_colours_from_dark_to_light() {
    let folder = folder();
    let path = folder.path().join("photo.png");
    let noise = |x: u32, y: u32, part: u32| (x * 7 + y * 11 + x * y * (part + 3)) % 9;
    let photo = RgbImage::from_fn(600, 300, |x, y| {
        let colour = THREE[if y < 30 { 2 } else { (x / 300) as usize }];
        Rgb([0, 1, 2].map(|part| colour[part as usize] + noise(x, y, part) as u8))
    });
    photo.save(&path).unwrap();
    let wanted = |count| Wanted { count, most: 16 };
    let three = read(&path, wanted(Some(3))).unwrap().colours;
    for (colour, flat) in three.iter().zip([THREE[0], THREE[2], THREE[1]]) {
        assert!(colour.iter().zip(flat).all(|(a, b)| a.abs_diff(b + 4) <= 10), "{three:?}");
    }
    assert_eq!(read(&path, wanted(None)).unwrap().colours.len(), USUAL);
    assert_eq!(read(&path, wanted(Some(40))).unwrap().colours.len(), 16);
}
