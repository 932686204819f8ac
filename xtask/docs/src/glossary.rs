//! The symbols of the thesis beside the parameters that they are: meaning, names and controls from the declarations of the
//! nodes; of symbols that are no parameter, from here.

use crate::reference::cell;
use isophote::param::Param;
use isophote::registry;
use isophote::spec::NodeSpec;
use std::fmt::Write as _;

/// Symbols that are parameters: symbol, sections, node and parameter whose declaration says what it is.
const PARAMETERS: [(&str, &str, &str, &str); 45] = [
    ("σ_g (scale of the derivative)", "2.2.2", "structure_tensor", "sigma_g"),
    ("ρ", "2.4", "structure_tensor", "rho"),
    ("α (significance)", "2.6.3", "tensor_view", "alpha"),
    ("k (Harris)", "2.6.4", "tensor_view", "k"),
    ("h", "2.9", "line_integral_convolution", "step"),
    ("K, λ (contrast)", "3.1", "anisotropic_diffusion", "contrast"),
    ("σ_d", "3.2", "bilateral", "sigma_d"),
    ("σ_r", "3.2", "bilateral", "sigma_r"),
    ("σ_d across edges", "3.4", "oriented_bilateral", "sigma_dg"),
    ("σ_d along edges", "3.4", "oriented_bilateral", "sigma_dt"),
    ("σ_r across edges", "3.4", "oriented_bilateral", "sigma_rg"),
    ("σ_r along edges", "3.4", "oriented_bilateral", "sigma_rt"),
    ("σ_e", "4.2", "flow_dog", "sigma_e"),
    ("k", "4.2", "flow_dog", "k"),
    ("τ", "4.3", "flow_dog", "tau"),
    ("ε", "4.3", "flow_dog", "epsilon"),
    ("φ", "4.3", "flow_dog", "phi"),
    ("p", "4.4", "flow_dog", "p"),
    ("ε (with p)", "4.4", "flow_dog", "epsilon_p"),
    ("φ (with p)", "4.4", "flow_dog", "phi_p"),
    ("σ_m", "4.5", "flow_dog", "sigma_m"),
    ("n_e", "4.6", "cartoon", "n_e"),
    ("n_a", "4.6", "cartoon", "n_a"),
    ("q (levels)", "4.6", "quantize_luminance", "bins"),
    ("φ_q", "4.6", "quantize_luminance", "phi_q"),
    ("Λ_δ", "4.6, WOG06", "quantize_luminance", "lambda_delta"),
    ("Ω_δ", "4.6, WOG06", "quantize_luminance", "omega_delta"),
    ("Λ_φ", "4.6, WOG06", "quantize_luminance", "lambda_phi"),
    ("Ω_φ", "4.6, WOG06", "quantize_luminance", "omega_phi"),
    ("φ_w", "4.6, WOG06", "warp_sharpen", "phi_w"),
    ("r", "5.2 to 5.4", "anisotropic_kuwahara", "radius"),
    ("N (sectors)", "5.3", "anisotropic_kuwahara", "sectors"),
    ("q", "5.3", "anisotropic_kuwahara", "q"),
    ("τ_s (flat sectors)", "5.3", "anisotropic_kuwahara", "threshold"),
    ("α", "5.4.1", "anisotropic_kuwahara", "alpha"),
    ("p_s", "5.5.2", "anisotropic_kuwahara", "p_s"),
    ("p_d", "5.5.2", "anisotropic_kuwahara", "p_d"),
    ("τ_v", "5.5.2", "anisotropic_kuwahara", "tau_v"),
    ("τ_w", "5.5.2", "anisotropic_kuwahara", "tau_w"),
    ("N (iterations)", "6", "coherence_enhancing", "iterations"),
    ("σ_s", "6.3.1", "coherence_enhancing", "sigma_t"),
    ("σ_g (shocks)", "6.4", "coherence_enhancing", "sigma_g"),
    ("σ_i", "6.4.3", "coherence_enhancing", "sigma_i"),
    ("τ_s (shocks)", "6.4.3", "coherence_enhancing", "threshold"),
    ("σ_a", "6.5", "coherence_enhancing", "sigma_a"),
];

