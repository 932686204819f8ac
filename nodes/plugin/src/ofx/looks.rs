//! Looks of a style in its own effect: a choice that sets the other controls, and is "Custom" once they are edited.
//!
//! Projects hold the values, so that a look that becomes another changes none of them; the choice decides about no pixel.

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
    let chosen = values.index(LOOK).and_then(|option| option.checked_sub(1));
    let Some(look) = chosen.and_then(|at| of_style(effect.nodes[0].id).nth(at)) else { return Ok(()) };
    let other = others(effect, look, &values)?;
    if other.is_empty() {
        return Ok(());
    }
    host.editing(instance, || {
        if name == LOOK {
            values.in_one_step(c"Look", || {
                other.iter().for_each(|(name, value)| values.set_value(name, *value))
            });
        } else {
            // Not a step of its own: it is a part of the user's.
            values.set_int(LOOK, 0);
        }
    });
    Ok(())
}

/// True for a parameter that a look leaves to the user: the amount of the effect, and movement.
fn is_the_users(param: &Param) -> bool {
    param.id == MIX.id || param.group == "time"
}

/// The controls that are not as a look has them, with its values.
fn others(
    effect: &'static Effect,
    look: &Shipped,
    values: &Values<'_>,
) -> Outcome<Vec<(&'static CStr, Value)>> {
    let node = look.graph.node(0).map_err(|_| kOfxStatFailed)?;
    let mut others = Vec::new();
    for control in &effect.controls {
        let name = control.name.as_c_str();
        match control.target {
            Target::Param(0, param) if !is_the_users(param) => {
                let wanted = look.graph.value(node, param.id).map_err(|_| kOfxStatFailed)?;
                if values.value(name, param).is_some_and(|now| now != wanted) || values.is_animated(name) {
                    others.push((name, wanted));
                }
            }
            Target::ReferenceHeight => {
                let wanted = look.settings.lengths().reference_height() as c_int;
                if values.int(name).is_some_and(|now| now != wanted) {
                    others.push((name, Value::Int(wanted)));
                }
            }
            _ => {}
        }
    }
    Ok(others)
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
