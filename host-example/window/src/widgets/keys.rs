//! Keys and what they do. The help of the program and of the window say so too.

use winit::keyboard::{Key, NamedKey};

use crate::state::browser::Step;
use crate::state::session::Session;
use crate::state::viewport::Compare;

/// Keys and what they do, for the help of the program and of the window.
pub const KEYS: [(&str, &str); 42] = [
    ("drag", "turns the scene; moves a picture"),
    ("Shift+drag", "pans, as other buttons do"),
    ("wheel", "zooms"),
    ("wheel (slider)", "changes a slider on which the pointer has rested; with Shift finely"),
    ("double click", "on a name in the panel: sets it back to the look, then to the style"),
    ("Ctrl+wheel", "magnifies the pixels under the pointer"),
    ("Ctrl+drag", "moves what is magnified"),
    ("1, 2, ...", "show the style of that number"),
    ("n, Shift+n", "show the next style, and the one before"),
    ("Tab, Shift+Tab", "go to the next control, and to the one before"),
    ("Enter, Space", "press the control that has the focus"),
    ("arrows", "move the slider that has the focus; with Shift less"),
    ("Home, End", "move it to its ends"),
    ("l", "shows all looks as they make this picture, and the picture again"),
    ("arrows, Enter", "among the looks: go from card to card; take one"),
    ("letters", "among the looks: search"),
    ("*", "among the looks: makes one a favourite, or no more"),
    ("Ctrl+M", "among the looks: marks one to be compared, or no more"),
    ("Ctrl+Enter", "among the looks: compares those that are marked"),
    ("\\ (hold)", "shows the original while it is held"),
    ("w", "compares by a wipe"),
    ("e", "compares side by side"),
    ("d", "shows the difference to the original, made stronger"),
    ("z", "shows pixels as large as the screen's, or all of the picture"),
    ("0", "shows all of the picture"),
    ("Space", "plays and pauses"),
    ("Left, Right", "show the frame before and the next"),
    ("Page Up, Page Down", "open the file before and the next of the folder; the look stays"),
    ("f", "frames the scene"),
    ("c", "looks through the file's camera"),
    ("b", "paints with the brush, and no more; Alt erases, other buttons move the picture"),
    ("[, ]", "make the brush smaller and larger"),
    ("p", "hides and shows the panel"),
    ("h", "hides and shows the histogram"),
    ("Ctrl+Z, Ctrl+Y", "takes the last step back, and takes it again"),
    ("Ctrl+O", "opens a file"),
    ("Ctrl+E", "asks what is to be exported"),
    ("Ctrl+S", "saves the look; with Shift under another name"),
    ("r", "goes back to the look as it was chosen; pressed again, to the defaults of its style"),
    ("?", "shows and hides the help"),
    ("Escape", "closes what is open in front: a dialog, the help, the looks"),
    ("Ctrl+Q", "closes the window, and asks before if something would be lost"),
];

/// A key was pressed, without Ctrl.
pub fn press(session: &mut Session, key: &Key) {
    if *key == Key::Named(NamedKey::Escape) {
        return session.close_front();
    }
    let is_help = matches!(key.as_ref(), Key::Named(NamedKey::F1) | Key::Character("?"));
    if is_help && !session.dialogs.leaving.is_shown() && (session.dialogs.shows_help || !session.has_dialog())
    {
        session.dialogs.shows_help = !session.dialogs.shows_help;
        return;
    }
    let is_elsewhere = session.dialogs.leaving.is_shown() || session.has_dialog();
    if is_elsewhere || session.is_covered() && !cover(session, key) {
        return;
    }
    let toggled = |now: Compare, wanted: Compare| if now == wanted { Compare::Off } else { wanted };
    match key.as_ref() {
        Key::Named(NamedKey::Space) => session.open.toggle_playing(),
        Key::Named(key @ (NamedKey::ArrowLeft | NamedKey::ArrowRight)) => {
            if let Some(playback) = session.open.playback_mut() {
                playback.step(if key == NamedKey::ArrowLeft { -1 } else { 1 });
            }
        }
        Key::Character("n") if session.open.has_picture() => session.choose_next(),
        Key::Character("N") if session.open.has_picture() => session.choose_before(),
        Key::Character("l") => session.toggle_browser(),
        Key::Character("f") => session.frame_all(),
        Key::Character("c") => {
            if let Some(scenery) = session.open.scenery_mut() {
                scenery.use_file_camera();
            }
        }
        Key::Character("w") => session.viewport.compare = toggled(session.viewport.compare, Compare::Wipe),
        Key::Character("e") => session.viewport.compare = toggled(session.viewport.compare, Compare::Side),
        Key::Character("d") => {
            session.viewport.compare = toggled(session.viewport.compare, Compare::Difference);
        }
        Key::Named(NamedKey::PageUp) => session.open_beside(-1),
        Key::Named(NamedKey::PageDown) => session.open_beside(1),
        Key::Character("z") => session.viewport.toggle_actual(),
        Key::Character("0") => session.viewport.fit(),
        Key::Character("b") if session.open.playback().is_some() => {
            session.painting.is_on = !session.painting.is_on;
        }
        Key::Character("[") => session.painting.brush.grow(-1.0),
        Key::Character("]") => session.painting.brush.grow(1.0),
        Key::Character("p") => session.settings.panel_hidden = !session.settings.panel_hidden,
        Key::Character("h") => session.settings.shows_histogram = !session.settings.shows_histogram,
        Key::Character("r") => session.reset_all(),
        Key::Character(text) => {
            if let Some(number) = text.parse::<usize>().ok().filter(|number| *number > 0) {
                session.choose(number - 1);
            }
        }
        _ => {}
    }
}

/// Handles a key where looks are shown instead of the picture; says whether it is left to do what it does on the picture.
fn cover(session: &mut Session, key: &Key) -> bool {
    if session.browser.comparison.is_some() {
        return matches!(key.as_ref(), Key::Character("l" | "z" | "0"));
    }
    match key.as_ref() {
        Key::Named(NamedKey::ArrowLeft) => session.browser.step(Step::Left),
        Key::Named(NamedKey::ArrowRight) => session.browser.step(Step::Right),
        Key::Named(NamedKey::ArrowUp) => session.browser.step(Step::Up),
        Key::Named(NamedKey::ArrowDown) => session.browser.step(Step::Down),
        Key::Named(NamedKey::Enter) => {
            if let Some(id) = session.browser.selected {
                session.apply(id, true);
            }
        }
        Key::Character("*") => {
            if let Some(id) = session.browser.selected {
                session.star(id);
            }
        }
        Key::Character(text) if text.chars().all(char::is_alphanumeric) => session.browser.search(text),
        _ => {}
    }
    false
}

/// Marks the selected look to be compared, or no more.
pub fn mark(session: &mut Session) {
    if let Some(id) = session.browser.selected.filter(|_| session.browser.is_open) {
        session.mark(id);
    }
}

/// Compares the looks that are marked.
pub fn compare(session: &mut Session) {
    if session.browser.is_open {
        session.compare_marked();
    }
}
