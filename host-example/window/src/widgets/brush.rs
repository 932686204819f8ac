//! The brush: its controls, its strokes on the picture, and what is painted as it is seen there.

use egui::{
    Color32, ColorImage, ComboBox, CursorIcon, Event, Id, Pos2, Rect, Response, TextureHandle,
    TextureOptions, Ui, pos2, vec2,
};

use super::number::Number;
use super::scale::{self, Scale};
use super::{keyboard, theme};
use crate::state::outcome::Dialog;
use crate::state::painted::brush::SIZES;
use crate::state::painted::channel::{Channel, Kind, MOST};
use crate::state::painted::key_frames::KeyFrames;
use crate::state::painted::maps::{Maps, middle};
use crate::state::playback::Playback;
use crate::state::session::Session;
use crate::state::viewport::{Area, Compare};
use crate::state::work::Request;

/// The largest brush that the slider gives; larger ones are typed.
const USUAL: f32 = 600.0;
/// Most pixels across and down of the picture of what is painted.
const MOST_SHOWN: u32 = 512;
/// Most numbers of key frames that are shown.
const MOST_NUMBERS: usize = 12;
/// Share of a frame that no key frame shows from which on it is told.
const TOLD: f32 = 0.01;
/// Opacity of what is painted in full.
const OPACITY: f32 = 150.0;
/// Colour of more.
const MORE: [u8; 3] = [255, 150, 40];
/// Colour of less.
const LESS: [u8; 3] = [60, 140, 255];
/// Colour where the look is taken away.
const GONE: [u8; 3] = [225, 40, 40];

/// The picture of what is painted: of which revision, frame and channel it is.
type Drawn = Option<((u64, i64, Channel), TextureHandle)>;

/// True where anything can be painted: on pictures, not on scenes.
pub fn has_any(session: &Session) -> bool {
    session.open.playback().is_some()
}

/// Shows the controls.
pub fn show(ui: &mut Ui, session: &mut Session) {
    ui.horizontal(|ui| {
        ui.add_space(12.0);
        let hint = "Paints on the picture with the left button (b). Alt erases; other buttons move the picture";
        ui.toggle_value(&mut session.painting.is_on, "Paint").on_hover_text(hint);
        let hint = "Takes back what was painted, stroke by stroke";
        ui.checkbox(&mut session.painting.brush.erases, "Erase").on_hover_text(hint);
        let hint = "Shows what is painted over the picture: orange for more, blue for less, red where the look is taken away";
        ui.checkbox(&mut session.painting.is_shown, "Show it").on_hover_text(hint);
    });
    channels(ui, session);
    let kind = session.painting.brush.channel.kind();
    if !session.looks.takes(kind.option()) {
        note(ui, &format!("{} follows no {}.", session.look().name, kind.name()));
    }
    sliders(ui, session);
    whole(ui, session);
    frames(ui, session);
}

/// The key frames of a sequence, and how what is painted on them lies on the others.
fn frames(ui: &mut Ui, session: &mut Session) {
    let Some(playback) = session.open.playback().filter(|playback| playback.frames().is_some()) else {
        return;
    };
    if !playback.has_key_frames() {
        return note(ui, "It lies on all frames as it is.");
    }
    let keys = playback.keys().cloned();
    let is_painted = |keys: &KeyFrames| Kind::ALL.iter().any(|kind| keys.has(*kind));
    let Some(keys) = keys.filter(|keys| is_painted(keys)) else {
        return note(ui, "The frame that is painted on becomes a key frame.");
    };
    let (key, has_others) = (playback.key(), keys.iter().count() > 1);
    let mut numbers: Vec<String> = keys.iter().map(|(frame, _)| frame.to_string()).collect();
    if numbers.len() > MOST_NUMBERS {
        let more = numbers.split_off(MOST_NUMBERS).len();
        numbers.push(format!("{more} more"));
    }
    note(ui, &format!("Painted on: {}", numbers.join(", ")));
    ui.horizontal(|ui| {
        ui.add_space(12.0);
        let carry = ui.add_enabled(!keys.is_carried(), egui::Button::new("Carry along the motion"));
        let hint = "Carries what is painted to all frames: along the motion vectors of the files, else along motion that is estimated";
        if carry.on_hover_text(hint).clicked() {
            session.carry_maps();
        }
        let remove = ui.add_enabled(has_others && keys.is_key(key), egui::Button::new("Remove this key frame"));
        if remove.on_hover_text("Takes back all that was painted on the frame that is shown").clicked() {
            session.remove_key_frame();
        }
    });
    let unknown = keys.unknown(key);
    note(
        ui,
        &match (keys.is_carried(), has_others) {
            (true, _) if unknown > TOLD => format!(
                "{:.0} % of this frame is seen on no key frame, and nothing is painted there. Paint on it.",
                100.0 * unknown
            ),
            (true, _) => "It is carried along the motion to all frames.".to_owned(),
            (false, true) => "Other frames have the map of the nearest as it is.".to_owned(),
            (false, false) => "It lies on all frames as it is.".to_owned(),
        },
    );
}

