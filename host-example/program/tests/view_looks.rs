//! The browser of looks and what belongs to it, without a window: what there is, what is shown of it, and what becomes of
//! files.

use std::fs;
use std::path::{Path, PathBuf};

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use isophote_finishing::stylize::preset::{self as file, Preset};
use isophote_finishing::stylize::value::Value;
use isophote_loader::Library;
use isophote_window::jobs::document::{Document, Options};
use isophote_window::jobs::listing::{self, ListingRequest};
use isophote_window::state::browser::entry::{Content, Group};
use isophote_window::state::browser::listing::Listing;
use isophote_window::state::leaving::Leaving;
use isophote_window::state::look::EditedLook;
use isophote_window::state::outcome::Dialog;
use isophote_window::state::session::Session;
use isophote_window::state::settings::Settings;
use isophote_window::state::work::Request;
use isophote_window::widgets;
use tempfile::TempDir;
use winit::keyboard::{Key, NamedKey};

use crate::support;

fn library() -> Library {
    Library::from_file(support::library()).expect("the library")
}

/// Presets in folders: two that are in order and one that is not.
fn presets() -> TempDir {
    let folder = support::folder();
    let dusk = r#"{"name": "Dusk", "about": "Indigo lines.", "tags": ["comic", "dim"], "style": "cartoon",
        "parameters": {"posterize": 4}}"#;
    fs::create_dir_all(folder.path().join("client/night")).expect("the folder is writable");
    for (name, text) in [
        ("dusk.json", dusk),
        ("client/later.json", r#"{"style": "cartoon", "parameters": {"later": 1}}"#),
        ("client/night/ink.json", r#"{"style": "ink"}"#),
        ("client/night/notes.txt", "no look"),
    ] {
        fs::write(folder.path().join(name), text).expect("the folder is writable");
    }
    folder
}

fn read(folder: &Path) -> Listing {
    listing::read(ListingRequest { library: library(), folders: vec![folder.to_owned()] })
}

/// A window with a picture and the looks of a folder, in which two looks are at hand.
fn session(folder: &Path) -> Session {
    let library = library();
    let looks =
        ["none", "cartoon", "ink"].map(|name| EditedLook::open(&library, name.as_ref()).expect("a style"));
    let mut session = Session::new(library, looks.into(), Settings::default()).expect("a session");
    let picture = folder.join("picture.png");
    support::picture(90, 60).save(&picture).expect("the folder is writable");
    let document = Document::open(&picture, &Options::default()).expect("a picture");
    session.show_playback(document.playback().expect("a picture"));
    session.settings.add_look_folder(folder);
    session.toggle_browser();
    session.list(read(folder));
    session
}

/// The controls in a window large enough for all cards.
fn harness(session: Session) -> Harness<'static, Session> {
    let mut harness = Harness::builder()
        .with_size(egui::vec2(1400.0, 4400.0))
        .build_ui_state(|ui, session: &mut Session| widgets::show(ui, session), session);
    widgets::theme::apply(&harness.ctx);
    harness.run_ok();
    harness
}

fn click(harness: &mut Harness<'_, Session>, role: Role, label: &str) {
    harness.get_by_role_and_label(role, label).click();
    harness.run_ok();
}

fn type_into(harness: &mut Harness<'_, Session>, label: &str, text: &str) {
    let field = harness.get_by_role_and_label(Role::TextInput, label);
    field.focus();
    harness.run_ok();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    harness.get_by_role_and_label(Role::TextInput, label).type_text(text);
    harness.run_ok();
}

fn id(session: &Session, source: &Path) -> u64 {
    session.browser.find(source).unwrap_or_else(|| panic!("{} is there", source.display())).id
}

/// Names of the looks that are shown.
fn shown(session: &Session) -> Vec<String> {
    session.browser.groups().into_iter().flat_map(|(_, list)| list).map(|entry| entry.name.clone()).collect()
}

fn preset(path: &Path) -> Preset {
    file::parse(path, &fs::read_to_string(path).expect("the file is there")).expect("a preset")
}

