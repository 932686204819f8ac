//! A look on the frames of a camera, in order.

use crate::component::Wanted;
use crate::error::Error;
use crate::guides;
use crate::images::{Images, Needed};
use crate::look::Style;
use bevy::platform::cell::SyncCell;
use isophote::engine::Rect;
use isophote::engine::gpu::{Device, Executor, Prepared, texture_format, wgpu};
use isophote::engine::program::{Program, Role};
use isophote::frames::Frames;
use isophote::guides::Guides;
use isophote::planned::Change;
use isophote::preset::Lengths;
use isophote::{ColourSpace, Graph, Lowered, Request};
use std::sync::Arc;

/// Picture of a camera: what can change from frame to frame, and asks for another plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Picture {
    /// Size of the viewport, in pixels.
    pub(crate) size: [u32; 2],
    /// Space of its colours.
    pub(crate) space: ColourSpace,
    /// What its prepasses know.
    pub(crate) guides: Guides,
}

/// A plan, its textures and those of frames before, for one camera.
pub(crate) struct Runner {
    device: Arc<Device>,
    /// Not to be shared between threads, as resources are.
    executor: SyncCell<Executor>,
    style: Arc<Style>,
    picture: Picture,
    wanted: Wanted,
    lowered: Lowered,
    prepared: Option<Prepared>,
    images: Images,
    /// Frames before the next that were drawn, at most those that the look reads.
    known: u32,
    /// Number of them that the plan reads.
    planned: u32,
}

impl Runner {
    /// Plans the first frame.
    ///
    /// # Errors
    /// [`Error::Plan`] for sizes and lengths that are impossible, [`Error::Device`] where memory does not suffice.
    pub(crate) fn new(device: &Arc<Device>, wanted: &Wanted, picture: Picture) -> Result<Self, Error> {
        let style = Arc::clone(&wanted.style);
        let graph = graph_of(wanted)?;
        let lowered = lowered(graph, request(wanted, &picture), 0)?;
        let mut runner = Self {
            device: Arc::clone(device),
            executor: SyncCell::new(Executor::new(Arc::clone(device))),
            style,
            picture,
            wanted: wanted.clone(),
            lowered,
            prepared: None,
            images: Images::default(),
            known: 0,
            planned: 0,
        };
        runner.make_images()?;
        runner.prepare()?;
        Ok(runner)
    }

    /// Follows what is wanted of the next frame. Parameters and frame numbers cost a small upload; another size, look or guide
    /// another plan.
    ///
    /// # Errors
    /// As [`Runner::new`], which must be called then.
    pub(crate) fn update(&mut self, wanted: &Wanted, picture: Picture) -> Result<(), Error> {
        let is_other = picture != self.picture
            || wanted.max_motion != self.wanted.max_motion
            || wanted.precision != self.wanted.precision;
        if is_other {
            *self = Self::new(&Arc::clone(&self.device), wanted, picture)?;
            return Ok(());
        }
        if wanted.shot != self.wanted.shot {
            self.known = 0;
        }
        let is_edited = !Arc::ptr_eq(&wanted.style, &self.style);
        let is_later = wanted.frame != self.wanted.frame;
        self.wanted = wanted.clone();
        if is_edited {
            self.style = Arc::clone(&wanted.style);
        }
        let graph = if is_edited || is_later { graph_of(wanted)? } else { self.lowered.graph().clone() };
        if is_edited && reads(&graph) != reads(self.lowered.graph()) {
            self.known = 0;
            self.plan(graph)?;
            self.make_images()
        } else if self.known != self.planned {
            self.plan(graph)
        } else if is_edited || is_later {
            self.follow(graph)
        } else {
            Ok(())
        }
    }

    /// Takes over parameters, and a frame number.
    fn follow(&mut self, graph: Graph) -> Result<(), Error> {
        let request = request(&self.wanted, &self.picture);
        let change = self.lowered.update(graph, Some(request))?;
        let program = self.lowered.program();
        match &mut self.prepared {
            Some(prepared) if change == Change::Uniforms => Ok(prepared.repack(program)?),
            _ => {
                self.make_images()?;
                self.prepare()
            }
        }
    }

    /// Plans for the frames before that are known.
    fn plan(&mut self, graph: Graph) -> Result<(), Error> {
        self.lowered = lowered(graph, request(&self.wanted, &self.picture), self.known)?;
        self.planned = self.known;
        self.prepare()
    }

    fn prepare(&mut self) -> Result<(), Error> {
        // Its scratch textures are taken again.
        self.prepared = None;
        self.prepared = Some(self.executor.get().prepare(self.lowered.program())?);
        Ok(())
    }

    /// Makes the images that the camera writes, and those that frames hand on, as a frame reads them where all before it are known.
    fn make_images(&mut self) -> Result<(), Error> {
        let graph = self.lowered.graph().clone();
        let depth = reads(&graph)[0];
        let whole = lowered(graph, request(&self.wanted, &self.picture), depth)?;
        let mut needed: Vec<Needed> = guides::IMAGES
            .map(|(name, format)| Needed { name: name.into(), depth: 0, size: self.picture.size, format })
            .into();
        for texture in &whole.program().textures {
            if let Role::Output(name) = &texture.role
                && is_stage(name)
            {
                let (size, format) =
                    ([texture.window.width(), texture.window.height()], texture_format(texture.format));
                needed.push(Needed { name: name.clone(), depth: 0, size, format });
            }
        }
        for (base, before) in inputs(whole.program()).filter_map(split) {
            if let Some(image) = needed.iter_mut().find(|image| image.name == base) {
                image.depth = image.depth.max(before);
            }
        }
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
        let program = self.lowered.program();
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
        self.known = (self.planned + 1).min(reads(self.lowered.graph())[0]);
        Ok(result)
    }
}

/// Frames around its own that a frame of a graph reads; those after it are never there.
fn reads(graph: &Graph) -> [u32; 2] {
    graph.frames()
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

/// The program of a frame where so many before it are known.
fn lowered(graph: Graph, request: Request, known: u32) -> Result<Lowered, Error> {
    let frames = match known {
        0 if reads(&graph) == [0, 0] => Frames::NONE,
        _ => Frames::in_order(known),
    };
    let all = Rect::of_size(request.width, request.height);
    Ok(Lowered::new(graph, Request { frames, ..request }, all)?)
}

fn inputs(program: &Program) -> impl Iterator<Item = &str> {
    program.textures.iter().filter_map(|texture| match &texture.role {
        Role::Input(name) => Some(name.as_str()),
        _ => None,
    })
}

/// The name of an input of a frame before, and how many frames: `depth@-2` is of 2 before.
fn split(name: &str) -> Option<(&str, usize)> {
    let (base, before) = name.split_once("@-")?;
    Some((base, before.parse().ok()?))
}

/// True for an output that later frames read.
fn is_stage(name: &str) -> bool {
    name.strip_prefix("stage").is_some_and(|number| number.parse::<u32>().is_ok())
}
