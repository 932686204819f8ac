//! Looks as pages hand them in: the name of a node or a look, a preset or a graph.

use isophote::{Error, Graph, preset};
use serde_json::Value;

/// The name of a look in messages.
const PLACE: &str = "the look";

/// Graph of a look at a frame.
#[derive(Debug)]
pub struct GraphAtFrame {
    /// Nodes, with the values of the frame.
    pub graph: Graph,
    /// Lines of the pictures that its lengths are meant for; 0: lengths are pixels.
    pub reference_height: u32,
}

impl GraphAtFrame {
    /// The look that a page names, or writes out.
    ///
    /// # Errors
    /// Faults of [`preset::open`] and [`preset::open_json`].
    pub fn read(json: &Value, frame: i64) -> Result<Self, Error> {
        let (mut graph, settings) = match json {
            Value::String(name) => preset::open(name)?,
            json => preset::open_json(PLACE, &json.to_string(), None)?,
        };
        settings.at_frame(&mut graph, frame)?;
        Ok(Self { graph, reference_height: settings.lengths().reference_height() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote::{Value as Declared, registry};
    use serde_json::json;

    fn value(look: Value, param: &str, frame: i64) -> Result<Declared, Error> {
        let look = GraphAtFrame::read(&look, frame)?;
        look.graph.value(look.graph.node(0)?, param)
    }

    #[test]
    fn nodes_looks_presets_and_graphs_are_read() {
        let look = GraphAtFrame::read(&json!({ "style": "ink", "lengths": "pixels" }), 0).unwrap();
        assert_eq!((look.graph.len(), look.reference_height), (1, 0));
        let text = look.graph.to_json().unwrap();
        let graph: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(GraphAtFrame::read(&graph, 0).unwrap().reference_height, 1080);
        let preset = json!({ "style": graph, "parameters": { "ink.tone": 0.5, "style": "pencil" } });
        assert_eq!(value(preset, "tone", 0).unwrap(), Declared::Float(0.5));
        assert_eq!(GraphAtFrame::read(&json!("look:linocut"), 0).unwrap().graph.len(), 1);
        for node in registry::nodes() {
            assert!(GraphAtFrame::read(&json!(node.id), 0).is_ok(), "{}", node.id);
            assert!(GraphAtFrame::read(&json!({ "style": node.id }), 0).is_ok(), "{}", node.id);
        }
    }

    #[test]
    fn values_are_those_of_the_frame() {
        let look = json!({ "style": "cartoon", "parameters": { "sigma_d": { "10": 2, "20": 4 } } });
        for (frame, wanted) in [(0, 2.0), (10, 2.0), (15, 3.0), (20, 4.0), (99, 4.0)] {
            assert_eq!(value(look.clone(), "sigma_d", frame).unwrap(), Declared::Float(wanted), "{frame}");
        }
    }

    #[test]
    fn what_is_wrong_with_a_look_is_said() {
        for (look, part) in [
            (json!([]), "the look: is no preset"),
            (json!(3), "the look: is no preset"),
            (json!("cartoom"), "did you mean 'cartoon'?"),
            (json!("look:linokut"), "did you mean 'look:linocut'?"),
            (json!({ "style": "ink", "parameter": {} }), "did you mean 'parameters'?"),
            (json!({ "style": "ink", "parameters": { "tune": 1 } }), "did you mean 'tone'?"),
            (json!({ "style": "poster.json" }), "write the graph out"),
        ] {
            let error = GraphAtFrame::read(&look, 0).unwrap_err().to_string();
            assert!(error.contains(part), "{look}: {error}");
        }
    }
}
