//! Cryptomattes: what `--mask cryptomatte:NAMES` covers, where names are listed, and the numbers of objects.

use std::fs;

use exr::prelude::*;
use isophote_pictures::exr::{Guide, Selection};
use isophote_pictures::read;

use crate::support::mattes::*;
use crate::support::{fails, folder, isophote};

#[test]
fn cryptomattes_cover_what_they_name() {
    let folder = folder();
    let at = folder.path().join("in.exr");
    save_usual(&at);
    let mask = |text: &str| mask_of(&at, text, false).unwrap_or_else(|e| panic!("{text}: {e}"));
    for (text, names) in [
        ("cryptomatte:hero", &["hero"][..]),
        ("cryptomatte:hero,props/*", &["hero", "props/barrel", "props/box"]),
        ("cryptomatte: props/b?x , hero", &["hero", "props/box"]),
        ("cryptomatte:hero,hero,he*", &["hero"]),
        (r"cryptomatte:a\,b\*", &["a,b*"]),
        ("cryptomatte:*", &["hero", "props/barrel", "props/box", "a,b*"]),
        // Not listed, but there.
        ("cryptomatte:bunny", &["bunny"]),
        ("cryptomatte[crypto_object]:bunny,hero", &["bunny", "hero"]),
    ] {
        assert_eq!(mask(text), coverage(names), "{text}");
    }
    let inverted = mask_of(&at, "cryptomatte:hero", true).expect("a mask");
    assert_eq!(inverted, coverage(&["hero"]).iter().map(|c| 1.0 - c).collect::<Vec<_>>());
    for (text, words) in [
        ("cryptomatte:heroo", &["no 'heroo'", "'crypto_object'", "did you mean hero?"][..]),
        ("cryptomatte:props/c*", &["no 'props/c*'", "props/box"]),
        ("cryptomatte:unheard-of", &["choose from", "a,b*, hero"]),
        (
            "cryptomatte[crypto_material]:a",
            &["no Cryptomatte 'crypto_material'", "cryptomatte[crypto_object]"],
        ),
    ] {
        let error = mask_of(&at, text, false).expect_err(text);
        assert!(words.iter().all(|word| error.contains(word)), "{text}: {error}");
    }
}

#[test]
fn manifests_beside_pictures_are_read() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("m")).expect("a folder");
    fs::write(at("m/names.json"), manifest(&["hero", "props/box", "props/barrel"]))
        .expect("the folder is writable");
    let save_with = |file: &str| {
        let channels = [colours(), matte("crypto_object", ["R", "G", "B", "A"])].concat();
        let texts = attributes("f834d0a", "crypto_object", ("manif_file", file));
        save(&at("in.exr"), vec![("", channels, texts)]);
    };
    save_with("m/names.json");
    let mask = |text: &str| mask_of(&at("in.exr"), text, false);
    assert_eq!(mask("cryptomatte:props/*"), Ok(coverage(&["props/barrel", "props/box"])));
    // No file is needed for whole names, and none is read from elsewhere.
    for (file, words) in [
        ("gone.json", &["gone.json", "cannot be read"][..]),
        ("../names.json", &["../names.json", "not below"]),
        ("/etc/hostname", &["not below"]),
        (r"m\\names.json", &["not below"]),
    ] {
        save_with(file);
        assert_eq!(mask("cryptomatte:hero"), Ok(coverage(&["hero"])), "{file}");
        let error = mask("cryptomatte:props/*").expect_err(file);
        assert!(error.contains("no 'props/*'") && words.iter().all(|w| error.contains(w)), "{error}");
    }
    fs::write(at("m/names.json"), "{\"hero\": 7}").expect("the folder is writable");
    save_with("m/names.json");
    assert!(mask("cryptomatte:h*").is_err_and(|e| e.contains("is no JSON of names")));
}

