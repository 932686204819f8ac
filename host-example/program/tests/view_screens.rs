//! Every screen of `isophote view` at several sizes, without a window: nothing is cut, what does not fit scrolls, and no two
//! labels lie over each other.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use egui::accesskit::{Action, ActionRequest, Role, TreeId};
use egui::{Event, Id, LayerId, Rect};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use isophote_loader::Library;
use isophote_scene::Scene;
use isophote_window::jobs::document::{Document, Options};
use isophote_window::jobs::listing::{self, ListingRequest};
use isophote_window::state::browser::entry::Group;
use isophote_window::state::histogram::{Histogram, Histograms};
use isophote_window::state::leaving::Leaving;
use isophote_window::state::look::EditedLook;
use isophote_window::state::probed::Probed;
use isophote_window::state::scenery::{Scenery, Staging};
use isophote_window::state::session::Session;
use isophote_window::state::settings::Settings;
use isophote_window::state::viewport::{Compare, Overlay};
use isophote_window::state::work::Request;
use isophote_window::widgets;
use winit::keyboard::{Key, NamedKey};

use crate::support;

/// Sizes of windows in pixels, and of their letters.
const SIZES: [([f32; 2], f32); 5] = [
    ([1000.0, 600.0], 1.0),
    ([1200.0, 750.0], 1.0),
    ([1920.0, 1080.0], 1.0),
    ([3840.0, 2160.0], 2.0),
    ([1440.0, 900.0], 2.0),
];

fn library() -> Library {
    Library::from_file(support::library()).expect("the library")
}

/// A window of all styles with nothing open, that knows recent files.
fn nothing() -> Session {
    let library = library();
    let catalogue = library.catalogue().expect("the catalogue");
    let styles = catalogue.nodes.iter().filter(|node| node.group == "styles").map(|node| node.id.to_owned());
    let looks = std::iter::once("none".to_owned()).chain(styles);
    let looks = looks.map(|name| EditedLook::open(&library, name.as_ref()).expect("a style")).collect();
    let recent =
        |n: u32| PathBuf::from(format!("/somewhere/in a folder with a long name/of a project/shot_{n}.png"));
    let mut settings = Settings::default();
    settings.recent = (0..12).map(recent).collect();
    let mut session = Session::new(library, looks, settings).expect("a session");
    session.choose(1);
    session
}

fn open(session: &mut Session, path: &Path) {
    let document = Document::open(path, &Options::default()).expect("a document");
    session.show_playback(document.playback().expect("pictures"));
}

fn photo(folder: &Path) -> Session {
    let mut session = nothing();
    let file = folder.join("a photograph with a name that is rather long.png");
    support::picture(90, 60).save(&file).expect("the folder is writable");
    open(&mut session, &file);
    let names = fs::read_dir(folder).expect("the folder").flatten().map(|entry| entry.file_name()).collect();
    let files = isophote_window::state::folder::files(&file, names, &[]);
    session.beside.take(file, files);
    session
}

fn sequence(folder: &Path) -> Session {
    let mut session = nothing();
    for number in 1..4 {
        support::picture(48, 32).save(folder.join(format!("shot.000{number}.png"))).expect("it is writable");
    }
    open(&mut session, &folder.join("shot.####.png"));
    session.probed = Some(probed());
    session
}

/// A pixel with as many digits as there may be.
fn probed() -> Probed {
    let original = [0.123_456, 0.456_789, 0.789_123, 0.5];
    Probed {
        at: [1234, 987],
        original,
        shown: Some([0.987_654, 0.654_321, 0.321_987, 0.5]),
        overlay: Overlay::None,
    }
}

fn scene(folder: &Path) -> Session {
    let mut session = nothing();
    let scene = Scene::load(&support::cube(folder), None).expect("a scene");
    session.show_scene(Scenery::new(scene, Staging::default(), 1.5), None, "cube.gltf".into());
    session
}

fn grid(folder: &Path) -> Session {
    let mut session = photo(folder);
    session.toggle_browser();
    session.list(listing::read(ListingRequest { library: library(), folders: Vec::new() }));
    session
}

/// A screen: its name, what is open, and the label that is clicked on there.
type Screen = (&'static str, fn(&Path) -> Session, Option<&'static str>);

