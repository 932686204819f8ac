//! A look on the frames of a camera, in order.

use crate::component::Wanted;
use crate::error::Error;
use crate::guides;
use crate::images::{Images, Needed};
use crate::look::Style;
use bevy::platform::cell::SyncCell;
use isophote::engine::gpu::{Device, Executor, Prepared, texture_format, wgpu};
use isophote::engine::program::{Program, Role};
use isophote::guides::Guides;
use isophote::live::{Follow, Live, is_stage, split};
use isophote::preset::Lengths;
use isophote::{ColourSpace, Graph, Request};
use std::sync::Arc;

/// Picture of a camera: what can change from frame to frame, and asks for another plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Picture {
    /// Size of the viewport, in pixels.
    pub(crate) size: [u32; 2],
    /// Space of its colours.
    pub(crate) space: ColourSpace,
    /// Guides that its prepasses give.
    pub(crate) guides: Guides,
}

/// A plan, its textures and those of frames before, for one camera.
pub(crate) struct Runner {
    device: Arc<Device>,
    /// Not to be shared between threads, as resources are.
    executor: SyncCell<Executor>,
    style: Arc<Style>,
    wanted: Wanted,
    live: Live,
    prepared: Option<Prepared>,
    images: Images,
}

impl Runner {
    /// Plans the first frame.
    ///
    /// # Errors
    /// [`Error::Plan`] for sizes and lengths that are impossible, [`Error::Device`] where memory does not suffice.
    pub(crate) fn new(device: &Arc<Device>, wanted: &Wanted, picture: Picture) -> Result<Self, Error> {
        let live = Live::new(graph_of(wanted)?, request(wanted, &picture))?;
        let mut runner = Self {
            device: Arc::clone(device),
            executor: SyncCell::new(Executor::new(Arc::clone(device))),
            style: Arc::clone(&wanted.style),
            wanted: wanted.clone(),
            live,
            prepared: None,
            images: Images::default(),
        };
        runner.make_images(picture.size)?;
        runner.prepare()?;
        Ok(runner)
    }

    /// Follows what is wanted of the next frame. Parameters and frame numbers cost a small upload; another size, look or guide
    /// another plan.
    ///
    /// # Errors
    /// As [`Runner::new`], which must be called then.
    pub(crate) fn update(&mut self, wanted: &Wanted, picture: Picture) -> Result<(), Error> {
        if wanted.shot != self.wanted.shot {
            self.live.cut();
        }
        let is_edited = !Arc::ptr_eq(&wanted.style, &self.style) || wanted.precision != self.wanted.precision;
        let is_later = wanted.frame != self.wanted.frame;
        let graph = if is_edited || is_later { Some(graph_of(wanted)?) } else { None };
        (self.wanted, self.style) = (wanted.clone(), Arc::clone(&wanted.style));
        match self.live.follow(graph, request(wanted, &picture))? {
            Follow::Nothing => Ok(()),
            Follow::Uniforms => match &mut self.prepared {
                Some(prepared) => Ok(prepared.repack(self.live.program())?),
                None => self.prepare(),
            },
            Follow::Program => self.prepare(),
            Follow::Kept => {
                self.make_images(picture.size)?;
                self.prepare()
            }
        }
    }

    fn prepare(&mut self) -> Result<(), Error> {
        // Its scratch textures are taken again.
        self.prepared = None;
        self.prepared = Some(self.executor.get().prepare(self.live.program())?);
        Ok(())
    }

    /// Makes the images that the camera writes, and those that frames hand on.
    fn make_images(&mut self, size: [u32; 2]) -> Result<(), Error> {
        let kept = self.live.kept();
        let depth = |name: &str| kept.iter().find(|image| image.name == name).map_or(0, |image| image.depth);
        let mut needed: Vec<Needed> = guides::IMAGES
            .map(|(name, format)| Needed { name: name.into(), depth: depth(name), size, format })
            .into();
        needed.extend(kept.iter().filter_map(|image| {
            let (size, format) = image.texture?;
            let format = texture_format(format);
            Some(Needed { name: image.name.clone(), depth: image.depth, size, format })
        }));
        self.images.hold(&self.device, &needed)
    }

    /// The images that the camera's pictures are written to, in the order of [`guides::IMAGES`].
    pub(crate) fn targets(&self) -> Vec<&wgpu::TextureView> {
        guides::IMAGES.iter().filter_map(|(name, _)| self.images.now(name)).collect()
    }

    /// Records the look on what [`Runner::targets`] holds, and returns the picture that it draws. The next call is of the next
    /// frame.
    ///
    /// # Errors
    /// [`Error::Device`] where the device refuses.
    pub(crate) fn encode(&mut self, encoder: &mut wgpu::CommandEncoder) -> Result<wgpu::TextureView, Error> {
        let program = self.live.program();
        let Some(prepared) = &mut self.prepared else {
            return Err(isophote::engine::Error::Input("the plan was not prepared".into()).into());
        };
        let mut bound = Vec::new();
        for name in inputs(program) {
            let (base, before) = split(name).unwrap_or((name, 0));
            bound.extend(self.images.before(base, before).map(|view| (name, view)));
        }
        let mut written = Vec::new();
        let mut result = None;
        for texture in &program.textures {
            match &texture.role {
                Role::Output(name) if is_stage(name) => {
                    written.extend(self.images.now(name).map(|view| (name.as_str(), view)));
                }
                Role::Output(name) => result = Some(name.as_str()),
                _ => {}
            }
        }
        prepared.bind(&bound, &written)?;
        let name = result.ok_or_else(|| isophote::engine::Error::Input("the look has no picture".into()))?;
        let result = prepared.own_output(name)?;
        prepared.encode(encoder)?;
        self.images.advance();
        self.live.drawn();
        Ok(result)
    }
}

/// The graph of a style at a frame.
fn graph_of(wanted: &Wanted) -> Result<Graph, Error> {
    let mut graph = wanted.style.graph.clone();
    wanted.style.settings.at_frame(&mut graph, wanted.frame)?;
    graph.set_precision(wanted.precision);
    Ok(graph)
}

fn request(wanted: &Wanted, picture: &Picture) -> Request {
    let lengths: Lengths = wanted.style.settings.lengths();
    Request {
        space: picture.space,
        guides: picture.guides,
        frame: wanted.frame,
        reference_height: lengths.reference_height(),
        max_motion: wanted.max_motion,
        ..Request::new(picture.size[0], picture.size[1])
    }
}

fn inputs(program: &Program) -> impl Iterator<Item = &str> {
    program.textures.iter().filter_map(|texture| match &texture.role {
        Role::Input(name) => Some(name.as_str()),
        _ => None,
    })
}
