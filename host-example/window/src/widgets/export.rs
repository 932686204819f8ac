//! Dialog of exports, in a window of its own.

use egui::{ComboBox, DragValue, Grid, RichText, TextEdit, Ui};

use super::{dialog, keyboard, theme};
use crate::state::document::kind::Kind;
use crate::state::outcome::Dialog;
use crate::state::plan::{Plan, What};
use crate::state::session::Session;
use crate::state::work::Request;

/// Shows the window while something is to be exported.
pub fn show(context: &egui::Context, session: &mut Session) {
    let Some(mut plan) = session.dialogs.plan.take() else { return };
    let mut open = true;
    let mut request = None;
    dialog::show(context, "Export", Some(&mut open), |ui| {
        ui.set_width(460.0);
        Grid::new("export").num_columns(2).spacing([18.0, 8.0]).show(ui, |ui| {
            kind(ui, &mut plan);
            amount(ui, &mut plan, session.open.playback().map(|playback| playback.number()));
            if place(ui, &mut plan) {
                request = Some(Request::Choose(Dialog::Export));
            }
        });
        ui.add_space(10.0);
        request = end(ui, &plan, session.work.exported.is_some()).or(request.take());
    });
    if open {
        session.dialogs.plan = Some(plan);
    }
    request.into_iter().for_each(|request| session.work.ask(request));
}

/// Kind of the export, and its format.
fn kind(ui: &mut Ui, plan: &mut Plan) {
    if plan.choices().len() > 1 {
        ui.label("What");
        let mut what = plan.what;
        ui.horizontal(|ui| {
            for choice in plan.choices() {
                ui.selectable_value(&mut what, *choice, choice.name());
            }
        });
        if what != plan.what {
            plan.choose(what);
        }
        ui.end_row();
    }
    let label = ui.label("Format");
    let before = plan.format;
    let shown = ComboBox::from_id_salt("format").selected_text(format(before)).show_ui(ui, |ui| {
        for known in plan.formats() {
            ui.selectable_value(&mut plan.format, known, format(known));
        }
    });
    keyboard::tell(&shown.response, &format(before));
    shown.response.labelled_by(label.id);
    if plan.format != before {
        plan.rename();
    }
    ui.end_row();
}

/// Name of a format for people.
fn format(extension: &str) -> String {
    match extension {
        "jpg" => "JPEG".into(),
        "tif" => "TIFF".into(),
        "png" | "exr" => extension.to_uppercase(),
        video => format!("Video ({})", video.to_uppercase()),
    }
}

/// Amount that is made: size and frames.
fn amount(ui: &mut Ui, plan: &mut Plan, now: Option<i64>) {
    if let [What::Picture, ..] = plan.choices()
        && plan.counts[0] > 0
        && plan.choices().len() > 1
    {
        let label = ui.label("Size");
        ui.horizontal(|ui| {
            let [width, height] = &mut plan.size;
            ui.add(DragValue::new(width).range(1..=16384)).labelled_by(label.id).on_hover_text("Width");
            ui.label("×");
            ui.add(DragValue::new(height).range(1..=16384)).labelled_by(label.id).on_hover_text("Height");
            ui.label(RichText::new("pixels").color(theme::FAINT));
        });
        ui.end_row();
    }
    let count = match plan.what {
        What::Turntable => Some(0),
        What::Animation => Some(1),
        What::Picture | What::Frames => None,
    };
    if let Some(at) = count {
        let label = ui.label("Frames");
        ui.add(DragValue::new(&mut plan.counts[at]).range(1..=100_000)).labelled_by(label.id);
        ui.end_row();
    } else if !plan.numbers.is_empty() && plan.kind == Kind::Sequence {
        let range = plan.numbers[0]..=plan.numbers[plan.numbers.len() - 1];
        let label = ui.label("Frames");
        ui.horizontal(|ui| {
            ui.add(DragValue::new(&mut plan.first).range(range.clone())).labelled_by(label.id);
            ui.label("to");
            ui.add(DragValue::new(&mut plan.last).range(range.clone())).labelled_by(label.id);
            if ui.button("All").clicked() {
                (plan.first, plan.last) = (*range.start(), *range.end());
            }
            if let Some(now) = now
                && ui.button("This one").clicked()
            {
                (plan.first, plan.last) = (now, now);
            }
        });
        ui.end_row();
    }
}

/// Place that it goes to; says whether that is to be chosen in a dialog.
fn place(ui: &mut Ui, plan: &mut Plan) -> bool {
    let label = ui.label("File");
    let clicked = ui.horizontal(|ui| {
        ui.add(TextEdit::singleline(&mut plan.path).desired_width(290.0)).labelled_by(label.id);
        ui.button("Choose…").clicked()
    });
    ui.end_row();
    clicked.inner
}

/// Remarks on it, and the buttons.
fn end(ui: &mut Ui, plan: &Plan, is_busy: bool) -> Option<Request> {
    let problem = plan.problem().or(is_busy.then_some("Another export is running."));
    if let Some(problem) = problem {
        ui.label(RichText::new(problem).color(theme::BAD));
    } else if plan.replaces() {
        ui.label(RichText::new("The file is there already and will be replaced.").color(theme::ACCENT));
    } else if plan.is_several_files() {
        ui.label(RichText::new("#### is the place of the frame's number.").color(theme::FAINT));
    }
    ui.add_space(4.0);
    dialog::confirm(ui, "Start the export", problem.is_none()).then_some(Request::Export)
}
