//! Pictures in the colours of a palette and no others (§ 4.6 quantizes lightness alone), with ordered dither where it is
//! asked for.

mod patterns;

use self::patterns::{BAYER, Dither};
use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, STEADINESS, Scope, WINDOW};
use crate::declare::value::Value;
use crate::kernels::colour::palette_colours::{self, Options};
use crate::kernels::colour::rgb_to_lab;
use crate::stages::LOOK;
use crate::stages::abstraction::{self, Abstraction};
use crate::stages::palette::{COMIC, Colours, FIT, Palette, rgb};
use crate::stages::steady::{Agreement, COLOUR_AGREEMENT, steadied};
use crate::stages::tensor_options::TensorOptions;
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "palette",
    label: "Palette",
    group: "colour",
    hint: "Draws the picture in the colours of a palette and no others, with or without dither.",
    doc: "Pictures in the exact colours of a palette. The picture is smoothed by the bilateral filter along the local structure, \
          so that photographs give areas, and each pixel takes the colour that is nearest in CIELAB (D65). With dither it \
          takes that or a second colour: of the lines from the nearest colour to the others, the one that leads \
          nearest to what is wanted says which, and the share of the way, against a threshold that belongs to the \
          place, says where. Shares are those of CIELAB, so that means of lightness and colour are kept, not of \
          light. Colours are copied, gamma-encoded, and never computed: a `mix` of 1 without a mask gives no others. Alpha stays.",
    section: "4.6",
    inputs: &[ports::COLOR],
    output: ports::color_output("The picture in colours of the palette."),
    own_params: &[
        Param::choice("palette", "Palette", Palette::Comic.selected())
            .uniform()
            .group(LOOK)
            .hint("The colours that the picture is drawn in: a set that ships, or your own.")
            .doc("One's own has up to sixteen colours; sets of more are among those that ship."),
        Param::int("count", "Number of colours", 8, [2, OWN as i32])
            .group(LOOK)
            .hint("How many of your own colours are used, from the first on. No effect on palettes that ship."),
        COLORS[0],
        COLORS[1],
        COLORS[2],
        COLORS[3],
        COLORS[4],
        COLORS[5],
        COLORS[6],
        COLORS[7],
        COLORS[8],
        COLORS[9],
        COLORS[10],
        COLORS[11],
        COLORS[12],
        COLORS[13],
        COLORS[14],
        COLORS[15],
        Param::float("fit", "Fit tones", FIT, [0.0, 1.0])
            .group(LOOK)
            .hint("Brings black and white to the darkest and lightest colour of the palette: 0 leaves tones as they are.")
            .doc("Share of the way from lightness 0..100 to that of the palette."),
        Param::choice("dither", "Dither", Dither::None.selected())
            .uniform()
            .group(LOOK)
            .hint("How tones between two colours are drawn: as flat areas, in a woven pattern, or as even grain.")
            .doc(
                "Bayer's matrix of 8 x 8 (1973), or blue noise of 32 x 32 by void and cluster (Ulichney 1993). The pattern stays \
                 on the screen.",
            ),
        Param::length("dither_size", "Dither size", 2.0, [1.0, 64.0])
            .slider(1.0, 12.0)
            .group(LOOK)
            .hint("Size of the dots of the dither.")
            .doc("A pixel of what is rendered at least."),
        Param::float("spread", "Dither amount", 1.0, [0.0, 1.0])
            .group(LOOK)
            .hint("How far dither reaches from where two colours meet: 1 mixes all tones, 0 leaves hard borders.")
            .doc("Factor on the thresholds about their middle."),
        SMOOTHING,
        abstraction::ABSTRACTION,
        abstraction::N_A.with_default(Value::Int(2)),
        abstraction::SIGMA_D,
        abstraction::SIGMA_R,
        STEADINESS,
        WINDOW,
    ],
    build,
};

/// Most colours of one's own.
const OWN: usize = COMIC.len();

const SMOOTHING: Param = Param::float("smoothing", "Smoothing", 0.5, [0.0, 1.0])
    .structural()
    .group(LOOK)
    .hint("How much the picture is smoothed before, so that areas are clean: 0 leaves all of its grain.")
    .doc("1 less the `detail` of other styles; 0 smooths nothing, at no cost.");

/// Ids and labels of one's own colours.
const NAMES: [[&str; 2]; OWN] = [
    ["color_1", "Colour 1"],
    ["color_2", "Colour 2"],
    ["color_3", "Colour 3"],
    ["color_4", "Colour 4"],
    ["color_5", "Colour 5"],
    ["color_6", "Colour 6"],
    ["color_7", "Colour 7"],
    ["color_8", "Colour 8"],
    ["color_9", "Colour 9"],
    ["color_10", "Colour 10"],
    ["color_11", "Colour 11"],
    ["color_12", "Colour 12"],
    ["color_13", "Colour 13"],
    ["color_14", "Colour 14"],
    ["color_15", "Colour 15"],
    ["color_16", "Colour 16"],
];

const COLORS: [Param; OWN] = [
    color(0),
    color(1),
    color(2),
    color(3),
    color(4),
    color(5),
    color(6),
    color(7),
    color(8),
    color(9),
    color(10),
    color(11),
    color(12),
    color(13),
    color(14),
    color(15),
];

const fn color(at: usize) -> Param {
    let [id, label] = NAMES[at];
    let [r, g, b] = rgb(COMIC[at]);
    Param::color(id, label, [r, g, b, 1.0])
        .group(LOOK)
        .hint("A colour of your own palette. No effect with another palette, or with fewer colours.")
        .doc("Its opacity is not used.")
}

fn build(scope: &mut Scope<'_>) -> ImageId {
    let [smooth] = steadied(scope, Agreement::lab(COLOUR_AGREEMENT), |scope| [smoothed(scope)]);
    let colours = colours(scope);
    let pattern = scope.option::<Dither>("dither").pattern();
    let options = Options {
        colours: colours.all(),
        fit: scope.float("fit"),
        spread: if pattern.is_some() { scope.float("spread") } else { 0.0 },
        pattern: pattern.unwrap_or(&BAYER),
        cell: scope.float("dither_size"),
        origin: scope.origin(),
    };
    palette_colours::pass(scope.plan, smooth, &options)
}

/// The picture in CIELAB, without small differences.
fn smoothed(scope: &mut Scope<'_>) -> ImageId {
    let smoothing = scope.float(SMOOTHING.id);
    if smoothing > 0.0 && scope.int(abstraction::N_A.id) > 0 {
        let options = TensorOptions::at_scale(scope.scale());
        let filter = Abstraction::with_detail(scope, 1.0 - smoothing);
        return abstraction::regions_by(scope, &options, &filter)[0];
    }
    let color = scope.required("color");
    rgb_to_lab::pass(scope.plan, color, 1.0)
}

/// The colours of the palette that is chosen.
fn colours(scope: &Scope<'_>) -> Colours {
    if let Some(shipped) = scope.option::<Palette>("palette").colours() {
        return Colours::of_numbers(shipped);
    }
    let own = COLORS.iter().map(|param| {
        let [r, g, b, _] = scope.color(param.id);
        [r, g, b]
    });
    Colours::new(own.take(scope.int("count") as usize))
}
