//! Looks of a style in its own effect: a choice that sets the other controls, and is "Custom" once they are edited.
//!
//! Projects hold the values, so that a look that becomes another changes none of them; the choice decides about no pixel.

use super::before::{Before, Named};
use super::effects::{Effect, Form, Target};
use super::host::{Host, Outcome};
use super::look_effect::{self, LOOK};
use super::shipped::{Shipped, of_style};
use super::values::Values;
use isophote::Value;
use isophote::spec::{MIX, Param};
use isophote_abi::openfx::{Handle, kOfxStatFailed};
use std::ffi::{CStr, c_int};

/// Answers to an edit of the user's: of the choice of a look, or of anything else.
///
/// # Errors
/// Failed, when the host has no parameters.
pub fn edited(effect: &'static Effect, host: &Host, instance: Handle, name: &CStr, time: f64) -> Outcome<()> {
    let values = Values::of(host, instance, time)?;
    if effect.form == Form::Look {
        host.editing(instance, || look_effect::edited(&values, name));
        return Ok(());
    }
    if !effect.controls.iter().any(|control| matches!(control.target, Target::Look)) {
        return Ok(());
    }
    let Some(option) = values.index(LOOK) else { return Ok(()) };
    if name == LOOK {
        chosen(effect, &values, instance, option)
    } else {
        adjusted(effect, &values, instance, option)
    }
}

/// The look of an option, unless it is "Custom".
fn at(effect: &'static Effect, option: usize) -> Option<&'static Shipped> {
    of_style(effect.nodes[0].id).nth(option.checked_sub(1)?)
}

/// Sets all controls to what they are in the look that was chosen.
fn chosen(effect: &'static Effect, values: &Values<'_>, instance: Handle, option: usize) -> Outcome<()> {
    let host = values.host;
    let kept = host.before(instance);
    let Some(look) = at(effect, option) else { return back(effect, values, instance, kept) };
    let settings = settings(effect, look, values)?;
    let differs = settings.iter().any(Setting::differs);
    let set = || settings.iter().filter(|s| s.differs()).for_each(|s| values.set_value(s.name, s.wanted));
    if host.quirks.keeps_steps {
        if differs {
            host.editing(instance, || values.in_one_step(c"Look", set));
        }
        return Ok(());
    }
    // The choice is the only step, so that what it replaces is kept here; a look that an undo brings back replaces nothing.
    let now = || settings.iter().map(|setting| (setting.name, setting.now)).collect();
    let kept = kept.filter(|before| !before.edited || (before.option == option && !differs));
    let before = kept.map_or_else(now, |before| before.values);
    host.keep_before(instance, Some(Before { option, values: before, edited: false }));
    host.editing(instance, set);
    Ok(())
}

/// Sets all controls to what they were before the look, in hosts that leave that to the effect, unless they are another's by now.
fn back(effect: &'static Effect, values: &Values<'_>, instance: Handle, kept: Option<Before>) -> Outcome<()> {
    let Some(before) = kept else { return Ok(()) };
    let Some(look) = at(effect, before.option) else { return Ok(()) };
    let settings = settings(effect, look, values)?;
    let now: Vec<Named> = settings.iter().map(|setting| (setting.name, setting.now)).collect();
    if !settings.iter().any(Setting::differs) {
        values.host.editing(instance, || {
            let other = before.values.iter().filter(|named| !now.contains(named));
            other.for_each(|(name, value)| values.set_value(name, *value));
        });
    }
    // Kept for undos that the effect does not hear of, such as that of a reset.
    values.host.keep_before(instance, Some(Before { edited: true, ..before }));
    Ok(())
}

/// Makes a look custom when something that it sets is edited, and the look again when such an edit is undone.
fn adjusted(effect: &'static Effect, values: &Values<'_>, instance: Handle, option: usize) -> Outcome<()> {
    let host = values.host;
    let kept = host.before(instance);
    let last =
        kept.as_ref().filter(|before| option == 0 && before.edited).map_or(option, |before| before.option);
    let Some(look) = at(effect, last) else { return Ok(()) };
    let is_custom = settings(effect, look, values)?.iter().any(Setting::differs);
    let now = if is_custom { 0 } else { last };
    if now != option {
        // Not a step of its own: it is a part of the user's.
        host.editing(instance, || values.set_int(LOOK, now as c_int));
    }
    host.keep_before(instance, kept.map(|before| Before { edited: is_custom, ..before }));
    Ok(())
}

/// True for a parameter that a look leaves to the user: the amount of the effect, and movement.
fn is_the_users(param: &Param) -> bool {
    param.id == MIX.id || param.group == "time"
}

/// A control that looks set.
struct Setting {
    name: &'static CStr,
    now: Value,
    wanted: Value,
    is_animated: bool,
}

impl Setting {
    /// True where it is not as the look has it.
    fn differs(&self) -> bool {
        self.now != self.wanted || self.is_animated
    }
}

/// The controls that a look sets.
fn settings(effect: &'static Effect, look: &Shipped, values: &Values<'_>) -> Outcome<Vec<Setting>> {
    let node = look.graph.node(0).map_err(|_| kOfxStatFailed)?;
    let mut settings = Vec::new();
    for control in &effect.controls {
        let name = control.name.as_c_str();
        let (now, wanted) = match control.target {
            Target::Param(0, param) if !is_the_users(param) => {
                let wanted = look.graph.value(node, param.id).map_err(|_| kOfxStatFailed)?;
                (values.value(name, param), wanted)
            }
            Target::ReferenceHeight => {
                let wanted = look.settings.lengths().reference_height() as c_int;
                (values.int(name).map(Value::Int), Value::Int(wanted))
            }
            _ => continue,
        };
        if let Some(now) = now {
            settings.push(Setting { name, now, wanted, is_animated: values.is_animated(name) });
        }
    }
    Ok(settings)
}

#[cfg(test)]
mod tests {
    use super::super::shipped::all;
    use super::*;

    /// Otherwise one look would leave it to the next.
    #[test]
    fn no_look_has_values_of_what_is_left_to_the_user() {
        for look in all().iter().filter(|shipped| shipped.look_of.is_some()) {
            let node = look.graph.node(0).unwrap();
            for param in look.graph.spec(node).unwrap().params().filter(|param| is_the_users(param)) {
                let value = look.graph.value(node, param.id).unwrap();
                assert_eq!(value, param.default, "{:?}: {}", look.label, param.id);
            }
        }
    }
}
