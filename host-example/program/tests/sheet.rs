//! `sheet`: pictures side by side, whatever kind of file they are.

use std::path::Path;

use crate::support::{fails, folder, isophote, listing, root, succeeds};
use image::{Rgb, RgbImage};

const GROUND: Rgb<u8> = Rgb([46, 46, 48]);

fn sheet(folder: &Path, arguments: &[&str]) -> RgbImage {
    succeeds(isophote().current_dir(folder).arg("sheet").args(arguments));
    image::open(folder.join(arguments[0])).expect("a sheet was written").to_rgb8()
}

#[test]
fn pictures_stand_side_by_side_over_their_names() {
    let folder = folder();
    let save = |name: &str, color| {
        RgbImage::from_pixel(40, 20, color).save(folder.path().join(name)).expect("it can be written");
    };
    save("a.png", Rgb([200, 40, 10]));
    save("b.png", Rgb([10, 90, 220]));
    // As light in an EXR file it is the same colour.
    let apply = ["apply", "gaussian", "b.png", "b.exr", "--set", "mix=0", "--backend", "cpu"];
    succeeds(isophote().current_dir(folder.path()).args(apply));
    let result = sheet(folder.path(), &["s.png", "a.png", "b.png", "b.exr", "--width", "80"]);
    assert_eq!(result.dimensions(), (12 + 3 * 92, 12 + 40 + 26));
    for (x, color) in [(52, [200, 40, 10]), (144, [10, 90, 220]), (236, [10, 90, 220])] {
        let Rgb(shown) = *result.get_pixel(x, 32);
        assert!(shown.iter().zip(color).all(|(a, b)| a.abs_diff(b) <= 1), "{shown:?} for {color:?}");
        let letters = (x - 40..x + 40).flat_map(|x| (53..78).map(move |y| (x, y)));
        assert!(
            letters.filter(|(x, y)| *result.get_pixel(*x, *y) != GROUND).count() > 30,
            "no name under {x}"
        );
    }
    let below = sheet(folder.path(), &["t.png", "a.png", "b.png", "--width", "40", "--columns", "1"]);
    assert_eq!(below.dimensions(), (64, 12 + 2 * 46));
    let named =
        sheet(folder.path(), &["u.png", "a.png", "b.png", "--width", "40", "--columns", "1", "--label", "x"]);
    assert_ne!(below, named);
}

#[test]
fn cases_of_pixels_that_are_not_square_have_their_shape() {
    let folder = folder();
    let case = root().join("tests/data/cases/pixel_aspect/imp2.exr");
    let shown = sheet(folder.path(), &["s.png", case.to_str().expect("a name"), "--width", "80"]);
    // As wide as they are high, of pixels twice as wide as high.
    assert_eq!(shown.dimensions(), (12 + 92, 12 + 40 + 26));
}

#[test]
fn what_cannot_be_shown_leaves_no_sheet() {
    let folder = folder();
    RgbImage::new(4, 4).save(folder.path().join("a.png")).expect("it can be written");
    for (arguments, words) in [
        (&["s.jpg", "a.png"][..], &["s.jpg", ".png"][..]),
        (&["s.png", "none.png"], &["none.png", "cannot be read"]),
        (&["s.png", "a.png", "--label", "a", "--label", "b"], &["--label", "2 labels for 1"]),
        (&["nowhere/s.png", "a.png"], &["nowhere/s.png", "cannot be written"]),
    ] {
        let mut command = isophote();
        command.current_dir(folder.path()).arg("sheet").args(arguments);
        fails(&mut command, 2, words);
    }
    assert_eq!(listing(folder.path()), ["a.png"]);
}
