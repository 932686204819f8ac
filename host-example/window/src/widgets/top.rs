//! The bar at the top: files, steps, comparing.

use egui::{Button, DragValue, RichText, Ui};

use super::{ends, keyboard, theme};
use crate::state::command;
use crate::state::outcome::Dialog;
use crate::state::session::Session;
use crate::state::viewport::{Compare, Overlay};
use crate::state::work::Request;

/// Points of the bar up to which the name is left out.
const NARROW: f32 = 760.0;
/// The narrowest window, in points, that has room for what the menu has, too.
const WIDE: f32 = 900.0;

/// Shows the bar.
pub fn show(ui: &mut Ui, session: &mut Session) {
    let bar = ("top", 24.0, right as ends::End);
    ends::show(ui, session, bar, |ui, session| {
        let width = ui.clip_rect().width();
        file_menu(ui, session);
        let name = if session.open.has_picture() { session.open.name() } else { "Isophote" };
        // The title of the window has it, too.
        if width > NARROW {
            ends::cut(ui, RichText::new(name).color(theme::FAINT), (width - NARROW).clamp(60.0, 220.0));
        }
        if !session.open.has_picture() {
            return;
        }
        ui.add_space(10.0);
        let [undo, redo] = session.can();
        if ui.add_enabled(undo, Button::new("Undo")).on_hover_text("Ctrl+Z").clicked() {
            session.undo();
        }
        if ui.add_enabled(redo, Button::new("Redo")).on_hover_text("Ctrl+Y").clicked() {
            session.redo();
        }
        ui.add_space(10.0);
        looks(ui, session);
        if !session.is_covered() {
            compare(ui, session);
            ui.add_space(10.0);
            overlays(ui, session);
        }
    });
}

fn file_menu(ui: &mut Ui, session: &mut Session) {
    ends::menu(ui, "File", |ui| {
        ui.set_min_width(240.0);
        item(ui, session, "Open…", "Ctrl+O", Request::Choose(Dialog::File), true);
        item(ui, session, "Open the demo scene", "", Request::OpenDemo, true);
        ui.separator();
        item(ui, session, "Open a look…", "", Request::Choose(Dialog::Look), true);
        let has_look = !session.look().is_plain();
        for (text, keys, elsewhere) in
            [("Save the look", "Ctrl+S", false), ("Save the look as…", "Ctrl+Shift+S", true)]
        {
            if ui.add_enabled(has_look, Button::new(text).shortcut_text(keys)).clicked() {
                session.save_look(elsewhere);
                ui.close();
            }
        }
        ui.separator();
        let can_export = session.can_export();
        let copy = Button::new("Copy the command line").shortcut_text("");
        if ui.add_enabled(session.open.file().is_some(), copy).clicked() {
            ui.ctx().copy_text(command::copied(session));
            ui.close();
        }
        if ui.add_enabled(can_export, Button::new("Export…").shortcut_text("Ctrl+E")).clicked() {
            session.plan_export();
            ui.close();
        }
        item(
            ui,
            session,
            "Use the look on several pictures…",
            "",
            Request::Choose(Dialog::Several),
            has_look,
        );
        ui.separator();
        let recent = session.settings.recent.clone();
        if !recent.is_empty() {
            ui.label(RichText::new("Recent").small().color(theme::FAINT));
        }
        for path in recent {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if ui.button(name).on_hover_text(path.display().to_string()).clicked() {
                session.work.ask(Request::Open(path));
                ui.close();
            }
        }
        if !session.settings.recent.is_empty() {
            ui.separator();
        }
        if ui.add(Button::new("Close the window").shortcut_text("Ctrl+Q")).clicked() {
            session.leave();
            ui.close();
        }
    });
}

fn item(ui: &mut Ui, session: &mut Session, text: &str, keys: &str, request: Request, enabled: bool) {
    if ui.add_enabled(enabled, Button::new(text).shortcut_text(keys)).clicked() {
        session.work.ask(request);
        ui.close();
    }
}

/// The way to the browser of looks, and back.
fn looks(ui: &mut Ui, session: &mut Session) {
    let browser = Button::selectable(session.browser.is_open, "Browse looks").frame_when_inactive(true);
    if ui.add(browser).on_hover_text("All looks, as they make this picture (l)").clicked() {
        session.toggle_browser();
    }
    if session.browser.comparison.is_some() {
        ui.label(RichText::new("A click takes a look").color(theme::FAINT));
        if ui.button("End the comparison").on_hover_text("Esc").clicked() {
            session.end_comparison();
        }
    }
    ui.add_space(10.0);
}

