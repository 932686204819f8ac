//! Values of parameters as controls hold them, and as text that `--set` and presets take.

use super::preset;
use isophote_loader::catalogue::ParamKind;
use isophote_loader::{Graph, Result};

/// A value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Float(f32),
    /// A whole number.
    Int(i64),
    /// On or off.
    Bool(bool),
    /// Id of an option.
    Choice(String),
    /// RGBA, gamma-encoded sRGB, 0 to 1.
    Color([f32; 4]),
}

impl Value {
    /// The default of a parameter; none of a kind that this program does not know.
    pub fn default(kind: &ParamKind) -> Option<Self> {
        Some(match kind {
            ParamKind::Unknown { .. } => return None,
            ParamKind::Float { default, .. } => Self::Float(*default),
            ParamKind::Int { default, .. } => Self::Int(*default),
            ParamKind::Bool { default } => Self::Bool(*default),
            ParamKind::Choice { default, .. } => Self::Choice((*default).to_owned()),
            ParamKind::Color { default } => Self::Color(*default),
        })
    }

    /// Reads a value as people write it.
    pub fn parse(kind: &ParamKind, text: &str) -> Option<Self> {
        let text = text.trim();
        Some(match kind {
            ParamKind::Unknown { .. } => return None,
            ParamKind::Float { .. } => Self::Float(text.parse().ok().filter(|v: &f32| v.is_finite())?),
            ParamKind::Int { .. } => {
                let whole = text.parse().ok();
                // JSON of other programs may write whole numbers with a point.
                Self::Int(whole.or_else(|| text.parse::<f64>().ok().map(|v| v.round() as i64))?)
            }
            ParamKind::Bool { .. } => Self::Bool(text.parse().ok()?),
            ParamKind::Choice { options, .. } => {
                Self::Choice(options.iter().find(|option| option.id == text)?.id.to_owned())
            }
            ParamKind::Color { .. } => Self::Color(preset::color(text)?),
        })
    }

    /// The value as `--set` takes it, from which the same value is read.
    pub fn text(&self) -> String {
        match self {
            Self::Float(value) => value.to_string(),
            Self::Int(value) => value.to_string(),
            Self::Bool(value) => value.to_string(),
            Self::Choice(id) => id.clone(),
            Self::Color(color) => color_text(*color),
        }
    }

    /// Sets a parameter of a node of a graph to it, by its type.
    ///
    /// # Errors
    /// As [`Graph::set_float`].
    pub fn put(&self, graph: &Graph, node: u32, param: &str) -> Result<()> {
        match self {
            Self::Float(value) => graph.set_float(node, param, *value),
            Self::Int(value) => graph.set_int(node, param, *value),
            Self::Bool(value) => graph.set_bool(node, param, *value),
            Self::Choice(option) => graph.set_choice(node, param, option),
            Self::Color(color) => graph.set_color(node, param, color),
        }
    }

    /// Values that differ from this one as far as the parameter allows: where none of them changes what is computed, the
    /// parameter has no effect.
    pub fn others(&self, kind: &ParamKind) -> Vec<Self> {
        let mut others: Vec<Self> = match kind {
            ParamKind::Unknown { .. } => Vec::new(),
            ParamKind::Float { range, slider, .. } => {
                let middle = f32::midpoint(slider[0], slider[1]);
                [slider[1], slider[0], middle, range[1], range[0]].map(Self::Float).into()
            }
            ParamKind::Int { range, slider, .. } => {
                let middle = i64::midpoint(slider[0], slider[1]);
                [slider[1], slider[0], middle, range[1], range[0]].map(Self::Int).into()
            }
            ParamKind::Bool { .. } => vec![Self::Bool(true), Self::Bool(false)],
            ParamKind::Choice { options, .. } => {
                options.iter().map(|option| Self::Choice(option.id.to_owned())).collect()
            }
            ParamKind::Color { .. } => vec![Self::Color([0.0; 4]), Self::Color([1.0; 4])],
        };
        others.retain(|other| other != self);
        others
    }
}

/// As short as it can be without loss.
fn color_text(color: [f32; 4]) -> String {
    let bytes = color.map(|part| (part.clamp(0.0, 1.0) * 255.0).round() as u8);
    if bytes.map(|byte| f32::from(byte) / 255.0) != color {
        return color.map(|part| part.to_string()).join(",");
    }
    let [r, g, b, a] = bytes;
    if a == 255 { format!("#{r:02x}{g:02x}{b:02x}") } else { format!("#{r:02x}{g:02x}{b:02x}{a:02x}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_as_they_are_written() {
        let float = ParamKind::Float { default: 0.1, range: [0.0, 1.0], slider: [0.0, 1.0] };
        let int = ParamKind::Int { default: 3, range: [0, 9], slider: [0, 9] };
        let color = ParamKind::Color { default: [0.0; 4] };
        for (kind, text) in [(&float, "0.1"), (&int, "-4"), (&color, "#12407b"), (&color, "#12407b80")] {
            assert_eq!(Value::parse(kind, text).unwrap().text(), text);
        }
        assert_eq!(Value::parse(&color, "0.1, 0.2, 0.3").unwrap().text(), "0.1,0.2,0.3,1");
        assert_eq!(Value::parse(&int, "4.0"), Some(Value::Int(4)));
        for bad in ["", "nan", "#12", "#ééé", "1,2", "a,b,c"] {
            assert!(Value::parse(&color, bad).is_none(), "{bad}");
        }
        assert!(Value::parse(&float, "inf").is_none());
        assert!(!Value::Int(9).others(&int).contains(&Value::Int(9)));
    }
}
