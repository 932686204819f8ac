//! The bar at the bottom: time, what is under the pointer, magnification and brightness.

use egui::{Button, RichText, Ui, vec2};

use super::number::Number;
use super::{ends, keyboard, probe, theme};
use crate::state::running::Running;
use crate::state::session::Session;
use crate::state::work::Request;

/// Shows the bar.
pub fn show(ui: &mut Ui, session: &mut Session) {
    let right: ends::End = |ui, session| {
        if session.open.has_picture() {
            magnification(ui, session);
        }
    };
    ends::show(ui, session, ("bottom", 22.0, right), |ui, session| {
        if let Some(share) = session.work.exported {
            let text = session.work.running.as_ref().map_or_else(|| "Exporting".to_owned(), Running::words);
            ui.add(egui::ProgressBar::new(share).desired_width(240.0).text(text));
            if ui.button("Cancel").clicked() {
                session.work.ask(Request::CancelExport);
            }
        }
        if session.open.has_picture() {
            beside(ui, session);
            timeline(ui, session);
            frames(ui, session);
            if !session.is_covered() {
                probe::show(ui, session);
            }
        } else {
            ui.label(RichText::new(&session.record.adapter).small().color(theme::FAINT));
        }
    });
}

/// Place of the file in its folder, and the way to the others.
fn beside(ui: &mut Ui, session: &mut Session) {
    let Some((index, count)) = session.beside.place().filter(|(_, count)| *count > 1) else { return };
    let mut step = |ui: &mut Ui, text: &str, name: &str, hint: &str, by: i64| {
        let button = ui.add(Button::new(text)).on_hover_text(hint);
        button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
        if button.clicked() {
            session.open_beside(by);
        }
    };
    step(ui, "‹", "File before", "The file before in the folder (Page Up)", -1);
    let place = format!("{} of {count}", index + 1);
    ui.label(RichText::new(place).color(theme::FAINT)).on_hover_text("Files of this folder");
    step(ui, "›", "Next file", "The next file in the folder (Page Down)", 1);
    ui.add_space(10.0);
}

fn timeline(ui: &mut Ui, session: &mut Session) {
    let Some(scenery) = session.open.scenery_mut() else { return };
    let (time, length) = scenery.time();
    if length <= 0.0 {
        return;
    }
    let text = if scenery.playing { "⏸" } else { "▶" };
    let hint = if scenery.playing { "Pause (Space)" } else { "Play (Space)" };
    let play = ui.add(Button::new(text)).accessible_name(if scenery.playing { "Pause" } else { "Play" });
    if play.on_hover_text(hint).clicked() {
        scenery.toggle_playing();
    }
    let mut now = time;
    ui.spacing_mut().slider_width = 220.0;
    let slider = keyboard::slider(ui, &mut now, 0.0..=length, |slider| slider.show_value(false));
    let slider = slider.on_hover_text("Time");
    slider.widget_info(|| egui::WidgetInfo::slider(true, f64::from(time), "Time"));
    if slider.changed() {
        scenery.seek(now);
    }
    ui.label(RichText::new(format!("{time:.2} of {length:.2} s")).monospace().color(theme::FAINT));
    ui.add_space(10.0);
}

/// Time of sequences and videos, by their frames.
fn frames(ui: &mut Ui, session: &mut Session) {
    let Some(playback) = session.open.playback_mut() else { return };
    let Some(frames) = playback.frames().cloned() else {
        if let Some(pattern) = playback.info().sequence() {
            let name = pattern.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if ui.button(format!("Open all of {name}")).clicked() {
                session.work.ask(Request::Open(pattern));
            }
        }
        return;
    };
    let text = if playback.playing { "⏸" } else { "▶" };
    let play = ui.add(Button::new(text)).accessible_name(if playback.playing { "Pause" } else { "Play" });
    if play.on_hover_text("Play and pause (Space)").clicked() {
        playback.toggle_playing();
    }
    for (text, name, key, by) in [("⏴", "The frame before", "←", -1), ("⏵", "The next frame", "→", 1)]
    {
        let button = ui.add(Button::new(text)).accessible_name(name);
        if button.on_hover_text(format!("{name} ({key})")).clicked() {
            playback.step(by);
        }
    }
    let mut number = playback.number();
    ui.spacing_mut().slider_width = 220.0;
    let range = frames.first()..=frames.last();
    let rail = keyboard::slider(ui, &mut number, range, |slider| slider.show_value(false));
    let rail = rail.on_hover_text("Frame");
    rail.widget_info(|| egui::WidgetInfo::slider(true, number as f64, "Frame"));
    if rail.changed() {
        playback.seek(number);
    }
    let last = frames.last();
    ui.label(RichText::new(format!("{number} of {last}")).monospace().color(theme::FAINT));
    let label = ui.label(RichText::new("at").color(theme::FAINT));
    let number = Number { value: playback.rate, range: [1.0, 240.0], speed: 0.2, decimals: 2, unit: " fps" };
    let (rate, given) = number.show(ui, vec2(72.0, 20.0));
    rate.labelled_by(label.id).on_hover_text("Frames per second");
    playback.rate = given.unwrap_or(playback.rate);
    ui.add_space(10.0);
}

fn magnification(ui: &mut Ui, session: &mut Session) {
    let label = ui.label(RichText::new("Exposure").color(theme::FAINT));
    let value = f64::from(session.viewport.exposure);
    let number = Number { value, range: [-10.0, 10.0], speed: 0.02, decimals: 2, unit: " stops" };
    let (stops, given) = number.show(ui, vec2(82.0, 20.0));
    if let Some(given) = given {
        session.viewport.exposure = given as f32;
    }
    if stops
        .labelled_by(label.id)
        .on_hover_text("Brightness of what is shown, not of what is saved; a double click sets it back")
        .double_clicked()
    {
        session.viewport.exposure = 0.0;
    }
    if !session.browser.is_open {
        ui.add_space(8.0);
        size(ui, session);
    }
}

/// Size at which the picture is shown.
fn size(ui: &mut Ui, session: &mut Session) {
    let scale = session.viewport.scale(session.nominal_size());
    if ui
        .add(Button::new("Fit").selected(session.viewport.is_fitting()))
        .on_hover_text("All of the picture (0)")
        .clicked()
    {
        session.viewport.fit();
    }
    let percent = format!("{:.0} %", scale * 100.0);
    let name = format!("Magnification {percent}");
    let button = ui.add(Button::new(percent)).accessible_name(name);
    if button.on_hover_text("Pixels as large as the screen's (z)").clicked() {
        session.viewport.toggle_actual();
    }
}
