//! The histogram of what is shown, at the lower end of the panel.

use egui::{CollapsingHeader, Color32, Rect, RichText, Sense, Shape, Stroke, Ui, pos2, vec2};

use super::theme;
use crate::state::histogram::{BINS, Histogram};
use crate::state::session::Session;

/// Height of the curves in points.
const HEIGHT: f32 = 84.0;
/// The lowest panel that has room for them.
const ROOM: f32 = 330.0;
/// Share of the pixels from which on clipped ones are marked.
const MARKED: f32 = 0.0005;
/// Colours of red, green and blue, which add up where they lie over each other.
const CHANNELS: [Color32; 3] = [
    Color32::from_rgba_premultiplied(120, 30, 28, 0),
    Color32::from_rgba_premultiplied(26, 104, 34, 0),
    Color32::from_rgba_premultiplied(30, 54, 124, 0),
];

/// Shows the heading, and the curves where that is open; `height` is that of the panel.
pub fn show(ui: &mut Ui, session: &mut Session, height: f32) {
    ui.add_space(4.0);
    let is_open = session.settings.shows_histogram && height >= ROOM;
    let heading = CollapsingHeader::new("Histogram").open(Some(is_open)).show_unindented(ui, |ui| {
        ui.set_width(ui.available_width() - 10.0);
        curves(ui, session);
    });
    let hint = "How many pixels are dark, middling and light, in all and in each colour (h)";
    if heading.header_response.on_hover_text(hint).clicked() {
        session.settings.shows_histogram = !session.settings.shows_histogram;
    }
    ui.add_space(4.0);
}

fn curves(ui: &mut Ui, session: &Session) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    ui.painter().rect_filled(rect, 3.0, theme::EMPTY);
    let Some(histograms) = &session.histograms else {
        ui.label(RichText::new("Counting…").small().color(theme::FAINT));
        return;
    };
    let inner = rect.shrink(2.0);
    let most = histograms.shown.most();
    for (channel, color) in histograms.shown.channels[1..].iter().zip(CHANNELS) {
        bars(ui, inner, channel, most, color);
    }
    line(ui, inner, &histograms.original.channels[0], histograms.original.most(), Color32::from_gray(110));
    line(ui, inner, &histograms.shown.channels[0], most, theme::BRIGHT);
    response.on_hover_text("The light line is brightness, the dim one that of the original");
    ends(ui, inner, &histograms.shown);
}

/// Height of a count over the height of the curves.
fn share(count: u32, most: u32) -> f32 {
    (count as f32 / most as f32).min(1.0)
}

fn bars(ui: &Ui, rect: Rect, channel: &[u32; BINS], most: u32, color: Color32) {
    let step = rect.width() / BINS as f32;
    for (index, count) in channel.iter().enumerate().filter(|(_, count)| **count > 0) {
        let left = rect.left() + step * index as f32;
        let top = rect.bottom() - rect.height() * share(*count, most);
        let bar = Rect::from_min_max(pos2(left, top), pos2(left + step, rect.bottom()));
        ui.painter().rect_filled(bar, 0.0, color);
    }
}

fn line(ui: &Ui, rect: Rect, channel: &[u32; BINS], most: u32, color: Color32) {
    let point = |(index, count): (usize, &u32)| {
        let x = rect.left() + rect.width() * (index as f32 + 0.5) / BINS as f32;
        pos2(x, rect.bottom() - rect.height() * share(*count, most))
    };
    let points = channel.iter().enumerate().map(point).collect();
    ui.painter().add(Shape::line(points, Stroke::new(1.0, color)));
}

/// Marks of clipped shadows and highlights, and how many pixels that are.
fn ends(ui: &mut Ui, rect: Rect, shown: &Histogram) {
    let [low, high] = shown.clipped_shares();
    for (corner, side, clipped, color) in
        [(rect.left_top(), 1.0, low, theme::ACCENT), (rect.right_top(), -1.0, high, theme::BAD)]
    {
        if clipped > MARKED {
            let points = vec![corner, corner + vec2(side * 9.0, 0.0), corner + vec2(0.0, 9.0)];
            ui.painter().add(Shape::convex_polygon(points, color, Stroke::NONE));
        }
    }
    let text = |name: &str, share: f32| {
        let color = if share > MARKED { theme::TEXT } else { theme::FAINT };
        RichText::new(format!("{name} {:.1} %", share * 100.0)).small().color(color)
    };
    ui.horizontal(|ui| {
        ui.label(text("Lost in black", low))
            .on_hover_text("Pixels with a colour at the lower end of the scale");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let hint = "Pixels with a colour at the upper end of the scale";
            ui.label(text("Lost in white", high)).on_hover_text(hint);
        });
    });
}
