//! Files of kinds that other programs write, in `tests/data/cases`; each folder has a note of what is right.

use std::fs;
use std::path::{Path, PathBuf};

use isophote_files::files::Existing;
use isophote_files::frames::Pattern;
use isophote_pictures::convert::Conversion;
use isophote_pictures::exr::{Guide, GuideChoice, Selection};
use isophote_pictures::meaning::Meaning;
use isophote_pictures::pixels::{Pixels, Precision};
use isophote_pictures::primaries;
use isophote_pictures::read::{self, Source};
use isophote_pictures::transfer::Transfer;
use isophote_pictures::write::{self, Format, Options};

fn case(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/cases").join(name)
}

fn source(path: &Path) -> Source {
    read::read(path, &Selection::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// The only picture of a file as floats.
fn numbers(name: &str) -> Vec<f32> {
    source(&case(name)).pictures[0].pixels.to_f32()
}

/// A guide of a file, found by its name or as `--guide` says.
fn guide(path: &Path, guide: Guide, choice: Option<&str>) -> Result<Option<Pixels>, String> {
    let guides = choice.map(|text| text.parse::<GuideChoice>().expect("a choice")).into_iter().collect();
    let selection = Selection { wanted: vec![guide], guides, ..Selection::default() };
    let source = read::read(path, &selection).map_err(|error| error.to_string())?;
    let found = source.pictures.into_iter().next().expect("a picture").guides.into_iter();
    Ok(found.map(|(_, pixels)| pixels).next())
}

/// An EXR file of floats with these channels, each of one number.
fn exr_file(folder: &Path, channels: &[(&str, f32)]) -> PathBuf {
    use isophote_exr_edit::{Plane, create};
    let plane = |value: f32| Plane::Float(vec![value; 4 * 2]);
    let channels = channels.iter().map(|(name, value)| ((*name).to_owned(), plane(*value))).collect();
    let mut bytes = std::io::Cursor::new(Vec::new());
    let picture = create::Picture { width: 4, height: 2, channels, ..create::Picture::default() };
    create::write(&picture, &mut bytes).expect("the file can be made");
    let path = folder.join("in.exr");
    fs::write(&path, bytes.into_inner()).expect("the folder is writable");
    path
}

#[test]
fn files_with_signs_of_patterns_in_their_names_are_read() {
    for name in ["photo #1.png", "a@b.png", "50%d.png"] {
        let path = case("file_names").join(name);
        assert_eq!(Pattern::new(&path).expect("a name"), None, "{name}");
        assert_eq!(source(&path).pictures.len(), 1);
    }
}

#[test]
fn one_sign_finds_frames_of_four_digits() {
    for name in ["shot.#.exr", "shot.@.exr", "shot.%d.exr", "shot.$F4.exr", "shot.####.exr"] {
        let pattern = Pattern::new(&case("frames_hash").join(name)).expect("a name").expect("a pattern");
        assert_eq!(pattern.on_disk().expect("frames"), [1, 2, 10], "{name}");
    }
}

#[test]
fn normals_are_found_by_the_names_of_renderers() {
    let mut first = None;
    for name in ["g_N_corona", "g_N_octane", "g_N_pbrts", "g_N_red"] {
        let path = case("exr_guide_names").join(format!("{name}.exr"));
        let found = guide(&path, Guide::Normal, None).expect("a picture").unwrap_or_else(|| panic!("{name}"));
        // All four hold the same normals.
        let numbers = found.to_f32();
        assert!(numbers.iter().any(|v| *v != 0.0));
        assert_eq!(*first.get_or_insert_with(|| numbers.clone()), numbers, "{name}");
    }
    let pbrt = case("exr_guide_names").join("g_N_pbrts.exr");
    for choice in ["normal=Nsx,Nsy,Nsz", "normal=Nsx, Nsy, Nsz", "normal=Ns"] {
        let named = guide(&pbrt, Guide::Normal, Some(choice)).expect("a picture").expect("normals");
        assert_eq!(first.as_ref(), Some(&named.to_f32()), "{choice}");
    }
    for choice in ["normal=Nsx", "normal=Nsx,Nsy", "normal=Nsx,Nsy,none"] {
        let refused = guide(&pbrt, Guide::Normal, Some(choice)).unwrap_err();
        assert!(refused.contains("could be the normal"), "{choice}: {refused}");
    }
}

#[test]
fn guides_are_found_by_the_names_of_renderers() {
    let blender = case("exr_guide_names").join("g_Z_blenderidx.exr");
    assert!(guide(&blender, Guide::ObjectId, None).expect("a picture").is_some());
    let folder = tempfile::tempdir().expect("a folder");
    let colors = [("R", 0.1), ("G", 0.2), ("B", 0.3)];
    for (kind, names) in [
        (
            Guide::ObjectId,
            &["ViewLayer.Object Index.X", "VRayObjectID.R", "ObjectID", "CMasking_ID.Y", "primid"][..],
        ),
        (Guide::Depth, &["VRayZDepth.R", "CGeometry_ZDepth.Y", "Z depth.R", "hitPz", "ViewLayer.Depth.V"]),
    ] {
        for name in names {
            let path = exr_file(folder.path(), &[&colors[..], &[(name, 7.0)]].concat());
            let found = guide(&path, kind, None).expect("a picture").unwrap_or_else(|| panic!("{name}"));
            assert_eq!(found.to_f32(), [7.0; 8], "{name}");
            // What guides is no picture.
            let only = exr_file(folder.path(), &[(name, 7.0)]);
            let is_picture = read::read(&only, &Selection::default()).is_ok();
            assert!(!is_picture || !name.contains('.'), "{name}");
        }
    }
    // Normals of shading go before those of the geometry.
    let all =
        ["R", "G", "B"].map(|c| [(format!("Ng.{c}"), 1.0), (format!("ShadingNormal.{c}"), 0.5)]).concat();
    let all: Vec<(&str, f32)> = all.iter().map(|(name, value)| (name.as_str(), *value)).collect();
    let path = exr_file(folder.path(), &[&colors[..], &all].concat());
    let found = guide(&path, Guide::Normal, None).expect("a picture").expect("normals");
    assert_eq!(found.to_f32()[..4], [0.5, 0.5, 0.5, 1.0]);
}

#[test]
fn layers_of_nuke_are_pictures() {
    let folder = tempfile::tempdir().expect("a folder");
    let channels = [("fx.red", 0.5), ("fx.green", 0.25), ("fx.blue", 0.125), ("fx.alpha", 1.0)];
    let path = exr_file(folder.path(), &channels);
    assert_eq!(source(&path).pictures[0].pixels.to_f32()[..4], [0.5, 0.25, 0.125, 1.0]);
}

#[test]
fn dwa_is_read_and_written_without_loss() {
    let [a, b] = ["s_dwaa", "s_dwab"].map(|name| case("exr_dwa").join(format!("{name}.exr")));
    let (first, second) = (source(&a), source(&b));
    let [first, second] = [&first, &second].map(|source| source.pictures[0].pixels.to_f32());
    assert!(first.iter().zip(&second).all(|(a, b)| (a - b).abs() < 0.05 * (1.0 + a.abs())));
    let folder = tempfile::tempdir().expect("a folder");
    for (path, numbers) in [(&a, first), (&b, second)] {
        let mut source = source(path);
        let out = folder.path().join(path.file_name().expect("a name"));
        let (exr, pixels) = (source.exr.take(), source.pictures[0].pixels.clone());
        write::write(
            &out,
            Existing::Keep,
            (Format::Exr, Options::default()),
            vec![pixels],
            &Meaning::light(),
            &source,
            exr,
        )
        .expect("it can be written");
        assert_eq!(self::source(&out).pictures[0].pixels.to_f32(), numbers);
    }
}

#[test]
fn compressions_that_are_not_read_are_named() {
    for name in ["HTJ2K256", "LJ2K", "ZSTD"] {
        let path = case("exr_new_compressions").join(format!("env_{name}_COMPRESSION.exr"));
        let error = read::read(&path, &Selection::default()).unwrap_err().to_string();
        let is_named = error.contains(&format!("is compressed by {name}, which is not read"));
        assert!(is_named && !error.contains("damaged") && !error.contains("without loss"), "{error}");
    }
}

#[test]
fn hdr_files_of_other_programs_are_read() {
    let flat = numbers("hdr_magic/flat.hdr");
    assert_eq!(numbers("hdr_magic/rgbe_magic.hdr"), flat);
    // The same numbers are light of Rec.2020 there, whose greens lie far outside of Rec.709.
    let converted = numbers("hdr_magic/prims.hdr");
    let known = [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]];
    for (pixel, light) in flat.as_chunks::<3>().0.iter().zip(converted.as_chunks::<3>().0) {
        for (row, found) in known.iter().zip(light) {
            let right: f32 = row.iter().zip(pixel).map(|(weight, value)| weight * value).sum();
            assert!((right - found).abs() < 1e-3 * (1.0 + pixel[0] + pixel[1] + pixel[2]), "{right} {found}");
        }
    }
}

#[test]
fn tiff_files_of_32_bit_integers_look_as_those_of_8() {
    let (wide, narrow) = (numbers("tiff_u32/u32.tif"), numbers("tiff_u32/u8.tif"));
    assert_eq!(wide.len(), narrow.len());
    assert!(wide.iter().zip(&narrow).all(|(a, b)| (a - b).abs() < 0.5 / 255.0));
    // The same where the samples are said to be integers.
    let mut bytes = fs::read(case("tiff_u32/u32.tif")).expect("the case");
    let entry = bytes.windows(4).position(|b| *b == [0x0e, 1, 2, 0]).expect("a description, which gives way");
    bytes[entry..entry + 12].copy_from_slice(&[0x53, 1, 3, 0, 1, 0, 0, 0, 1, 0, 0, 0]);
    // Entries are sorted by their tags.
    let count = u16::from_le_bytes([bytes[8], bytes[9]]) as usize;
    let start = bytes[4] as usize + 2;
    let count =
        if start == 10 { count } else { u16::from_le_bytes([bytes[start - 2], bytes[start - 1]]) as usize };
    let mut entries: Vec<[u8; 12]> = bytes[start..start + 12 * count].as_chunks::<12>().0.to_vec();
    entries.sort_by_key(|entry| u16::from_le_bytes([entry[0], entry[1]]));
    bytes[start..start + 12 * count].copy_from_slice(&entries.concat());
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("said.tif");
    fs::write(&path, bytes).expect("the folder is writable");
    assert_eq!(source(&path).pictures[0].pixels.to_f32(), wide);
}

#[test]
fn colour_spaces_by_name_are_those_of_their_chromaticities() {
    let primaries = |name: &str| source(&case("exr_color_interop").join(name)).pictures[0].meaning.primaries;
    for (named, written) in [("c_2020id.exr", "c_2020chr.exr"), ("c_ap1id.exr", "c_ap1chr.exr")] {
        let (named, written) = (primaries(named), primaries(written));
        assert!(primaries::same(named, written), "{named:?}");
    }
    assert_eq!(primaries("cs_Linear_Rec2020.exr"), primaries::REC2020);
    assert_eq!(primaries("c_p3id.exr"), primaries::P3);
    for name in ["c_plain.exr", "c_data.exr"] {
        assert_eq!(primaries(name), primaries::REC709, "{name}");
    }
}

#[test]
fn profiles_are_kept_where_they_fit() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, format, is_kept) in [
        ("p3.png", Format::Jpeg, true),
        ("p3.jpg", Format::Png, true),
        ("p3.tif", Format::Png, true),
        ("p3.tif", Format::Tiff, true),
        ("cmyk_icc.jpg", Format::Png, false),
        ("cmyk_icc.tif", Format::Tiff, false),
    ] {
        let source = source(&case("icc_profiles").join(name));
        let out = folder.path().join(format!("{name}.out"));
        let pixels = source.pictures[0].pixels.clone();
        write::write(
            &out,
            Existing::Replace,
            (format, Options::default()),
            vec![pixels],
            &source.pictures[0].meaning,
            &source,
            None,
        )
        .expect("it can be written");
        assert_eq!(self::source(&out).pictures[0].meaning.profile.is_some(), is_kept, "{name} to {format:?}");
    }
    // A grey picture that becomes one of colours.
    let mut grey = source(&case("icc_profiles").join("gicc.png"));
    assert!(grey.pictures[0].meaning.profile.is_some());
    let of_colours = source(&case("icc_profiles").join("p3.png")).pictures.remove(0).pixels;
    grey.pictures[0].pixels = of_colours.clone();
    let out = folder.path().join("grey.png");
    write::write(
        &out,
        Existing::Replace,
        (Format::Png, Options::default()),
        vec![of_colours],
        &grey.pictures[0].meaning,
        &grey,
        None,
    )
    .expect("it can be written");
    assert_eq!(source(&out).pictures[0].meaning.profile, None);
}