fn note(ui: &mut Ui, text: &str) {
    ui.add(egui::Label::new(egui::RichText::new(text).small().color(theme::FAINT)).wrap());
}

/// The list of what can be painted.
fn channels(ui: &mut Ui, session: &mut Session) {
    ui.horizontal(|ui| {
        ui.add_space(12.0);
        let label = ui.label("Paints");
        let takes = |kind: Kind| session.looks.takes(kind.option());
        let brush = &mut session.painting.brush;
        let name = brush.channel.label();
        let list = ComboBox::from_id_salt("channel").selected_text(name).width(200.0).truncate();
        let shown = list.show_ui(ui, |ui| {
            for channel in Channel::ALL {
                ui.add_enabled_ui(takes(channel.kind()), |ui| {
                    ui.selectable_value(&mut brush.channel, channel, channel.label());
                });
            }
        });
        keyboard::tell(&shown.response, name);
        let hint = "Looks follow what is painted as far as they have it: lines, detail, hatching, grain, strokes, paint";
        shown.response.labelled_by(label.id).on_hover_text(hint);
    });
}

/// The sliders of the brush.
fn sliders(ui: &mut Ui, session: &mut Session) {
    let mut row = |ui: &mut Ui, words: (&str, &str), scale: Scale<'_>| {
        scale::row(ui, words, &scale, &mut session.wheeled).map(|given| given as f32)
    };
    let scale = |value: f32, range: [f32; 2], most: f32, decimals, unit| {
        let (value, range) = (f64::from(value), range.map(f64::from));
        let ends = [range[0], f64::from(most)];
        Scale { number: Number { value, range, speed: (ends[1] - ends[0]) / 240.0, decimals, unit }, ends }
    };
    let brush = &mut session.painting.brush;
    let hint = match brush.channel.kind() {
        Kind::Control => {
            "0 changes nothing, 1 is four times as much, -1 a quarter; of the amount of lines none"
        }
        Kind::Mask => "-1 takes the look away, 1 brings it back",
    };
    if let Some(strength) = row(ui, ("Strength", hint), scale(brush.strength(), [-1.0, 1.0], 1.0, 2, "")) {
        brush.strengths[brush.channel as usize] = strength;
    }
    let hint = "Diameter in pixels of the picture ([ and ])";
    if let Some(size) = row(ui, ("Size", hint), scale(brush.size, SIZES, USUAL, 0, " px")) {
        brush.size = size;
    }
    let hint = "Share of the brush that paints in full; from there on it falls off";
    if let Some(hardness) = row(ui, ("Hardness", hint), scale(brush.hardness, [0.0, 1.0], 1.0, 2, "")) {
        brush.hardness = hardness;
    }
}

/// Buttons for maps as a whole.
fn whole(ui: &mut Ui, session: &mut Session) {
    let channel = session.painting.brush.channel;
    let kind = channel.kind();
    let has = |is: &dyn Fn(&Maps) -> bool| session.maps().is_some_and(is);
    let (is_painted, can_save) = (has(&|maps| !maps.layer(channel).is_plain()), has(&|maps| maps.has(kind)));
    let file = if kind == Kind::Control { "the control map, all four numbers of it," } else { "the mask" };
    ui.horizontal(|ui| {
        ui.add_space(12.0);
        if ui.button("Fill").on_hover_text("Paints all of the picture").clicked() {
            session.fill_map();
        }
        let clear = ui.add_enabled(is_painted, egui::Button::new("Clear"));
        if clear.on_hover_text(format!("Takes back all that was painted of: {}", channel.label())).clicked() {
            session.clear_map();
        }
        let save = ui.add_enabled(can_save, egui::Button::new("Save the map…"));
        if save.on_hover_text(format!("Saves {file} as a PNG file, which isophote apply takes")).clicked() {
            session.work.ask(Request::Choose(Dialog::SaveMap(kind)));
        }
        let open = ui.button("Open a map…").on_hover_text(format!("Opens {file} in the place of this one"));
        if open.clicked() {
            session.work.ask(Request::Choose(Dialog::OpenMap(kind)));
        }
    });
}

