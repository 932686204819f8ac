//! The panel at the side: which look, and all of its parameters.

use std::sync::Arc;

use egui::{CollapsingHeader, RichText, ScrollArea, Ui};

use super::{brush, chain, control, hint, histogram, keyboard, layers, lighting, materials, order, theme};
use crate::state::look::Parameter;
use crate::state::outcome::Dialog;
use crate::state::resetting::Goal;
use crate::state::session::{Session, TURNS};
use crate::state::work::Request;
use isophote_finishing::stylize::palette;

/// Headings that are open at first.
const OPEN: [&str; 2] = ["look", ""];

/// Shows the panel.
pub fn show(ui: &mut Ui, session: &mut Session) {
    let height = ui.available_height();
    chooser(ui, session);
    ui.add_space(6.0);
    let room = order::height_above(ui, "histogram");
    ScrollArea::vertical().auto_shrink([false, false]).max_height(room).show(ui, |ui| {
        ui.set_width(ui.available_width() - 10.0);
        let parameters = Arc::clone(session.looks.parameters());
        if session.look().is_plain() {
            ui.label(
                RichText::new("The picture as it is. Choose a look above, or press n.").color(theme::FAINT),
            );
        }
        chain::show(ui, session);
        let shown = selected(session, &parameters);
        for (heading, id, parameters) in sections(&shown) {
            section(ui, session, &heading, id, &parameters);
        }
        if session.open.scenery().is_some() {
            CollapsingHeader::new("Scene and light").default_open(false).show_unindented(ui, |ui| {
                lighting::show(ui, session);
            });
        }
        if layers::has_any(session) {
            CollapsingHeader::new("Layers and guides").default_open(true).show_unindented(ui, |ui| {
                layers::show(ui, session);
            });
        }
        if brush::has_any(session) {
            CollapsingHeader::new("Brush").default_open(false).show_unindented(ui, |ui| {
                brush::show(ui, session);
            });
        }
        if materials::has_any(session) {
            CollapsingHeader::new("Materials").default_open(false).show_unindented(ui, |ui| {
                materials::show(ui, session);
            });
        }
        ui.add_space(16.0);
        keyboard::follow(ui);
    });
    order::at_bottom(ui, "histogram", |ui| histogram::show(ui, session, height));
    if session.is_wheeled() {
        // What was turned is let go of then.
        ui.ctx().request_repaint_after(TURNS);
    }
}

/// The look, and what can be done with it as a whole.
fn chooser(ui: &mut Ui, session: &mut Session) {
    ui.horizontal(|ui| {
        let look = session.look();
        let mark = if look.is_changed() { " •" } else { "" };
        let name = RichText::new(format!("{}{mark}", look.name)).size(16.0);
        let width = ui.available_width() - 188.0;
        let mut chosen = None;
        let response = egui::ComboBox::from_id_salt("look")
            .selected_text(name)
            .width(width)
            .truncate()
            .show_ui(ui, |ui| {
                for (index, look) in session.looks.list().iter().enumerate() {
                    let number = if index < 9 { format!("{}", index + 1) } else { String::new() };
                    let entry =
                        egui::Button::selectable(index == session.looks.current(), look.name.as_str());
                    if ui.add(entry.shortcut_text(number)).clicked() {
                        chosen = Some(index);
                    }
                }
            });
        keyboard::tell(&response.response, &session.look().name);
        response.response.accessible_name("Look").on_hover_text("The look. n shows the next one");
        if let Some(index) = chosen {
            session.choose(index);
        }
        if ui.button("Looks").on_hover_text("All looks, as they make this picture (l)").clicked() {
            session.toggle_browser();
        }
        reset(ui, session);
    });
}

/// The button that goes back to the look as it was chosen, or from there to the defaults of its style.
fn reset(ui: &mut Ui, session: &mut Session) {
    let goal = session.look().way_back(session.looks.parameters());
    let (text, hint) = match goal {
        Some(Goal::Style) => {
            ("Reset to style", "Nothing differs from the look. Go on to the defaults of its style (r)")
        }
        Some(Goal::Look) => ("Reset to look", "Go back to the look as it was chosen (r)"),
        None => ("Reset to look", "Nothing has been changed"),
    };
    let button = ui.add_enabled(goal.is_some(), egui::Button::new(text));
    if button.on_hover_text(hint).on_disabled_hover_text(hint).clicked() {
        session.reset_all();
    }
}

/// Parameters of the node that is selected, or of all.
fn selected<'p>(session: &Session, parameters: &'p [Parameter]) -> Vec<&'p Parameter> {
    let Some(node) = session.looks.selected() else { return parameters.iter().collect() };
    let own = |parameter: &&Parameter| parameter.name.rsplit_once('.').is_none_or(|(of, _)| of == node);
    parameters.iter().filter(own).collect()
}

/// A heading with its id, and the parameters below it.
type Section<'p> = (String, String, Vec<&'p Parameter>);

/// Parameters by their headings, in the order of the declarations; nodes of a graph one after the other.
fn sections<'p>(parameters: &[&'p Parameter]) -> Vec<Section<'p>> {
    let several = parameters.iter().any(|parameter| parameter.node != parameters[0].node);
    let mut sections: Vec<Section<'p>> = Vec::new();
    for parameter in parameters.iter().copied() {
        let group = parameter.param.group;
        let id = format!("{} {group}", parameter.node);
        match sections.iter_mut().find(|(_, known, _)| *known == id) {
            Some((.., list)) => list.push(parameter),
            None => {
                let heading = match (several, group) {
                    (false, "") => "Look".to_owned(),
                    (false, group) => theme::capital(group),
                    (true, "") => parameter.of.to_owned(),
                    (true, group) => format!("{}: {group}", parameter.of),
                };
                sections.push((heading, id, vec![parameter]));
            }
        }
    }
    sections
}

/// The button that takes the colours of a palette from a file.
fn of_file(ui: &mut Ui, session: &mut Session) {
    ui.horizontal(|ui| {
        ui.add_space(12.0);
        let hint =
            "Takes the colours of a palette (.gpl, .hex, .ase, .aco, .pal or .json), or those of a picture";
        if ui.button("Colours from a file…").on_hover_text(hint).clicked() {
            session.work.ask(Request::Choose(Dialog::Palette));
        }
    });
}

fn section(ui: &mut Ui, session: &mut Session, heading: &str, id: String, parameters: &[&Parameter]) {
    let changed = parameters.iter().filter(|parameter| session.look().strays(parameter)).count();
    let mut text = RichText::new(heading).strong();
    if changed > 0 {
        text = text.color(theme::ACCENT);
    }
    let open = parameters.first().is_some_and(|parameter| OPEN.contains(&parameter.param.group));
    let header = CollapsingHeader::new(text).id_salt(id).default_open(open);
    let shown = header.show_unindented(ui, |ui| {
        for parameter in parameters {
            control::show(ui, session, parameter);
            if palette::chooses(&parameter.param) {
                of_file(ui, session);
            }
        }
        ui.add_space(8.0);
    });
    if changed > 0 && shown.fully_closed() {
        let what =
            if changed == 1 { "One control differs".into() } else { format!("{changed} controls differ") };
        hint::mark(ui, &shown.header_response, &format!("{what} from the look"));
    }
}
