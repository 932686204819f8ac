//! A look on the frames of a viewport, in order.

use crate::device::{Bound, Device, Shader, format_of};
use crate::error::Error;
use crate::guides;
use crate::images::{Images, Needed};
use godot::builtin::Rid;
use isophote::engine::program::{Dispatch, Program, Role, SAMPLER_BINDING};
use isophote::live::{Follow, Live, is_stage, split};
use isophote::{Graph, Request};

/// A dispatch of the program, ready to be recorded.
#[derive(Debug)]
struct Pass {
    shader: Shader,
    /// Buffers of the grid and, where the kernel has any, of its parameters, with the bytes that they hold.
    uniforms: Vec<(Rid, Vec<u8>)>,
    /// Resources that it is given, by the turn of the images that it reads; made when it is first needed.
    sets: Vec<Option<Rid>>,
}

/// A plan, its textures and those of frames before, for one viewport.
#[derive(Debug)]
pub(crate) struct Runner {
    live: Live,
    passes: Vec<Pass>,
    /// By texture of the program: those that are the plan's alone.
    own: Vec<Option<Rid>>,
    images: Images,
    /// Turn of the images, out of as many as there are sets.
    turn: usize,
}

impl Runner {
    /// Plans the first frame.
    ///
    /// # Errors
    /// [`Error::Plan`] for sizes and lengths that are impossible, [`Error::Device`] where the device refuses.
    pub(crate) fn new(device: &mut Device, graph: Graph, request: Request) -> Result<Self, Error> {
        let live = Live::new(graph, request)?;
        let mut runner =
            Self { live, passes: Vec::new(), own: Vec::new(), images: Images::default(), turn: 0 };
        let prepared = runner.make_images(device, [request.width, request.height]);
        if let Err(e) = prepared.and_then(|()| runner.prepare(device)) {
            runner.free(device);
            return Err(e);
        }
        Ok(runner)
    }

    /// Follows what is wanted of the next frame; `graph` is there where it was edited.
    ///
    /// # Errors
    /// As [`Runner::new`], which must be called then.
    pub(crate) fn follow(
        &mut self,
        device: &mut Device,
        graph: Option<Graph>,
        request: Request,
    ) -> Result<(), Error> {
        match self.live.follow(graph, request)? {
            Follow::Nothing => {}
            Follow::Uniforms => {
                for (pass, dispatch) in self.passes.iter_mut().zip(&self.live.program().dispatches) {
                    for ((buffer, held), bytes) in pass.uniforms.iter_mut().zip(blocks(dispatch)) {
                        if held != bytes {
                            device.write(*buffer, bytes);
                            held.clear();
                            held.extend_from_slice(bytes);
                        }
                    }
                }
            }
            Follow::Program => self.prepare(device)?,
            Follow::Kept => {
                self.make_images(device, [request.width, request.height])?;
                self.prepare(device)?;
            }
        }
        Ok(())
    }

    /// Takes the next frame for the first of a shot.
    pub(crate) fn cut(&mut self) {
        self.live.cut();
    }

    /// Makes the images that the viewport's pictures are written to, and those that frames hand on.
    fn make_images(&mut self, device: &mut Device, size: [u32; 2]) -> Result<(), Error> {
        let kept = self.live.kept();
        let depth = |name: &str| kept.iter().find(|image| image.name == name).map_or(0, |image| image.depth);
        let mut needed: Vec<Needed> = guides::IMAGES
            .map(|(name, format)| Needed { name: name.into(), depth: depth(name), size, format })
            .into();
        needed.extend(kept.iter().filter_map(|image| {
            let (size, format) = image.texture?;
            Some(Needed { name: image.name.clone(), depth: image.depth, size, format: format_of(format) })
        }));
        self.images.hold(device, &needed)
    }

    /// Compiles what the program needs, and makes its textures and uniform blocks.
    fn prepare(&mut self, device: &mut Device) -> Result<(), Error> {
        self.free_program(device);
        let program = self.live.program();
        for texture in &program.textures {
            let is_own = match &texture.role {
                Role::Transient => true,
                Role::Output(name) => !is_stage(name),
                Role::Input(_) => false,
            };
            let size = [texture.window.width(), texture.window.height()];
            let made = is_own.then(|| device.texture(size, format_of(texture.format))).transpose()?;
            self.own.push(made);
        }
        let turns = self.images.turns();
        for dispatch in &program.dispatches {
            let shader = device.shader(&dispatch.shader.name, &dispatch.shader.source)?;
            self.passes.push(Pass { shader, uniforms: Vec::new(), sets: vec![None; turns] });
            for bytes in blocks(dispatch) {
                let buffer = device.uniforms(bytes)?;
                if let Some(pass) = self.passes.last_mut() {
                    pass.uniforms.push((buffer, bytes.to_vec()));
                }
            }
        }
        self.turn = 0;
        Ok(())
    }

