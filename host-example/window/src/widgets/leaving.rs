//! The question whether the window may be closed, in front of everything, while something would be lost.

use egui::{Button, Context, RichText, Ui};

use super::{dialog, theme};
use crate::state::command;
use crate::state::leaving::Leaving;
use crate::state::session::Session;

/// Width in points.
const WIDTH: f32 = 420.0;
/// Most looks that are named.
const MOST: usize = 4;

/// Choices that the question offers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Choice {
    Save,
    Copy,
    Wait,
    Close,
    Cancel,
}

/// Shows the question while it is asked.
pub fn show(context: &Context, session: &mut Session) {
    if !session.dialogs.leaving.is_shown() {
        return;
    }
    egui::Popup::close_all(context);
    let choice = dialog::show(context, "Close the window?", None, |ui| {
        ui.set_width(WIDTH.min(context.content_rect().width() - 60.0));
        reasons(ui, session);
        ui.add_space(12.0);
        ui.horizontal_wrapped(|ui| choices(ui, session)).inner
    });
    match choice {
        Some(Choice::Save) => session.save_and_leave(),
        Some(Choice::Copy) => {
            context.copy_text(command::copied(session));
            session.dialogs.leaving = Leaving::Stays;
        }
        Some(Choice::Wait) => session.dialogs.leaving = Leaving::Waits,
        Some(Choice::Close) => session.dialogs.leaving = Leaving::Closes,
        Some(Choice::Cancel) => session.dialogs.leaving = Leaving::Stays,
        None => return,
    }
    context.request_repaint();
}

/// Lists what would be lost, or what is waited for.
fn reasons(ui: &mut Ui, session: &Session) {
    let mut say = |text: String| ui.add(egui::Label::new(text).wrap());
    let percent = session.work.exported.map(|share| format!("{:.0} %", (share * 100.0).floor()));
    match (session.dialogs.leaving, &percent) {
        (Leaving::Closes, _) => {
            say("The export is being ended.".into());
            return;
        }
        (Leaving::Waits, Some(percent)) => {
            say(format!("It closes when the export is done, of which there is {percent}."));
        }
        (_, Some(percent)) => {
            say(format!(
                "An export is running, {percent} of it done. Closing ends it, and removes what is not whole."
            ));
        }
        (_, None) => {}
    }
    let unsaved = session.looks.unsaved();
    let names = unsaved.iter().take(MOST).map(|index| format!("“{}”", session.looks.list()[*index].name));
    let names = names.collect::<Vec<_>>().join(", ");
    match unsaved.len() {
        0 if percent.is_none() && !session.has_changed_scene() && session.unsaved_maps().is_empty() => {
            drop(say("Nothing would be lost.".into()))
        }
        0 => {}
        1 => drop(say(format!("The look {names} is not saved."))),
        count if count <= MOST => drop(say(format!("{count} looks are not saved: {names}."))),
        count => drop(say(format!("{count} looks are not saved: {names} and {} more.", count - MOST))),
    }
    for (name, kind) in session.unsaved_maps() {
        let text = format!("The {} that was painted over {name} is not saved.", kind.name());
        ui.add(egui::Label::new(text).wrap());
    }
    if session.has_changed_scene() {
        let text = "The camera or the light of the scene was changed. Only its command line keeps them.";
        ui.add(egui::Label::new(text).wrap());
    }
    if session.work.exported.is_some() {
        ui.ctx().request_repaint_after(std::time::Duration::from_millis(200));
    }
}

/// The buttons. Return presses the first, which loses nothing, unless Tab has gone to another; Escape cancels.
fn choices(ui: &mut Ui, session: &Session) -> Option<Choice> {
    let unsaved = session.looks.unsaved().len();
    let is_exporting = session.work.exported.is_some();
    let is_changed = session.has_changed_scene();
    let is_painted = !session.unsaved_maps().is_empty();
    let is_lost = unsaved > 0 || (is_changed || is_painted) && !is_exporting;
    let close = match (is_lost, is_exporting) {
        (true, _) => "Discard and close",
        (false, true) => "End the export and close",
        (false, false) => "Close",
    };
    let offered: &[(Choice, &str)] = match session.dialogs.leaving {
        Leaving::Closes => &[],
        Leaving::Waits => &[(Choice::Cancel, "Cancel"), (Choice::Close, close)],
        _ if unsaved > 0 => {
            &[(Choice::Save, "Save the look…"), (Choice::Close, close), (Choice::Cancel, "Cancel")]
        }
        _ if is_exporting => {
            &[(Choice::Wait, "Close when it is done"), (Choice::Close, close), (Choice::Cancel, "Cancel")]
        }
        _ if is_changed => {
            &[(Choice::Copy, "Copy the command line"), (Choice::Close, close), (Choice::Cancel, "Cancel")]
        }
        // What loses nothing is first.
        _ if is_painted => &[(Choice::Cancel, "Cancel"), (Choice::Close, close)],
        _ => &[(Choice::Close, close), (Choice::Cancel, "Cancel")],
    };
    let mut choice = None;
    let mut buttons = Vec::new();
    for (index, (means, text)) in offered.iter().enumerate() {
        let loses = *means == Choice::Close && (unsaved > 0 || is_exporting || is_changed || is_painted);
        let text = RichText::new(*text);
        let button = Button::new(if loses { text.color(theme::BAD) } else { text });
        let button = ui.add(if index == 0 { button.fill(theme::CHOSEN) } else { button });
        if button.clicked() {
            choice = Some(*means);
        }
        buttons.push(button);
    }
    if !buttons.iter().any(egui::Response::has_focus)
        && let Some(first) = buttons.first()
    {
        first.request_focus();
    }
    choice
}
