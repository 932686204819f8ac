//! Paper and hatching in the place of the look's own.

use std::path::{Path, PathBuf};

use egui::{ComboBox, Ui};

use super::keyboard;
use crate::state::materials::chosen;
use crate::state::outcome::Dialog;
use crate::state::session::Session;
use crate::state::work::Request;
use isophote_pictures::material::MaterialKind;

/// Text where the look has its own.
const OWN: &str = "The look's own";

/// True where the look of what is open has any materials.
pub fn has_any(session: &Session) -> bool {
    MaterialKind::ALL.into_iter().any(|kind| has(session, kind))
}

/// True where the look has a kind of material, or one was chosen.
fn has(session: &Session, kind: MaterialKind) -> bool {
    let takes = || session.open.has_picture() && session.looks.takes(kind.guide().id());
    takes() || chosen(session).iter().any(|(known, _)| *known == kind)
}

/// Shows the controls.
pub fn show(ui: &mut Ui, session: &mut Session) {
    for kind in MaterialKind::ALL.into_iter().filter(|kind| has(session, *kind)).collect::<Vec<_>>() {
        let name = chosen(session).into_iter().find(|(known, _)| *known == kind).map(|(_, name)| name);
        let request = row(ui, kind, name);
        request.into_iter().for_each(|request| session.work.ask(request));
    }
}

/// The list of one kind, and what was chosen of it.
fn row(ui: &mut Ui, kind: MaterialKind, chosen: Option<&Path>) -> Option<Request> {
    let (label, hint) = match kind {
        MaterialKind::Paper => ("Paper", "Paper that looks with paper are drawn on"),
        MaterialKind::Hatching => ("Hatching", "Hatching that ink draws its tones with"),
    };
    let name = chosen.map_or(OWN.into(), |name| match kind.ships(name) {
        true => title(&name.to_string_lossy()),
        false => name.file_name().unwrap_or_default().to_string_lossy().into_owned(),
    });
    let mut request = None;
    ui.horizontal(|ui| {
        ui.add_space(12.0);
        let label = ui.label(label);
        let list = ComboBox::from_id_salt(kind.guide().id()).selected_text(&name).width(200.0).truncate();
        let shown = list.show_ui(ui, |ui| {
            if ui.selectable_label(chosen.is_none(), OWN).clicked() {
                request = Some(Request::ChooseMaterial(kind, None));
            }
            for shipped in kind.shipped() {
                let own = Path::new(shipped.name);
                let response = ui.selectable_label(chosen == Some(own), title(shipped.name));
                if response.on_hover_text(shipped.doc.trim_end_matches('.')).clicked() {
                    request = Some(Request::ChooseMaterial(kind, Some(PathBuf::from(own))));
                }
            }
            if ui.selectable_label(false, "From a file…").clicked() {
                request = Some(Request::Choose(Dialog::Material(kind)));
            }
        });
        keyboard::tell(&shown.response, &name);
        shown.response.labelled_by(label.id).on_hover_text(hint);
    });
    request
}

/// A name as people write it: `cold_press` is "Cold press".
fn title(name: &str) -> String {
    let words = name.replace('_', " ");
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