#[test]
fn folders_are_groups_and_broken_files_say_why() {
    let folder = presets();
    let session = session(folder.path());
    let path = |name: &str| folder.path().join(name);
    let groups: Vec<(Group, usize)> =
        session.browser.groups().into_iter().map(|(group, list)| (group.clone(), list.len())).collect();
    let own: Vec<(Group, usize)> = [("", 1), ("client", 1), ("client/night", 1)]
        .map(|(name, count)| (Group::Folder(path(name).components().collect()), count))
        .into();
    assert_eq!(groups[..3], own);
    assert!(matches!(groups[3], (Group::Shipped, count) if count >= 30), "{groups:?}");
    assert!(matches!(groups[4], (Group::Styles, count) if count >= 8), "{groups:?}");
    let dusk = session.browser.find(&path("dusk.json")).expect("it is there");
    assert_eq!((dusk.name.as_str(), dusk.style.as_str()), ("Dusk", "Cartoon"));
    assert!(dusk.has_title() && dusk.look().is_some());
    let broken = session.browser.find(&path("client/later.json")).expect("it is there");
    assert!(matches!(&broken.content, Content::Broken(why) if why.contains("later")), "{broken:?}");
    assert_eq!(broken.name, "later.json");
    let entries = session.browser.entries();
    assert!(
        entries
            .iter()
            .filter(|e| e.group == Group::Shipped)
            .all(|e| e.look().is_some() && !e.title.tags.is_empty())
    );
    let missing = read(&path("nowhere"));
    assert!(missing.problems[0].to_string().contains("nowhere"));
}

