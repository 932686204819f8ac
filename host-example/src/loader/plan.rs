//! Plans as data: the library says what to run, the host runs it on a device of its own.

use std::borrow::Cow;
use std::cell::Cell;
use std::collections::HashMap;
use std::marker::PhantomData;
use std::sync::Arc;

use isophote_engine::program::{Dispatch, Grid, Program, Role, Shader, Texture};
use isophote_engine::{Class, Rect};

use super::contract::{self as c, IsophoteApi, IsophotePass, IsophotePlan, IsophoteRequest, IsophoteTexture};
use super::{Answer, Graph, Refusal, check, text};

/// The passes that compute what a graph gives, for one request. One thread at a time may use it.
#[derive(Debug)]
pub struct Plan {
    api: &'static IsophoteApi,
    handle: IsophotePlan,
    one_thread: PhantomData<Cell<()>>,
}

/// What an update of a plan came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Only uniform bytes.
    Uniforms,
    /// Passes and textures are others now.
    Structure,
}

impl Graph {
    /// Plans the whole picture of `request`.
    ///
    /// # Errors
    /// [`Refusal`] when an input that is needed is open, or the size is impossible.
    pub fn plan(&self, request: &IsophoteRequest) -> Answer<Plan> {
        let mut handle = 0;
        let (status, message) = text::message(|error| {
            // SAFETY: the handle is the graph's; the request is read and the others written during the call.
            unsafe { (self.api.plan_create)(self.handle, request, std::ptr::null(), error, &raw mut handle) }
        });
        check(status, || message)?;
        Ok(Plan { api: self.api, handle, one_thread: PhantomData })
    }
}

impl Plan {
    /// Takes over the parameters that `graph` has now.
    ///
    /// # Errors
    /// [`Refusal`] as [`Graph::plan`]; the plan is then as before.
    pub fn update(&mut self, graph: &Graph) -> Answer<Change> {
        let mut change = 0;
        // SAFETY: both handles are their objects'; `change` may be written during the call.
        let status = unsafe { (self.api.plan_update)(self.handle, graph.handle, &raw mut change) };
        self.check(status)?;
        Ok(if change == c::ISOPHOTE_CHANGE_UNIFORMS { Change::Uniforms } else { Change::Structure })
    }

    /// The plan as a program for the executor: shaders in WGSL, textures, bindings, uniform bytes, dispatches.
    ///
    /// # Errors
    /// [`Refusal`] when the library fails or its plan is not of the form that the contract names.
    pub fn program(&self) -> Answer<Program> {
        let mut program = Program::default();
        for texture in self.textures()? {
            // SAFETY: the texture and its name are the plan's, which is borrowed.
            program.textures.push(unsafe { engine_texture(texture) }?);
        }
        let mut shaders: HashMap<&str, Arc<Shader>> = HashMap::new();
        for (index, pass) in (0..).zip(self.passes()?) {
            // SAFETY: the pass and what it points to are the plan's, which is borrowed.
            let (kernel, inputs, outputs, params) = unsafe {
                (
                    text::kept(pass.kernel),
                    text::slice(pass.inputs, pass.input_count),
                    text::slice(pass.outputs, pass.output_count),
                    text::slice(pass.params.cast::<u8>(), pass.params_size),
                )
            };
            let channels = |i: &u32| program.textures.get(*i as usize).map(|t| t.channels);
            let channels: Option<Vec<u32>> = inputs.iter().chain(outputs).map(channels).collect();
            let Some(channels) = channels else {
                return Err(mistaken(format!("pass {index} ({kernel}) names a texture that does not exist")));
            };
            let shader = match shaders.get(kernel) {
                Some(shader) => Arc::clone(shader),
                None => {
                    let shader = Arc::new(Shader {
                        name: Cow::Owned(kernel.to_owned()),
                        source: Cow::Borrowed(self.wgsl(index)?),
                        inputs: inputs.len(),
                        outputs: Cow::Owned(channels[inputs.len()..].to_vec()),
                        params_size: params.len(),
                    });
                    shaders.insert(kernel, Arc::clone(&shader));
                    shader
                }
            };
            program.dispatches.push(Dispatch {
                shader,
                grid: self.grid(pass)?,
                params: params.to_vec(),
                inputs: inputs.to_vec(),
                outputs: outputs.to_vec(),
                workgroups: pass.workgroups,
            });
        }
        Ok(program)
    }

