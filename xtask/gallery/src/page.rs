//! The page: HTML with the parameters under each picture.

use crate::nodes::{Shot, list, text};
use serde_json::Value;

/// The head of the page; `subjects` are the names of the pictures.
pub fn opening(subjects: &[&str]) -> String {
    let names: Vec<String> = subjects.iter().map(|s| escaped(s)).collect();
    format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>Isophote gallery</title><style>\n\
         body {{ font: 15px/1.45 sans-serif; margin: 2em; background: #1d1e20; color: #ddd; }}\n\
         .row {{ display: flex; flex-wrap: wrap; gap: 1em; }} figure {{ margin: 0; }}\n\
         img {{ max-width: 45vw; max-height: 60vh; display: block; }} a {{ color: #9cf; }}\n\
         .values {{ color: #999; font-size: 13px; max-width: 100ch; }} .values b {{ color: #fd8; }}\n\
         </style></head><body><h1>Isophote gallery</h1><p>Every node on: {}.</p>\n",
        names.join(", ")
    )
}

/// All parameters with the values of this picture, those that differ from the defaults marked.
pub fn values(node: &Value, shot: &Shot) -> String {
    let all = list(node, "params").iter().map(|param| {
        let id = text(param, "id");
        match shot.set.iter().find(|(set, _)| set == id) {
            Some((_, value)) => format!("<b>{id} {}</b>", escaped(value)),
            None => format!("{id} {}", escaped(&plain(&param["default"]))),
        }
    });
    all.collect::<Vec<_>>().join(" · ")
}

fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        // As the parameter's own precision shows it.
        Value::Number(number) => {
            number.as_f64().map_or_else(|| number.to_string(), |v| (v as f32).to_string())
        }
        other => other.to_string(),
    }
}

/// Text as HTML shows it.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nodes::shots;
    use crate::nodes::tests::node;

    #[test]
    fn each_other_option_is_shown_and_marked() {
        let shots = shots(&node());
        assert_eq!(shots.len(), 2);
        assert_eq!(values(&node(), &shots[0]), "kind a · sigma 0.1");
        assert_eq!(values(&node(), &shots[1]), "<b>kind b</b> · sigma 0.1");
    }
}
