//! Clicks that are faster than frames.

/// Leaves at most one press or release of a button among the events, those of before first, and returns the rest: controls
/// do not see a click that begins and ends within one frame, as clicks do where frames are slow.
pub fn one_at_a_time(events: &mut Vec<egui::Event>, before: Vec<egui::Event>) -> Vec<egui::Event> {
    events.splice(..0, before);
    let is_button = |event: &egui::Event| matches!(event, egui::Event::PointerButton { .. });
    let second = events.iter().enumerate().filter(|(_, event)| is_button(event)).nth(1);
    second.map(|(at, _)| at).map_or_else(Vec::new, |at| events.split_off(at))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fast_click_lasts_two_frames() {
        let button = |pressed| egui::Event::PointerButton {
            pos: egui::pos2(1.0, 2.0),
            button: egui::PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::NONE,
        };
        let moved = egui::Event::PointerMoved(egui::pos2(1.0, 2.0));
        let mut events = vec![moved.clone(), button(true), button(false), moved.clone()];
        let late = one_at_a_time(&mut events, Vec::new());
        assert_eq!(events, [moved.clone(), button(true)]);
        let mut next = vec![moved.clone()];
        assert!(one_at_a_time(&mut next, late).is_empty());
        assert_eq!(next, [button(false), moved.clone(), moved]);
    }
}