/// The way in which pictures are compared, and with what.
fn compare(ui: &mut Ui, session: &mut Session) {
    ui.spacing_mut().item_spacing.x = 3.0;
    for (compare, text, hint) in [
        (Compare::Off, "Look", "The look alone"),
        (Compare::Wipe, "Wipe", "Before and after, divided by a line that can be dragged (w)"),
        (Compare::Side, "Side by side", "Before and after beside each other (e)"),
        (Compare::Difference, "Difference", "How far before and after are apart, made stronger (d)"),
    ] {
        if ui.selectable_label(session.viewport.compare == compare, text).on_hover_text(hint).clicked() {
            session.viewport.compare = compare;
        }
    }
    ui.spacing_mut().item_spacing.x = 8.0;
    if session.viewport.compare == Compare::Off {
        return;
    }
    if session.viewport.is_difference() {
        let factor = DragValue::new(&mut session.viewport.amplification).range(1.0..=64.0).speed(0.05);
        let factor = ui.add(factor.max_decimals(1).prefix("× ")).on_hover_text("Factor on the difference");
        factor.widget_info(|| egui::WidgetInfo {
            label: Some("Factor on the difference".into()),
            ..egui::WidgetInfo::drag_value(true, f64::from(session.viewport.amplification))
        });
    }
    let mut chosen = None;
    let name = session.looks.compared.as_ref().map_or("Original", |look| look.name.as_str()).to_owned();
    let list = egui::ComboBox::from_id_salt("compared")
        .selected_text(format!("with {name}"))
        .width(130.0)
        .show_ui(ui, |ui| {
            if ui.selectable_label(session.looks.compared.is_none(), "Original").clicked() {
                session.looks.compared = None;
            }
            if !session.look().is_plain() && ui.selectable_label(false, "The look as it is now").clicked() {
                let mut look = session.look().clone();
                look.name += " before";
                chosen = Some(look);
            }
            for look in session.looks.list().iter().filter(|look| !look.is_plain()) {
                let is_compared = session.looks.compared.as_ref() == Some(&**look);
                if ui.selectable_label(is_compared, &look.name).clicked() {
                    chosen = Some((**look).clone());
                }
            }
        })
        .response;
    keyboard::tell(&list, &name);
    list.accessible_name("Compare with").on_hover_text("What the look is compared with");
    if chosen.is_some() {
        session.looks.compared = chosen;
    }
}

fn overlays(ui: &mut Ui, session: &mut Session) {
    let now = Overlay::ALL
        .iter()
        .find(|(overlay, _)| *overlay == session.viewport.overlay)
        .map_or("", |(_, name)| name);
    let shown = if session.viewport.overlay == Overlay::None { "Show" } else { now };
    let list = egui::ComboBox::from_id_salt("overlay")
        .selected_text(shown)
        .width(70.0)
        .show_ui(ui, |ui| {
            for (overlay, name) in Overlay::ALL {
                if !session.has_overlay(overlay) {
                    continue;
                }
                ui.selectable_value(&mut session.viewport.overlay, overlay, name);
            }
        })
        .response;
    keyboard::tell(&list, now);
    let hint = "What the look is made of: what is known of the picture, and what is found in it";
    list.accessible_name("Show").on_hover_text(hint);
}

fn right(ui: &mut Ui, session: &mut Session) {
    if session.open.has_picture() {
        // The menu has the rest, too.
        if ui.ctx().content_rect().width() >= WIDE {
            let has_look = !session.look().is_plain();
            if ui.add_enabled(has_look, Button::new("Save look")).on_hover_text("Ctrl+S").clicked() {
                session.save_look(false);
            }
            let copy = ui.add_enabled(session.open.file().is_some(), Button::new("Copy command"));
            if copy.on_hover_text("The command line that gives this picture").clicked() {
                ui.ctx().copy_text(command::copied(session));
            }
        }
        let export = Button::new("Export").fill(theme::CHOSEN);
        let export = ui.add_enabled(session.can_export(), export);
        let export = export.on_hover_text("Writes the picture, its frames or a video (Ctrl+E)");
        if export.on_disabled_hover_text("Choose a style first").clicked() {
            session.plan_export();
        }
    }
    let help = ui.button("?").accessible_name("Keys and mouse").on_hover_text("Keys and mouse");
    if help.clicked() {
        session.dialogs.shows_help = !session.dialogs.shows_help;
    }
}
