//! The browser of looks: a grid of cards with what each look makes of the picture.

use std::sync::Arc;

use egui::{
    Align2, Button, FontId, Id, Key, Rect, RichText, ScrollArea, Sense, TextEdit, Ui, UiBuilder, Vec2, pos2,
    vec2,
};

use super::act::{Act, perform};
use super::{card, keyboard, order, star, theme};
use crate::state::browser::Step;
use crate::state::browser::entry::{Entry, Group};
use crate::state::browser::filter::{Filter, tags};
use crate::state::look::PLAIN;
use crate::state::outcome::Dialog;
use crate::state::preview::Place;
use crate::state::preview::order::{FINENESS, Order};
use crate::state::session::Session;
use crate::state::work::Request;

/// Least width of a card in points.
const LEAST: f32 = 200.0;
/// Points between cards.
const GAP: f32 = 14.0;
/// Height of a heading.
const HEADING: f32 = 40.0;
/// Points beside the grid.
const MARGIN: f32 = 18.0;
/// Points from one tag to the next, on average.
const CHIP: f32 = 62.0;
/// Width below which the controls stand on two lines.
const NARROW: f32 = 720.0;
/// Most bytes of previews that are made before they are seen.
const AHEAD: usize = 48 << 20;

/// Shows the browser.
pub fn show(ui: &mut Ui, rect: Rect, session: &mut Session) {
    ui.painter().rect_filled(rect, 0.0, theme::SURROUND);
    let inner = rect.shrink2(vec2(MARGIN, 0.0));
    ui.scope_builder(UiBuilder::new().max_rect(inner), |ui| {
        ui.add_space(12.0);
        strip(ui, session);
        ui.add_space(4.0);
        chips(ui, session);
        ui.add_space(6.0);
        ScrollArea::vertical().id_salt("looks").auto_shrink([false, false]).show_viewport(
            ui,
            |ui, viewport| {
                grid(ui, viewport, session);
            },
        );
    });
}

/// Searching, comparing, folders; on two lines where there is little room.
fn strip(ui: &mut Ui, session: &mut Session) {
    let is_narrow = ui.available_width() < NARROW;
    ui.horizontal(|ui| {
        ui.set_min_height(28.0);
        ui.label(RichText::new("Looks").size(17.0).color(theme::BRIGHT));
        ui.add_space(8.0);
        search(ui, session);
        if !is_narrow {
            order::at_right(ui, "browser", |ui| buttons(ui, session));
        }
    });
    if is_narrow {
        ui.horizontal_wrapped(|ui| buttons(ui, session));
    }
}

fn search(ui: &mut Ui, session: &mut Session) {
    let width = ui.available_width().min(220.0);
    let id = Id::unique("search looks");
    if std::mem::take(&mut session.browser.searches) {
        begin_typing(ui, id, session.browser.filter.text.chars().count());
    }
    let field = TextEdit::singleline(&mut session.browser.filter.text)
        .id(id)
        .hint_text("Search names, tags and styles")
        .desired_width(width);
    let field = ui.add(field);
    field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Search looks"));
    let is_entered = field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
    if is_entered || field.has_focus() && ui.input(|i| i.key_pressed(Key::ArrowDown)) {
        session.browser.selected = None;
        session.browser.step(Step::Down);
    }
    if !session.browser.filter.is_empty() && ui.button("Show all").clicked() {
        session.browser.filter = Filter::default();
    }
}

/// Gives a field the focus, with the cursor after so many letters.
fn begin_typing(ui: &Ui, id: Id, letters: usize) {
    ui.memory_mut(|memory| memory.request_focus(id));
    let mut state = egui::text_edit::TextEditState::load(ui.ctx(), id).unwrap_or_default();
    let end = egui::text::CCursor::new(letters);
    state.cursor.set_char_range(Some(egui::text::CCursorRange::one(end)));
    state.store(ui.ctx(), id);
}

