//! Control maps on the CPU executor: what is neutral changes no bit, and each channel does what it is for.

use crate::result::{self, Inputs};
use isophote::ColourSpace;
use isophote::engine::Image;
use isophote::registry;

const SIZE: [i32; 2] = [192, 96];
const NEUTRAL: [f32; 4] = [0.5; 4];

fn picture(value: impl Fn(i32, i32) -> [f32; 4]) -> Image {
    result::picture(SIZE, value)
}

/// Bars from top to bottom, sharp ones and faint ones, the same in both halves of the picture.
fn bars() -> Image {
    picture(|x, y| {
        let x = x % (SIZE[0] / 2);
        let light = if (24..48).contains(&x) { 0.25 } else { 0.7 };
        let faint = if (64..72).contains(&x) && y % 24 < 12 { 0.05 } else { 0.0 };
        [light + faint, light, 0.8 * light, 1.0]
    })
}

/// A map that is neutral on the left, and on the right but for one channel.
fn on_the_right(channel: usize, value: f32) -> Image {
    picture(|x, _| {
        let mut map = NEUTRAL;
        if x >= SIZE[0] / 2 {
            map[channel] = value;
        }
        map
    })
}

fn styled(style: &str, settings: &[(&str, &str)], inputs: Inputs<'_>) -> Image {
    result::of(style, settings, ColourSpace::Srgb, inputs)
}

fn bits(image: &Image) -> Vec<u32> {
    image.data().iter().map(|v| v.to_bits()).collect()
}

/// Mean darkness of the left and of the right half, off their borders.
fn darkness(image: &Image) -> [f32; 2] {
    mean(image, |pixel| 1.0 - pixel[..3].iter().sum::<f32>() / 3.0)
}

/// Mean of a value of the pixels of both halves, off their borders.
fn mean(image: &Image, value: impl Fn(&[f32]) -> f32) -> [f32; 2] {
    let half = SIZE[0] / 2;
    [0, half].map(|left| {
        let places = (8..SIZE[1] - 8).flat_map(|y| (left + 12..left + half - 12).map(move |x| (x, y)));
        let all: Vec<f32> = places.map(|(x, y)| value(image.pixel(x, y))).collect();
        all.iter().sum::<f32>() / all.len() as f32
    })
}

/// How much the colours of pixels differ from those beside them, in both halves.
fn structure(image: &Image) -> [f32; 2] {
    let half = SIZE[0] / 2;
    [0, half].map(|left| {
        let mut sum = 0.0;
        for y in 8..SIZE[1] - 8 {
            for x in left + 12..left + half - 12 {
                let [a, b] = [x, x + 1].map(|x| &image.row(y)[4 * x as usize..][..3]);
                sum += a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f32>();
            }
        }
        sum
    })
}

#[test]
fn neutral_maps_change_no_bit_of_any_style() {
    let color = bars();
    // Eight bits have no half; what is no number is neutral.
    let values = [0.5, 127.0 / 255.0, 128.0 / 255.0, f32::NAN];
    let map = picture(|x, y| [0, 1, 2, 3].map(|c| values[((x / 3 + y + c) % 4) as usize]));
    let directed = registry::nodes().iter().filter(|node| node.ports().any(|port| port.id == "control"));
    let mut count = 0;
    for node in directed {
        let plain = styled(node.id, &[], &[("color", &color)]);
        let same = styled(node.id, &[], &[("color", &color), ("control", &map)]);
        assert!(bits(&plain) == bits(&same), "{}", node.id);
        count += 1;
    }
    let styles = registry::nodes().iter().filter(|node| node.group == "styles").count();
    assert!(count > styles, "{count}");
}

#[test]
fn lines_are_as_many_as_asked_for() {
    let color = bars();
    for style in ["cartoon", "blueprint", "ink", "flow_dog"] {
        let drawn = |value: f32| {
            let (map, inputs) = (on_the_right(2, value), [("color", &color)]);
            let alone = if style == "flow_dog" { ("tau", "0.97") } else { ("show", "lines") };
            let out = styled(style, &[alone], &[inputs[0], ("control", &map)]);
            // One channel is 0 where lines are.
            mean(&out, |pixel| if pixel.len() == 1 { 1.0 - pixel[0] } else { pixel[3] })
        };
        let ([same, none], [left, right], [_, more]) = (drawn(0.0), drawn(0.5), drawn(1.0));
        assert!((same - left).abs() < 1e-6, "{style}: {same} {left}");
        assert!(none < 0.9 * right && more > 1.01 * right, "{style}: {none} {right} {more}");
    }
    // None is none, where the ground is light.
    let map = on_the_right(2, 0.0);
    let out = styled("flow_dog", &[("tau", "0.97")], &[("color", &color), ("control", &map)]);
    for y in 0..SIZE[1] {
        for x in SIZE[0] / 2 + 12..SIZE[0] {
            assert!(out.pixel(x, y)[0] > 0.999, "{x} {y}");
        }
    }
}