/// The first pixel of a case as light, by what its reader says of its numbers.
fn light(name: &str) -> [f32; 3] {
    let picture = source(&case(name)).pictures.remove(0);
    let change = Conversion::between(&picture.meaning, &Meaning::light()).expect("it is encoded");
    let numbers = change.apply(&picture.pixels).0.to_f32();
    if picture.pixels.channels() == 1 { [numbers[0]; 3] } else { [numbers[0], numbers[1], numbers[2]] }
}

#[test]
fn profiles_say_what_numbers_mean() {
    // The note's numbers are of 8 bits; JPEG changes red by one.
    for (name, near) in [("p3.png", 4e-3), ("p3.tif", 4e-3), ("p3.jpg", 2e-2), ("p3.webp", 4e-3)] {
        let found = light(&format!("icc_profiles/{name}"));
        let is_right = found.iter().zip([0.694, 0.023, 0.0086]).all(|(a, b)| (a - b).abs() < near);
        assert!(is_right, "{name}: {found:?}");
    }
    let meaning = source(&case("icc_profiles/p3.png")).pictures.remove(0).meaning;
    assert!(meaning.has_primaries(primaries::P3) && meaning.transfer == Transfer::Srgb, "{meaning:?}");
    assert_eq!(meaning.said_by, Some("ICC profile"));
    // The profile of grey has a gamma of 1.8, and results of colours are sRGB.
    let grey = source(&case("icc_profiles/gicc.png")).pictures.remove(0).meaning;
    assert!(matches!(grey.transfer, Transfer::Gamma(gamma) if (gamma - 1.8).abs() < 1e-2), "{grey:?}");
    let results = grey.of_results(grey.state);
    assert!(grey.profile.is_some() && grey.warnings.is_empty() && results.is_usual());
    assert_eq!(results.profile, None);
}

