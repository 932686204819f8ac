//! Theme of the controls: dark, neutral and quiet, so that colours are judged by the picture.

use egui::{Color32, CornerRadius, FontFamily, FontId, Margin, Stroke, TextStyle, Visuals, vec2};

/// Colour of what is switched on or chosen.
pub const ACCENT: Color32 = Color32::from_rgb(112, 152, 196);
/// Ring around the control that has the focus.
pub const FOCUS: Color32 = Color32::from_rgb(158, 200, 246);
/// Text that matters less.
pub const FAINT: Color32 = Color32::from_gray(138);
/// Text that matters.
pub const TEXT: Color32 = Color32::from_gray(206);
/// Text that names things.
pub const BRIGHT: Color32 = Color32::from_gray(232);
/// Colour of what went wrong.
pub const BAD: Color32 = Color32::from_rgb(226, 132, 110);
/// Colour of the stars of favourites.
pub const STAR: Color32 = Color32::from_rgb(232, 190, 92);
/// Behind text that lies on the picture.
pub const VEIL: Color32 = Color32::from_rgba_premultiplied(14, 14, 14, 190);
/// Panels.
pub const PANEL: Color32 = Color32::from_gray(34);
/// Colour that surrounds pictures.
pub const SURROUND: Color32 = Color32::from_gray(27);
/// Cards.
pub const CARD: Color32 = Color32::from_gray(38);
/// Cards under the pointer, and the selected one.
pub const CARD_ABOVE: Color32 = Color32::from_gray(50);
/// Colour of the place where there is no picture yet.
pub const EMPTY: Color32 = Color32::from_gray(22);
/// Behind the text of a button that goes on with something.
pub const CHOSEN: Color32 = Color32::from_rgb(62, 88, 116);

/// Gives a context this look, and clicks that count however long a button is held: where frames are slow, the shortest
/// is as long as a frame.
pub fn apply(context: &egui::Context) {
    context.options_mut(|options| options.input_options.max_click_duration = f64::INFINITY);
    context.set_theme(egui::Theme::Dark);
    context.set_visuals_of(egui::Theme::Dark, visuals());
    context.all_styles_mut(|style| {
        for (name, size) in [
            (TextStyle::Body, 13.0),
            (TextStyle::Button, 13.0),
            (TextStyle::Small, 11.0),
            (TextStyle::Heading, 17.0),
        ] {
            style.text_styles.insert(name, FontId::new(size, FontFamily::Proportional));
        }
        style.text_styles.insert(TextStyle::Monospace, FontId::new(12.0, FontFamily::Monospace));
        style.spacing.item_spacing = vec2(8.0, 5.0);
        style.spacing.button_padding = vec2(8.0, 3.0);
        style.spacing.interact_size = vec2(28.0, 20.0);
        style.spacing.slider_rail_height = 4.0;
        style.spacing.combo_height = 420.0;
        style.spacing.tooltip_width = 320.0;
        style.spacing.menu_margin = Margin::same(6);
        style.interaction.tooltip_delay = 0.5;
        style.animation_time = 0.1;
    });
}

fn visuals() -> Visuals {
    let mut visuals = Visuals::dark();
    visuals.panel_fill = PANEL;
    visuals.window_fill = Color32::from_gray(40);
    visuals.extreme_bg_color = Color32::from_gray(22);
    visuals.faint_bg_color = Color32::from_gray(40);
    visuals.warn_fg_color = BAD;
    visuals.error_fg_color = BAD;
    visuals.window_stroke = Stroke::new(1.0, Color32::from_gray(58));
    visuals.window_corner_radius = CornerRadius::same(8);
    visuals.menu_corner_radius = CornerRadius::same(6);
    visuals.slider_trailing_fill = true;
    visuals.handle_shape = egui::style::HandleShape::Circle;
    visuals.indent_has_left_vline = false;
    visuals.disabled_alpha = 0.4;
    visuals.selection.bg_fill = CHOSEN;
    visuals.selection.stroke = Stroke::new(1.0, Color32::from_gray(236));
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, Color32::from_gray(50));
    widgets.noninteractive.fg_stroke = Stroke::new(1.0, TEXT);
    widgets.inactive.fg_stroke = Stroke::new(1.0, TEXT);
    widgets.inactive.bg_fill = Color32::from_gray(60);
    widgets.inactive.weak_bg_fill = Color32::from_gray(52);
    widgets.hovered.weak_bg_fill = Color32::from_gray(66);
    widgets.hovered.bg_fill = Color32::from_gray(78);
    widgets.hovered.bg_stroke = Stroke::new(1.0, Color32::from_gray(84));
    widgets.active.weak_bg_fill = Color32::from_gray(74);
    widgets.active.bg_fill = ACCENT;
    for state in [&mut widgets.inactive, &mut widgets.hovered, &mut widgets.active, &mut widgets.open] {
        state.corner_radius = CornerRadius::same(4);
        state.expansion = 0.0;
    }
    visuals
}

/// A heading of a word.
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
