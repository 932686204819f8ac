//! Windows of the browser: a look is saved, its name and tags are changed, its file is deleted.

use egui::{Context, Grid, RichText, TextEdit, Ui};

use super::{dialog, theme};
use crate::state::browser::title_edit::Words;
use crate::state::outcome::Dialog;
use crate::state::session::Session;
use crate::state::work::Request;

/// Width of windows with text fields in points.
const WIDTH: f32 = 460.0;
/// Width of text fields in points.
const FIELD: f32 = 340.0;

/// Shows those that are open.
pub fn show(context: &Context, session: &mut Session) {
    saving(context, session);
    title_edit(context, session);
    deleting(context, session);
}

/// Fields for name, description and tags; says whether the name was changed.
fn fields(ui: &mut Ui, words: &mut Words) -> bool {
    let field = |ui: &mut Ui, label: &str, text: &mut String, hint: &'static str| {
        let label = ui.label(label);
        let edit = TextEdit::singleline(text).desired_width(FIELD).hint_text(hint).char_limit(500);
        let changed = ui.add(edit).labelled_by(label.id).changed();
        ui.end_row();
        changed
    };
    let renamed = field(ui, "Name", &mut words.name, "");
    field(ui, "Description", &mut words.about, "What it looks like");
    field(ui, "Tags", &mut words.tags, "Words with commas between them");
    renamed
}

fn saving(context: &Context, session: &mut Session) {
    let Some(mut saving) = session.dialogs.saving.take() else { return };
    let (mut open, mut closes, mut done, mut chooses) = (true, false, false, false);
    let title = if saving.is_present { "Save the look" } else { "Save a copy" };
    dialog::show(context, title, Some(&mut open), |ui| {
        ui.set_width(WIDTH);
        Grid::new("saving").num_columns(2).spacing([18.0, 8.0]).show(ui, |ui| {
            if fields(ui, &mut saving.words) {
                saving.rename();
            }
            let label = ui.label("File");
            ui.horizontal(|ui| {
                let edit = TextEdit::singleline(&mut saving.path).desired_width(FIELD - 88.0);
                if ui.add(edit).labelled_by(label.id).changed() {
                    saving.place(None);
                }
                chooses = ui.button("Choose…").clicked();
            });
            ui.end_row();
        });
        ui.add_space(8.0);
        if let Some(problem) = &saving.problem {
            ui.label(RichText::new(problem).color(theme::BAD));
        } else if saving.asks {
            ui.label(
                RichText::new("There is a file of this name. Is it to be replaced?").color(theme::ACCENT),
            );
        }
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            let text = if saving.asks { "Replace the file" } else { "Save" };
            done = dialog::confirm(ui, text, true);
            closes = ui.button("Cancel").clicked();
        });
    });
    if open && !closes {
        session.dialogs.saving = Some(saving);
    }
    if chooses {
        session.work.ask(Request::Choose(Dialog::Save));
    }
    if done {
        session.finish_saving();
        context.request_repaint();
    }
}

fn title_edit(context: &Context, session: &mut Session) {
    let Some(mut title_edit) = session.browser.title_edit.take() else { return };
    let (mut open, mut closes, mut done) = (true, false, false);
    dialog::show(context, "Name and tags", Some(&mut open), |ui| {
        ui.set_width(WIDTH);
        Grid::new("title_edit").num_columns(2).spacing([18.0, 8.0]).show(ui, |ui| {
            fields(ui, &mut title_edit.words);
        });
        file(ui, &title_edit.file);
        ui.horizontal(|ui| {
            done = dialog::confirm(ui, "Save", true);
            closes = ui.button("Cancel").clicked();
        });
    });
    if open && !closes {
        session.browser.title_edit = Some(title_edit);
    }
    if done {
        session.write_title();
        context.request_repaint();
    }
}

fn deleting(context: &Context, session: &mut Session) {
    let Some(path) = session.browser.deleting.take() else { return };
    let (mut open, mut closes, mut done) = (true, false, false);
    dialog::show(context, "Delete this look?", Some(&mut open), |ui| {
        ui.set_max_width(FIELD + 90.0);
        ui.label("The file is deleted from the disk. Undo brings it back until the window is closed.");
        file(ui, &path);
        ui.horizontal(|ui| {
            done = ui.button(RichText::new("Delete the file").color(theme::BAD)).clicked();
            let keep = ui.button("Keep it");
            // Enter must not delete anything that nobody has gone to.
            dialog::begin_with(&keep);
            closes = keep.clicked();
        });
    });
    if open && !closes {
        session.browser.deleting = Some(path);
    }
    if done {
        session.delete();
        context.request_repaint();
    }
}

/// Path of a file.
fn file(ui: &mut Ui, path: &std::path::Path) {
    ui.add_space(6.0);
    ui.add(egui::Label::new(RichText::new(path.display().to_string()).small().color(theme::FAINT)).wrap());
    ui.add_space(6.0);
}