#[test]
fn inks_become_colours_by_their_profile() {
    for name in ["icc_profiles/cmyk_icc.jpg", "icc_profiles/cmyk_icc.tif"] {
        let picture = source(&case(name)).pictures.remove(0);
        let [r, g, b] = [0, 1, 2].map(|channel: usize| picture.pixels.bytes()[channel]);
        // Little CMS gives 202, 102, 76 by the same tables.
        let is_right = [(r, 202), (g, 102), (b, 76)].iter().all(|(found, right)| found.abs_diff(*right) <= 2);
        assert!(is_right, "{name}: {r} {g} {b}");
        assert_eq!((picture.meaning.is_usual(), picture.meaning.profile), (true, None));
        assert_eq!(picture.pixels.precision(), Precision::U8);
    }
}

#[test]
fn numbers_mean_the_same_in_all_files_that_are_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let read = source(&case("icc_profiles/p3.png"));
    let pixels = read.pictures[0].pixels.clone();
    for (primaries, transfer) in [
        (primaries::P3, Transfer::Srgb),
        (primaries::REC2020, Transfer::Pq),
        (primaries::REC2020, Transfer::Hlg),
        (primaries::REC2020, Transfer::Rec709),
        (primaries::ADOBE, Transfer::Gamma(2.2)),
        (primaries::AP1, Transfer::Linear),
        (primaries::AP0, Transfer::Linear),
    ] {
        let meaning = Meaning { primaries, transfer, ..Meaning::display() };
        for name in ["a.png", "a.tif", "a.jpg"] {
            let path = folder.path().join(name);
            let format = Format::of(&path).expect("a kind of file");
            write::write(
                &path,
                Existing::Replace,
                (format, Options::default()),
                vec![pixels.clone()],
                &meaning,
                &read,
                None,
            )
            .expect("it can be written");
            let found = source(&path).pictures.remove(0).meaning;
            let said = format!("{name}: {} as {}", meaning.words(), found.words());
            assert!(found.warnings.is_empty(), "{said}: {:?}", found.warnings);
            // Negative chromaticities cannot be said in PNG.
            assert!(found.has_primaries(primaries) || primaries[5] < 0.0 && name == "a.png", "{said}");
            match (&found.transfer, &meaning.transfer) {
                (Transfer::Gamma(a), Transfer::Gamma(b)) => assert!((a - b).abs() < 1e-3, "{said}"),
                (a, b) => assert_eq!(a, b, "{said}"),
            }
        }
    }
    // The usual is not said.
    let path = folder.path().join("usual.png");
    write::write(
        &path,
        Existing::Keep,
        (Format::Png, Options::default()),
        vec![pixels],
        &Meaning::display(),
        &read,
        None,
    )
    .expect("it can be written");
    let bytes = fs::read(&path).expect("it is there");
    for chunk in [b"cICP", b"gAMA", b"cHRM", b"iCCP", b"sRGB"] {
        assert!(bytes.windows(4).all(|window| window != chunk));
    }
}

