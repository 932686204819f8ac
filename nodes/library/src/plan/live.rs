//! A look on live frames, in order, as engines draw them.
//!
//! [`Live`] has the program of the next frame. It follows the graph, the frame's number and the frames before that are known; what
//! frames hand on to later ones is told by [`Live::kept`], and lies in textures of the engine's.

use crate::error::Result;
use crate::frames::Frames;
use crate::graph::Graph;
use crate::plan::lowered::Lowered;
use crate::plan::planned::Change;
use crate::plan::request::Request;
use isophote_engine::Rect;
use isophote_engine::program::{Format, Program, Role};

/// Image of a frame that later frames read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kept {
    /// Name of the output that it is, such as `stage0`, or of the guide.
    pub name: String,
    /// Frames before the one at hand that it is read of.
    pub depth: usize,
    /// Width and height, and the format; none for guides, which are the engine's.
    pub texture: Option<([u32; 2], Format)>,
}

/// Changes of a program from a frame to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Follow {
    /// It is the same.
    Nothing,
    /// Only uniform bytes are others.
    Uniforms,
    /// The program is another one; what is kept stays.
    Program,
    /// The program is another one, and so is what is kept: frames before count no longer.
    Kept,
}

/// The program of a look on live frames of one size.
#[derive(Debug)]
pub struct Live {
    lowered: Lowered,
    kept: Vec<Kept>,
    /// Frames before its own that a frame reads at most.
    reads: u32,
    /// Frames before the next that were drawn, at most those that are read.
    known: u32,
    /// Number of them that the program reads.
    planned: u32,
}

impl Live {
    /// Plans the first frame. What the request says of other frames is left aside.
    ///
    /// # Errors
    /// As planning and lowering.
    pub fn new(graph: Graph, request: Request) -> Result<Self> {
        let [reads, _] = graph.frames();
        let kept = kept(&graph, request, reads)?;
        Ok(Self { lowered: lowered(graph, request, reads, 0)?, kept, reads, known: 0, planned: 0 })
    }

    /// The program of the next frame. It reads images of frames before as `NAME@-N`, by the names of [`Live::kept`], and writes
    /// those that later frames read as outputs.
    pub fn program(&self) -> &Program {
        self.lowered.program()
    }

    /// The graph.
    pub fn graph(&self) -> &Graph {
        self.lowered.graph()
    }

    /// Images that frames hand on to later ones, as long as [`Live::follow`] does not say otherwise.
    pub fn kept(&self) -> &[Kept] {
        &self.kept
    }

    /// Takes over a request, and a graph where that was edited, for the next frame.
    ///
    /// # Errors
    /// As [`Live::new`]; it must then be made anew.
    pub fn follow(&mut self, graph: Option<Graph>, request: Request) -> Result<Follow> {
        let earlier = *self.lowered.request();
        let is_other = Request { frames: earlier.frames, frame: earlier.frame, ..request } != earlier;
        if is_other {
            *self = Self::new(graph.unwrap_or_else(|| self.graph().clone()), request)?;
            return Ok(Follow::Kept);
        }
        if let Some(graph) = &graph {
            let [reads, _] = graph.frames();
            let kept = kept(graph, request, reads)?;
            if kept != self.kept || reads != self.reads {
                (self.kept, self.reads, self.known, self.planned) = (kept, reads, 0, 0);
                self.lowered = lowered(graph.clone(), request, reads, 0)?;
                return Ok(Follow::Kept);
            }
        }
        if self.known != self.planned {
            let graph = graph.unwrap_or_else(|| self.graph().clone());
            self.lowered = lowered(graph, request, self.reads, self.known)?;
            self.planned = self.known;
            return Ok(Follow::Program);
        }
        if graph.is_none() && request.frame == earlier.frame {
            return Ok(Follow::Nothing);
        }
        let graph = graph.unwrap_or_else(|| self.graph().clone());
        Ok(match self.lowered.update(graph, Some(request))? {
            Change::Uniforms => Follow::Uniforms,
            Change::Structure => Follow::Program,
        })
    }

    /// Takes the next frame for the first of a shot.
    pub fn cut(&mut self) {
        self.known = 0;
    }

    /// Tells that the program was run: the next call is of the next frame.
    pub fn drawn(&mut self) {
        self.known = (self.planned + 1).min(self.reads);
    }
}

