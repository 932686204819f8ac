//! Rules of a preset for things in a picture: how much detail they have, how wide, how many and of which colour their lines
//! are, how strong the medium is on them, and whether they have a look of their own. Those by number and by whole names are the
//! graph's; a host that knows where other things are makes maps of their rules, and lays the looks over the picture there.

use super::fault::Fault;
use crate::declare::value::color_from_text;
use crate::error::nearest_name;
use crate::kernels::shared::control::value_of;
use crate::things::{ThingRule, Things};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// The key of the rules in a preset.
pub(super) const KEY: &str = "objects";
/// Most rules of a preset.
const MOST: usize = 256;
/// Keys of a rule: what names the things, what turns lines off, and its factors in the order of a map's channels.
const MATCH: &str = "match";
const LINES: &str = "lines";
/// Key of the colour of their lines.
const LINE_COLOR: &str = "line_color";
/// Key of a look of their own.
pub(super) const LOOK: &str = "look";
const FACTORS: [&str; 4] = ["detail", "line_width", "line_amount", "medium"];
/// Channel of the amount of lines.
const AMOUNT: usize = 2;
/// Least and most of a factor.
const RANGE: [f64; 2] = [0.25, 4.0];

/// A rule for things.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectRule {
    /// The rule as the file has it.
    pub rule: Map<String, Value>,
    /// The things, in the words of the host that finds them.
    #[serde(skip_deserializing)]
    pub things: String,
    /// What a control map has where the things are: detail, width of lines, their amount and strength of the medium.
    #[serde(skip_deserializing)]
    pub control: [Option<f32>; 4],
}

impl ObjectRule {
    /// Takes the rules out of the file `place`. Their faults are added to `faults`.
    pub(super) fn take(place: &str, file: &mut Map<String, Value>, faults: &mut Vec<Fault>) -> Vec<Self> {
        let list = match file.remove(KEY) {
            None => return Vec::new(),
            Some(Value::Array(list)) if list.len() <= MOST => list,
            Some(Value::Array(list)) => {
                let problem = format!("has {} rules for objects, and there may be {MOST}", list.len());
                faults.push(Fault::format(place, problem, "leave some of them out"));
                return Vec::new();
            }
            Some(_) => {
                let fix = "write \"objects\": [{\"match\": \"cryptomatte:hero\", \"detail\": 2}]";
                faults.push(Fault::format(place, "its objects are no list", fix));
                return Vec::new();
            }
        };
        let one = |(number, rule)| Self::new(&format!("{place}: object {}", number + 1), rule, faults);
        list.into_iter().enumerate().filter_map(one).collect()
    }

    fn new(place: &str, json: Value, faults: &mut Vec<Fault>) -> Option<Self> {
        let before = faults.len();
        let Value::Object(rule) = json else {
            let fix = "write {\"match\": \"cryptomatte:hero\", \"detail\": 2}";
            faults.push(Fault::format(place, "is no object of JSON", fix));
            return None;
        };
        let things = match rule.get(MATCH) {
            Some(Value::String(things)) if !things.trim().is_empty() => things.clone(),
            _ => {
                let fix = "add \"match\": \"cryptomatte:NAME\"";
                faults.push(Fault::format(place, "names no things", fix));
                String::new()
            }
        };
        let lines = match rule.get(LINES) {
            None => None,
            Some(Value::Bool(lines)) => Some(*lines),
            Some(_) => {
                faults.push(Fault::value(place, "does not say whether it has lines", "write true or false"));
                None
            }
        };
        let factors = FACTORS.map(|key| factor(place, key, rule.get(key), faults));
        if lines == Some(false) && factors[AMOUNT].is_some() {
            let fix = format!("leave out \"{LINES}\" or \"{}\"", FACTORS[AMOUNT]);
            faults.push(Fault::format(place, "has no lines, and an amount of them", fix));
        }
        if rule.get(LOOK).is_some_and(|look| !look.is_string() && !look.is_object()) {
            let fix = "write {\"style\": \"ink\"}, or the name of a style, a look or a preset";
            faults.push(Fault::value(place, "its look is none", fix));
        }
        let is_color = |value: &Value| value.as_str().is_some_and(|text| color_from_text(text).is_ok());
        if rule.get(LINE_COLOR).is_some_and(|value| !is_color(value)) {
            let problem = format!("its {LINE_COLOR} is no colour");
            faults.push(Fault::value(place, problem, "write one such as \"#552211\""));
        }
        let is_known = |key: &str| [MATCH, LINES, LINE_COLOR, LOOK].contains(&key) || FACTORS.contains(&key);
        faults.extend(rule.keys().filter(|key| !is_known(key)).map(|key| unknown(place, key)));
        let control = control(lines, factors);
        (faults.len() == before).then_some(Self { rule, things, control })
    }

    /// The rule as a graph has it; none where a host alone knows what it is for. A colour of lines is that of the look, if the things
    /// have one of their own.
    pub fn of_graph(&self) -> Option<ThingRule> {
        let things = Things::of(&self.things)?;
        let color = self.line_color().filter(|_| self.look().is_none());
        let line_color = color.and_then(|text| color_from_text(text).ok());
        Some(ThingRule { things, control: self.control, line_color })
    }

    /// The look of its own that things have: a name, or a preset that is written out.
    pub(super) fn look(&self) -> Option<&Value> {
        self.rule.get(LOOK)
    }

    /// Colour of lines, as it is written.
    pub(super) fn line_color(&self) -> Option<&str> {
        self.rule.get(LINE_COLOR).and_then(Value::as_str)
    }

    /// Adds rules to a file, if there are any.
    pub(super) fn put(rules: &[Self], file: &mut Map<String, Value>) {
        if !rules.is_empty() {
            file.insert(KEY.into(), rules.iter().map(|rule| rule.rule.clone()).collect());
        }
    }
}

/// What a control map says by a rule.
fn control(lines: Option<bool>, factors: [Option<f64>; 4]) -> [Option<f32>; 4] {
    let mut control = factors.map(|factor| factor.map(|factor| value_of(factor as f32)));
    // A thing that has lines has those that a rule before took from it.
    control[AMOUNT] = control[AMOUNT].or(lines.map(|lines| if lines { value_of(1.0) } else { 0.0 }));
    control
}

fn factor(place: &str, key: &str, value: Option<&Value>, faults: &mut Vec<Fault>) -> Option<f64> {
    let value = value?;
    let [least, most] = RANGE;
    let factor = value.as_f64().filter(|factor| (least..=most).contains(factor));
    if factor.is_none() {
        let fix = format!("write a factor from {least} to {most}; 1 changes nothing");
        faults.push(Fault::value(place, format!("its {key} cannot be {value}"), fix));
    }
    factor
}

fn unknown(place: &str, key: &str) -> Fault {
    let keys = [&[MATCH, LINES, LINE_COLOR, LOOK], &FACTORS[..]].concat();
    let fix = nearest_name(key, keys.iter().copied()).map_or_else(
        || format!("the keys are {}", keys.join(", ")),
        |near| format!("did you mean '{near}'?"),
    );
    Fault::format(place, format!("has an unknown key '{}'", key.escape_default()), fix)
}