#[test]
fn looks_that_stay_the_same_keep_their_cards() {
    let folder = presets();
    let mut session = session(folder.path());
    let (dusk, ink) = (folder.path().join("dusk.json"), folder.path().join("client/night/ink.json"));
    let before = [id(&session, &dusk), id(&session, &ink)];
    session.browser.selected = Some(before[0]);
    session.mark(before[0]);
    fs::write(&dusk, r#"{"style": "cartoon"}"#).expect("it is writable");
    session.list(read(folder.path()));
    let after = [id(&session, &dusk), id(&session, &ink)];
    assert!(before[0] != after[0] && before[1] == after[1], "{before:?} {after:?}");
    assert_eq!((session.browser.selected, &session.browser.marked[..]), (Some(after[0]), &after[..1]));
    fs::remove_file(&dusk).expect("it is there");
    session.list(read(folder.path()));
    assert!(session.browser.find(&dusk).is_none() && session.browser.marked.is_empty());
}

#[test]
fn looks_are_searched_by_words_and_tags() {
    let folder = presets();
    let mut harness = harness(session(folder.path()));
    let all = shown(harness.state()).len();
    type_into(&mut harness, "Search looks", "dusk");
    assert_eq!(shown(harness.state()), ["Dusk"]);
    assert!(harness.query_by_role_and_label(Role::Button, "Copperplate").is_none());
    type_into(&mut harness, "Search looks", "INK dark");
    let found = shown(harness.state());
    assert!(!found.is_empty() && found.len() < 12 && !found.contains(&"Dusk".to_owned()), "{found:?}");
    type_into(&mut harness, "Search looks", "zzz");
    assert!(harness.query_by_label("No look is like that.").is_some());
    click(&mut harness, Role::Button, "Show all");
    assert_eq!(shown(harness.state()).len(), all);
    click(&mut harness, Role::Button, "Tag comic");
    let comics = shown(harness.state());
    assert!(comics.contains(&"Dusk".to_owned()) && comics.len() < all / 2, "{comics:?}");
    click(&mut harness, Role::Button, "Tag comic");
    assert_eq!(shown(harness.state()).len(), all);
}

#[test]
fn a_click_shows_a_look_and_undo_brings_back_what_it_replaced() {
    let folder = presets();
    let mut session = session(folder.path());
    session.choose(1);
    let parameter = session
        .looks
        .parameters()
        .iter()
        .find(|parameter| matches!(parameter.default, Value::Float(_)))
        .expect("a number")
        .clone();
    session.set(&parameter, &parameter.default.others(&parameter.param.kind)[0]);
    session.let_go();
    let edited = session.look().clone();
    session.choose(2);
    let mut harness = harness(session);
    // The style by itself, of which an edited look is at hand.
    click(&mut harness, Role::Button, "Cartoon");
    assert!(harness.state().browser.is_open && !harness.state().look().is_changed());
    assert_eq!(harness.state().look().source, Path::new("cartoon"));
    click(&mut harness, Role::Button, "Dusk");
    assert_eq!(harness.state().look().name, "Dusk");
    let count = harness.state().looks.list().len();
    harness.state_mut().undo();
    assert_eq!(harness.state().looks.list().len(), count - 1, "what was new is gone");
    harness.state_mut().undo();
    assert_eq!(harness.state().look().source, Path::new("ink"));
    harness.state_mut().choose(1);
    assert_eq!(*harness.state().look(), edited, "what was replaced is back");
    let broken = id(harness.state(), &folder.path().join("client/later.json"));
    harness.state_mut().apply(broken, true);
    assert!(harness.state().browser.is_open && *harness.state().look() == edited);
}

#[test]
fn a_medium_is_a_card_beside_the_styles() {
    let folder = presets();
    let mut harness = harness(session(folder.path()));
    type_into(&mut harness, "Search looks", "charcoal");
    click(&mut harness, Role::Button, "Charcoal");
    let look = harness.state().look();
    assert_eq!((look.name.as_str(), look.preset.style.as_str()), ("Charcoal", "ink"));
    assert!(!look.is_changed() && look.source == Path::new("ink:charcoal"));
    let entry = harness.state().browser.find(Path::new("ink:charcoal")).expect("a card");
    assert!(entry.group == Group::Styles && entry.title.about.is_some());
}

#[test]
fn keys_go_from_card_to_card() {
    let folder = presets();
    let mut session = session(folder.path());
    session.browser.columns = 4;
    session.browser.selected = None;
    let press = |session: &mut Session, key: NamedKey| widgets::keys::press(session, &Key::Named(key));
    let selected = |session: &Session| {
        session.browser.selected.and_then(|id| session.browser.entry(id)).map(|entry| entry.name.clone())
    };
    let all = shown(&session);
    for (key, name) in [
        (NamedKey::ArrowDown, all[0].as_str()),
        (NamedKey::ArrowLeft, &all[0]),
        (NamedKey::ArrowUp, &all[0]),
        (NamedKey::ArrowRight, &all[1]),
        (NamedKey::ArrowDown, &all[2]),
        (NamedKey::ArrowDown, &all[3]),
        (NamedKey::ArrowRight, &all[4]),
        (NamedKey::ArrowDown, &all[8]),
        (NamedKey::ArrowUp, &all[4]),
    ] {
        press(&mut session, key);
        assert_eq!(selected(&session).as_deref(), Some(name), "{key:?}");
    }
    press(&mut session, NamedKey::Enter);
    assert!(!session.browser.is_open);
    assert_eq!(session.look().name, all[4]);
    widgets::keys::press(&mut session, &Key::Character("l".into()));
    assert!(session.browser.is_open && session.browser.is_outdated, "the looks are read again");
    assert_eq!(selected(&session).as_deref(), Some(all[4].as_str()));
    press(&mut session, NamedKey::Escape);
    assert!(!session.browser.is_open && session.dialogs.leaving == Leaving::Stays, "the window stays open");
}

#[test]
fn names_and_tags_are_written_to_the_file() {
    let folder = presets();
    let file = folder.path().join("dusk.json");
    let before = preset(&file);
    let bytes = fs::read(&file).expect("it is there");
    let mut session = session(folder.path());
    let dusk = id(&session, &file);
    session.apply(dusk, false);
    let mut harness = harness(session);
    click(&mut harness, Role::Button, "Name and tags…");
    type_into(&mut harness, "Name", "Twilight");
    type_into(&mut harness, "Tags", "dim, blue hour");
    click(&mut harness, Role::Button, "Save");
    let after = preset(&file);
    assert_eq!(after.title.name.as_deref(), Some("Twilight"));
    assert_eq!(
        (after.title.tags.join("|"), after.title.about.as_deref()),
        ("dim|blue hour".into(), Some("Indigo lines."))
    );
    assert_eq!((&after.style, &after.params), (&before.style, &before.params));
    let session = harness.state_mut();
    assert!(session.browser.is_outdated && session.look().name == "Twilight" && !session.look().is_changed());
    // The window's own writing is no change from outside.
    let again = EditedLook::open(&session.library, &file);
    session.reload(&file, again);
    assert_eq!(session.look().name, "Twilight");
    session.list(read(folder.path()));
    assert!(shown(session).contains(&"Twilight".to_owned()));
    // They are a step like any other.
    session.undo();
    assert_eq!((fs::read(&file).expect("it is there"), session.look().name.as_str()), (bytes, "Dusk"));
    assert!(std::mem::take(&mut session.browser.is_outdated), "the looks are read again");
    session.redo();
    assert_eq!((preset(&file).title, session.look().name.as_str()), (after.title, "Twilight"));
    assert!(session.browser.is_outdated && !session.look().is_changed());
    // What is broken meanwhile stays as it is, and the window says so.
    let id = id(session, &file);
    session.ask_title(id);
    fs::write(&file, "{").expect("it is writable");
    session.write_title();
    assert!(session.notes.present()[0].text.contains("dusk.json"));
    assert_eq!(fs::read_to_string(&file).expect("it is there"), "{");
}

#[test]
fn a_file_is_deleted_only_when_that_was_asked_and_undo_brings_it_back() {
    let folder = presets();
    let file = folder.path().join("dusk.json");
    let bytes = fs::read(&file).expect("it is there");
    let mut session = session(folder.path());
    session.browser.selected = Some(id(&session, &file));
    let mut harness = harness(session);
    click(&mut harness, Role::Button, "Delete…");
    let places = harness.query_all_by_label(&file.display().to_string()).count();
    assert_eq!(places, 2, "it is said where the file is, beside the card and where it is asked");
    click(&mut harness, Role::Button, "Keep it");
    assert!(file.exists() && harness.state().browser.deleting.is_none());
    click(&mut harness, Role::Button, "Delete…");
    click(&mut harness, Role::Button, "Delete the file");
    assert!(!file.exists() && harness.state().browser.is_outdated);
    // It is kept until the window is closed, whatever is opened meanwhile.
    let session = harness.state_mut();
    let picture = Document::open(&folder.path().join("picture.png"), &Options::default()).expect("a picture");
    session.show_playback(picture.playback().expect("a picture"));
    session.undo();
    assert_eq!(fs::read(&file).expect("it is back"), bytes);
    session.redo();
    assert!(!file.exists());
    // What somebody else has put there meanwhile stays.
    fs::write(&file, "theirs").expect("it is writable");
    session.undo();
    assert_eq!(fs::read_to_string(&file).expect("it is there"), "theirs");
    assert!(session.notes.present().iter().any(|note| note.is_bad && note.text.contains("somebody else")));
}

#[test]
fn a_look_is_saved_with_its_name_and_nothing_is_replaced_unasked() {
    let folder = presets();
    let mut session = session(folder.path());
    session.browser.is_open = false;
    session.choose(1);
    let looks = folder.path().join("new/mine");
    session.settings.look_folder = Some(looks.clone());
    session.save_look(false);
    let mut harness = harness(session);
    type_into(&mut harness, "Name", "Late Evening");
    type_into(&mut harness, "Tags", "calm");
    let file = looks.join("late-evening.json");
    assert_eq!(harness.state().dialogs.saving.as_ref().map(|saving| saving.file()), Some(file.clone()));
    click(&mut harness, Role::Button, "Save");
    let saved = preset(&file);
    assert_eq!(
        (saved.title.name.as_deref(), saved.title.tags.join("|")),
        (Some("Late Evening"), "calm".into())
    );
    let session = harness.state_mut();
    assert_eq!(
        (session.look().source.as_path(), session.look().name.as_str()),
        (file.as_path(), "Late Evening")
    );
    assert!(session.settings.look_folders.contains(&looks), "its folder is offered");
    // To its own file it is saved at once, under its name.
    let parameter = session
        .looks
        .parameters()
        .iter()
        .find(|parameter| matches!(parameter.default, Value::Float(_)))
        .expect("a number")
        .clone();
    session.set(&parameter, &parameter.default.others(&parameter.param.kind)[0]);
    session.save_look(false);
    assert!(session.dialogs.saving.is_none() && !session.look().is_changed());
    assert_eq!(preset(&file).title.name.as_deref(), Some("Late Evening"));
    // Another of that name asks first.
    session.choose(2);
    session.save_look(false);
    harness.run_ok();
    type_into(&mut harness, "Name", "Late Evening");
    click(&mut harness, Role::Button, "Save");
    assert!(harness.query_by_label_contains("to be replaced").is_some());
    assert_eq!(preset(&file).style, "cartoon");
    click(&mut harness, Role::Button, "Replace the file");
    assert_eq!(preset(&file).style, "ink");
    assert_eq!(harness.state().look().name, "Late Evening");
}

#[test]
fn looks_that_ship_are_copied_to_files_of_ones_own() {
    let folder = presets();
    let mut session = session(folder.path());
    session.settings.look_folder = Some(folder.path().to_owned());
    session.browser.selected = Some(id(&session, Path::new("look:linocut")));
    let mut harness = harness(session);
    assert!(harness.query_by_role_and_label(Role::Button, "Delete…").is_none());
    click(&mut harness, Role::Button, "Save a copy…");
    click(&mut harness, Role::Button, "Save");
    let copy = preset(&folder.path().join("linocut-copy.json"));
    let looks = file::looks().expect("the looks");
    let shipped = looks.iter().find(|look| look.id == "linocut").expect("it ships");
    let shipped = file::of_look(shipped).expect("it is a preset");
    assert_eq!(
        (copy.style, copy.params, copy.title.tags),
        (shipped.style, shipped.params, shipped.title.tags)
    );
    assert_eq!(copy.title.name.as_deref(), Some("Linocut copy"));
    assert_eq!(harness.state().look().source, Path::new("none"), "the window's look is as it was");
}

#[test]
fn a_card_has_a_menu() {
    let folder = presets();
    let mut session = session(folder.path());
    session.browser.selected = None;
    let mut harness = harness(session);
    harness.get_by_role_and_label(Role::Button, "Dusk").click_secondary();
    harness.run_ok();
    for item in ["Save a copy…", "Name and tags…", "Delete…", "Copy the file's path"] {
        assert!(harness.query_by_role_and_label(Role::Button, item).is_some(), "{item}");
    }
    click(&mut harness, Role::Button, "Mark to compare");
    assert_eq!(harness.state().browser.marked.len(), 1);
    assert!(harness.query_by_role_and_label(Role::Button, "Delete…").is_none(), "the menu is gone");
}

#[test]
fn up_to_six_looks_are_compared_and_one_is_taken() {
    let folder = presets();
    let mut harness = harness(session(folder.path()));
    let names = ["Original", "Dusk", "Copperplate", "Linocut", "Impasto", "Fresco"];
    assert!(harness.get_by_role_and_label(Role::Button, "Compare").accesskit_node().is_disabled());
    for name in names {
        click(&mut harness, Role::CheckBox, &format!("Compare {name}"));
    }
    click(&mut harness, Role::CheckBox, "Compare Enamel");
    let session = harness.state_mut();
    assert_eq!(session.browser.marked.len(), 6);
    assert!(session.notes.present()[0].text.contains("six") || session.notes.present()[0].text.contains('6'));
    click(&mut harness, Role::Button, "Compare 6");
    assert!(!harness.state().browser.is_open);
    for name in names {
        assert!(harness.query_by_role_and_label(Role::Button, &format!("Take {name}")).is_some(), "{name}");
    }
    // Another picture is seen by the same looks.
    let other = folder.path().join("picture.png");
    let document = Document::open(&other, &Options::default()).expect("a picture");
    harness.state_mut().show_playback(document.playback().expect("a picture"));
    harness.run_ok();
    assert!(harness.query_by_role_and_label(Role::Button, "Take Linocut").is_some());
    // Escape goes back to where it came from.
    widgets::keys::press(harness.state_mut(), &Key::Named(NamedKey::Escape));
    assert!(harness.state().browser.is_open && harness.state().browser.comparison.is_none());
    harness.state_mut().compare_marked();
    harness.run_ok();
    click(&mut harness, Role::Button, "Take Linocut");
    let session = harness.state_mut();
    assert_eq!((session.look().name.as_str(), session.is_covered()), ("Linocut", false));
    session.undo();
    assert_eq!(session.look().name, "Original");
}

#[test]
fn folders_are_added_and_taken_off_the_list() {
    let folder = presets();
    let mut harness = harness(session(folder.path()));
    click(&mut harness, Role::Button, "Add a folder…");
    assert_eq!(harness.state().work.requests(), [Request::Choose(Dialog::LookFolder)]);
    let shown: PathBuf = folder.path().components().collect();
    click(&mut harness, Role::Button, &format!("Remove {} from the list", shown.display()));
    assert!(harness.state().settings.look_folders.is_empty() && harness.state().browser.is_outdated);
}
