//! Messages of the window, in bars above the lower border of the picture.

use egui::{Align2, Button, Frame, Id, Margin, Rect, RichText, vec2};

use super::theme;
use crate::state::session::Session;
use crate::state::work::Request;

/// Points beside the text for the buttons of a note that tells of a file.
const BUTTONS: f32 = 170.0;

/// Shows all notes.
pub fn show(context: &egui::Context, rect: Rect, session: &mut Session) {
    let (mut dismissed, mut shown) = (None, None);
    let notes = session.notes.present();
    if notes.is_empty() {
        return;
    }
    let width = (rect.width() - 64.0).clamp(80.0, 760.0);
    egui::Area::new(Id::unique("notes"))
        .pivot(Align2::CENTER_BOTTOM)
        .fixed_pos(rect.center_bottom() + vec2(0.0, -12.0))
        .show(context, |ui| {
            for (index, note) in notes.iter().enumerate() {
                let frame = Frame::new().fill(egui::Color32::from_gray(46)).corner_radius(6.0);
                frame.inner_margin(Margin::symmetric(12, 8)).show(ui, |ui| {
                    ui.horizontal(|ui| {
                        ui.set_max_width(width);
                        let color = if note.is_bad { theme::BAD } else { theme::TEXT };
                        let text = egui::Label::new(RichText::new(&note.text).color(color)).wrap();
                        let said = match note.place {
                            Some(_) => {
                                let beside = ui.vertical(|ui| {
                                    ui.set_max_width((width - BUTTONS).max(80.0));
                                    ui.add(text)
                                });
                                beside.inner
                            }
                            None => ui.add(text),
                        };
                        announce(context, said.id, note.is_bad);
                        if let Some(place) = &note.place
                            && ui.add(Button::new("Show in folder").small()).clicked()
                        {
                            shown = Some(place.clone());
                        }
                        if (note.is_bad || note.place.is_some())
                            && ui.add(Button::new("OK").small()).clicked()
                        {
                            dismissed = Some(index);
                        }
                    });
                });
            }
        });
    shown.into_iter().for_each(|place| session.work.ask(Request::Reveal(place)));
    if let Some(index) = dismissed {
        session.notes.dismiss(index);
    }
    // What goes away by itself must be seen to go; what stays draws nothing anew.
    session.notes.next_end().into_iter().for_each(|left| context.request_repaint_after(left));
}

/// Lets programs that read the window aloud say a message when it comes.
fn announce(context: &egui::Context, label: Id, is_bad: bool) {
    use egui::accesskit::Live;
    let live = if is_bad { Live::Assertive } else { Live::Polite };
    context.accesskit_node_builder(label, |node| node.set_live(live));
}
