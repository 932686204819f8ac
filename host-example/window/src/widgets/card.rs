//! A card of the browser: what a look makes of the picture, its name, style and tags.

use egui::{
    Align, Align2, Color32, FontId, Galley, Id, Layout, Rect, Response, RichText, Sense, Stroke, StrokeKind,
    TextureId, Ui, UiBuilder, pos2, vec2,
};
use std::sync::Arc;

use super::act::Act;
use super::{keyboard, star, theme};
use crate::state::browser::entry::{Content, Entry};
use crate::state::preview::order::{FINENESS, Order};
use crate::state::preview::picture::Picture;
use crate::state::preview::{Place, Preview};
use crate::state::session::Session;

/// Height of name, style and tags.
const TEXT: f32 = 46.0;
/// Points around the preview.
const PAD: f32 = 8.0;
/// Least and greatest height of a preview over its width.
const ASPECTS: [f32; 2] = [0.5, 0.8];

/// Height of a card of a width.
pub fn height(width: f32, session: &Session) -> f32 {
    let aspect = session
        .previews
        .picture()
        .map_or(2.0 / 3.0, |picture| picture.frame.height as f32 / picture.frame.width.max(1) as f32);
    ((width - 2.0 * PAD) * aspect.clamp(ASPECTS[0], ASPECTS[1])).round() + PAD + TEXT
}

/// Place of the preview on a card.
fn place(card: Rect) -> Rect {
    Rect::from_min_max(card.min + vec2(PAD, PAD), pos2(card.right() - PAD, card.bottom() - TEXT))
}

/// Size of a preview in pixels, on a card of a size in points.
pub fn pixels(ui: &Ui, card: egui::Vec2, picture: &Picture) -> (u32, u32) {
    let room = place(Rect::from_min_size(pos2(0.0, 0.0), card)).size() * ui.pixels_per_point();
    picture.fitting([room.x, room.y])
}

/// Asks for the preview of a card of a size; returns the bytes that it takes.
pub fn want(ui: &Ui, size: egui::Vec2, session: &mut Session, entry: &Entry) -> usize {
    let (Some(picture), Some(look)) = (session.previews.picture(), entry.look()) else { return 0 };
    let (width, height) = pixels(ui, size, picture);
    session.previews.want(Place::Card(entry.id), Order::whole(Arc::clone(look), (width, height), FINENESS));
    width as usize * height as usize * 4
}

/// Control of a card, which can have the focus.
pub fn id(entry: u64) -> Id {
    Id::unique(("card", entry))
}

/// Shows a card; returns what is asked for. Of all cards Tab goes to one alone, from which arrows go on.
pub fn show(ui: &mut Ui, rect: Rect, session: &mut Session, entry: &Arc<Entry>) -> Option<Act> {
    want(ui, rect.size(), session, entry);
    let is_selected = session.browser.selected == Some(entry.id);
    let is_stop = session.browser.stop() == Some(entry.id);
    let sense = if is_stop { Sense::click() } else { Sense::CLICK };
    let response = ui.interact(rect, id(entry.id), sense);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &entry.name));
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_selected(is_selected));
    if is_stop && std::mem::take(&mut session.browser.takes_focus) {
        response.request_focus();
        keyboard::stay(ui);
    }
    let fill = if response.hovered() || is_selected { theme::CARD_ABOVE } else { theme::CARD };
    ui.painter().rect_filled(rect, 7.0, fill);
    picture(ui, place(rect), session, entry);
    words(ui, rect, session, entry);
    if is_selected {
        ui.painter().rect_stroke(rect, 7.0, Stroke::new(2.0, theme::ACCENT), StrokeKind::Inside);
    }
    let marked = mark(ui, place(rect), session, entry, &response);
    let starred = star::show(ui, place(rect), session, entry, &response);
    let mut act = None;
    response.context_menu(|ui| {
        ui.set_min_width(180.0);
        act = actions(ui, session, entry);
    });
    let response = hint(response, entry);
    match () {
        () if marked => Some(Act::Mark(entry.id)),
        () if starred => Some(Act::Star(entry.id)),
        () if act.is_some() => act,
        () if response.double_clicked() => Some(Act::ApplyAndClose(entry.id)),
        () if response.has_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter)) => {
            Some(Act::ApplyAndClose(entry.id))
        }
        () if response.clicked() => Some(Act::Apply(entry.id)),
        () => None,
    }
}