/// Lets the pointer paint, or ends a stroke where it does no more.
pub fn paint(ui: &Ui, response: &Response, session: &mut Session) {
    if !session.is_painting() {
        return session.end_stroke();
    }
    let (scale, size) = (ui.pixels_per_point(), session.nominal_size());
    let place = |session: &Session, at: Pos2| session.viewport.on_picture(size, [at.x * scale, at.y * scale]);
    if session.painting.stroke.is_none() {
        let pressed =
            response.is_pointer_button_down_on() && ui.input(|input| input.pointer.primary_pressed());
        if let Some(at) = response.interact_pointer_pos().filter(|_| pressed) {
            let at = place(session, at);
            session.begin_stroke(at, ui.input(|input| input.modifiers.alt));
        }
        return;
    }
    // More places than one frame has are on the way.
    let is_move = |event: &Event| if let Event::PointerMoved(at) = event { Some(*at) } else { None };
    let way: Vec<Pos2> = ui.input(|input| input.events.iter().filter_map(is_move).collect());
    for at in way {
        let at = place(session, at);
        session.go_on_stroke(at);
    }
    if !ui.input(|input| input.pointer.primary_down()) {
        session.end_stroke();
    }
}

/// Draws what is painted, and the brush.
pub fn draw(ui: &Ui, rect: Rect, pointer: Option<Pos2>, session: &Session) {
    if !session.is_painting() {
        return;
    }
    let (scale, size) = (ui.pixels_per_point(), session.nominal_size());
    let points =
        |area: Area| Rect::from_min_size(pos2(area.x, area.y) / scale, vec2(area.width, area.height) / scale);
    let viewport = &session.viewport;
    if session.painting.is_shown
        && !viewport.peek
        && let Some(texture) = texture(ui, session)
    {
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        let first = usize::from(viewport.compare != Compare::Side);
        for (place, half) in viewport.places(size).into_iter().zip(viewport.halves()).skip(first) {
            let painter = ui.painter_at(points(half).intersect(rect));
            painter.image(texture.id(), points(place), whole, Color32::WHITE);
        }
    }
    if let Some(at) = pointer.filter(|at| rect.contains(*at)) {
        let radius = (session.painting.brush.size * 0.5 * viewport.scale(size) / scale).max(1.0);
        let painter = ui.painter_at(rect);
        painter.circle_stroke(at, radius, (2.5, Color32::from_black_alpha(110)));
        painter.circle_stroke(at, radius, (1.0, Color32::from_white_alpha(220)));
        ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
    }
}

/// Picture of what is painted of the brush's channel, if anything is.
fn texture(ui: &Ui, session: &Session) -> Option<TextureHandle> {
    let (painting, maps) = (&session.painting, session.maps()?);
    let channel = painting.stroke.as_ref().map_or(painting.brush.channel, |stroke| stroke.brush().channel);
    if maps.layer(channel).is_plain() {
        return None;
    }
    let id = Id::unique("painted");
    let drawn: Drawn = ui.data(|data| data.get_temp(id)).flatten();
    let frame = session.open.playback().map_or(0, Playback::key);
    let of = (painting.revision, frame, channel);
    if let Some((known, texture)) = &drawn
        && *known == of
    {
        return Some(texture.clone());
    }
    let image = image(maps, channel);
    let texture = match drawn {
        Some((_, mut texture)) if texture.size() == image.size => {
            texture.set(image, TextureOptions::LINEAR);
            texture
        }
        _ => ui.ctx().load_texture("painted", image, TextureOptions::LINEAR),
    };
    ui.data_mut(|data| data.insert_temp::<Drawn>(id, Some((of, texture.clone()))));
    Some(texture)
}

/// What is painted of a channel, small.
fn image(maps: &Maps, channel: Channel) -> ColorImage {
    let (width, height) = maps.size();
    let share = (MOST_SHOWN as f32 / width.max(height) as f32).min(1.0);
    let [across, down] = [width, height].map(|length| ((length as f32 * share).round() as u32).max(1));
    let tiles = maps.layer(channel);
    let cells = (0..down).flat_map(|y| (0..across).map(move |x| (x, y)));
    let colour = |(x, y): (u32, u32)| {
        colour(channel, tiles.get(middle(x as usize, width, across), middle(y as usize, height, down)))
    };
    ColorImage::new([across as usize, down as usize], cells.map(colour).collect())
}

fn colour(channel: Channel, value: u8) -> Color32 {
    let plain = f32::from(channel.plain());
    let (tint, share) = match channel.kind() {
        Kind::Mask => (GONE, 1.0 - f32::from(value) / plain),
        Kind::Control => {
            let step = (f32::from(value) - plain) / f32::from(MOST / 2);
            (if step > 0.0 { MORE } else { LESS }, step.abs())
        }
    };
    Color32::from_rgba_unmultiplied(tint[0], tint[1], tint[2], (share * OPACITY).round() as u8)
}