#[test]
fn lines_are_as_wide_as_asked_for() {
    let color = bars();
    let narrow = |value: f32| {
        let map = on_the_right(1, value);
        let out = styled("flow_dog", &[("tau", "0.99")], &[("color", &color), ("control", &map)]);
        // Width of the line beside the first bar, in the middle row.
        let line = |x: i32| 1.0 - out.pixel(x, SIZE[1] / 2)[0];
        [12, SIZE[0] / 2 + 12].map(|from| (from..from + 24).map(line).sum::<f32>())
    };
    let [left, wide] = narrow(1.0);
    let [_, thin] = narrow(0.0);
    assert!(wide > 2.0 * left, "{wide} {left}");
    assert!(thin < 0.9 * left && thin > 0.1 * left, "{thin} {left}");
}

#[test]
fn outlines_of_guides_follow_the_map_too() {
    let grey = picture(|_, _| [0.6, 0.6, 0.6, 1.0]);
    let mut ids = Image::new(SIZE[0] as u32, SIZE[1] as u32, 1).unwrap();
    for (at, id) in ids.data_mut().iter_mut().enumerate() {
        let x = at as i32 % SIZE[0] % (SIZE[0] / 2);
        *id = if x < 48 { 1.0 } else { 2.0 };
    }
    let drawn = |channel: usize, value: f32| {
        let map = on_the_right(channel, value);
        darkness(&styled("cartoon", &[], &[("color", &grey), ("object_id", &ids), ("control", &map)]))
    };
    let [left, same] = drawn(1, 0.5);
    assert!((left - same).abs() < 1e-3);
    assert!(drawn(1, 1.0)[1] > left + 0.02, "{:?}", drawn(1, 1.0));
    assert!(drawn(2, 0.0)[1] < left - 0.01, "{:?}", drawn(2, 0.0));
}

#[test]
fn detail_stays_where_it_is_asked_for() {
    let color = picture(|x, y| {
        let x = x % (SIZE[0] / 2);
        let grain = ((x * 7 + y * 13) % 11) as f32 / 11.0 - 0.5;
        let light = if (x / 5 + y / 5) % 2 == 0 { 0.52 } else { 0.6 };
        [light + 0.06 * grain, light + 0.05 * grain, light - 0.04 * grain, 1.0]
    });
    for style in ["cartoon", "watercolor", "painting", "coherent"] {
        let plain = [("line_amount", "0"), ("posterize", "0")];
        let even = [("clouds", "0"), ("granulation", "0"), ("backruns", "0"), ("dry_brush", "0")];
        let settings = match style {
            "cartoon" => &plain[..],
            "watercolor" => &even[..],
            _ => &[],
        };
        let map = on_the_right(0, 1.0);
        let [left, right] = structure(&styled(style, settings, &[("color", &color), ("control", &map)]));
        assert!(right > 1.1 * left, "{style}: {left} {right}");
    }
}

#[test]
fn media_are_as_strong_as_asked_for() {
    let color = bars();
    for style in ["ink", "watercolor"] {
        let drawn = |value: f32| {
            let map = on_the_right(3, value);
            darkness(&styled(style, &[], &[("color", &color), ("control", &map)]))
        };
        let ([left, more], [_, less]) = (drawn(1.0), drawn(0.0));
        assert!(more > left && less < left, "{style}: {less} {left} {more}");
    }
}

#[test]
fn lines_far_away_are_as_wide_as_asked_for() {
    let color = bars();
    let grey = picture(|_, _| [0.6, 0.6, 0.6, 1.0]);
    // Near on the left, far on the right, where there is a gap through which nothing is seen.
    let mut depth = Image::new(SIZE[0] as u32, SIZE[1] as u32, 1).unwrap();
    for (at, depth) in depth.data_mut().iter_mut().enumerate() {
        let x = at as i32 % SIZE[0];
        let gap = (40..56).contains(&(x % (SIZE[0] / 2)));
        *depth = if gap {
            0.0
        } else if x < SIZE[0] / 2 {
            1.0
        } else {
            50.0
        };
    }
    for picture in [&color, &grey] {
        let drawn = |width: &str| {
            let settings = [("far_width", width), ("outline_width", "1.5"), ("show", "lines")];
            mean(&styled("cartoon", &settings, &[("color", picture), ("depth", &depth)]), |pixel| pixel[3])
        };
        let ([left, same], [near, wide], [_, thin]) = (drawn("1"), drawn("2.5"), drawn("0.5"));
        assert!(
            (left - same).abs() < 0.1 * left && (near - left).abs() < 0.02 * left,
            "{left} {same} {near}"
        );
        assert!(wide > 1.3 * same && thin < 0.95 * same, "{thin} {same} {wide}");
    }
}
