//! Plans as data: the library says what to run, the host runs it on a device of its own.

use std::cell::Cell;
use std::marker::PhantomData;

use super::error::{Error, Result, check};
use super::graph::Graph;
use super::text;
use isophote_abi::{
    self as c, IsophoteApi, IsophotePass, IsophotePlan, IsophoteRequest, IsophoteStatus, IsophoteText,
    IsophoteTexture,
};

/// The passes that compute what a graph gives, for one request. One thread at a time may use it.
#[derive(Debug)]
pub struct Plan {
    api: &'static IsophoteApi,
    handle: IsophotePlan,
    one_thread: PhantomData<Cell<()>>,
}

/// Change that an update of a plan came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Only uniform bytes.
    Uniforms,
    /// Passes and textures are others now.
    Structure,
}

/// Role of a texture in a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The host binds its own texture.
    Input,
    /// A result.
    Output,
    /// Scratch memory; its contents need not survive from one run to the next.
    Transient,
}

/// Texel format of a texture of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// One 32-bit float.
    R32Float,
    /// Two 32-bit floats.
    Rg32Float,
    /// Four 32-bit floats.
    Rgba32Float,
    /// Four 16-bit floats.
    Rgba16Float,
}

/// One texture of a plan: two-dimensional, one mip level, one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Texture<'a> {
    /// Name of an input or output; empty for transients.
    pub name: &'a str,
    /// Role of the texture.
    pub role: Role,
    /// Format of its texels. An input may have any format of as many channels that is read as floats.
    pub format: Format,
    /// Columns and rows; at least so many.
    pub size: [u32; 2],
}

/// One dispatch of a plan.
#[derive(Clone, Copy, Debug)]
pub struct Pass<'a> {
    /// The kernel; passes of the same kernel have the same shader.
    pub kernel: &'a str,
    /// Bytes of the uniform at binding 0.
    pub grid: &'a [u8],
    /// Bytes of the uniform at binding 1; empty for kernels without parameters, which have no such binding.
    pub params: &'a [u8],
    /// Indices of the textures read, at bindings 2, 3, ...
    pub inputs: &'a [u32],
    /// Indices of the textures written, at the bindings after those.
    pub outputs: &'a [u32],
    /// Workgroups to dispatch in x, y and z.
    pub workgroups: [u32; 3],
}

/// A shader in WGSL.
#[derive(Clone, Copy, Debug)]
pub struct Wgsl {
    /// The whole module.
    pub source: &'static str,
    /// Name of its entry point.
    pub entry_point: &'static str,
    /// Binding of the sampler that it reads textures of [`Format::Rgba16Float`] by, if it does.
    pub sampler: Option<u32>,
}

impl Texture<'_> {
    /// Bytes of all its texels.
    pub fn bytes(&self) -> u64 {
        let texel = match self.format {
            Format::R32Float => 4,
            Format::Rg32Float => 8,
            Format::Rgba32Float => 16,
            Format::Rgba16Float => 8,
        };
        u64::from(self.size[0]) * u64::from(self.size[1]) * texel
    }
}

impl Graph {
    /// Plans the whole picture of `request`.
    ///
    /// # Errors
    /// [`Error`] when an input that is needed is open, or the size is impossible.
    pub fn plan(&self, request: &IsophoteRequest) -> Result<Plan> {
        Plan::made(self.api, |error, plan| {
            // SAFETY: the handle is the graph's; the request is read and the others written during the call.
            unsafe { (self.api.plan_create)(self.handle, request, std::ptr::null(), error, plan) }
        })
    }
}

impl Plan {
    /// The plan that `create` makes.
    pub(super) fn made(
        api: &'static IsophoteApi,
        create: impl FnOnce(*mut IsophoteText, *mut IsophotePlan) -> IsophoteStatus,
    ) -> Result<Self> {
        let mut handle = Default::default();
        let (status, message) = text::message(|error| create(error, &raw mut handle));
        check(status, || message)?;
        Ok(Self { api, handle, one_thread: PhantomData })
    }

    /// Takes over the parameters that `graph` has now, and what `request` of the same size asks for.
    ///
    /// # Errors
    /// [`Error`] as [`Graph::plan`]; the plan is then as before.
    pub fn update(&mut self, graph: &Graph, request: &IsophoteRequest) -> Result<Change> {
        let mut change = 0;
        // SAFETY: both handles are their objects'; the request may be read and `change` written during the call.
        let status = unsafe { (self.api.plan_update)(self.handle, graph.handle, request, &raw mut change) };
        self.check(status)?;
        Ok(if change == c::ISOPHOTE_CHANGE_UNIFORMS { Change::Uniforms } else { Change::Structure })
    }

