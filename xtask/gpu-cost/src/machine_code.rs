//! Machine code of AMD cards as the driver prints it: blocks `BB7:` of one instruction a line, each with its bits after
//! a semicolon.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Instructions of a stretch of code, by what carries them out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Arithmetic on a value for each pixel.
    pub vector: u64,
    /// Arithmetic on one value for all, control flow and waiting.
    pub scalar: u64,
    /// Loads from textures.
    pub image: u64,
    /// Loads from uniform blocks.
    pub uniform: u64,
    /// Loads from workgroup memory.
    pub workgroup: u64,
}

/// The loops that a kernel is about, those with most vector instructions first: all that hold no other and do not fill
/// workgroup memory, which takes a few turns.
pub fn main_loops(code: &str) -> Vec<Counts> {
    let lines: Vec<&str> = code.lines().map(instruction).collect();
    let loops = loops(&lines);
    let is_innermost = |body: &&RangeInclusive<usize>| {
        !loops
            .iter()
            .any(|other| other != *body && body.contains(other.start()) && body.contains(other.end()))
    };
    let fills = |body: &[&str]| body.iter().any(|line| line.starts_with("ds_write"));
    let bodies = loops.iter().filter(is_innermost).map(|body| &lines[body.clone()]);
    let mut bodies: Vec<Counts> = bodies.filter(|body| !fills(body)).map(counts).collect();
    bodies.sort_by_key(|body| std::cmp::Reverse((body.vector, body.workgroup)));
    bodies
}

/// A line without its bits.
fn instruction(line: &str) -> &str {
    line.split(';').next().unwrap_or_default().trim()
}

/// The lines of every loop, from the block that all branches back lead to, to the last of these.
fn loops(lines: &[&str]) -> Vec<RangeInclusive<usize>> {
    let mut blocks = BTreeMap::new();
    let mut ends = BTreeMap::new();
    for (at, line) in lines.iter().enumerate() {
        if let Some(name) = line.strip_suffix(':') {
            blocks.insert(name, at);
        } else if let Some(start) = branch(line).and_then(|to| blocks.get(to)) {
            // Blocks that are not known yet lie ahead.
            ends.insert(*start, at);
        }
    }
    ends.into_iter().map(|(start, end)| start..=end).collect()
}

/// Label that a branch leads to.
fn branch(line: &str) -> Option<&str> {
    let (name, to) = line.split_once(char::is_whitespace)?;
    (name == "s_branch" || name.starts_with("s_cbranch_")).then_some(to.trim())
}

fn counts(lines: &[&str]) -> Counts {
    let mut counts = Counts::default();
    for line in lines.iter().filter(|line| !line.ends_with(':')) {
        let name = line.split_whitespace().next().unwrap_or_default();
        if name.starts_with("s_buffer_load") || name.starts_with("s_load") || name.starts_with("buffer_load")
        {
            counts.uniform += 1;
        } else if name.starts_with("s_") {
            counts.scalar += 1;
        } else if name.starts_with("v_") {
            counts.vector += 1;
        } else if name.starts_with("image_") && !name.starts_with("image_store") {
            counts.image += 1;
        } else if name.starts_with("ds_read") {
            counts.workgroup += 1;
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::{Counts, main_loops};

    /// `gaussian_blur` for Navi 21, by Mesa 22.3.6.
    const SAMPLE: &str = include_str!("../samples/gaussian_blur.txt");

    #[test]
    fn the_loop_over_the_taps_is_found_among_those_that_load_the_window() {
        let taps = Counts { vector: 15, scalar: 18, image: 0, uniform: 1, workgroup: 2 };
        assert_eq!(main_loops(SAMPLE), [taps]);
    }

    #[test]
    fn a_loop_that_holds_another_is_left_out_and_the_largest_is_first() {
        let code = "BB0:\n\tv_nop\n\tv_nop\n\tv_nop\nBB1:\n\tv_add_f32 v0, v1, v2 ; 0\n\timage_load v0, v1\n\
                    \ts_cbranch_scc1 BB1 ; 1\n\tv_nop\n\ts_branch BB0\nBB2:\n\tv_nop\n\tv_nop\n\
                    \ts_branch BB2\n\ts_endpgm\n";
        let last = Counts { vector: 2, scalar: 1, ..Counts::default() };
        let inner = Counts { vector: 1, scalar: 1, image: 1, ..Counts::default() };
        assert_eq!(main_loops(code), [last, inner]);
    }

    #[test]
    fn code_without_a_branch_back_has_no_loop() {
        assert_eq!(main_loops("BB0:\n\ts_cbranch_scc0 BB2\n\tv_nop\nBB2:\n\ts_endpgm\n"), []);
    }
}