    /// The images that the viewport's pictures are written to, in the order of [`guides::IMAGES`].
    pub(crate) fn targets(&self) -> Vec<Rid> {
        guides::IMAGES.iter().filter_map(|(name, _)| self.images.before(name, 0)).collect()
    }

    /// The image of a name in the frame that was drawn last.
    pub(crate) fn last(&self, name: &str) -> Option<Rid> {
        self.images.before(name, 1).or_else(|| self.images.before(name, 0))
    }

    /// Records the look on what [`Runner::targets`] holds, and returns the picture that it draws. The next call is of the next
    /// frame.
    ///
    /// # Errors
    /// [`Error::Device`] where the device refuses.
    pub(crate) fn run(&mut self, device: &mut Device) -> Result<Rid, Error> {
        let program = self.live.program();
        let refused = |what: &str| Error::Device(what.to_owned());
        for (pass, dispatch) in self.passes.iter_mut().zip(&program.dispatches) {
            let set = match pass.sets[self.turn] {
                Some(set) => set,
                None => {
                    let texture = |index: &u32| texture(program, &self.own, &self.images, *index);
                    let read: Option<Vec<Rid>> = dispatch.inputs.iter().map(texture).collect();
                    let written: Option<Vec<Rid>> = dispatch.outputs.iter().map(texture).collect();
                    let (Some(read), Some(written)) = (read, written) else {
                        return Err(refused("a plan without its textures"));
                    };
                    let uniforms = pass.uniforms.iter().map(|(buffer, _)| Bound::Uniforms(*buffer));
                    let textures =
                        read.into_iter().map(Bound::Read).chain(written.into_iter().map(Bound::Written));
                    let mut bound: Vec<(u32, Bound)> =
                        (0..).zip(uniforms).chain((2..).zip(textures)).collect();
                    if !dispatch.shader.filtered.is_empty() {
                        bound.push((SAMPLER_BINDING, Bound::Sampler(device.sampler()?)));
                    }
                    *pass.sets[self.turn].insert(device.set(pass.shader, &bound)?)
                }
            };
            device.dispatch(pass.shader, set, dispatch.workgroups);
        }
        let is_result = |role: &Role| matches!(role, Role::Output(name) if !is_stage(name));
        let result = program.textures.iter().position(|texture| is_result(&texture.role));
        let result =
            result.and_then(|index| self.own[index]).ok_or_else(|| refused("a look without a picture"))?;
        self.images.advance();
        self.turn = (self.turn + 1) % self.images.turns();
        self.live.drawn();
        Ok(result)
    }

    fn free_program(&mut self, device: &mut Device) {
        let buffers = self.passes.drain(..).flat_map(|pass| pass.uniforms).map(|(buffer, _)| buffer);
        device.free(buffers.collect::<Vec<Rid>>());
        device.free(self.own.drain(..).flatten());
    }

    /// Gives all back; nothing else may be called then.
    pub(crate) fn free(&mut self, device: &mut Device) {
        self.free_program(device);
        // Room for nothing.
        let _ = self.images.hold(device, &[]);
    }
}

/// The uniform blocks of a dispatch.
fn blocks(dispatch: &Dispatch) -> impl Iterator<Item = &[u8]> {
    let params = Some(&dispatch.params[..]).filter(|params| !params.is_empty());
    std::iter::once(bytemuck::bytes_of(&dispatch.grid)).chain(params)
}

/// A texture of a program in the frame at hand.
fn texture(program: &Program, own: &[Option<Rid>], images: &Images, index: u32) -> Option<Rid> {
    let index = index as usize;
    match &program.textures.get(index)?.role {
        Role::Input(name) => {
            let (base, before) = split(name).unwrap_or((name, 0));
            images.before(base, before)
        }
        Role::Output(name) if is_stage(name) => images.before(name, 0),
        _ => *own.get(index)?,
    }
}