fn buttons(ui: &mut Ui, session: &mut Session) {
    let marked = session.browser.marked.len();
    if marked > 0 && ui.button("Clear marks").clicked() {
        session.browser.marked.clear();
    }
    let text = if marked > 0 { format!("Compare {marked}") } else { "Compare".to_owned() };
    let mut button = Button::new(text);
    if marked > 1 {
        button = button.fill(theme::CHOSEN);
    }
    let button = ui
        .add_enabled(marked > 1, button)
        .on_hover_text("See the marked looks beside each other (Ctrl+Enter)");
    if button.on_disabled_hover_text("Mark two to six looks to see them beside each other").clicked() {
        session.compare_marked();
    }
    let hint = "Offer the looks of a folder and of those within it";
    if ui.button("Add a folder…").on_hover_text(hint).clicked() {
        session.work.ask(Request::Choose(Dialog::LookFolder));
    }
    if ui.button("Back to the picture").on_hover_text("Esc").clicked() {
        session.browser.is_open = false;
    }
}

/// Tags that can be asked for.
fn chips(ui: &mut Ui, session: &mut Session) {
    let counted = tags(session.browser.entries().iter().map(|entry| &**entry));
    let wanted = session.browser.filter.tags.clone();
    let is_wanted = |tag: &str| wanted.iter().any(|known| known.eq_ignore_ascii_case(tag));
    let most = ((ui.available_width() / CHIP) as usize).max(6);
    let mut shown: Vec<&str> = counted.iter().take(most).map(|(tag, _)| tag.as_str()).collect();
    shown.extend(counted.iter().skip(most).map(|(tag, _)| tag.as_str()).filter(|tag| is_wanted(tag)));
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(6.0, 6.0);
        star::filter(ui, session);
        for tag in shown {
            let text = RichText::new(tag).size(12.0);
            let chip = Button::selectable(is_wanted(tag), text).corner_radius(10.0).frame_when_inactive(true);
            let chip = ui.add(chip);
            chip.widget_info(|| {
                egui::WidgetInfo::selected(egui::Role::Button, true, is_wanted(tag), format!("Tag {tag}"))
            });
            if chip.clicked() {
                session.browser.filter.toggle(tag);
            }
        }
    });
}

/// Item of the grid, at its upper left corner.
enum Item {
    Heading(Group, usize),
    Card(Arc<Entry>),
}

/// Cards, from the upper left corner of the grid, and its height.
fn layout(session: &Session, width: f32, columns: usize) -> (Vec<(Rect, Item)>, f32) {
    let across = (width - GAP * (columns - 1) as f32) / columns as f32;
    let size = vec2(across.floor(), card::height(across.floor(), session));
    let (mut items, mut y) = (Vec::new(), 0.0);
    for (group, entries) in session.browser.groups() {
        let heading = Rect::from_min_size(pos2(0.0, y), vec2(width, HEADING));
        items.push((heading, Item::Heading(group.clone(), entries.len())));
        y += HEADING;
        for row in entries.chunks(columns) {
            for (column, entry) in row.iter().enumerate() {
                let at = pos2(column as f32 * (size.x + GAP), y);
                items.push((Rect::from_min_size(at, size), Item::Card(Arc::clone(entry))));
            }
            y += size.y + GAP;
        }
    }
    (items, y + GAP)
}

/// Says why there is no card.
fn say_why_empty(ui: &mut Ui, session: &Session) {
    let text = if session.browser.entries().is_empty() {
        "Reading the looks…"
    } else if session.browser.filter.favourites {
        "No look with a star is like that. A click on the star of a card, or *, makes it a favourite."
    } else {
        "No look is like that."
    };
    if !session.browser.entries().is_empty() {
        ui.add_space(24.0);
    }
    ui.label(RichText::new(text).color(theme::FAINT));
}

