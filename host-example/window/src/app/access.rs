//! Programs that read the window aloud, or act in it for people who use neither eyes nor hands for it.

use std::time::Instant;

use egui_winit::accesskit_winit::WindowEvent;

use super::App;

impl App {
    /// Does what such a program asks for. The controls are described from the moment on that the first one does: it costs time.
    pub(super) fn access(&mut self, event: WindowEvent) {
        let Some(input) = &mut self.input else { return };
        match event {
            WindowEvent::InitialTreeRequested => input.egui_ctx().enable_accesskit(),
            WindowEvent::ActionRequested(request) => input.on_accesskit_action_request(request),
            WindowEvent::AccessibilityDeactivated => input.egui_ctx().disable_accesskit(),
        }
        self.due = Some(Instant::now());
    }
}
