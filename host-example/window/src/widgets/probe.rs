//! The pixel under the pointer in words, in the room that the bar has for them.

use egui::{Label, RichText, TextStyle, Ui};

use super::theme;
use crate::state::session::Session;

/// Shows the pixel, with as many digits as there is room for.
pub fn show(ui: &mut Ui, session: &Session) {
    let Some(probed) = &session.probed else { return };
    let frame = session.open.playback().and_then(|playback| playback.frame(false));
    let font = TextStyle::Monospace.resolve(ui.style());
    // The end of the bar scrolls, so that its own width says nothing.
    let room = ui.clip_rect().right() - ui.cursor().left();
    let fits = |line: &String| {
        let laid = ui.painter().layout_no_wrap(line.clone(), font.clone(), theme::FAINT);
        laid.size().x <= room
    };
    let lines = probed.lines(frame.is_some_and(|(frame, _)| frame.is_bytes));
    if let Some(line) = lines.into_iter().find(fits) {
        ui.add(Label::new(RichText::new(line).monospace().color(theme::FAINT)).selectable(false));
    }
}
