//! WGSL in pieces: shaders are cut once, where they are built, by what reads WGSL; what joins the pieces of several
//! kernels to one shader reads none.

use std::borrow::Cow;

/// Statement that stores a result, up to the value, in kernels that others can follow.
pub const STORE: &str = "textureStore(target_image, vec2i(id.xy), ";

/// Load from the only texture of a kernel that is computed for the window of another, up to the place.
pub const LOAD: &str = "fetch(source, 0u, ";

/// Piece of WGSL.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Piece {
    /// Text that is the same in every shader.
    Text(&'static str),
    /// Name that a kernel declares for its whole module. Where the kernel follows others its place stands behind the name,
    /// so that two may use the same names.
    Name(&'static str),
    /// Declaration of something bound, or a part of it: shaders of several kernels declare anew what they bind.
    Binding(&'static str),
    /// Format of a storage texture in its declaration.
    Format {
        /// Number of the output.
        output: usize,
        /// Format of 32-bit floats.
        exact: &'static str,
    },
    /// Uniform block of the kernel, or of the rows in a pair.
    Params,
    /// Uniform block of the columns in a pair.
    ColumnsParams,
    /// Type of the uniform block.
    ParamsType,
    /// Number of an input among all textures that are read, where a constant has it.
    Slot(usize),
    /// Two sides of a workgroup.
    Workgroup,
    /// [`STORE`].
    Store,
    /// [`LOAD`].
    Load,
}

impl Piece {
    /// Text of the piece in the shader of its kernel alone.
    pub fn text(self) -> Cow<'static, str> {
        match self {
            Self::Text(text) | Self::Name(text) | Self::Binding(text) | Self::Format { exact: text, .. } => {
                text.into()
            }
            Self::Params => "params".into(),
            Self::ColumnsParams => "columns_params".into(),
            Self::ParamsType => "Params".into(),
            Self::Slot(input) => input.to_string().into(),
            Self::Workgroup => "8, 8".into(),
            Self::Store => STORE.into(),
            Self::Load => LOAD.into(),
        }
    }
}

/// Pieces of a kernel's shader, and which of them change with what textures hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pieces {
    /// Texts that it shares with other shaders, in an order in which each stands after what it uses.
    pub imports: &'static [&'static Import],
    /// Its own text.
    pub own: &'static [Piece],
    /// The entry point that was written for a kernel of single pixels; others have theirs in `own`.
    pub entry: &'static [Piece],
    /// Names of the textures that it reads, in the order of its inputs.
    pub textures: &'static [&'static str],
    /// Inputs that are interpolated by [`Import::filtered`] alone, if the kernel imports any text that has one.
    pub filtered: &'static [usize],
    /// The input of which its windows of neighbours hold pixels as they are: where that has 16-bit floats, the windows may,
    /// too, by [`Import::packed`].
    pub windowed: Option<usize>,
}

impl Pieces {
    /// No pieces, to name those that a kernel has.
    pub const NONE: Self =
        Self { imports: &[], own: &[], entry: &[], textures: &[], filtered: &[], windowed: None };
}

/// Text that shaders share.
#[derive(Debug, PartialEq, Eq)]
pub struct Import {
    /// Folder and stem of its file.
    pub name: &'static str,
    /// WGSL.
    pub text: &'static [Piece],
    /// The same functions with the sampler at [`SAMPLER_BINDING`](crate::kernel::SAMPLER_BINDING) in place of loads and
    /// arithmetic, for textures that a device filters; none where nothing is interpolated.
    pub filtered: Option<&'static [Piece]>,
    /// Pieces that take its place where windows hold 16-bit floats, for workgroups of
    /// [`PACKED_WORKGROUP`](crate::kernel::PACKED_WORKGROUP).
    pub packed: Option<&'static [Piece]>,
}
