//! Fields of numbers, which can be dragged and typed: with decimal points or commas, as calculations, with their unit.

use std::cell::RefCell;

use egui::{DragValue, Response, Ui, Vec2};

use super::hint;
use crate::state::expression::{self, Marks};

/// A number and what is known of it.
pub struct Number<'n> {
    /// The number as it is.
    pub value: f64,
    /// The least and the most.
    pub range: [f64; 2],
    /// Change for each point that it is dragged.
    pub speed: f64,
    /// Most digits after the point that are shown.
    pub decimals: usize,
    /// Unit as it stands behind the number.
    pub unit: &'n str,
}

impl Number<'_> {
    /// Shows the field; returns the number that it has been given, if any.
    pub fn show(&self, ui: &mut Ui, size: Vec2) -> (Response, Option<f64>) {
        let said = RefCell::new(None);
        let mut value = self.value;
        let field = DragValue::new(&mut value)
            .range(self.range[0]..=self.range[1])
            .speed(self.speed)
            .max_decimals(self.decimals)
            .suffix(self.unit)
            .clip_text(true)
            // What is half typed is no value yet.
            .update_while_editing(false)
            .custom_parser(|text| {
                let (value, message) = self.read(text);
                *said.borrow_mut() = message;
                value
            });
        let response = ui.add_sized(size, field);
        if let Some(message) = said.take() {
            hint::say(&response, message);
        }
        hint::show(&response);
        let given = response.changed().then_some(value);
        (response, given)
    }

    /// The number that a text gives, if it gives one, and what is to be said of it.
    fn read(&self, text: &str) -> (Option<f64>, Option<String>) {
        if self.is_shown_as(text) {
            return (Some(self.value), None);
        }
        let is_share = self.unit.is_empty() && self.range[0] >= 0.0 && self.range[1] <= 1.0;
        let value = match expression::number(text, Marks { unit: self.unit, is_share }) {
            Ok(value) => value,
            Err(problem) => {
                let now = self.text(self.value);
                return (None, Some(format!("{problem}. It stays {now}")));
            }
        };
        let [least, most] = self.range;
        if value < least {
            return (Some(least), Some(format!("The least is {}", self.text(least))));
        }
        if value > most {
            return (Some(most), Some(format!("The most is {}", self.text(most))));
        }
        if self.decimals == 0 && value.fract() != 0.0 {
            let whole = value.round();
            return (Some(whole), Some(format!("Rounded to {}, a whole number", self.text(whole))));
        }
        (Some(value), None)
    }

    /// True where a text is the number as it is, perhaps with fewer digits: who leaves the field does not round it.
    fn is_shown_as(&self, text: &str) -> bool {
        (0..=self.decimals).any(|digits| format!("{:.digits$}", self.value) == text.trim())
    }

    fn text(&self, value: f64) -> String {
        let digits = self.decimals;
        let text = format!("{value:.digits$}");
        let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        format!("{text}{}", self.unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(value: f64, range: [f64; 2], decimals: usize, unit: &str) -> Number<'_> {
        Number { value, range, speed: 0.1, decimals, unit }
    }

    fn read(number: &Number<'_>, text: &str) -> (Option<f64>, String) {
        let (value, message) = number.read(text);
        (value, message.unwrap_or_default())
    }

    #[test]
    fn what_is_typed_is_held_within_the_range_with_a_word() {
        let width = number(1.5, [0.5, 10.0], 3, " px");
        assert_eq!(read(&width, "2*1,5 px"), (Some(3.0), String::new()));
        assert_eq!(read(&width, "12"), (Some(10.0), "The most is 10 px".into()));
        assert_eq!(read(&width, "-1"), (Some(0.5), "The least is 0.5 px".into()));
        assert_eq!(read(&width, "wide"), (None, "'wide' is no number. It stays 1.5 px".into()));
        let count = number(4.0, [1.0, 10.0], 0, "");
        assert_eq!(read(&count, "7/2"), (Some(4.0), "Rounded to 4, a whole number".into()));
        assert_eq!(read(&count, "100"), (Some(10.0), "The most is 10".into()));
        assert_eq!(read(&number(0.2, [0.0, 1.0], 3, ""), "50%"), (Some(0.5), String::new()));
        assert_eq!(read(&number(0.2, [0.0, 2.0], 3, ""), "50%").0, None);
    }

    #[test]
    fn a_number_is_not_rounded_by_leaving_its_field() {
        let value = f64::from(0.123_456_f32);
        let shown = number(value, [0.0, 1.0], 3, "");
        assert_eq!(read(&shown, "0.123").0, Some(value));
        assert_eq!(read(&shown, "0.124").0, Some(0.124));
    }
}