const SCREENS: [Screen; 16] = [
    ("start", |_| nothing(), None),
    ("menu at the start", |_| nothing(), Some("File")),
    ("photo", photo, None),
    ("menu", photo, Some("File")),
    ("help", photo, Some("Keys and mouse")),
    (
        "histogram",
        |folder| {
            let mut session = photo(folder);
            session.settings.shows_histogram = true;
            session.histograms = Some(histograms());
            session
        },
        None,
    ),
    (
        "probe",
        |folder| {
            let mut session = photo(folder);
            session.probed = Some(probed());
            session.work.exported = Some(0.3);
            session
        },
        None,
    ),
    (
        "wipe",
        |folder| {
            let mut session = photo(folder);
            session.viewport.compare = Compare::Wipe;
            session
        },
        None,
    ),
    (
        "difference",
        |folder| {
            let mut session = photo(folder);
            session.viewport.compare = Compare::Difference;
            session
        },
        None,
    ),
    ("scene", scene, Some("Scene and light")),
    ("sequence", sequence, None),
    ("grid", grid, None),
    (
        "comparison",
        |folder| {
            let mut session = grid(folder);
            let all: Vec<u64> = session.browser.entries().iter().take(6).map(|entry| entry.id).collect();
            all.into_iter().for_each(|id| session.mark(id));
            session.compare_marked();
            session
        },
        None,
    ),
    (
        "export",
        |folder| {
            let mut session = photo(folder);
            session.plan_export();
            session
        },
        None,
    ),
    (
        "saving",
        |folder| {
            let mut session = photo(folder);
            session.save_look(true);
            session
        },
        None,
    ),
    (
        "leaving",
        |folder| {
            let mut session = photo(folder);
            session.dialogs.leaving = Leaving::Asks;
            session
        },
        None,
    ),
];

fn histograms() -> Histograms {
    let pixels: Vec<[u8; 4]> =
        (0..4000_u32).map(|n| [(n % 256) as u8, (n / 16) as u8, (n % 97) as u8, 255]).collect();
    let shown = Histogram::of(pixels.iter());
    let original = Histogram::of(pixels[..2000].iter());
    Histograms { shown, original }
}

fn harness(session: Session, ([width, height], scale): ([f32; 2], f32)) -> Harness<'static, Session> {
    let mut harness = Harness::builder()
        .with_size(egui::vec2(width / scale, height / scale))
        .with_pixels_per_point(scale)
        .build_ui_state(|ui, session: &mut Session| widgets::show(ui, session), session);
    widgets::theme::apply(&harness.ctx);
    harness.run_ok();
    harness
}

/// A control or a label: what it is, where it lies, and the part of that which is seen.
#[derive(Clone, Debug)]
struct Thing {
    id: Id,
    layer: LayerId,
    role: Role,
    name: String,
    rect: Rect,
    seen: Rect,
}

/// Kinds of things that are looked at: what can be read, and what can be used.
const ROLES: [Role; 11] = [
    Role::Label,
    Role::Button,
    Role::CheckBox,
    Role::RadioButton,
    Role::Slider,
    Role::SpinButton,
    Role::ComboBox,
    Role::TextInput,
    Role::Link,
    Role::ColorWell,
    Role::ProgressIndicator,
];

fn things(harness: &Harness<'_, Session>) -> Vec<Thing> {
    let mut named = HashMap::new();
    for role in ROLES {
        for node in harness.query_all_by_role(role) {
            let node = node.accesskit_node();
            let name = node.label().or_else(|| node.value()).unwrap_or_default();
            named.insert(node.locate().0, (role, name));
        }
    }
    harness.ctx.viewport(|viewport| {
        let all = viewport.prev_pass.widgets.layers();
        let all = all.flat_map(|(layer, rects)| rects.iter().map(|rect| (*layer, rect)));
        let things = all.filter_map(|(layer, widget)| {
            let (role, name) = named.get(&widget.id.accesskit_id())?.clone();
            Some(Thing { id: widget.id, layer, role, name, rect: widget.rect, seen: widget.interact_rect })
        });
        things.collect()
    })
}

/// True where all of something is seen, but for what rounding takes.
fn is_whole(thing: &Thing, window: Rect) -> bool {
    thing.seen.expand(1.0).contains_rect(thing.rect) && window.expand(1.0).contains_rect(thing.rect)
}

