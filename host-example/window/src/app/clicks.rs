//! Clicks, drags and steps by Tab that are faster than frames.

use egui::{Event, Key};

fn is_button(event: &Event) -> bool {
    matches!(event, Event::PointerButton { .. })
}

/// True where a button is pressed or released.
pub fn is_any(events: &[Event]) -> bool {
    events.iter().any(is_button)
}

/// Ends the events of a frame, those of before first, with the first press or release of a button, and before a release that
/// follows a move; returns the rest. Controls do not see a click that begins and ends within one frame, as clicks do where
/// frames are slow; they take a press for one where the pointer is at the end of the frame; and what is dragged does not go
/// where it is let go of in the same frame. Tab takes the focus on by one control a frame, and keys after it are for that one.
pub fn one_at_a_time(events: &mut Vec<Event>, before: Vec<Event>) -> Vec<Event> {
    events.splice(..0, before);
    let is_move = |event: &Event| matches!(event, Event::PointerMoved(_));
    let is_key = |event: &Event| matches!(event, Event::Key { pressed: true, .. });
    let is_tab = |event: &Event| matches!(event, Event::Key { key: Key::Tab, pressed: true, .. });
    let Some(first) = events.iter().position(|event| is_button(event) || is_tab(event)) else {
        return Vec::new();
    };
    let is_release = matches!(events[first], Event::PointerButton { pressed: false, .. });
    if is_release && events[..first].iter().any(is_move) {
        return events.split_off(first);
    }
    let (tabs, rest) = (is_tab(&events[first]), &events[first + 1..]);
    match rest.iter().any(|event| is_button(event) || if tabs { is_key(event) } else { is_move(event) }) {
        true => events.split_off(first + 1),
        false => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tab_takes_one_step_a_frame() {
        let key = |key, pressed| Event::Key {
            key,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers: egui::Modifiers::NONE,
        };
        let tab = [key(Key::Tab, true), key(Key::Tab, false)];
        let mut events = [&tab[..], &tab, &[key(Key::Enter, true)]].concat();
        let mut late = one_at_a_time(&mut events, Vec::new());
        assert_eq!(events, tab[..1]);
        for frame in [[&tab[1..], &tab[..1]].concat(), vec![tab[1].clone(), key(Key::Enter, true)]] {
            let mut events = Vec::new();
            late = one_at_a_time(&mut events, late);
            assert_eq!(events, frame);
        }
        assert!(late.is_empty());
    }

    #[test]
    fn a_fast_click_lasts_two_frames_and_stays_where_it_is() {
        let button = |pressed| Event::PointerButton {
            pos: egui::pos2(1.0, 2.0),
            button: egui::PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::NONE,
        };
        let moved = |x| Event::PointerMoved(egui::pos2(x, 2.0));
        let mut events = vec![moved(1.0), button(true), moved(5.0), button(false), moved(9.0)];
        let late = one_at_a_time(&mut events, Vec::new());
        assert_eq!(events, [moved(1.0), button(true)]);
        let mut next = vec![Event::Copy];
        let late = one_at_a_time(&mut next, late);
        assert_eq!(next, [moved(5.0)]);
        let mut after = Vec::new();
        let late = one_at_a_time(&mut after, late);
        assert_eq!(after, [button(false)]);
        let mut last = vec![Event::Copy];
        assert!(one_at_a_time(&mut last, late).is_empty());
        assert_eq!(last, [moved(9.0), Event::Copy, Event::Copy]);
        let mut alone = vec![button(true), Event::Copy];
        assert!(one_at_a_time(&mut alone, Vec::new()).is_empty());
        assert_eq!(alone.len(), 2);
    }
}