/// Hint about a look where the pointer rests.
fn hint(response: Response, entry: &Entry) -> Response {
    match (&entry.content, &entry.title.about) {
        (Content::Broken(problem), _) => response.on_hover_text(problem),
        (_, Some(about)) => response.on_hover_text(about),
        _ => response,
    }
}

/// The preview, or the dimmed picture while there is none.
fn picture(ui: &mut Ui, place: Rect, session: &mut Session, entry: &Entry) {
    if let Content::Broken(problem) = &entry.content {
        // Which file it is stands below.
        let file = format!("{}: ", entry.source.display());
        return wrapped(ui, place, problem.strip_prefix(&file).unwrap_or(problem));
    }
    let card = Place::Card(entry.id);
    if let Some(problem) = session.previews.problem(card).map(str::to_owned) {
        return wrapped(ui, place, &problem);
    }
    let context = ui.ctx().clone();
    let preview = session.previews.get(&context, card, false).filter(|preview| preview.is_current);
    match preview {
        Some(preview) => image(ui, place, &preview, Color32::WHITE),
        None => match session.previews.get(&context, Place::Plain, false) {
            Some(plain) if plain.is_current => image(ui, place, &plain, Color32::from_gray(72)),
            _ => drop(ui.painter().rect_filled(place, 3.0, theme::EMPTY)),
        },
    }
}

/// A picture as large as it can be within a place, on whole pixels of the window.
pub fn image(ui: &Ui, place: Rect, preview: &Preview, tint: Color32) {
    let scale = ui.pixels_per_point();
    let size = vec2(preview.size.0 as f32, preview.size.1 as f32) / scale;
    let size = size * (place.width() / size.x).min(place.height() / size.y);
    let corner = place.center() - size * 0.5;
    let corner = pos2((corner.x * scale).round() / scale, (corner.y * scale).round() / scale);
    draw(ui, preview.texture, Rect::from_min_size(corner, size), tint);
}

/// A whole texture.
pub fn draw(ui: &Ui, texture: TextureId, rect: Rect, tint: Color32) {
    ui.painter().image(texture, rect, Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0)), tint);
}

/// Reason why there is no preview, in several lines.
fn wrapped(ui: &mut Ui, place: Rect, problem: &str) {
    ui.painter().rect_filled(place, 3.0, theme::EMPTY);
    let mut inner =
        ui.new_child(UiBuilder::new().max_rect(place.shrink(8.0)).layout(Layout::top_down(Align::Min)));
    inner.set_clip_rect(place.intersect(ui.clip_rect()));
    inner.add(egui::Label::new(RichText::new(problem).size(11.0).color(theme::BAD)).wrap().selectable(false));
}

/// Name, style and tags.
fn words(ui: &Ui, rect: Rect, session: &Session, entry: &Entry) {
    let (left, top) = (rect.left() + PAD + 2.0, rect.bottom() - TEXT + 7.0);
    let width = rect.width() - 2.0 * PAD - 4.0;
    let is_present = session.look().source == entry.source;
    let indent = if is_present { 12.0 } else { 0.0 };
    if is_present {
        ui.painter().circle_filled(pos2(left + 3.5, top + 8.0), 3.5, theme::ACCENT);
    }
    let name = cut(ui, &entry.name, 13.0, theme::BRIGHT, width - indent);
    ui.painter().galley(pos2(left + indent, top), name, theme::BRIGHT);
    let faint = cut(ui, &line(entry), 11.0, theme::FAINT, width);
    ui.painter().galley(pos2(left, top + 17.0), faint, theme::FAINT);
}