/// Name of an input of a frame before, and how many frames: `depth@-2` is of 2 before; none for those of the frame itself.
pub fn split(name: &str) -> Option<(&str, usize)> {
    let (base, before) = name.split_once("@-")?;
    Some((base, before.parse().ok()?))
}

/// True for an output that later frames read.
pub fn is_stage(name: &str) -> bool {
    name.strip_prefix("stage").is_some_and(|number| number.parse::<u32>().is_ok())
}

/// The program of a frame where so many before it are known, of those that are read.
fn lowered(graph: Graph, request: Request, reads: u32, known: u32) -> Result<Lowered> {
    let frames = if reads == 0 { Frames::NONE } else { Frames::in_order(known) };
    let all = Rect::of_size(request.width, request.height);
    Lowered::new(graph, Request { frames, ..request }, all)
}

/// Images that frames hand on, as one reads it where all before it are known.
fn kept(graph: &Graph, request: Request, reads: u32) -> Result<Vec<Kept>> {
    if reads == 0 {
        return Ok(Vec::new());
    }
    let whole = lowered(graph.clone(), request, reads, reads)?;
    let textures = &whole.program().textures;
    let mut kept: Vec<Kept> = Vec::new();
    for texture in textures {
        if let Role::Output(name) = &texture.role
            && is_stage(name)
        {
            let size = [texture.window.width(), texture.window.height()];
            kept.push(Kept { name: name.clone(), depth: 0, texture: Some((size, texture.format)) });
        }
    }
    for texture in textures {
        let Role::Input(name) = &texture.role else { continue };
        let Some((base, before)) = split(name) else { continue };
        match kept.iter_mut().find(|image| image.name == base) {
            Some(image) => image.depth = image.depth.max(before),
            None => kept.push(Kept { name: base.to_owned(), depth: before, texture: None }),
        }
    }
    Ok(kept)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::guides::Guides;

    fn steady(steadiness: &str) -> Graph {
        let mut graph = Graph::single("cartoon").expect("there is a cartoon");
        let node = graph.node(0).expect("it has a node");
        graph.set_text(node, "steadiness", steadiness).expect("it can be steady");
        graph
    }

    fn request(frame: i64) -> Request {
        Request { guides: Guides { motion: true, ..Guides::NONE }, frame, ..Request::new(64, 48) }
    }

    fn inputs(live: &Live) -> usize {
        let textures = live.program().textures.iter();
        textures.filter(|t| matches!(&t.role, Role::Input(name) if split(name).is_some())).count()
    }

    #[test]
    fn programs_read_more_frames_until_all_are_known() {
        let mut live = Live::new(steady("1"), request(0)).expect("a plan");
        assert!(live.kept().iter().any(|image| image.name == "stage0" && image.depth > 0));
        assert_eq!(inputs(&live), 0);
        let mut steps = Vec::new();
        for frame in 1..=live.reads as i64 + 2 {
            live.drawn();
            steps.push(live.follow(None, request(frame)).expect("a plan"));
            assert!(inputs(&live) > 0);
        }
        let whole = steps.iter().filter(|step| **step == Follow::Program).count();
        assert_eq!(whole as u32, live.reads);
        assert_eq!(steps.last(), Some(&Follow::Uniforms));
        live.drawn();
        live.cut();
        assert_eq!(live.follow(None, request(99)).expect("a plan"), Follow::Program);
        assert_eq!(inputs(&live), 0);
    }

    #[test]
    fn other_looks_and_sizes_begin_anew() {
        let mut live = Live::new(steady("1"), request(0)).expect("a plan");
        live.drawn();
        assert_eq!(live.follow(Some(steady("0")), request(0)).expect("a plan"), Follow::Kept);
        assert!(live.kept().is_empty() && inputs(&live) == 0);
        let mut edited = steady("0");
        let node = edited.node(0).expect("it has a node");
        edited.set_text(node, "line_color", "#ff0000").expect("lines have a colour");
        assert_eq!(live.follow(Some(edited), request(0)).expect("a plan"), Follow::Uniforms);
        assert_eq!(live.follow(None, request(0)).expect("a plan"), Follow::Nothing);
        let larger = Request { width: 65, ..request(0) };
        assert_eq!(live.follow(None, larger).expect("a plan"), Follow::Kept);
        assert_eq!(live.program().textures[0].window.width(), 65);
    }
}
