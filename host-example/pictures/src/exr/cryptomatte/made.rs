//! Cryptomattes of rendered pictures: how much of each pixel the things in it cover, from several samples of it.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::floats::Picture;
use isophote_cryptomatte::id;

/// Things of a pixel that are kept.
const RANKS: usize = 4;
/// Channels of a layer: an id and its coverage, twice.
const CHANNELS: usize = 4;

/// A Cryptomatte as files hold it.
#[derive(Clone, Debug, PartialEq)]
pub struct Made {
    /// Name of its layers, but for their numbers.
    pub name: String,
    /// Layers from the first, of four channels each: the id of what covers the most of the pixel, its share of it, and the
    /// same of what comes next.
    pub layers: Vec<Picture>,
    /// Attributes of the header that name it and list its things.
    pub texts: Vec<(String, String)>,
}

impl Made {
    /// The Cryptomatte `name` of a picture of `size` pixels. Each of `samples` has the number of a thing, from 1, for each
    /// pixel, or 0; the thing has the name at that place of `things`. Things of one name are one.
    pub fn new(name: &str, size: (u32, u32), samples: &[Vec<u32>], things: &[String]) -> Self {
        let ids: Vec<u32> = things.iter().map(|thing| id(thing)).collect();
        let share = 1.0 / samples.len().max(1) as f32;
        let pixels = size.0 as usize * size.1 as usize;
        let empty =
            Picture { width: size.0, height: size.1, channels: CHANNELS, data: vec![0.0; CHANNELS * pixels] };
        let mut layers = vec![empty; 2 * RANKS / CHANNELS];
        let mut covered: Vec<(u32, u32)> = Vec::with_capacity(samples.len());
        for pixel in 0..pixels {
            count(samples, pixel, &ids, &mut covered);
            for (rank, (id, count)) in covered.iter().take(RANKS).enumerate() {
                let at = CHANNELS * pixel + 2 * rank % CHANNELS;
                let value = &mut layers[2 * rank / CHANNELS].data[at..at + 2];
                value.copy_from_slice(&[f32::from_bits(*id), *count as f32 * share]);
            }
        }
        Self { name: name.to_owned(), layers, texts: texts(name, things) }
    }
}

/// The ids in a pixel with how many samples each has, the most first.
fn count(samples: &[Vec<u32>], pixel: usize, ids: &[u32], covered: &mut Vec<(u32, u32)>) {
    covered.clear();
    for sample in samples {
        let number = sample.get(pixel).copied().unwrap_or_default() as usize;
        let Some(id) = number.checked_sub(1).and_then(|index| ids.get(index)) else { continue };
        match covered.iter_mut().find(|(known, _)| known == id) {
            Some((_, count)) => *count += 1,
            None => covered.push((*id, 1)),
        }
    }
    covered.sort_unstable_by_key(|(id, count)| (u32::MAX - count, *id));
}

/// Attributes of the header.
fn texts(name: &str, things: &[String]) -> Vec<(String, String)> {
    let key = format!("{:08x}", id(name));
    let entries: BTreeMap<&str, u32> = things.iter().map(|thing| (thing.as_str(), id(thing))).collect();
    let entries: Vec<String> =
        entries.into_iter().map(|(thing, id)| format!("{}:\"{id:08x}\"", quoted(thing))).collect();
    let values = [
        ("name", name.to_owned()),
        ("hash", "MurmurHash3_32".to_owned()),
        ("conversion", "uint32_to_float32".to_owned()),
        ("manifest", format!("{{{}}}", entries.join(","))),
    ];
    values.into_iter().map(|(field, value)| (format!("cryptomatte/{}/{field}", &key[..7]), value)).collect()
}

/// A text as JSON of ASCII alone, since headers have no other letters.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for letter in text.chars() {
        match letter {
            '"' | '\\' => quoted.extend(['\\', letter]),
            ' '..='~' => quoted.push(letter),
            // Writing to a text does not fail.
            _ => letter.encode_utf16(&mut [0; 2]).iter().for_each(|unit| {
                let _ = write!(quoted, "\\u{unit:04x}");
            }),
        }
    }
    quoted + "\""
}

#[cfg(test)]
mod tests {
    use super::super::Manifest;
    use super::*;

    fn made(samples: &[Vec<u32>], things: &[&str]) -> Made {
        let things: Vec<String> = things.iter().map(|thing| (*thing).to_owned()).collect();
        Made::new("crypto_object", (2, 1), samples, &things)
    }

    #[test]
    fn things_are_ranked_by_what_they_cover() {
        let things = ["a", "b", "c", "d", "e"];
        let samples = [1, 2, 2, 3, 3, 3, 0, 4, 4, 5].map(|number| vec![number, 1]);
        let Made { layers, .. } = made(&samples, &things);
        let rank = |layer: usize, pixel: usize, at: usize| {
            let value = &layers[layer].data[4 * pixel + 2 * at..];
            (value[0].to_bits(), (10.0 * value[1]).round() as u32)
        };
        assert_eq!(rank(0, 0, 0), (id("c"), 3));
        let mut second = [rank(0, 0, 1), rank(1, 0, 0)];
        second.sort_unstable();
        let mut expected = [(id("b"), 2), (id("d"), 2)];
        expected.sort_unstable();
        assert_eq!(second, expected);
        // Of more things than ranks the least are left out, and the order of samples does not count.
        assert!([(id("a"), 1), (id("e"), 1)].contains(&rank(1, 0, 1)));
        let turned: Vec<Vec<u32>> = samples.iter().rev().cloned().collect();
        assert_eq!(made(&turned, &things).layers, layers);
        assert_eq!((rank(0, 1, 0), rank(0, 1, 1)), ((id("a"), 10), (0, 0)));
    }

    #[test]
    fn things_of_one_name_are_one_and_numbers_without_a_thing_are_none() {
        let Made { layers, texts, .. } = made(&[vec![1, 9], vec![2, 9]], &["leaf", "leaf"]);
        assert_eq!(layers[0].data, [f32::from_bits(id("leaf")), 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(texts[3].1, format!("{{\"leaf\":\"{:08x}\"}}", id("leaf")));
    }

    #[test]
    fn headers_name_any_things() {
        let names = ["равнина", "a \"b\" \\c", "tab\tand 🜂", ""];
        let Made { texts, .. } = made(&[vec![0, 0]], &names);
        assert!(texts.iter().all(|(name, value)| name.is_ascii() && value.is_ascii()));
        assert_eq!(texts[0], ("cryptomatte/f834d0a/name".to_owned(), "crypto_object".to_owned()));
        let manifest = Manifest::parse(&texts[3].1).unwrap();
        assert!(names.iter().all(|name| manifest.id(name) == Some(id(name))), "{texts:?}");
    }
}