/// Style and tags on one line.
pub fn line(entry: &Entry) -> String {
    let style = Some(entry.style.as_str()).filter(|style| !style.is_empty() && *style != entry.name);
    style.into_iter().chain(entry.title.tags.iter().map(String::as_str)).collect::<Vec<_>>().join(" · ")
}

/// A line that is cut off where it is too long.
fn cut(ui: &Ui, text: &str, size: f32, color: Color32, width: f32) -> Arc<Galley> {
    let mut job =
        egui::text::LayoutJob::simple_singleline(text.to_owned(), FontId::proportional(size), color);
    job.wrap = egui::text::TextWrapping::truncate_at_width(width.max(1.0));
    ui.fonts_mut(|fonts| fonts.layout_job(job))
}

/// The mark of looks that are to be compared, and whether it was clicked.
fn mark(ui: &Ui, place: Rect, session: &Session, entry: &Entry, card: &Response) -> bool {
    if entry.look().is_none() {
        return false;
    }
    let number = session.browser.marked.iter().position(|marked| *marked == entry.id);
    let rect = Rect::from_min_size(place.min + vec2(6.0, 6.0), vec2(20.0, 20.0));
    let response = ui.interact(rect, Id::unique(("mark", entry.id)), Sense::CLICK);
    response.widget_info(|| {
        let name = format!("Compare {}", entry.name);
        egui::WidgetInfo::selected(egui::Role::CheckBox, true, number.is_some(), name)
    });
    let hint = "Mark it, to see it beside other looks, up to six (Ctrl+M)";
    let response = response.on_hover_text(hint);
    let is_seen =
        number.is_some() || card.hovered() || response.hovered() || !session.browser.marked.is_empty();
    if is_seen {
        let fill = if number.is_some() { theme::ACCENT } else { theme::VEIL };
        ui.painter().rect_filled(rect, 4.0, fill);
        let light = if response.hovered() { theme::BRIGHT } else { theme::TEXT };
        ui.painter().rect_stroke(rect, 4.0, Stroke::new(1.0, light), StrokeKind::Inside);
        if let Some(number) = number {
            let font = FontId::proportional(12.0);
            ui.painter().text(rect.center(), Align2::CENTER_CENTER, number + 1, font, Color32::BLACK);
        }
    }
    response.clicked()
}

/// Actions on a look and its file.
pub fn actions(ui: &mut Ui, session: &Session, entry: &Entry) -> Option<Act> {
    let mut act = None;
    let mut item = |ui: &mut Ui, text: &str, enabled: bool, wanted: &dyn Fn() -> Act| {
        if ui.add_enabled(enabled, egui::Button::new(text)).clicked() {
            act = Some(wanted());
            ui.close();
        }
    };
    let is_look = entry.look().is_some();
    let is_marked = session.browser.marked.contains(&entry.id);
    item(ui, "Apply", is_look, &|| Act::ApplyAndClose(entry.id));
    let mark = if is_marked { "Remove the mark" } else { "Mark to compare" };
    item(ui, mark, is_look, &|| Act::Mark(entry.id));
    let star =
        if session.browser.is_favourite(entry) { "Remove from favourites" } else { "Add to favourites" };
    item(ui, star, is_look, &|| Act::Star(entry.id));
    item(ui, "Save a copy…", is_look && !entry.style.is_empty(), &|| Act::Copy(entry.id));
    if let Some(file) = entry.file() {
        item(ui, "Name and tags…", entry.has_title(), &|| Act::Title(entry.id));
        item(ui, "Delete…", true, &|| Act::Delete(file.to_owned()));
        if ui.button("Copy the file's path").on_hover_text(file.display().to_string()).clicked() {
            ui.ctx().copy_text(file.display().to_string());
            ui.close();
        }
    }
    act
}