#[test]
fn light_of_other_primaries_is_written_with_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let read = source(&case("exr_color_interop/c_2020id.exr"));
    let picture = &read.pictures[0];
    for name in ["a.tif", "a.exr"] {
        let path = folder.path().join(name);
        let (format, pixels) = (Format::of(&path).expect("a kind"), picture.pixels.clone());
        write::write(
            &path,
            Existing::Keep,
            (format, Options::default()),
            vec![pixels],
            &picture.meaning,
            &read,
            None,
        )
        .expect("it can be written");
        let found = source(&path).pictures.remove(0).meaning;
        assert!(found.has_primaries(primaries::REC2020) && found.transfer == Transfer::Linear, "{found:?}");
    }
}

#[test]
fn colours_and_light_of_surfaces_are_found_by_the_names_of_renderers() {
    let folder = tempfile::tempdir().expect("a folder");
    // A layer of each, whose red, green and blue are multiples of its number, and a picture with alpha.
    let file = |layers: &[(&str, f32)]| {
        let own =
            [("R", 0.1), ("G", 0.2), ("B", 0.3), ("A", 0.5)].map(|(name, value)| (name.to_owned(), value));
        let of = |(layer, value): &(&str, f32)| {
            [("R", 1.0), ("G", 2.0), ("B", 4.0)].map(|(c, factor)| (format!("{layer}.{c}"), value * factor))
        };
        let all: Vec<(String, f32)> = own.into_iter().chain(layers.iter().flat_map(of)).collect();
        let all: Vec<(&str, f32)> = all.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        exr_file(folder.path(), &all)
    };
    let found = |path: &Path, kind| guide(path, kind, None).expect("a picture").map(|pixels| pixels.to_f32());
    let plain = |value: f32| [value, 2.0 * value, 4.0 * value, 0.5];
    for (kind, names) in [
        (
            Guide::Albedo,
            &["albedo", "diffuse_albedo", "ViewLayer.DiffCol", "VRayDiffuseFilter", "DiffuseFilter"][..],
        ),
        (Guide::Diffuse, &["diffuse", "combineddiffuse", "DiffuseLighting"]),
        (Guide::Specular, &["specular", "combinedglossyreflection"]),
    ] {
        for name in names {
            let numbers = found(&file(&[(name, 0.25)]), kind).unwrap_or_else(|| panic!("{name}"));
            assert_eq!(numbers[..4], plain(0.25), "{name}, with the alpha of the picture");
            assert_eq!(numbers.len(), 4 * 8);
        }
        assert_eq!(found(&file(&[("fog", 0.25)]), kind), None);
    }
    // Arnold's light has the colours of surfaces in it, and its parts are none of these.
    let arnold = file(&[("diffuse_direct", 0.5), ("diffuse_indirect", 0.5)]);
    assert_eq!(found(&arnold, Guide::Diffuse), None);
    // That of Blender has not: (direct + indirect) colour.
    for names in [["DiffCol", "DiffDir", "DiffInd"], ["Diffuse Color", "Diffuse Direct", "Diffuse Indirect"]]
    {
        let [colour, direct, indirect] = names.map(|name| format!("ViewLayer.{name}"));
        let blender = file(&[(colour.as_str(), 0.5), (direct.as_str(), 0.25), (indirect.as_str(), 0.125)]);
        assert_eq!(found(&blender, Guide::Diffuse).expect("light")[..4], [0.1875, 0.75, 3.0, 0.5]);
        assert_eq!(found(&blender, Guide::Albedo).expect("colours")[..4], plain(0.5));
    }
    let blender = file(&[("ViewLayer.GlossCol", 0.5), ("ViewLayer.GlossDir", 0.25)]);
    assert_eq!(found(&blender, Guide::Specular).expect("light")[..4], [0.125, 0.5, 2.0, 0.5]);
    // They are pictures all the same, for whoever asks for them, and channels can be named.
    let selection = Selection { layer: Some("diffuse".into()), ..Selection::default() };
    assert!(read::read(&file(&[("diffuse", 0.25)]), &selection).is_ok());
    let named = guide(&file(&[("fog", 0.25)]), Guide::Albedo, Some("albedo=fog.R,fog.G,fog.B"));
    assert_eq!(named.expect("a picture").expect("colours").to_f32()[..4], plain(0.25));
    let layer = guide(&file(&[("fog", 0.25)]), Guide::Albedo, Some("albedo=fog"));
    assert_eq!(layer.expect("a picture").expect("colours").to_f32()[..4], plain(0.25));
}
