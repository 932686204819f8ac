//! Dialog of one look on several pictures, in a window of its own.

use egui::{ComboBox, RichText, TextEdit, Ui};

use super::choices::{self, Answer};
use super::{dialog, keyboard, theme};
use crate::state::batch::Batch;
use crate::state::formats::{PICTURES, Replaced};
use crate::state::outcome::Dialog;
use crate::state::session::Session;
use crate::state::work::Request;
use isophote_finishing::writing::FileKind;

/// Request of the dialog, or its end.
enum Act {
    Ask(Request),
    OpenSequence,
    Close,
}

/// Shows the window while pictures are there that the look can be used on.
pub fn show(context: &egui::Context, session: &mut Session) {
    let Some(mut batch) = session.dialogs.batch.take() else { return };
    let (mut open, mut act) = (true, None);
    let title = format!("Use this look on {} pictures", batch.pictures.len());
    dialog::show(context, &title, Some(&mut open), |ui| {
        ui.set_width(480.0);
        content(ui, &mut batch, session, &mut act);
    });
    match act {
        Some(Act::Ask(request)) => session.work.ask(request),
        Some(Act::OpenSequence) => {
            open = false;
            batch.sequence.take().into_iter().for_each(|pattern| session.work.ask(Request::Open(pattern)));
        }
        Some(Act::Close) => open = false,
        None => {}
    }
    if open {
        session.dialogs.batch = Some(batch);
    }
}

fn content(ui: &mut Ui, batch: &mut Batch, session: &Session, act: &mut Option<Act>) {
    if let Some(sequence) = &batch.sequence {
        let name = sequence.file_name().unwrap_or_default().to_string_lossy().into_owned();
        ui.label(
            RichText::new(format!("They are numbered, and can be one sequence: {name}")).color(theme::FAINT),
        );
        let button = ui.button("Open as one sequence");
        if button.on_hover_text("Frames of one shot, which play and are exported together").clicked() {
            *act = Some(Act::OpenSequence);
        }
        ui.add_space(8.0);
    }
    let before = (batch.kind, batch.folder.clone());
    choices::table(ui, "batch", |ui| {
        ui.label("Look");
        ui.label(RichText::new(&session.look().name).color(theme::BRIGHT));
        ui.end_row();
        kind(ui, batch);
        if !batch.are_among_layers() {
            choices::scaling(ui, &mut batch.choices);
        }
        if let Some(format) = batch.format().filter(|_| !batch.are_among_layers()) {
            choices::samples(ui, &mut batch.choices, format);
        }
        let label = ui.label("Folder");
        ui.horizontal(|ui| {
            ui.add(TextEdit::singleline(&mut batch.folder).desired_width(300.0)).labelled_by(label.id);
            if ui.button("Choose…").clicked() {
                *act = Some(Act::Ask(Request::Choose(Dialog::SeveralTo)));
            }
        });
        ui.end_row();
    });
    if before != (batch.kind, batch.folder.clone()) {
        batch.asks = None;
    }
    ui.add_space(8.0);
    end(ui, batch, session, act);
}

/// Kind of the files.
fn kind(ui: &mut Ui, batch: &mut Batch) {
    const OWN: &str = "As each picture";
    let label = ui.label("Format");
    let kinds = PICTURES.iter().filter_map(|format| Some((FileKind::of(format.extension)?, format.name)));
    let name = kinds.clone().find(|(kind, _)| Some(*kind) == batch.kind).map_or(OWN, |(_, name)| name);
    let shown = ComboBox::from_id_salt("kind").selected_text(name).show_ui(ui, |ui| {
        ui.selectable_value(&mut batch.kind, None, OWN);
        for (kind, name) in kinds {
            ui.selectable_value(&mut batch.kind, Some(kind), name);
        }
    });
    keyboard::tell(&shown.response, name);
    shown.response.labelled_by(label.id);
    ui.end_row();
}

/// Remarks, and the buttons.
fn end(ui: &mut Ui, batch: &mut Batch, session: &Session, act: &mut Option<Act>) {
    if let Some(replaced) = batch.asks {
        let text = match replaced {
            Replaced::Original => {
                "This replaces the pictures that you chose. The originals cannot be brought back.".to_owned()
            }
            Replaced::Others(1) => "One file of these names is in the folder already. Replace it?".to_owned(),
            Replaced::Others(count) => {
                format!("{count} files of these names are in the folder already. Replace them?")
            }
        };
        match choices::question(ui, &text, replaced) {
            Some(Answer::Replace) => *act = Some(Act::Ask(Request::UseOnSeveral)),
            Some(Answer::Cancel) => batch.asks = None,
            None => {}
        }
        return;
    }
    let is_busy = session.work.exported.is_some();
    let has_none = session.look().is_plain();
    let problem = batch
        .problem()
        .or(has_none.then_some("Choose a look first."))
        .or(is_busy.then_some("Another export is running."));
    match problem {
        Some(problem) => ui.label(RichText::new(problem).color(theme::BAD)),
        None => ui.label(RichText::new("Every result keeps the name of its picture.").color(theme::FAINT)),
    };
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        if dialog::confirm(ui, "Use the look on all", problem.is_none()) && batch.may_begin() {
            *act = Some(Act::Ask(Request::UseOnSeveral));
        }
        if ui.button("Cancel").clicked() {
            *act = Some(Act::Close);
        }
    });
}
