//! Dialogs within the window: nothing behind one takes keys or clicks, Enter does what it is for, and the focus begins within it
//! and returns to where it was.

use egui::{Button, Context, FocusDirection, Frame, Id, Key, Layout, Margin, Modal, RichText, Ui};

use super::theme;

/// Width in points at which lines are broken at the latest.
const WIDEST: f32 = 760.0;

/// A dialog that is open.
#[derive(Clone, Copy, Debug)]
struct Opened {
    id: Id,
    /// The control that had the focus when it was opened.
    home: Option<Id>,
    /// Passes in which it has been shown, of which the last has this number.
    passes: u32,
    last: u64,
}

/// Dialogs that are open, from the back to the front, and the focus outside of them.
#[derive(Clone, Debug, Default)]
struct Stack {
    opened: Vec<Opened>,
    /// The control that had the focus last while no menu was open.
    home: Option<Id>,
    /// True where a menu was open.
    has_menu: bool,
    /// True where Enter does what the dialog in front is for, in this pass.
    confirms: bool,
}

fn stack<R>(context: &Context, change: impl FnOnce(&mut Stack) -> R) -> R {
    let id = Id::unique("dialogs");
    context.data_mut(|data| change(data.get_temp_mut_or_default::<Stack>(id)))
}

/// Shows a dialog in the middle of the window. `open` turns false when it is closed by its cross; without it there is none.
pub fn show<R>(
    context: &Context,
    title: &str,
    open: Option<&mut bool>,
    content: impl FnOnce(&mut Ui) -> R,
) -> R {
    let id = Id::unique(("dialog", title));
    begin(context, id);
    let frame = Frame::popup(&context.global_style()).inner_margin(Margin::same(18));
    let width = (context.content_rect().width() - 60.0).clamp(100.0, WIDEST);
    let area = Modal::default_area(id).default_width(width).accessible_name(title);
    let shown = Modal::new(id).area(area).frame(frame).show(context, |ui| {
        let heading = ui.label(RichText::new(title).size(17.0).color(theme::BRIGHT));
        ui.add_space(8.0);
        let inner = content(ui);
        if let Some(open) = open {
            let size = egui::vec2(22.0, 22.0);
            let right = ui.min_rect().right().max(heading.rect.right() + size.x);
            let place =
                egui::Rect::from_center_size(egui::pos2(right - size.x / 2.0, heading.rect.center().y), size);
            let mut corner = ui.new_child(
                egui::UiBuilder::new()
                    .max_rect(place)
                    .layout(Layout::centered_and_justified(egui::Direction::TopDown)),
            );
            let cross = corner.add(Button::new("✖").frame(false)).accessible_name("Close");
            *open &= !cross.clicked();
        }
        inner
    });
    context.accesskit_node_builder(id, |node| node.set_modal());
    shown.inner
}

/// Registers that a dialog is shown in this pass, and gives its first control the focus in the second one: before, controls
/// behind it would take it.
fn begin(context: &Context, id: Id) {
    let pass = context.cumulative_pass_nr();
    let (focused, has_menu) = (context.memory(|memory| memory.focused()), egui::Popup::is_any_open(context));
    let clicked = context.interaction_snapshot(|snapshot| snapshot.clicked);
    let is_typing = context.text_edit_focused();
    let is_enter = context.input(|input| input.key_pressed(Key::Enter));
    let passes = stack(context, |stack| {
        let is_front = stack.opened.last().is_none_or(|front| front.id == id);
        let home = if has_menu { stack.home } else { focused.or(clicked).or(stack.home) };
        let known = stack.opened.iter_mut().find(|opened| opened.id == id);
        let passes = match known {
            Some(opened) => {
                (opened.passes, opened.last) = (opened.passes.saturating_add(1), pass);
                opened.passes
            }
            None => {
                stack.opened.push(Opened { id, home, passes: 0, last: pass });
                0
            }
        };
        // The key that has opened it does not close it.
        let is_free = is_typing || focused.is_none();
        stack.confirms = is_front && passes > 1 && is_enter && is_free && !has_menu;
        passes
    });
    match passes {
        0 => {
            egui::Popup::close_all(context);
            context.memory_mut(|memory| focused.into_iter().for_each(|id| memory.surrender_focus(id)));
            context.request_repaint();
        }
        1 => context.memory_mut(|memory| {
            if memory.focused().is_none() {
                memory.move_focus(FocusDirection::Next);
            }
        }),
        _ => {}
    }
}

/// True where the dialog in front has just been opened, and gives its focus away.
fn is_new(context: &Context) -> bool {
    stack(context, |stack| stack.opened.last().is_some_and(|front| front.passes == 1))
}

/// Gives a control the focus where the dialog has just been opened, instead of the first one.
pub fn begin_with(control: &egui::Response) {
    if is_new(&control.ctx) {
        control.request_focus();
    }
}

/// The button that does what a dialog is for: Enter presses it, too, unless another control has the focus that takes it. The
/// focus begins with it where the first control is no field that is typed in.
pub fn confirm(ui: &mut Ui, text: &str, enabled: bool) -> bool {
    let button = ui.add_enabled(enabled, Button::new(text).fill(theme::CHOSEN));
    if enabled && is_new(ui.ctx()) && !ui.ctx().text_edit_focused() {
        button.request_focus();
    }
    let is_entered = stack(ui.ctx(), |stack| std::mem::take(&mut stack.confirms));
    button.clicked() || enabled && is_entered
}

/// Returns the focus to where it was, where a dialog or a menu has been closed in this pass; called after all of them.
pub fn end(context: &Context) {
    let pass = context.cumulative_pass_nr();
    let (focused, has_menu) = (context.memory(|memory| memory.focused()), egui::Popup::is_any_open(context));
    let home = stack(context, |stack| {
        let mut home = None;
        while let Some(closed) = stack.opened.pop_if(|opened| opened.last != pass) {
            home = closed.home;
        }
        if std::mem::replace(&mut stack.has_menu, has_menu) && !has_menu && focused.is_none() {
            home = home.or(stack.home);
        }
        if stack.opened.is_empty() && !has_menu && home.is_none() {
            stack.home = focused;
        }
        home
    });
    if let Some(home) = home {
        context.memory_mut(|memory| memory.request_focus(home));
        context.request_repaint();
    }
}
