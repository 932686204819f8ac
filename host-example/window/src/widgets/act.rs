//! Actions that the controls of the browser ask for.

use std::path::PathBuf;

use egui::Ui;

use crate::state::session::Session;

/// One of the things that can be done with looks.
#[derive(Clone, Debug, PartialEq)]
pub enum Act {
    /// Show this look.
    Apply(u64),
    /// Show this look and the picture.
    ApplyAndClose(u64),
    /// Mark it to be compared, or no more.
    Mark(u64),
    /// Make it a favourite, or no more.
    Star(u64),
    /// Ask for its name and tags.
    Title(u64),
    /// Ask for the name of a copy.
    Copy(u64),
    /// Ask whether its file is to be deleted.
    Delete(PathBuf),
    /// Offer the looks of a folder no more.
    RemoveFolder(PathBuf),
}

/// Does what the controls ask for, after which they show something else.
pub fn perform(ui: &Ui, session: &mut Session, act: Act) {
    ui.ctx().request_repaint();
    match act {
        Act::Apply(id) => session.apply(id, false),
        Act::ApplyAndClose(id) => session.apply(id, true),
        Act::Mark(id) => session.mark(id),
        Act::Star(id) => session.star(id),
        Act::Title(id) => session.ask_title(id),
        Act::Copy(id) => session.ask_copy(id),
        Act::Delete(file) => session.browser.deleting = Some(file),
        Act::RemoveFolder(folder) => {
            session.settings.remove_look_folder(&folder);
            session.browser.is_outdated = true;
        }
    }
}