/// Things that are cut, and stay so when they are scrolled to. Of those that are not seen in one place the first and the last
/// are tried, between which all others lie.
fn cut(harness: &mut Harness<'_, Session>) -> Vec<String> {
    let window = harness.ctx.content_rect();
    let mut places: HashMap<(LayerId, i32, i32), Vec<Thing>> = HashMap::new();
    for thing in things(harness).into_iter().filter(|thing| !is_whole(thing, window)) {
        let seen = thing.seen.center();
        let place = if thing.seen.is_positive() { (seen.x as i32, seen.y as i32) } else { (-1, -1) };
        places.entry((thing.layer, place.0, place.1)).or_default().push(thing);
    }
    let suspects: Vec<Thing> = places
        .into_values()
        .flat_map(|mut things| {
            things.sort_by(|a, b| a.rect.bottom().total_cmp(&b.rect.bottom()));
            let last = if things.len() > 1 { things.pop() } else { None };
            things.into_iter().take(1).chain(last)
        })
        .collect();
    let mut cut = Vec::new();
    for thing in suspects {
        harness.event(Event::AccessKitActionRequest(ActionRequest {
            action: Action::ScrollIntoView,
            target_node: thing.id.accesskit_id(),
            target_tree: TreeId::ROOT,
            data: None,
        }));
        harness.run_ok();
        let now = things(harness).into_iter().find(|other| other.id == thing.id);
        if let Some(now) = now.filter(|now| !is_whole(now, window)) {
            cut.push(format!(
                "{:?} '{}' at {:?}, of which {:?} is seen",
                now.role, now.name, now.rect, now.seen
            ));
        }
    }
    cut
}

/// Pairs of labels that lie over each other.
fn overlapping(harness: &Harness<'_, Session>) -> Vec<String> {
    let mut labels = things(harness);
    labels.retain(|thing| thing.role == Role::Label && !thing.name.is_empty() && thing.seen.is_positive());
    let mut pairs = Vec::new();
    for (index, a) in labels.iter().enumerate() {
        for b in labels[index + 1..].iter().filter(|b| b.layer == a.layer) {
            let both = a.seen.intersect(b.seen);
            if both.is_positive() && both.width() > 1.0 && both.height() > 1.0 {
                pairs.push(format!("'{}' at {:?} and '{}' at {:?}", a.name, a.seen, b.name, b.seen));
            }
        }
    }
    pairs
}

#[test]
fn nothing_is_cut_and_no_two_labels_overlap_on_any_screen_at_any_size() {
    let folder = support::folder();
    let mut problems = Vec::new();
    for (name, session, click) in SCREENS {
        let mut harness = harness(session(folder.path()), SIZES[0]);
        if let Some(label) = click {
            let found = harness.query_by_label(label).map(|node| node.click());
            found.unwrap_or_else(|| panic!("{name}: there is no '{label}'"));
            harness.run_ok();
        }
        for ([width, height], scale) in SIZES {
            // Another scale changes the size as well, which is given after that.
            harness.set_pixels_per_point(scale).run_ok();
            harness.set_size(egui::vec2(width / scale, height / scale));
            harness.run_ok();
            let at = format!("{name} at {width} x {height}, letters times {scale}");
            assert!(things(&harness).len() > 4, "{at}: there is nothing to look at");
            let of = |problem| format!("{at}: {problem}");
            problems.extend(overlapping(&harness).into_iter().map(of));
            problems.extend(cut(&mut harness).into_iter().map(of));
        }
    }
    assert!(problems.is_empty(), "{} problems:\n{}", problems.len(), problems.join("\n"));
}

#[test]
fn favourites_come_first_by_a_click_and_by_a_key_and_can_be_seen_alone() {
    let folder = support::folder();
    let mut harness = harness(grid(folder.path()), ([1400.0, 4000.0], 1.0));
    let names = |harness: &Harness<'_, Session>| -> Vec<String> {
        let groups = harness.state().browser.groups();
        groups.into_iter().flat_map(|(_, list)| list).map(|entry| entry.name.clone()).collect()
    };
    let before = names(&harness);
    harness.get_by_role_and_label(Role::CheckBox, "Favourite Blueprint").click();
    harness.run_ok();
    let after = names(&harness);
    assert_eq!((after[0].as_str(), after.len()), ("Blueprint", before.len()));
    assert_eq!(*harness.state().browser.groups()[0].0, Group::Favourites);
    let cartoon = harness.state().browser.find(Path::new("cartoon")).expect("a style").id;
    harness.state_mut().browser.selected = Some(cartoon);
    widgets::keys::press(harness.state_mut(), &Key::Character("*".into()));
    harness.run_ok();
    let favourites = ["cartoon", "blueprint"].map(PathBuf::from);
    assert!(favourites.iter().all(|look| harness.state().settings.favourites.contains(look)));
    harness.get_by_role_and_label(Role::Button, "Favourites alone").click();
    harness.run_ok();
    let mut alone = names(&harness);
    alone.sort();
    assert_eq!(alone, ["Blueprint", "Cartoon"]);
    widgets::keys::press(harness.state_mut(), &Key::Character("*".into()));
    assert_eq!(names(&harness), ["Blueprint"], "the key takes it back");
}

