//! Shaders of dispatches, and that of one kernel.

use super::format::Format;
use crate::kernel::{Kernel, PACKED_WORKGROUP, WORKGROUP};
use crate::wgsl::{Import, Piece, Pieces, STORE};
use std::borrow::Cow;
use std::fmt::Write as _;

/// A shader, as data: it may come from this library's kernels or, through the C ABI, from another's.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Shader {
    /// Name of the kernel, or of several: with an ampersand between those that compute a window together, and a plus before
    /// each that follows for single pixels. Behind a follower stands which value each of its inputs is, unless the first is
    /// that of the kernel before and the others are textures, and a star behind values that are stored though others follow.
    /// At the end stand `/half` of those that write 16-bit floats, `/filtered` of those that interpolate by a sampler and
    /// `/packed` of those whose windows of neighbours hold 16-bit floats. Shaders of one name are the same.
    pub name: Cow<'static, str>,
    /// Complete WGSL module, entry point `main`.
    pub source: Cow<'static, str>,
    /// Number of sampled textures.
    pub inputs: usize,
    /// Formats of the storage textures.
    pub outputs: Cow<'static, [Format]>,
    /// Size of the uniform block at binding 1, in bytes; 0 for none.
    pub params_size: usize,
    /// Side of its square workgroups.
    pub workgroup: u32,
    /// Sampled textures that are read through the sampler at [`SAMPLER_BINDING`](crate::kernel::SAMPLER_BINDING); without
    /// any there is no such binding.
    pub filtered: Cow<'static, [usize]>,
}

/// Text in the place of [`STORE`] where 16-bit floats are stored.
const STORE_HALF: &str = "store_half(id, ";

/// Devices may cut bits off instead of rounding, which adds up from pass to pass, and may make what is too large infinite.
/// Ties go to even.
pub(super) const NEAREST_HALF: &str = "
fn nearest_half(value: vec4f) -> vec4f {
    let bits = bitcast<vec4u>(clamp(value, vec4f(-65504.0), vec4f(65504.0)));
    return bitcast<vec4f>((bits + 0xfffu + ((bits >> vec4u(13u)) & vec4u(1u))) & vec4u(0xffffe000u));
}
";

impl Shader {
    /// That of one kernel, which writes `outputs`.
    pub(super) fn of(kernel: &'static Kernel, outputs: &[Format], reading: Reading) -> Self {
        let is_half = outputs.contains(&Format::Rgba16);
        let source = if reading == Reading::default() && !is_half {
            Cow::Borrowed(kernel.shader)
        } else {
            source(&kernel.pieces, outputs, reading).into()
        };
        Self {
            name: match variant(is_half, reading).as_str() {
                "" => Cow::Borrowed(kernel.name),
                variant => format!("{}{variant}", kernel.name).into(),
            },
            source,
            inputs: kernel.inputs,
            outputs: outputs.to_vec().into(),
            params_size: kernel.params_size,
            workgroup: reading.workgroup(),
            filtered: reading.filtered(kernel).into(),
        }
    }

    /// Shaders of one kernel that store 32-bit floats: as it is, and as it reads 16-bit floats where it does so in a way of
    /// its own.
    pub fn variants(kernel: &'static Kernel) -> Vec<Self> {
        let Pieces { filtered, windowed, .. } = kernel.pieces;
        let plain = Reading::default();
        let readings = [
            Some(plain),
            (!filtered.is_empty()).then_some(Reading { is_filtered: true, ..plain }),
            windowed.map(|_| Reading { is_packed: true, ..plain }),
        ];
        let outputs: Vec<Format> = kernel.outputs.iter().map(|channels| Format::exact(*channels)).collect();
        readings.into_iter().flatten().map(|reading| Self::of(kernel, &outputs, reading)).collect()
    }
}

/// Access of a kernel to textures of 16-bit floats; the default is that to all others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Reading {
    /// True where it interpolates by a sampler.
    pub is_filtered: bool,
    /// True where its windows of neighbours hold 16-bit floats.
    pub is_packed: bool,
}

impl Reading {
    /// Pieces that stand in a module for what a kernel imports.
    pub fn pieces(self, import: &'static Import) -> &'static [Piece] {
        let filtered = import.filtered.filter(|_| self.is_filtered);
        filtered.or(import.packed.filter(|_| self.is_packed)).unwrap_or(import.text)
    }

    /// Two sides of its workgroups, as WGSL.
    pub fn sides(self) -> String {
        format!("{0}, {0}", self.workgroup())
    }

    /// The side of its workgroups.
    pub const fn workgroup(self) -> u32 {
        if self.is_packed { PACKED_WORKGROUP } else { WORKGROUP }
    }

    /// The inputs that it reads through a sampler.
    pub const fn filtered(self, kernel: &'static Kernel) -> &'static [usize] {
        if self.is_filtered { kernel.pieces.filtered } else { &[] }
    }
}

/// Endings of the names of shaders that differ from those of their kernels.
pub(super) fn variant(is_half: bool, reading: Reading) -> String {
    let words = [(is_half, "/half"), (reading.is_filtered, "/filtered"), (reading.is_packed, "/packed")];
    words.iter().filter(|(is, _)| *is).map(|(_, word)| *word).collect()
}

/// Module of one kernel whose storage textures have these formats.
fn source(pieces: &Pieces, outputs: &[Format], reading: Reading) -> String {
    let is_half = outputs.contains(&Format::Rgba16);
    let imports = pieces.imports.iter().flat_map(|import| reading.pieces(import));
    let mut text = String::new();
    let mut stores = false;
    for piece in imports.chain(pieces.own).chain(pieces.entry) {
        stores |= *piece == Piece::Store;
        match *piece {
            Piece::Format { output, exact } => text.push_str(outputs.get(output).map_or(exact, |f| f.wgsl())),
            Piece::Store if is_half => text.push_str(STORE_HALF),
            Piece::Workgroup => text.push_str(&reading.sides()),
            piece => text.push_str(&piece.text()),
        }
    }
    if is_half && stores {
        let _ = write!(
            text,
            "{NEAREST_HALF}\nfn store_half(id: vec3u, value: vec4f) {{\n    {STORE}nearest_half(value));\n}}\n"
        );
    }
    text
}
