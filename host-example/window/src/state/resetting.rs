//! The way back of a look: to what it was chosen as, and from there to the defaults of its style.

use super::look::{EditedLook, Parameter};
use super::values::{ParamValue, TypedPreset};
use isophote_finishing::stylize::value::Value;

/// State that a step back leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Goal {
    /// The look as it was chosen, opened or saved.
    Look,
    /// The defaults of its style.
    Style,
}

impl EditedLook {
    /// The entry of a parameter in the look as it was chosen, if that has one.
    fn chosen_entry(&self, parameter: &Parameter) -> Option<&ParamValue> {
        let opened = self.opened();
        // A node on its own has parameters without a name before them, and with one among others.
        let alone = || parameter.name.strip_prefix(opened.style.as_str())?.strip_prefix('.');
        opened.params.get(&parameter.name).or_else(|| opened.params.get(alone()?))
    }

    /// The value of a parameter in the look as it was chosen, at the first keyframe or everywhere.
    pub fn chosen(&self, parameter: &Parameter) -> Value {
        let given = self.chosen_entry(parameter).and_then(|given| given.first(&parameter.param.kind));
        given.unwrap_or_else(|| parameter.default.clone())
    }

    /// True where a value for all frames is what a parameter has in the look as it was chosen.
    pub(super) fn is_as_chosen(&self, parameter: &Parameter, value: &Value) -> bool {
        let is_animated = self.chosen_entry(parameter).is_some_and(ParamValue::is_animated);
        !is_animated && self.chosen(parameter) == *value
    }

    /// True where a parameter is not as in the look that was chosen.
    pub fn strays(&self, parameter: &Parameter) -> bool {
        match self.is_animated(parameter) {
            true => self.preset.params.get(&parameter.name) != self.chosen_entry(parameter),
            false => !self.is_as_chosen(parameter, &self.value(parameter)),
        }
    }

    /// Gives a parameter what it has in the look as it was chosen, in the same words.
    pub fn take_back(&mut self, parameter: &Parameter) {
        match self.chosen_entry(parameter).cloned() {
            Some(given) => self.preset.params.put(&parameter.name, given),
            None => self.reset(parameter),
        }
    }

    /// The state that a parameter goes back to: the look as it was chosen, or the style where it is that already.
    pub fn way_back_of(&self, parameter: &Parameter) -> Option<Goal> {
        match (self.strays(parameter), self.differs(parameter)) {
            (true, _) => Some(Goal::Look),
            (false, true) => Some(Goal::Style),
            (false, false) => None,
        }
    }

    /// The state that the whole look, which has these parameters, goes back to.
    pub fn way_back(&self, parameters: &[Parameter]) -> Option<Goal> {
        if self.rebuilt().is_some() {
            return Some(Goal::Look);
        }
        let ways = parameters.iter().filter_map(|parameter| self.way_back_of(parameter));
        ways.min_by_key(|goal| *goal == Goal::Style)
    }

    /// Goes back as a whole. The meaning of lengths stays, and so does the title.
    pub fn go_back(&mut self, goal: Goal) {
        match goal {
            Goal::Look => {
                let TypedPreset { style, params, .. } = self.opened().clone();
                (self.preset.style, self.preset.params) = (style, params);
            }
            Goal::Style => self.preset.params.clear(),
        }
    }
}
