//! Parameters that change from frame to frame.

use super::fault::Fault;
use crate::declare::param::Param;
use crate::declare::value::{Value, channels_from_text};
use crate::graph::NodeId;

/// A parameter of a graph with values by frame.
#[derive(Clone, Debug)]
pub(super) struct Animated {
    /// Its name in the preset.
    pub name: String,
    /// Its node.
    pub node: NodeId,
    /// Its id.
    pub param: &'static str,
    keys: Vec<(i64, String)>,
    /// Numbers of the keys where values change evenly between them, and true where they are whole.
    ramp: Option<(Vec<Vec<f64>>, bool)>,
}

impl Animated {
    /// The keys of a parameter, which `name` is called in the preset and in the preset's messages `place`.
    ///
    /// # Errors
    /// The fault of values that are to change evenly and cannot.
    pub fn new(
        place: &str,
        (name, node, param): (&str, NodeId, &'static Param),
        keys: &[(i64, String)],
        step: Option<bool>,
    ) -> Result<Self, Fault> {
        let even = matches!(param.default, Value::Float(_) | Value::Int(_) | Value::Color(_));
        if !even && step == Some(false) {
            return Err(Fault::value(place, "cannot change evenly", "write \"between\": \"step\""));
        }
        let numbers = |(_, text): &(i64, String)| numbers(param.default, text);
        let ramp = (even && step != Some(true))
            .then(|| keys.iter().map(numbers).collect::<Option<Vec<_>>>())
            .flatten()
            .map(|numbers| (numbers, matches!(param.default, Value::Int(_))));
        Ok(Self { name: name.to_owned(), node, param: param.id, keys: keys.to_vec(), ramp })
    }

    /// Frames of the keys.
    pub fn frames(&self) -> impl Iterator<Item = i64> {
        self.keys.iter().map(|(frame, _)| *frame)
    }

    /// The value at a frame, as text.
    pub fn at(&self, frame: i64) -> String {
        let after = self.keys.partition_point(|(key, _)| *key <= frame);
        let before = after.saturating_sub(1);
        let (Some((numbers, whole)), true) = (&self.ramp, after > 0 && after < self.keys.len()) else {
            return self.keys[before].1.clone();
        };
        let (from, to) = (self.keys[before].0 as f64, self.keys[after].0 as f64);
        let share = (frame as f64 - from) / (to - from);
        let mixed = numbers[before].iter().zip(&numbers[after]).map(|(a, b)| {
            let value = a + (b - a) * share;
            if *whole { value.round().to_string() } else { (value as f32).to_string() }
        });
        mixed.collect::<Vec<_>>().join(",")
    }
}

/// The numbers of a value: one, or those of a colour.
fn numbers(of: Value, text: &str) -> Option<Vec<f64>> {
    match of {
        Value::Color(_) => channels_from_text(text).map(|color: [f64; 4]| color.to_vec()),
        _ => text.trim().parse().ok().map(|number| vec![number]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::choice::Selection;
    use crate::graph::Graph;

    fn track(param: Param, keys: &[(i64, &str)], step: Option<bool>) -> Result<Animated, Fault> {
        let keys: Vec<_> = keys.iter().map(|(frame, text)| (*frame, (*text).to_owned())).collect();
        let mut graph = Graph::new();
        let node = graph.add("x", "ink").unwrap();
        Animated::new("p", ("x", node, Box::leak(Box::new(param))), &keys, step)
    }

    #[test]
    fn values_move_between_keys() {
        let float = Param::float("x", "X", 0.0, [0.0, 10.0]);
        let ramp = track(float, &[(1001, "2"), (1050, "6")], None).unwrap();
        let values = [900, 1001, 1013, 1050, 2000].map(|frame| ramp.at(frame).parse::<f32>().unwrap());
        assert_eq!([values[0], values[1], values[3], values[4]], [2.0, 2.0, 6.0, 6.0]);
        assert!((values[2] - (2.0 + 4.0 * 12.0 / 49.0)).abs() < 1e-6);
        let stepped = track(float, &[(1, "2"), (10, "6")], Some(true)).unwrap();
        assert_eq!([stepped.at(9), stepped.at(10)], ["2", "6"]);
        let whole = Param::int("x", "X", 0, [0, 10]);
        assert_eq!(track(whole, &[(0, "0"), (10, "5")], None).unwrap().at(5), "3");
        let colour = Param::color("x", "X", [0.0; 4]);
        assert_eq!(track(colour, &[(0, "#000000"), (2, "1,0,0.5,0")], None).unwrap().at(1), "0.5,0,0.25,0.5");
        let flag = Param::bool("x", "X", false);
        assert_eq!(track(flag, &[(0, "false"), (10, "true")], None).unwrap().at(9), "false");
        assert!(track(flag, &[(0, "true")], Some(false)).is_err());
        let choice = Param::choice("x", "X", Selection { index: 0, options: &[] });
        assert!(track(choice, &[(0, "a")], Some(false)).is_err() && track(choice, &[(0, "a")], None).is_ok());
    }
}
