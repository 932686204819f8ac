//! The nodes of a look that is a list: add, remove, reorder, pass by, look at.

use egui::{Button, CollapsingHeader, RichText, Ui, vec2};

use super::{hint, theme};
use crate::state::chain::Watched;
use crate::state::session::Session;
use isophote_files::error::Error;

/// Action that a button of a row asks for.
enum Act {
    Select,
    Shift(usize),
    Toggle,
    Watch(Watched),
    Remove,
}

/// Shows the list, folded where it has one node.
pub fn show(ui: &mut Ui, session: &mut Session) {
    if session.look().is_plain() {
        return;
    }
    let count = session.looks.chain().map_or(0, |chain| chain.links.len());
    let heading = RichText::new("Nodes").strong();
    let header = CollapsingHeader::new(heading).id_salt("nodes").default_open(count > 1);
    let is_changed = session.look().rebuilt().is_some();
    let shown = header.show_unindented(ui, |ui| {
        if session.looks.chain().is_none() {
            let text = "This graph is no list: its nodes branch. Their parameters are below.";
            ui.label(RichText::new(text).color(theme::FAINT));
            return;
        }
        let mut clicked = None;
        for index in 0..count {
            ui.push_id(index, |ui| row(ui, session, index, count, &mut clicked));
        }
        if let Some((index, act)) = clicked {
            perform(session, index, act);
        }
        add(ui, session);
        ui.add_space(8.0);
    });
    if is_changed && shown.fully_closed() {
        hint::mark(ui, &shown.header_response, "These are not the nodes of the look as it was chosen");
    }
}

fn row(ui: &mut Ui, session: &Session, index: usize, count: usize, clicked: &mut Option<(usize, Act)>) {
    let Some(link) = session.looks.chain().and_then(|chain| chain.links.get(index)) else { return };
    let is_alone = session.looks.watched() == Some(&Watched::Alone(link.name.clone()));
    let is_after = session.looks.watched() == Some(&Watched::After(link.name.clone()));
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        let button = |ui: &mut Ui, text: &str, name: &str, hint: &str, on: bool, enabled: bool| {
            let color = if on { theme::ACCENT } else { theme::TEXT };
            let button = Button::new(RichText::new(text).color(color).size(12.0)).min_size(vec2(20.0, 20.0));
            let response = ui.add_enabled(enabled, button).on_hover_text(hint);
            let name = format!("{name} {}", link.name);
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, enabled, &name));
            response.clicked()
        };
        let mut act = None;
        if button(ui, "⏶", "Earlier", "Do this earlier", false, index > 0) {
            act = Some(Act::Shift(index.saturating_sub(1)));
        }
        if button(ui, "⏷", "Later", "Do this later", false, index + 1 < count) {
            act = Some(Act::Shift(index + 1));
        }
        let is_selected = session.looks.selected() == Some(link.name.as_str());
        let mut text = RichText::new(link.label);
        if link.bypassed {
            text = text.color(theme::FAINT).strikethrough();
        }
        let width = ui.available_width() - 4.0 * 29.0;
        let name = Button::selectable(is_selected, text).truncate().min_size(vec2(width, 20.0));
        let hint = format!("Show the parameters of {} alone, or those of all nodes again", link.name);
        if ui.add_sized([width, 20.0], name).on_hover_text(hint).clicked() {
            act = Some(Act::Select);
        }
        let hint = "Let the picture pass this node by, or not";
        if button(ui, if link.bypassed { "-" } else { "•" }, "Bypass", hint, !link.bypassed, true) {
            act = Some(Act::Toggle);
        }
        if button(ui, "👁", "Look after", "Look at the picture as it leaves this node", is_after, true) {
            act = Some(Act::Watch(Watched::After(link.name.clone())));
        }
        if button(ui, "S", "Solo", "Look at what this node alone makes of the picture", is_alone, true) {
            act = Some(Act::Watch(Watched::Alone(link.name.clone())));
        }
        if button(ui, "✖", "Remove", "Remove this node", false, count > 1) {
            act = Some(Act::Remove);
        }
        *clicked = clicked.take().or(act.map(|act| (index, act)));
    });
}

fn perform(session: &mut Session, index: usize, act: Act) {
    let name = session.looks.chain().and_then(|chain| chain.links.get(index)).map(|link| link.name.clone());
    match act {
        Act::Select => {
            let is_selected = session.looks.selected() == name.as_deref();
            session.looks.select(name.filter(|_| !is_selected));
        }
        Act::Watch(watched) => {
            let is_watched = session.looks.watched() == Some(&watched);
            session.looks.watch(Some(watched).filter(|_| !is_watched));
        }
        Act::Shift(to) => session.relink(|chain, _| {
            chain.shift(index, to);
            Ok(())
        }),
        Act::Toggle => session.relink(|chain, _| kept(chain.toggle(index))),
        Act::Remove => session.relink(|chain, _| kept(chain.remove(index))),
    }
}

/// A list from which everything would be gone is no look.
fn kept(is_done: bool) -> isophote_files::error::Result<()> {
    let nothing =
        || Error::input("the nodes", "nothing would be left of the look", "choose the look Original");
    is_done.then_some(()).ok_or_else(nothing)
}

/// The menu of nodes that can be added, after the node that is selected or at the end.
fn add(ui: &mut Ui, session: &mut Session) {
    let mut chosen = None;
    ui.horizontal(|ui| {
        ui.menu_button("Add a node", |ui| {
            let mut groups: Vec<&str> = session.looks.fitting().iter().map(|node| node.group).collect();
            groups.dedup();
            for group in groups {
                ui.menu_button(theme::capital(group), |ui| {
                    for node in session.looks.fitting().iter().filter(|node| node.group == group) {
                        if ui.button(node.label).on_hover_text(node.hint).clicked() {
                            chosen = Some(node.id);
                            ui.close();
                        }
                    }
                });
            }
        });
        if session.looks.watched().is_some() && ui.button("Look at all").clicked() {
            session.looks.watch(None);
        }
    });
    let Some(node) = chosen else { return };
    let selected = session.looks.selected().map(str::to_owned);
    let mut added = None;
    session.relink(|chain, library| {
        let after = selected.and_then(|name| chain.find(&name)).map(|at| at + 1);
        let at = after.unwrap_or(usize::MAX).min(chain.end());
        added = Some(chain.add(library, node, at)?);
        Ok(())
    });
    if session.looks.selected().is_some() {
        session.looks.select(added);
    }
}