#[test]
fn words_tell_what_a_drop_will_do() {
    let folder = support::folder();
    let mut harness = harness(photo(folder.path()), SIZES[0]);
    for (files, words) in [
        (&["photo.png"][..], "Open photo.png"),
        (&["mine.json"], "Add mine.json as a look"),
        (&["a.png", "b.png", "c.png"], "Use this look on 3 pictures"),
        (&[], ""),
    ] {
        let hovered =
            |file: &&str| egui::HoveredFile { path: Some(folder.path().join(file)), ..Default::default() };
        harness.input_mut().hovered_files = files.iter().map(hovered).collect();
        harness.run_ok();
        let shown = harness.query_all_by_label_contains("photo.png").count()
            + harness.query_all_by_label_contains("as a look").count()
            + harness.query_all_by_label_contains("this look on").count();
        assert_eq!(shown, usize::from(!files.is_empty()), "{files:?}");
        assert!(files.is_empty() || harness.query_by_label(words).is_some(), "{words}");
    }
}

#[test]
fn where_nothing_can_be_dropped_nobody_is_told_to_drop_anything() {
    for takes_drops in [true, false] {
        let mut session = nothing();
        session.takes_drops = takes_drops;
        let harness = harness(session, SIZES[0]);
        assert_eq!(harness.query_by_label("or drop a file on this window").is_some(), takes_drops);
    }
}

#[test]
fn the_histogram_is_opened_and_closed_and_tells_of_clipped_pixels() {
    let folder = support::folder();
    let mut harness = harness(photo(folder.path()), SIZES[1]);
    assert!(!harness.state().settings.shows_histogram);
    harness.get_by_label("Histogram").click();
    harness.run_ok();
    assert!(harness.state().settings.shows_histogram);
    harness.state_mut().histograms = Some(histograms());
    harness.run_ok();
    let [low, high] = histograms().shown.clipped_shares().map(|share| format!("{:.1} %", share * 100.0));
    assert!(harness.query_by_label(&format!("Lost in black {low}")).is_some());
    assert!(harness.query_by_label(&format!("Lost in white {high}")).is_some());
    widgets::keys::press(harness.state_mut(), &Key::Character("h".into()));
    assert!(!harness.state().settings.shows_histogram);
}

#[test]
fn errors_go_away_when_they_are_mended_or_something_else_is_open() {
    let folder = support::folder();
    let file = folder.path().join("mine.json");
    let mut session = photo(folder.path());
    let library = session.library.clone();
    let reread = |session: &mut Session, text: &str| {
        fs::write(&file, text).expect("the folder is writable");
        session.reload(&file, EditedLook::open(&library, &file));
        session.notes.present().iter().filter(|note| note.is_bad).count()
    };
    fs::write(&file, r#"{"style": "cartoon"}"#).expect("the folder is writable");
    session.take(EditedLook::open(&session.library, &file).expect("a look").into());
    assert_eq!(reread(&mut session, "{"), 1);
    assert_eq!(reread(&mut session, r#"{"style": "cartoon", "parameters": {"posterize": 3}}"#), 0);
    assert_eq!(reread(&mut session, "{"), 1);
    open(&mut session, &folder.path().join("a photograph with a name that is rather long.png"));
    assert!(session.notes.present().iter().all(|note| !note.is_bad));
    let unread = isophote_files::error::Error::failure("something is wrong", "mend it");
    session.notes.complain(&unread);
    session.close();
    assert_eq!(session.notes.present().len(), 1, "what nobody has seen stays");
}

#[test]
fn the_lower_bar_tells_the_place_in_the_folder_and_leads_to_the_files_beside() {
    let folder = support::folder();
    let mut session = photo(folder.path());
    let of = session.open.file().expect("a file").to_owned();
    let files = ["a.png", "z.png"].map(|name| folder.path().join(name));
    session.beside.take(of.clone(), vec![files[0].clone(), of, files[1].clone()]);
    let mut harness = harness(session, SIZES[0]);
    assert!(harness.query_by_label("2 of 3").is_some());
    harness.get_by_label("Next file").click();
    harness.run_ok();
    assert_eq!(harness.state().work.requests(), [Request::Open(files[1].clone())]);
    for _ in 0..2 {
        widgets::keys::press(harness.state_mut(), &Key::Named(NamedKey::PageUp));
    }
    let last = harness.state().work.requests().last().cloned();
    assert_eq!(
        last,
        Some(Request::Open(files[0].clone())),
        "steps go on from the file that is about to be opened"
    );
}
