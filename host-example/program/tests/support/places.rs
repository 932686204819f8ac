//! Places of controls in the window.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use isophote_window::state::session::Session;
use isophote_window::widgets;

/// Places of controls in a window of a size that shows a session: the same controls are laid out once more and found by their
/// labels and roles.
pub fn places(session: Session, (width, height): (u32, u32)) -> impl FnMut(&str, Role) -> egui::Rect {
    let harness = laid_out(session, (width, height));
    move |label, role| {
        let mut found = harness.query_all_by_label(label);
        let control = found.find(|node| node.accesskit_node().role() == role);
        control.unwrap_or_else(|| panic!("there is no '{label}'")).rect()
    }
}

/// Number of times that Tab is pressed in such a window until a button has the focus.
pub fn tabs_to(session: Session, size: (u32, u32), label: &str) -> usize {
    const MOST: usize = 100;
    let mut harness = laid_out(session, size);
    let steps = (1..MOST).find(|_| {
        harness.key_press(egui::Key::Tab);
        harness.run_ok();
        harness.get_by_role_and_label(Role::Button, label).accesskit_node().is_focused()
    });
    steps.unwrap_or_else(|| panic!("Tab does not lead to '{label}'"))
}

fn laid_out(session: Session, (width, height): (u32, u32)) -> Harness<'static, Session> {
    let mut harness = Harness::builder()
        .with_size(egui::vec2(width as f32, height as f32))
        .build_ui_state(|ui, session: &mut Session| widgets::show(ui, session), session);
    widgets::theme::apply(&harness.ctx);
    harness.run_ok();
    harness
}