    /// Takes the uniform bytes over into a program that was made from this plan and has its structure still.
    ///
    /// # Errors
    /// As [`Plan::program`].
    pub fn repack(&self, program: &mut Program) -> Answer<()> {
        for (dispatch, pass) in program.dispatches.iter_mut().zip(self.passes()?) {
            dispatch.grid = self.grid(pass)?;
            // SAFETY: the bytes are the plan's, which is borrowed.
            let params = unsafe { text::slice(pass.params.cast::<u8>(), pass.params_size) };
            dispatch.params.clear();
            dispatch.params.extend_from_slice(params);
        }
        Ok(())
    }

    fn textures(&self) -> Answer<&[IsophoteTexture]> {
        let (mut textures, mut count) = (std::ptr::null(), 0);
        // SAFETY: the handle is this object's; the other two may be written during the call.
        let status = unsafe { (self.api.plan_textures)(self.handle, &raw mut textures, &raw mut count) };
        self.check(status)?;
        // SAFETY: the array is the plan's until it is updated or destroyed, which needs it not to be borrowed.
        Ok(unsafe { text::slice(textures, count) })
    }

    fn passes(&self) -> Answer<&[IsophotePass]> {
        let (mut passes, mut count) = (std::ptr::null(), 0);
        // SAFETY: the handle is this object's; the other two may be written during the call.
        let status = unsafe { (self.api.plan_passes)(self.handle, &raw mut passes, &raw mut count) };
        self.check(status)?;
        // SAFETY: the array is the plan's until it is updated or destroyed, which needs it not to be borrowed.
        Ok(unsafe { text::slice(passes, count) })
    }

    fn grid(&self, pass: &IsophotePass) -> Answer<Grid> {
        // SAFETY: the bytes are the plan's, which is borrowed.
        let bytes = unsafe { text::slice(pass.grid.cast::<u8>(), pass.grid_size) };
        bytemuck::try_pod_read_unaligned(bytes)
            .map_err(|_| mistaken(format!("a grid has {} bytes, not {}", bytes.len(), size_of::<Grid>())))
    }

    fn wgsl(&self, pass: u32) -> Answer<&'static str> {
        let mut shader = std::ptr::null();
        // SAFETY: the handle is this object's; `shader` may be written during the call.
        let status =
            unsafe { (self.api.plan_shader)(self.handle, pass, c::ISOPHOTE_LANGUAGE_WGSL, &raw mut shader) };
        self.check(status)?;
        // SAFETY: success means that `shader` and its text live until the process ends.
        Ok(unsafe { text::constant((*shader).code.cast()) })
    }

    fn check(&self, status: c::IsophoteStatus) -> Answer<()> {
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
/// The texture's name is null or text that ends with a zero.
unsafe fn engine_texture(texture: &IsophoteTexture) -> Answer<Texture> {
    // SAFETY: as the caller promised.
    let name = unsafe { text::kept(texture.name) }.to_owned();
    let window = texture.window;
    Ok(Texture {
        role: match texture.role {
            c::ISOPHOTE_ROLE_INPUT => Role::Input(name),
            c::ISOPHOTE_ROLE_OUTPUT => Role::Output(name),
            c::ISOPHOTE_ROLE_TRANSIENT => Role::Transient,
            other => return Err(mistaken(format!("a texture has the unknown role {other}"))),
        },
        channels: match texture.format {
            c::ISOPHOTE_FORMAT_R32F => 1,
            c::ISOPHOTE_FORMAT_RG32F => 2,
            c::ISOPHOTE_FORMAT_RGBA32F => 4,
            other => return Err(mistaken(format!("a texture has the unknown format {other}"))),
        },
        class: if texture.field != 0 { Class::Field } else { Class::Colour },
        window: Rect { x0: window.x0, y0: window.y0, x1: window.x1, y1: window.y1 },
    })
}

fn mistaken(message: String) -> Refusal {
    Refusal { status: c::ISOPHOTE_INTERNAL, message: format!("the library's plan cannot be run: {message}") }
}
