//! A program: a plan lowered to textures, bindings, uniform bytes and dispatch sizes.
//!
//! This is the plan as plain data, ready for any graphics API: no device, queue or driver handle
//! appears in it. The `gpu` executor runs it with wgpu; a host may run it with whatever it has.
//!
//! Bindings of every pass, all in group 0: 0 is the `Grid` uniform (below), 1 the kernel's own
//! uniform block if it has parameters, from 2 on the sampled textures in order, then the storage
//! textures in order. Textures are read by integer loads only and never filtered.

use crate::error::{Error, Result};
use crate::image::Rect;
use crate::kernel::{Kernel, MAX_INPUTS, WORKGROUP};
use crate::plan::{Class, ImageId, Pass, Plan, Port, Support};
use std::borrow::Cow;
use std::sync::Arc;

/// What a texture of a program is for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Role {
    /// The host binds its own texture here. It must show the picture's window named by `window`.
    Input(String),
    /// A result; the host's own texture or one it allocates.
    Output(String),
    /// Scratch memory; contents do not survive the program, and images of one level and format share it.
    Transient,
}

/// One physical texture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texture {
    /// What it is for.
    pub role: Role,
    /// 1, 2 or 4 stored channels: r32float, rg32float, rgba32float. (Three are stored as four.)
    pub channels: u32,
    /// Precision needed.
    pub class: Class,
    /// Part of the picture (at its pyramid level) that the texture holds, in pixels. That of a transient one begins
    /// at (0, 0) and is as large as the largest image in each direction; where an image lies is in the passes' grids.
    pub window: Rect,
}

/// The uniform block at binding 0: where the textures of a pass lie in the picture.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Grid {
    /// Absolute position of texel (0, 0) of the outputs.
    pub origin: [i32; 2],
    /// Texels to write.
    pub size: [i32; 2],
    /// Size of the whole picture at the outputs' level.
    pub full: [i32; 2],
    /// Zero.
    pub reserved: [i32; 2],
    /// Per input: absolute position of texel (0, 0), and the whole picture's size at its level.
    pub inputs: [[i32; 4]; MAX_INPUTS],
}

/// The shader of a kernel, as data: it may come from this library's kernels or, through the C ABI,
/// from another's.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Shader {
    /// The kernel's name.
    pub name: Cow<'static, str>,
    /// Complete WGSL module, entry point `main`.
    pub source: Cow<'static, str>,
    /// Number of sampled textures.
    pub inputs: usize,
    /// Channels of the storage textures.
    pub outputs: Cow<'static, [u32]>,
    /// Size of the uniform block at binding 1, in bytes; 0 for none.
    pub params_size: usize,
}

impl From<&'static Kernel> for Shader {
    fn from(kernel: &'static Kernel) -> Self {
        Self {
            name: Cow::Borrowed(kernel.name),
            source: Cow::Borrowed(kernel.shader),
            inputs: kernel.inputs,
            outputs: Cow::Borrowed(kernel.outputs),
            params_size: kernel.params_size,
        }
    }
}

/// One dispatch.
#[derive(Clone, Debug)]
pub struct Dispatch {
    /// What to run.
    pub shader: Arc<Shader>,
    /// Uniform at binding 0.
    pub grid: Grid,
    /// Uniform at binding 1; empty for a kernel without parameters.
    pub params: Vec<u8>,
    /// Sampled textures, indices into [`Program::textures`], from binding 2.
    pub inputs: Vec<u32>,
    /// Storage textures (write only), from the binding after the inputs.
    pub outputs: Vec<u32>,
    /// Workgroups in x, y, z.
    pub workgroups: [u32; 3],
}

/// A plan lowered for one region.
#[derive(Clone, Debug, Default)]
pub struct Program {
    /// All textures; inputs and outputs first, in the plan's order.
    pub textures: Vec<Texture>,
    /// All dispatches in order. Between two there must be a barrier wherever one reads what the
    /// other wrote (wgpu and WebGPU place it by themselves).
    pub dispatches: Vec<Dispatch>,
    /// Which pass of the plan each dispatch came from, and its supports where windows depend on them.
    passes: Vec<(usize, Option<Vec<Support>>)>,
}

impl Program {
    /// Lowers `plan` for `region` (level 0). Transient images with disjoint lives share a texture.
    ///
    /// # Errors
    /// [`Error::Geometry`] for a region outside the picture, [`Error::Input`] for a plan whose output
    /// is one of its inputs.
    pub fn lower(plan: &Plan, region: Rect) -> Result<Self> {
        plan.check_region(region)?;
        // The windows of the whole picture are whole, however far the passes read.
        let [width, height] = plan.size();
        let is_whole = region == Rect::of_size(width, height);
        let mut lowering = Lowering::new(plan, plan.windows(region));
        lowering.add_ports()?;
        let mut passes = Vec::new();
        let mut dispatches = Vec::new();
        for (index, pass) in plan.passes().iter().enumerate() {
            if lowering.windows[pass.outputs[0].index()].is_empty() {
                continue;
            }
            lowering.make_room(pass);
            dispatches.push(lowering.dispatch(pass));
            passes.push((index, (!is_whole).then(|| pass.supports.clone())));
            lowering.release(index);
        }
        Ok(Self { textures: lowering.textures, dispatches, passes })
    }