fn grid(ui: &mut Ui, viewport: Rect, session: &mut Session) {
    let width = ui.available_width() - 14.0;
    // Two beside each other can be compared where there is hardly room for them.
    let least = if width < 2.0 * LEAST + GAP { 140.0 } else { LEAST };
    let columns = (((width + GAP) / (least + GAP)) as usize).max(1);
    session.browser.columns = columns;
    let (items, height) = layout(session, width, columns);
    ui.set_height(height);
    let corner = ui.max_rect().min.to_vec2();
    if items.is_empty() {
        say_why_empty(ui, session);
    }
    let mut act = None;
    ask_plain(ui, session, &items);
    walk(ui, session);
    let (seen, unseen): (Vec<_>, Vec<_>) = items.into_iter().partition(|(rect, _)| rect.intersects(viewport));
    for (rect, item) in &seen {
        let rect = rect.translate(corner);
        match item {
            Item::Heading(group, count) => act = heading(ui, rect, session, group, *count).or(act),
            Item::Card(entry) => act = card::show(ui, rect, session, entry).or(act),
        }
    }
    let mut ahead = AHEAD;
    let below = |rect: &Rect| rect.min.y >= viewport.min.y;
    let rest =
        unseen.iter().filter(|(rect, _)| below(rect)).chain(unseen.iter().filter(|(rect, _)| !below(rect)));
    for (rect, item) in rest {
        if let Item::Card(entry) = item
            && let Some(bytes) = ahead.checked_sub(card::want(ui, rect.size(), session, entry))
        {
            ahead = bytes;
        }
    }
    let selected = seen
        .iter()
        .chain(&unseen)
        .find(|(_, item)| matches!(item, Item::Card(entry) if Some(entry.id) == session.browser.selected));
    if let Some((rect, _)) = selected
        && std::mem::take(&mut session.browser.scrolls)
    {
        let at = rect.translate(corner).expand2(vec2(GAP, HEADING));
        ui.scroll_to_rect_animation(at, None, egui::style::ScrollAnimation::none());
    }
    // A card that is out of sight does not take the focus when somebody scrolls to it.
    if ui.input(|input| input.smooth_scroll_delta() != Vec2::ZERO) {
        session.browser.takes_focus = false;
    }
    if let Some(act) = act {
        perform(ui, session, act);
    }
}

/// Goes from card to card by the arrows, while one of them has the focus.
fn walk(ui: &Ui, session: &mut Session) {
    let card = session.browser.stop().map(card::id);
    let Some(card) = card.filter(|card| ui.memory(|memory| memory.has_focus(*card))) else { return };
    keyboard::keep_arrows(ui, card);
    for (key, step) in [
        (Key::ArrowLeft, Step::Left),
        (Key::ArrowRight, Step::Right),
        (Key::ArrowUp, Step::Up),
        (Key::ArrowDown, Step::Down),
    ] {
        let presses = ui.input(|input| input.num_presses(key));
        if presses > 0 {
            keyboard::stay(ui);
        }
        (0..presses).for_each(|_| session.browser.step(step));
    }
}

/// The picture itself, which is behind cards that are not ready, is made before all others.
fn ask_plain(ui: &Ui, session: &mut Session, items: &[(Rect, Item)]) {
    let card = items.iter().find(|(_, item)| matches!(item, Item::Card(_)));
    let (Some((rect, _)), Some(picture)) = (card, session.previews.picture()) else { return };
    let size = card::pixels(ui, rect.size(), picture);
    let plain = session.looks.list().iter().find(|look| look.is_plain()).cloned();
    let plain = plain.or_else(|| session.browser.find(PLAIN.as_ref())?.look().cloned());
    if let Some(look) = plain {
        session.previews.want(Place::Plain, Order::whole(look, size, FINENESS));
    }
}

fn heading(ui: &mut Ui, rect: Rect, session: &Session, group: &Group, count: usize) -> Option<Act> {
    let text = match group {
        Group::Favourites => "Favourites".to_owned(),
        Group::Folder(folder) => folder.display().to_string(),
        Group::Shipped => "Looks that come with the program".to_owned(),
        Group::Styles => "Styles with their defaults".to_owned(),
    };
    let base = rect.bottom() - 12.0;
    let at = pos2(rect.left(), base);
    let name = ui.painter().text(at, Align2::LEFT_BOTTOM, &text, FontId::proportional(13.0), theme::TEXT);
    let at = pos2(name.right() + 10.0, base);
    let number = ui.painter().text(at, Align2::LEFT_BOTTOM, count, FontId::proportional(13.0), theme::FAINT);
    let label = ui.interact(name, Id::unique(("heading", &text)), Sense::hover());
    label.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &text));
    let Group::Folder(folder) = group else { return None };
    if !session.settings.look_folders.contains(folder) {
        return None;
    }
    let button =
        Button::new(RichText::new("Remove from the list").size(11.0).color(theme::FAINT)).frame(false);
    let place = Rect::from_min_size(pos2(number.right() + 14.0, base - 17.0), vec2(120.0, 18.0));
    let button =
        ui.put(place, button).on_hover_text("Offer these looks no more; the files stay where they are");
    button.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Remove {text} from the list"))
    });
    button.clicked().then(|| Act::RemoveFolder(folder.clone()))
}
