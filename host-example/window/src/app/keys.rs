//! Keys: those of the window, and those that belong to a field, a menu or a question.

use std::time::Instant;

use egui_winit::State;
use winit::event::{ElementState, KeyEvent, WindowEvent};
use winit::keyboard::{Key, NamedKey};

use super::{App, clicks};
use crate::state::leaving::Leaving;
use crate::state::outcome::Dialog;
use crate::state::work::Request;
use crate::widgets;

impl App {
    /// True for an Escape that comes again while the key is held: it closes one thing, and the control that has the focus then
    /// keeps it.
    pub(super) fn is_held_escape(event: &WindowEvent) -> bool {
        let WindowEvent::KeyboardInput { event, .. } = event else { return false };
        event.repeat && event.logical_key == Key::Named(NamedKey::Escape)
    }

    /// Lets the controls see the clicks that came before a key: they decide what it is for, and must not find what it has changed.
    pub(super) fn catch_up(&mut self) {
        loop {
            let fresh = self.input.as_ref().map(|input| &input.egui_input().events);
            let is_behind = fresh.is_some_and(|fresh| clicks::is_any(fresh)) || clicks::is_any(&self.late);
            if !is_behind || self.show_controls().is_none() {
                return;
            }
        }
    }

    /// Does what a key stands for.
    pub(super) fn key(&mut self, event: &KeyEvent) {
        let key = event.logical_key.as_ref();
        if !self.is_for_window(&event.logical_key) {
            return;
        }
        let pressed = event.state == ElementState::Pressed;
        let session = &mut self.session;
        if key == Key::Character("\\") {
            session.viewport.peek = pressed && !session.dialogs.leaving.is_shown() && !session.has_dialog();
            return;
        }
        if !pressed {
            return;
        }
        self.due = Some(Instant::now());
        if !self.is_command() {
            return widgets::keys::press(&mut self.session, &event.logical_key);
        }
        let session = &mut self.session;
        match key {
            Key::Character("q" | "Q") => self.leave(),
            _ if session.dialogs.leaving.is_shown() || session.has_dialog() => {}
            Key::Character("m") => widgets::keys::mark(session),
            Key::Named(NamedKey::Enter) => widgets::keys::compare(session),
            Key::Character("z") if !self.modifiers.shift_key() => session.undo(),
            Key::Character("z" | "Z" | "y") => session.redo(),
            Key::Character("e") => session.plan_export(),
            Key::Character("o") => session.work.ask(Request::Choose(Dialog::File)),
            Key::Character("s") => session.save_look(self.modifiers.shift_key()),
            Key::Character("S") => session.save_look(true),
            _ => {}
        }
    }

    /// Closes the window, or asks in it before, which must be seen then.
    pub(super) fn leave(&mut self) {
        self.session.leave();
        self.due = Some(Instant::now());
        if let Some(window) = self.window.as_ref().filter(|_| self.hidden)
            && self.session.dialogs.leaving == Leaving::Asks
        {
            window.set_minimized(false);
            window.focus_window();
        }
    }

    fn is_command(&self) -> bool {
        self.modifiers.control_key() || self.modifiers.super_key()
    }

    /// True for a key that is not for the control that has the focus, for the field that is being typed in, or for the menu that
    /// is open. Those that close the window or a dialog are for the window in fields, too.
    fn is_for_window(&self, key: &Key) -> bool {
        let Some(context) = self.input.as_ref().map(State::egui_ctx) else { return true };
        let closes = self.is_command() && matches!(key.as_ref(), Key::Character("q" | "Q"));
        let closes_dialog = *key == Key::Named(NamedKey::Escape) && self.session.has_dialog();
        let is_typing = context.text_edit_focused() && !closes_dialog;
        let has_focus = context.memory(|memory| memory.focused()).is_some();
        let is_control_s = has_focus && !self.is_command() && widgets::keyboard::belongs_to_controls(key);
        closes
            || self.session.dialogs.leaving.is_shown()
            || !egui::Popup::is_any_open(context) && !is_typing && !is_control_s
    }

    /// True for a letter that the window takes: a field that the same letter opens does not see it.
    pub(super) fn is_taken(&self, event: &WindowEvent) -> bool {
        let WindowEvent::KeyboardInput { event, .. } = event else { return false };
        let is_letter =
            matches!(event.logical_key, Key::Character(_)) && event.state == ElementState::Pressed;
        is_letter && !self.is_command() && self.is_for_window(&event.logical_key)
    }

    /// Lets the controls see an event.
    pub(super) fn pass_on(&mut self, event: &WindowEvent) {
        let (Some(window), Some(input)) = (&self.window, &mut self.input) else { return };
        if input.on_window_event(window, event).repaint && !matches!(event, WindowEvent::RedrawRequested) {
            self.due = Some(Instant::now());
        }
    }
}