    /// Takes over the uniform bytes of a plan that was edited in place, without allocating.
    ///
    /// Returns false, with nothing changed, when the plan must be lowered again: its passes are
    /// others, or the program is for a part of the picture and a pass now reads less or farther.
    pub fn repack(&mut self, plan: &Plan) -> bool {
        let fits = |dispatch: &Dispatch, (index, supports): &(usize, Option<Vec<Support>>)| {
            plan.passes().get(*index).is_some_and(|pass| {
                dispatch.shader.source == pass.kernel.shader
                    && pass.inputs.len() == dispatch.inputs.len()
                    && supports.as_ref().is_none_or(|s| *s == pass.supports)
            })
        };
        if !self.dispatches.iter().zip(&self.passes).all(|(d, p)| fits(d, p)) {
            return false;
        }
        for (dispatch, (index, _)) in self.dispatches.iter_mut().zip(&self.passes) {
            dispatch.params.copy_from_slice(&plan.passes()[*index].params);
        }
        true
    }

    /// Index of the input texture of this name.
    pub fn input(&self, name: &str) -> Option<usize> {
        self.textures.iter().position(|t| matches!(&t.role, Role::Input(n) if n == name))
    }

    /// Index of the output texture of this name.
    pub fn output(&self, name: &str) -> Option<usize> {
        self.textures.iter().position(|t| matches!(&t.role, Role::Output(n) if n == name))
    }
}

/// A plan on its way to a program.
struct Lowering<'p> {
    plan: &'p Plan,
    windows: Vec<Rect>,
    textures: Vec<Texture>,
    /// By texture: the level of its images.
    levels: Vec<i8>,
    /// By virtual image: its texture, once it has one.
    places: Vec<Option<u32>>,
    /// Transient textures whose images are needed no longer.
    free: Vec<u32>,
}

impl<'p> Lowering<'p> {
    fn new(plan: &'p Plan, windows: Vec<Rect>) -> Self {
        Self {
            plan,
            windows,
            textures: Vec::new(),
            levels: Vec::new(),
            places: vec![None; plan.images().len()],
            free: Vec::new(),
        }
    }

    /// Gives textures to what enters and leaves.
    fn add_ports(&mut self) -> Result<()> {
        for port in self.plan.inputs() {
            self.add_port(port, Role::Input(port.name.clone()));
        }
        for port in self.plan.outputs() {
            if self.places[port.image.index()].is_some() {
                return Err(Error::Input(format!(
                    "output '{}' is an input or another output passed on unchanged",
                    port.name
                )));
            }
            self.add_port(port, Role::Output(port.name.clone()));
        }
        Ok(())
    }

    fn add_port(&mut self, port: &Port, role: Role) {
        if !self.windows[port.image.index()].is_empty() {
            let texture = self.texture(port.image, role, self.windows[port.image.index()]);
            self.places[port.image.index()] = Some(self.push(port.image, texture));
        }
    }

    fn texture(&self, image: ImageId, role: Role, window: Rect) -> Texture {
        let desc = self.plan.desc(image);
        let channels = if desc.channels == 3 { 4 } else { desc.channels };
        Texture { role, channels, class: desc.class, window }
    }

    fn push(&mut self, image: ImageId, texture: Texture) -> u32 {
        self.textures.push(texture);
        self.levels.push(self.plan.desc(image).level);
        self.textures.len() as u32 - 1
    }

    /// Gives textures to the transient images that a pass writes: free ones of their level and format, which grow
    /// where an image is larger, or new ones. The size does not choose, so that tiles of all sizes connect their
    /// passes alike and one prepared program runs them all.
    fn make_room(&mut self, pass: &Pass) {
        for output in &pass.outputs {
            if self.places[output.index()].is_some() {
                continue;
            }
            let held = self.windows[output.index()];
            let wanted = self.texture(*output, Role::Transient, Rect::of_size(held.width(), held.height()));
            let fits = |free: &u32| {
                let texture = &self.textures[*free as usize];
                (texture.channels, texture.class) == (wanted.channels, wanted.class)
                    && self.levels[*free as usize] == self.plan.desc(*output).level
            };
            let place = match self.free.iter().position(fits) {
                Some(at) => {
                    let place = self.free.swap_remove(at);
                    let window = &mut self.textures[place as usize].window;
                    window.x1 = window.x1.max(wanted.window.x1);
                    window.y1 = window.y1.max(wanted.window.y1);
                    place
                }
                None => self.push(*output, wanted),
            };
            self.places[output.index()] = Some(place);
        }
    }

    /// Frees the transient textures whose images are needed for the last time by pass `index`.
    fn release(&mut self, index: usize) {
        let ended = self.plan.lifetimes().ending_with(index).iter().filter_map(|id| self.places[id.index()]);
        self.free.extend(ended.filter(|place| self.textures[*place as usize].role == Role::Transient));
    }

    fn dispatch(&self, pass: &Pass) -> Dispatch {
        let out = pass.outputs[0];
        let window = self.windows[out.index()];
        let full = self.plan.level_size(self.plan.desc(out).level);
        let mut inputs = [[0; 4]; MAX_INPUTS];
        for (place, image) in inputs.iter_mut().zip(&pass.inputs) {
            let w = self.windows[image.index()];
            let [fw, fh] = self.plan.level_size(self.plan.desc(*image).level);
            *place = [w.x0, w.y0, fw, fh];
        }
        let size = [window.width() as i32, window.height() as i32];
        // Every image of a pass got its texture before the pass, or in an earlier one.
        let textures = |ids: &[ImageId]| ids.iter().filter_map(|id| self.places[id.index()]).collect();
        Dispatch {
            shader: Arc::new(Shader::from(pass.kernel)),
            grid: Grid { origin: [window.x0, window.y0], size, full, reserved: [0; 2], inputs },
            params: pass.params.clone(),
            inputs: textures(&pass.inputs),
            outputs: textures(&pass.outputs),
            workgroups: [window.width().div_ceil(WORKGROUP), window.height().div_ceil(WORKGROUP), 1],
        }
    }
}
