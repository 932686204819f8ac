//! Dialog of exports, in a window of its own.

use egui::{ComboBox, DragValue, RichText, TextEdit, Ui};

use super::choices::{self, Answer};
use super::{dialog, keyboard, theme};
use crate::state::document::kind::Kind;
use crate::state::formats::Replaced;
use crate::state::outcome::Dialog;
use crate::state::plan::{Plan, What};
use crate::state::session::Session;
use crate::state::work::Request;

/// Shows the window while something is to be exported.
pub fn show(context: &egui::Context, session: &mut Session) {
    let Some(mut plan) = session.dialogs.plan.take() else { return };
    let (mut open, mut closes) = (true, false);
    let mut request = None;
    dialog::show(context, "Export", Some(&mut open), |ui| {
        ui.set_width(460.0);
        choices::table(ui, "export", |ui| {
            kind(ui, &mut plan);
            size(ui, &mut plan);
            amount(ui, &mut plan, session.open.playback().map(|playback| playback.number()));
            if place(ui, &mut plan) {
                request = Some(Request::Choose(Dialog::Export));
            }
        });
        ui.add_space(10.0);
        let (name, is_busy) = (session.open.name(), session.work.exported.is_some());
        let ended = end(ui, &mut plan, name, is_busy);
        closes = ended == Some(Act::Cancel);
        request = (ended == Some(Act::Start)).then_some(Request::Export).or(request.take());
    });
    if open && !closes {
        session.dialogs.plan = Some(plan);
    }
    request.into_iter().for_each(|request| session.work.ask(request));
}

/// Kind of the export, and its format.
fn kind(ui: &mut Ui, plan: &mut Plan) {
    if plan.results().len() > 1 {
        ui.label("What");
        let mut what = plan.what;
        ui.horizontal(|ui| {
            for choice in plan.results() {
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
    let shown = ComboBox::from_id_salt("format").width(220.0).selected_text(plan.name_of(before));
    let shown = shown.show_ui(ui, |ui| {
        for known in plan.formats() {
            let name = plan.name_of(known);
            ui.selectable_value(&mut plan.format, known, name);
        }
    });
    keyboard::tell(&shown.response, &plan.name_of(before));
    shown.response.labelled_by(label.id);
    if plan.format != before {
        plan.rename();
    }
    ui.end_row();
}

/// Size, quality and bit depth.
fn size(ui: &mut Ui, plan: &mut Plan) {
    if plan.kind == Kind::Scene {
        scene_size(ui, plan);
    } else if !plan.is_among_layers() {
        choices::scaling(ui, &mut plan.choices);
    }
    if let Some(format) = plan.format.written().filter(|_| !plan.is_among_layers()) {
        choices::samples(ui, &mut plan.choices, format);
    }
}

/// Size of pictures of a scene, in pixels.
fn scene_size(ui: &mut Ui, plan: &mut Plan) {
    let label = ui.label("Size");
    ui.horizontal(|ui| {
        let [width, height] = &mut plan.size;
        ui.add(DragValue::new(width).range(1..=16384)).labelled_by(label.id).on_hover_text("Width");
        ui.label("×");
        ui.add(DragValue::new(height).range(1..=16384)).labelled_by(label.id).on_hover_text("Height");
        for (name, size) in [("1080p", [1920, 1080]), ("4K", [3840, 2160])] {
            let hint = format!("{} × {} pixels", size[0], size[1]);
            if ui.selectable_label(plan.size == size, name).on_hover_text(hint).clicked() {
                plan.size = size;
            }
        }
    });
    ui.end_row();
}

/// Frames that are made, and how many a second.
fn amount(ui: &mut Ui, plan: &mut Plan, now: Option<i64>) {
    let count = match plan.what {
        What::Turntable => Some(0),
        What::Animation => Some(1),
        What::Picture | What::Frames => None,
    };
    if let Some(at) = count {
        let label = ui.label("Frames");
        ui.add(DragValue::new(&mut plan.counts[at]).range(1..=100_000)).labelled_by(label.id);
        ui.end_row();
    } else if plan.has_range() {
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
    if plan.has_rate() {
        let label = ui.label("Frame rate");
        let rate = DragValue::new(&mut plan.rate).range(1.0..=240.0).speed(0.2).max_decimals(3);
        ui.add(rate.suffix(" per second")).labelled_by(label.id);
        ui.end_row();
    }
}

/// Place that it goes to; says whether that is to be chosen in a dialog.
fn place(ui: &mut Ui, plan: &mut Plan) -> bool {
    let label = ui.label("File");
    let clicked = ui.horizontal(|ui| {
        let field = ui.add(TextEdit::singleline(&mut plan.path).desired_width(290.0)).labelled_by(label.id);
        if field.changed() {
            plan.follow_name();
        }
        ui.button("Choose…").clicked()
    });
    ui.end_row();
    clicked.inner
}

/// Choice that ends the dialog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Act {
    Start,
    Cancel,
}

/// Remarks on it, and the buttons; or the question whether files may be replaced.
fn end(ui: &mut Ui, plan: &mut Plan, name: &str, is_busy: bool) -> Option<Act> {
    if let Some(replaced) = plan.asks {
        let answer = choices::question(ui, &question(plan, name, replaced), replaced)?;
        if answer == Answer::Cancel {
            plan.asks = None;
            return None;
        }
        return Some(Act::Start);
    }
    let problem = plan.problem().or(is_busy.then_some("Another export is running."));
    if let Some(problem) = problem {
        ui.label(RichText::new(problem).color(theme::BAD));
    } else if plan.is_several_files() {
        ui.label(RichText::new("#### is the place of the frame's number.").color(theme::FAINT));
    }
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        if dialog::confirm(ui, "Start the export", problem.is_none()) && plan.may_begin() {
            return Some(Act::Start);
        }
        ui.button("Cancel").clicked().then_some(Act::Cancel)
    })
    .inner
}

/// Question whether files may be replaced.
fn question(plan: &Plan, name: &str, replaced: Replaced) -> String {
    match (replaced, plan.kind) {
        (Replaced::Original, Kind::Picture) => {
            format!("This replaces the photograph you opened, {name}. It cannot be brought back.")
        }
        (Replaced::Original, _) => {
            format!("This replaces the pictures you opened, {name}. They cannot be brought back.")
        }
        (Replaced::Others(1), _) => {
            let file = std::path::Path::new(&plan.path).file_name().unwrap_or_default().to_string_lossy();
            format!("There is a file of this name already, {file}. Replace it?")
        }
        (Replaced::Others(count), _) => {
            format!("{count} of these files are there already. Replace them?")
        }
    }
}