    /// All textures; passes name them by their index.
    ///
    /// # Errors
    /// [`Error`] when the library fails or a texture is not of a form that the contract names.
    pub fn textures(&self) -> Result<Vec<Texture<'_>>> {
        let (mut textures, mut count) = (std::ptr::null(), 0);
        // SAFETY: the handle is this object's; the other two may be written during the call.
        let status = unsafe { (self.api.plan_textures)(self.handle, &raw mut textures, &raw mut count) };
        self.check(status)?;
        // SAFETY: the array is the plan's until it is updated or destroyed, which needs it not to be borrowed.
        let textures = unsafe { text::slice(textures, count) };
        // SAFETY: so are the names that the array points to.
        textures.iter().map(|t| unsafe { texture(t) }).collect()
    }

    /// All passes in the order of execution. Nothing is allocated.
    ///
    /// # Errors
    /// [`Error`] when the library fails.
    pub fn passes(&self) -> Result<impl ExactSizeIterator<Item = Pass<'_>>> {
        let (mut passes, mut count) = (std::ptr::null(), 0);
        // SAFETY: the handle is this object's; the other two may be written during the call.
        let status = unsafe { (self.api.plan_passes)(self.handle, &raw mut passes, &raw mut count) };
        self.check(status)?;
        // SAFETY: the array is the plan's until it is updated or destroyed, which needs it not to be borrowed.
        let passes = unsafe { text::slice(passes, count) };
        // SAFETY: so is everything that the array points to.
        Ok(passes.iter().map(|p| unsafe { pass(p) }))
    }

    /// The shader of a pass.
    ///
    /// # Errors
    /// [`Error`] when there is no such pass or the library fails.
    pub fn wgsl(&self, pass: u32) -> Result<Wgsl> {
        let mut shader = std::ptr::null();
        // SAFETY: the handle is this object's; `shader` may be written during the call.
        let status =
            unsafe { (self.api.plan_shader)(self.handle, pass, c::ISOPHOTE_LANGUAGE_WGSL, &raw mut shader) };
        self.check(status)?;
        // SAFETY: success means that `shader` and its texts live until the process ends.
        let (source, entry_point, bindings) = unsafe {
            let bindings = text::slice((*shader).bindings, (*shader).binding_count);
            (text::constant((*shader).code.cast()), text::constant((*shader).entry_point), bindings)
        };
        let sampler = bindings.iter().find(|bound| bound.kind == c::ISOPHOTE_BINDING_SAMPLER);
        Ok(Wgsl { source, entry_point, sampler: sampler.map(|bound| bound.binding) })
    }

    fn check(&self, status: IsophoteStatus) -> Result<()> {
        check(status, || {
            // SAFETY: the handle is this object's; the text is a buffer of the length that it says.
            text::message(|out| unsafe { (self.api.plan_error)(self.handle, out) }).1
        })
    }
}

impl Drop for Plan {
    fn drop(&mut self) {
        // Nobody is left who could do anything about a failure.
        // SAFETY: the handle is this object's and not used again.
        let _ = unsafe { (self.api.plan_destroy)(self.handle) };
    }
}

/// # Safety
/// The texture's name is null or text that ends with a zero and stays for `'a`.
unsafe fn texture<'a>(texture: &IsophoteTexture) -> Result<Texture<'a>> {
    Ok(Texture {
        // SAFETY: as the caller promised.
        name: unsafe { text::kept(texture.name) },
        role: match texture.role {
            c::ISOPHOTE_ROLE_INPUT => Role::Input,
            c::ISOPHOTE_ROLE_OUTPUT => Role::Output,
            c::ISOPHOTE_ROLE_TRANSIENT => Role::Transient,
            other => return Err(malformed(format!("a texture has the unknown role {other}"))),
        },
        format: match texture.format {
            c::ISOPHOTE_FORMAT_R32F => Format::R32Float,
            c::ISOPHOTE_FORMAT_RG32F => Format::Rg32Float,
            c::ISOPHOTE_FORMAT_RGBA32F => Format::Rgba32Float,
            c::ISOPHOTE_FORMAT_RGBA16F => Format::Rgba16Float,
            other => return Err(malformed(format!("a texture has the unknown format {other}"))),
        },
        size: [texture.width, texture.height],
    })
}

/// # Safety
/// The memory that the pass points to has the sizes that it says and stays for `'a`.
unsafe fn pass<'a>(pass: &IsophotePass) -> Pass<'a> {
    // SAFETY: as the caller promised.
    unsafe {
        Pass {
            kernel: text::kept(pass.kernel),
            grid: text::slice(pass.grid.cast(), pass.grid_size),
            params: text::slice(pass.params.cast(), pass.params_size),
            inputs: text::slice(pass.inputs, pass.input_count),
            outputs: text::slice(pass.outputs, pass.output_count),
            workgroups: pass.workgroups,
        }
    }
}

/// A plan that the library should not have given.
fn malformed(message: String) -> Error {
    Error::Call {
        status: c::ISOPHOTE_ERROR_INTERNAL,
        message: format!("the library's plan cannot be run: {message}"),
    }
}
