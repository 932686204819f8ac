//! The wheel over sliders: it changes them in fine steps where the pointer has rested, and else scrolls what they lie in.

use egui::{Event, Id, MouseWheelUnit, Pos2, Response, Ui, Vec2};

/// Seconds that the pointer rests before the wheel is for the slider below it.
const REST: f64 = 0.3;
/// Points to a notch for devices that scroll smoothly.
const NOTCH: f32 = 40.0;
/// Steps from one end of a slider to the other.
const STEPS: f64 = 100.0;
/// Steps with Shift to one without.
const FINE: f64 = 10.0;

/// The pointer above a slider.
#[derive(Clone, Copy)]
struct Pointer {
    over: Id,
    at: Pos2,
    /// Time at which it was moved last. What was scrolled to below it has not been meant.
    since: Option<f64>,
    /// True where it has rested, until it leaves.
    has_rested: bool,
    /// Notches that are too few for a step.
    left: f32,
}

/// A value that can be turned.
pub struct Turned {
    /// The value as it is.
    pub value: f64,
    /// Both ends of its slider.
    pub ends: [f64; 2],
    /// True for whole numbers.
    pub is_whole: bool,
}

impl Turned {
    /// The value that the wheel gives the slider of `response`, if it turns and is meant for it.
    pub fn by_wheel(&self, ui: &Ui, response: &Response) -> Option<f64> {
        let mut pointer = resting(ui, response)?;
        let notches = notches(ui) + pointer.left;
        // A list that it lies in stays where it is.
        ui.input_mut(|input| input.smooth_scroll_delta = Vec2::ZERO);
        if notches == 0.0 {
            return None;
        }
        let shift = |event: &Event| matches!(event, Event::MouseWheel { modifiers, .. } if modifiers.shift);
        let is_fine = ui.input(|input| input.events.iter().any(shift));
        let mut step = (self.ends[1] - self.ends[0]) / STEPS / if is_fine { FINE } else { 1.0 };
        let mut count = f64::from(notches);
        if self.is_whole {
            step = step.round().max(1.0);
            count = count.trunc();
            pointer.left = notches.fract();
            keep(ui, pointer);
        }
        let [least, most] = [self.ends[0].min(self.value), self.ends[1].max(self.value)];
        // A few digits more than the step has.
        let digits = (2.0 - step.log10().floor()).clamp(0.0, 12.0) as usize;
        let value = egui::emath::round_to_decimals(self.value + count * step, digits).clamp(least, most);
        (value != self.value).then_some(value)
    }
}

/// The pointer where it has rested over a slider, or is over one that has the focus.
fn resting(ui: &Ui, response: &Response) -> Option<Pointer> {
    let (time, at) = ui.input(|input| (input.time, input.pointer.hover_pos()));
    let before = ui.data(|data| data.get_temp::<Pointer>(key())).filter(|before| before.over == response.id);
    let Some(at) = at.filter(|_| response.hovered() && response.enabled()) else {
        if before.is_some() {
            ui.data_mut(|data| data.remove::<Pointer>(key()));
        }
        return None;
    };
    let moves = ui.input(|input| input.events.iter().any(|event| matches!(event, Event::PointerMoved(_))));
    let moves = moves && before.is_none_or(|before| before.at != at);
    let mut pointer =
        before.unwrap_or(Pointer { over: response.id, at, since: None, has_rested: false, left: 0.0 });
    pointer.at = at;
    let rests = pointer.since.is_some_and(|since| time - since >= REST) && !moves;
    pointer.has_rested |= rests || response.has_focus();
    if moves {
        pointer.since = Some(time);
    }
    if !pointer.has_rested
        && (notches(ui) != 0.0 || ui.input(|input| input.smooth_scroll_delta) != Vec2::ZERO)
    {
        pointer.since = None;
    }
    keep(ui, pointer);
    pointer.has_rested.then_some(pointer)
}

fn keep(ui: &Ui, pointer: Pointer) {
    ui.data_mut(|data| data.insert_temp(key(), pointer));
}

fn key() -> Id {
    Id::unique("wheel over a slider")
}

/// Notches that the wheel has turned since the last frame, away from who turns it. With Ctrl it magnifies.
fn notches(ui: &Ui) -> f32 {
    let of = |event: &Event| match event {
        Event::MouseWheel { unit, delta, modifiers, .. } if !modifiers.command => {
            // Some systems turn the wheel to the side with Shift.
            let by = if delta.y == 0.0 && modifiers.shift { delta.x } else { delta.y };
            match unit {
                MouseWheelUnit::Point => by / NOTCH,
                MouseWheelUnit::Line => by,
                MouseWheelUnit::Page => by * 4.0,
            }
        }
        _ => 0.0,
    };
    ui.input(|input| input.events.iter().map(of).sum())
}