#[test]
fn one_of_several_cryptomattes_is_chosen() {
    let folder = folder();
    let at = folder.path().join("in.exr");
    let listed = manifest(&["hero", "thing119"]);
    let material = |name: &str| -> Vec<(String, FlatSamples)> {
        let plane = |value: f32| FlatSamples::F32(vec![value; PIXELS]);
        vec![(format!("{name}00.red"), plane(id("thing119"))), (format!("{name}00.green"), plane(0.5))]
    };
    let mut texts = attributes("f834d0a", "Layer.CryptoObject", ("manifest", &listed));
    texts.extend(attributes("bda530a", "uMaterials", ("manifest", &listed)));
    let objects = matte("Layer.CryptoObject", ["r", "g", "b", "a"]);
    save(&at, vec![("", [colours(), objects, material("uMaterials")].concat(), texts.clone())]);
    let mask = |text: &str| mask_of(&at, text, false);
    assert_eq!(mask("cryptomatte:hero"), Ok(coverage(&["hero"])));
    assert_eq!(mask("cryptomatte[cryptoobject]:hero"), Ok(coverage(&["hero"])));
    assert_eq!(mask("cryptomatte[uMaterials]:thing119"), Ok(vec![0.5; PIXELS]));
    let error = mask("cryptomatte:ghost").expect_err("is nowhere");
    assert!(error.contains("'Layer.CryptoObject'"), "{error}");

    // Parts of their own, each of which names all.
    let (first, second): (Vec<_>, Vec<_>) =
        matte("crypto_object", ["R", "G", "B", "A"]).into_iter().partition(|(name, _)| name.contains("00."));
    let bare = |channels: Vec<(String, FlatSamples)>| -> Vec<(String, FlatSamples)> {
        let component = |name: &str| name.rsplit('.').next().unwrap_or_default().to_owned();
        channels.into_iter().map(|(name, samples)| (component(&name), samples)).collect()
    };
    let texts = attributes("f834d0a", "crypto_object", ("manifest", &listed));
    save(
        &at,
        vec![
            ("beauty", colours(), texts.clone()),
            ("crypto_object01", bare(second), texts.clone()),
            ("crypto_object00", bare(first), texts),
        ],
    );
    assert_eq!(mask("cryptomatte:hero"), Ok(coverage(&["hero"])));

    let two = [attributes("1", "a", ("manifest", "{}")), attributes("2", "b", ("manifest", "{}"))].concat();
    save(&at, vec![("", colours(), two)]);
    assert!(mask("cryptomatte:hero").is_err_and(|e| e.contains("cryptomatte[a] or cryptomatte[b]")));
    assert!(mask("cryptomatte[a]:hero").is_err_and(|e| e.contains("no layer 'a00'")));
    save(&at, vec![("", colours(), vec![])]);
    assert!(mask("cryptomatte:hero").is_err_and(|e| e.contains("no Cryptomatte")));
    let halves = |name: &str| (name.to_owned(), FlatSamples::F16(vec![f16::ONE; PIXELS]));
    let short = [colours(), vec![halves("c00.R"), halves("c00.G")]].concat();
    save(&at, vec![("", short, attributes("1", "c", ("manifest", "{}")))]);
    assert!(mask("cryptomatte:hero").is_err_and(|e| e.contains("not 32 bits")));
}

#[test]
fn cryptomattes_number_objects() {
    let folder = folder();
    let at = folder.path().join("in.exr");
    save_usual(&at);
    let guide = |choice: Option<&str>| {
        let guides = choice.map(|text| text.parse().expect("a guide")).into_iter().collect();
        let selection = Selection { wanted: vec![Guide::ObjectId], guides, ..Selection::default() };
        let source = read::read(&at, &selection).expect("a picture");
        source.pictures[0].guides.first().map(|(name, pixels)| (*name, pixels.to_f32()))
    };
    let (name, ids) = guide(None).expect("ids");
    assert_eq!(name, "object_id");
    let front = |at: usize| ranks(at % SIZE.0, at / SIZE.0).first().map_or("", |(name, _)| name);
    for (a, id) in ids.iter().enumerate() {
        assert_eq!(*id == 0.0, front(a).is_empty(), "{a}");
        assert!(id.fract() == 0.0 && *id < 16_777_216.0);
        for (b, other) in ids.iter().enumerate().step_by(5) {
            assert_eq!(id == other, front(a) == front(b), "{a} {b}");
        }
    }
    assert_eq!(guide(Some("object_id=cryptomatte")), Some((name, ids)));
    assert_eq!(guide(Some("object_id=none")), None);
    // A layer of ids comes first.
    let plain = vec![("id".to_owned(), FlatSamples::U32(vec![7; PIXELS]))];
    let channels = [colours(), plain, matte("crypto_object", ["R", "G", "B", "A"])].concat();
    save(&at, vec![("", channels, attributes("f834d0a", "crypto_object", ("manifest", "{}")))]);
    assert_eq!(guide(None), Some((name, vec![7.0; PIXELS])));
    let refused = ["apply", "cartoon", "in.exr", "no.exr", "--guide", "object_id=cryptomatte[skin]"];
    fails(
        isophote().current_dir(folder.path()).args(refused),
        2,
        &["no Cryptomatte 'skin'", "crypto_object"],
    );
}
