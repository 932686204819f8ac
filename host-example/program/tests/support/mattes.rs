//! Pictures with a Cryptomatte, written by the `exr` crate, and the masks that the program finds in them.

use std::path::Path;

use exr::prelude::*;
use isophote_finishing::apply::masks::{MaskChoice, Masks};
use isophote_pictures::exr::{MaskSource, OnUnknown, Selection};
use isophote_pictures::read;

/// Pixels across and down.
pub const SIZE: (usize, usize) = (24, 16);
/// All of them.
pub const PIXELS: usize = SIZE.0 * SIZE.1;
/// Ids as the Python package mmh3 gives them.
pub const IDS: [(&str, u32); 6] = [
    ("bunny", 0x1385_1a76),
    ("hero", 0x82ce_30b4),
    ("props/barrel", 0x09c8_e8a6),
    ("props/box", 0xb981_b2fa),
    ("a,b*", 0x281d_d1f9),
    // Its hash is 0x005694cc, which would be denormal.
    ("thing119", 0x00d6_94cc),
];

/// The number that stands for a name.
pub fn id(name: &str) -> f32 {
    let known = IDS.iter().find(|(known, _)| *known == name).expect("a name with an id");
    f32::from_bits(known.1)
}

/// Things that cover a pixel, the most first.
pub fn ranks(x: usize, y: usize) -> Vec<(&'static str, f32)> {
    match (x, y) {
        (0..4, _) => vec![],
        (4..8, _) => vec![("bunny", 1.0)],
        (8, _) => vec![("bunny", 0.625), ("hero", 0.25), ("props/box", 0.125)],
        (9..14, 0..8) => vec![("hero", 1.0)],
        (9..14, _) => vec![("props/barrel", 1.0)],
        (14, _) => vec![("props/box", 0.5), ("props/barrel", 0.25), ("hero", 0.125), ("a,b*", 0.0625)],
        (15..20, _) => vec![("props/box", 1.0)],
        _ => vec![("a,b*", 0.75)],
    }
}

/// Share of a pixel that some things cover.
pub fn coverage(names: &[&str]) -> Vec<f32> {
    let of = |at: usize| {
        ranks(at % SIZE.0, at / SIZE.0).iter().filter(|(n, _)| names.contains(n)).map(|(_, c)| c).sum()
    };
    (0..PIXELS).map(of).collect()
}

/// The channels of two layers of ranks.
pub fn matte(name: &str, components: [&str; 4]) -> Vec<(String, FlatSamples)> {
    let mut channels = Vec::new();
    for rank in 0..4 {
        let pixel = |at: usize| ranks(at % SIZE.0, at / SIZE.0).get(rank).copied();
        let ids = (0..PIXELS).map(|at| pixel(at).map_or(0.0, |(name, _)| id(name)));
        let covers = (0..PIXELS).map(|at| pixel(at).map_or(0.0, |(_, coverage)| coverage));
        let name =
            |component: usize| format!("{name}{:02}.{}", rank / 2, components[2 * (rank % 2) + component]);
        channels.push((name(0), FlatSamples::F32(ids.collect())));
        channels.push((name(1), FlatSamples::F32(covers.collect())));
    }
    channels
}

/// A manifest of these names.
pub fn manifest(names: &[&str]) -> String {
    let entries: Vec<String> =
        names.iter().map(|n| format!("\"{}\":\"{:08x}\"", n.replace('/', "\\/"), id(n).to_bits())).collect();
    format!("{{{}}}", entries.join(","))
}

/// Red, green and blue.
pub fn colours() -> Vec<(String, FlatSamples)> {
    let plane = |step: usize| {
        let value = |i: usize| {
            f16::from_f32(((i * step) % 23) as f32 / 16.0 + if i % SIZE.0 > 12 { 0.5 } else { 0.0 })
        };
        FlatSamples::F16((0..PIXELS).map(value).collect())
    };
    ["R", "G", "B"].iter().zip([3, 5, 7]).map(|(name, step)| ((*name).to_owned(), plane(step))).collect()
}

/// The attributes of a Cryptomatte.
pub fn attributes(key: &str, name: &str, manifest: (&str, &str)) -> Vec<(String, String)> {
    let attribute = |field: &str, value: &str| (format!("cryptomatte/{key}/{field}"), value.to_owned());
    vec![
        attribute("name", name),
        attribute("hash", "MurmurHash3_32"),
        attribute("conversion", "uint32_to_float32"),
        attribute(manifest.0, manifest.1),
    ]
}

/// Name, channels and texts of a part.
pub type Part<'a> = (&'a str, Vec<(String, FlatSamples)>, Vec<(String, String)>);

/// Writes a file of these parts.
pub fn save(path: &Path, parts: Vec<Part<'_>>) {
    let layers = parts.into_iter().map(|(name, channels, texts)| {
        let mut attributes =
            LayerAttributes { layer_name: (!name.is_empty()).then(|| name.into()), ..Default::default() };
        for (name, value) in texts {
            let value = AttributeValue::Text(Text::new_or_none(&value).expect("a text"));
            attributes.other.insert(name.as_str().into(), value);
        }
        let channels = channels.into_iter().map(|(n, s)| AnyChannel::new(n.as_str(), s)).collect();
        Layer::new(SIZE, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels))
    });
    let attributes = ImageAttributes::new(IntegerBounds::from_dimensions(SIZE));
    let image: FlatImage = Image { attributes, layer_data: layers.collect() };
    image.write().to_file(path).expect("the picture can be written");
}

/// A picture with a Cryptomatte of objects whose manifest does not list the bunny.
pub fn save_usual(path: &Path) {
    let listed = manifest(&["hero", "props/barrel", "props/box", "a,b*"]);
    let channels = [colours(), matte("crypto_object", ["R", "G", "B", "A"])].concat();
    save(path, vec![("", channels, attributes("f834d0a", "crypto_object", ("manifest", &listed)))]);
}

/// The mask that a picture's file holds, before it is applied.
pub fn mask_of(path: &Path, text: &str, invert: bool) -> std::result::Result<Vec<f32>, String> {
    let source: MaskSource = text.parse()?;
    let masks = Masks::new(&[MaskChoice { source: source.clone(), invert }], None, OnUnknown::Fail)
        .map_err(|e| e.to_string())?;
    let selection = Selection { masks: vec![source], ..Selection::default() };
    let mut source = read::read(path, &selection).map_err(|e| e.to_string())?;
    masks.add(&mut source, None).and_then(|()| source.check()).map_err(|e| e.to_string())?;
    Ok(source.pictures[0].masks[0].as_ref().expect("a mask").to_f32())
}

/// Red, green and blue of the main layer.
pub fn rgb(path: &Path) -> Vec<[f32; 3]> {
    let image = read_first_flat_layer_from_file(path).expect("an EXR file");
    let plane = |name: &str| -> Vec<f32> {
        let channel = image.layer_data.channel_data.list.iter().find(|c| c.name.to_string() == name);
        channel.expect("a channel").sample_data.values_as_f32().collect()
    };
    let planes = ["R", "G", "B"].map(plane);
    (0..planes[0].len()).map(|at| [planes[0][at], planes[1][at], planes[2][at]]).collect()
}
