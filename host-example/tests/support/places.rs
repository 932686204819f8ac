//! Where controls lie in the window.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use isophote_host::view::session::Session;
use isophote_host::view::ui;

/// Places of controls in a window of a size that shows a session: the same controls are laid out once more and found by their
/// labels and roles.
pub fn places(session: Session, (width, height): (u32, u32)) -> impl FnMut(&str, Role) -> egui::Rect {
    let mut harness = Harness::builder()
        .with_size(egui::vec2(width as f32, height as f32))
        .build_ui_state(|ui, session: &mut Session| ui::show(ui, session), session);
    ui::theme::apply(&harness.ctx);
    harness.run_ok();
    move |label, role| {
        let mut found = harness.query_all_by_label(label);
        let control = found.find(|node| node.accesskit_node().role() == role);
        control.unwrap_or_else(|| panic!("there is no '{label}'")).rect()
    }
}