/// Symbols that nobody sets: symbol, section, meaning.
const QUANTITIES: [(&str, &str, &str); 7] = [
    ("f", "2.2", "The picture, a function of the place."),
    ("J", "2.4", "The structure tensor: the products of the derivatives with each other, smoothed by ρ."),
    (
        "E, F, G",
        "2.3.2",
        "Its three numbers: along x twice, mixed, along y twice. Images of the kind *tensor* have them as channels.",
    ),
    (
        "λ₁, λ₂",
        "2.3",
        "Its eigenvalues, the greater first: how much the picture changes across the edge and along it.",
    ),
    (
        "t",
        "3.4",
        "Direction of a pass: across edges (the major eigenvector) or along them (the minor one), which strokes and \
         hatches follow.",
    ),
    ("A", "2.6.1", "Anisotropy, from 0 (all directions alike) to 1 (one direction); *Tensor View* shows it."),
    ("L, a, b", "3.2", "Lightness from 0 to 100 and the two axes of colour, CIELAB."),
];

/// Parameters of a node that artists turn and whose text names another parameter of it.
fn controls(node: &'static NodeSpec, id: &str) -> impl Iterator<Item = &'static Param> {
    let named = format!("`{id}`");
    node.params().filter(move |param| param.group == "look" && param.doc.contains(&named))
}

/// The tables.
pub fn tables() -> String {
    let mut text = String::from(
        "## Symbols that are parameters\n\n| symbol | § | parameter | is | nodes | controls that move it |\n\
         |---|---|---|---|---|---|\n",
    );
    for (symbol, section, node, id) in PARAMETERS {
        let declared = registry::find(node).ok().and_then(|node| node.param(id));
        let Some((_, param)) = declared else { continue };
        let nodes: Vec<&'static NodeSpec> = registry::nodes()
            .iter()
            .copied()
            .filter(|other| {
                other.id == node || other.param(id).is_some_and(|(_, other)| is_same(param, other))
            })
            .collect();
        let links = nodes.iter().map(|node| format!("[{}](../nodes/{}.md)", node.label, node.id));
        let links = links.collect::<Vec<_>>().join(", ");
        let mut moved: Vec<&str> =
            nodes.iter().flat_map(|node| controls(node, id)).map(|control| control.label).collect();
        moved.sort_unstable();
        moved.dedup();
        let _ = writeln!(
            text,
            "| {} | {section} | `{id}`: {} | {} | {links} | {} |",
            written(symbol),
            param.label,
            cell(param.doc),
            moved.join(", ")
        );
    }
    text.push_str("\n## Symbols that nobody sets\n\n| symbol | § | is |\n|---|---|---|\n");
    for (symbol, section, is) in QUANTITIES {
        let _ = writeln!(text, "| {} | {section} | {is} |", written(symbol));
    }
    text
}

/// A symbol with its index below the line.
fn written(symbol: &str) -> String {
    let Some((letter, rest)) = symbol.split_once('_') else { return symbol.to_owned() };
    let end = rest.find(|c: char| !c.is_alphanumeric()).unwrap_or(rest.len());
    format!("{letter}<sub>{}</sub>{}", &rest[..end], &rest[end..])
}

/// True where two parameters of one id are one thing: the same word may be another thing in another node.
fn is_same(one: &Param, other: &Param) -> bool {
    let first = |text: &'static str| text.split(['.', ';', ',', ':', '(']).next().map(str::trim);
    let is_word = ["radius", "threshold", "iterations"].contains(&one.id);
    first(one.doc) == first(other.doc) || !is_word && one.label == other.label
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_symbol_is_a_parameter_that_is_there() {
        let tables = tables();
        for (symbol, _, node, id) in PARAMETERS {
            let found = registry::find(node).unwrap().param(id);
            assert!(found.is_some(), "{symbol}: {node} has no {id}");
            assert!(tables.contains(&format!("| {} |", written(symbol))), "{symbol}");
        }
        let line = tables.lines().find(|line| line.starts_with("| σ<sub>e</sub> |")).unwrap();
        assert!(line.contains("nodes/cartoon.md") && line.contains("Line width"), "{line}");
    }

    /// Parameters of the technical nodes whose id is a Greek letter's name are in the glossary.
    #[test]
    fn no_greek_letter_is_left_out() {
        let greek = ["sigma", "rho", "tau", "phi", "epsilon", "alpha", "lambda", "omega"];
        // Not of the thesis, or of a node's own.
        let own = ["sigma", "sigma_w", "sigma_b", "sigma_n"];
        for node in registry::nodes() {
            for param in node.params().filter(|param| !own.contains(&param.id)) {
                let is_greek = greek.contains(&param.id.split('_').next().unwrap_or_default());
                let is_told = PARAMETERS.iter().any(|(.., id)| *id == param.id);
                assert!(!is_greek || is_told, "{}.{}", node.id, param.id);
            }
        }
    }
}
