//! The plan as data: what a host needs to run a graph on its own graphics device.

use super::args;
use super::failure::{Failure, Outcome};
use super::guard::{self, lock};
use super::handles::{Object, object};
use super::objects::GraphObject;
use super::request;
use super::shader;
use isophote::engine::program::{Dispatch, Format, Program, Role, Texture};
use isophote::engine::{Class, Rect};
use isophote::planned::Change;
use isophote::{Graph, Lowered, Request};
use isophote_abi::*;
use std::collections::BTreeMap;
use std::ffi::{CString, c_char};
use std::ptr::null;
use std::sync::{Arc, Mutex};

/// A plan of a host's.
#[derive(Debug)]
pub struct PlanObject {
    state: Mutex<State>,
    message: Mutex<String>,
}

object!(PlanObject, IsophotePlan, 2, "plan");

impl PlanObject {
    /// The plan of `region`.
    ///
    /// # Errors
    /// The errors of planning and lowering.
    pub fn new(graph: Graph, request: Request, region: Rect) -> Outcome<Self> {
        let lowered = Lowered::new(graph, request, region)?;
        let shown = Shown::new(lowered.program());
        Ok(Self { state: Mutex::new(State { lowered, shown }), message: Mutex::default() })
    }
}

#[derive(Debug)]
struct State {
    lowered: Lowered,
    shown: Shown,
}

impl State {
    fn update(&mut self, graph: Graph, request: Option<Request>) -> Outcome<IsophoteChange> {
        let change = self.lowered.update(graph, request)?;
        if change == Change::Structure {
            self.shown = Shown::new(self.lowered.program());
        }
        Ok(change_number(change))
    }
}

/// Number of a change in the C interface.
pub fn change_number(change: Change) -> IsophoteChange {
    match change {
        Change::Uniforms => ISOPHOTE_CHANGE_UNIFORMS,
        Change::Structure => ISOPHOTE_CHANGE_STRUCTURE,
    }
}

/// A program as the host sees it. Points into the program and into the names kept here, whose places
/// on the heap change with the program only.
#[derive(Debug)]
struct Shown {
    textures: Vec<IsophoteTexture>,
    passes: Vec<IsophotePass>,
    /// Strings that the texts point to.
    _names: BTreeMap<String, CString>,
}

// SAFETY: the pointers lead to memory that the same state owns, and are followed by the host only.
unsafe impl Send for Shown {}

impl Shown {
    fn new(program: &Program) -> Self {
        let mut names = BTreeMap::new();
        let mut name = |text: &str| -> *const c_char {
            let entry = names.entry(text.to_owned());
            let name: &CString = entry.or_insert_with(|| CString::new(text).unwrap_or_default());
            name.as_ptr()
        };
        let textures = program.textures.iter().map(|t| texture(t, &mut name)).collect();
        let passes = program.dispatches.iter().map(|d| pass(d, &mut name)).collect();
        Self { textures, passes, _names: names }
    }
}

fn texture(texture: &Texture, name: &mut impl FnMut(&str) -> *const c_char) -> IsophoteTexture {
    let (role, name) = match &texture.role {
        Role::Input(text) => (ISOPHOTE_ROLE_INPUT, name(text)),
        Role::Output(text) => (ISOPHOTE_ROLE_OUTPUT, name(text)),
        Role::Transient => (ISOPHOTE_ROLE_TRANSIENT, null()),
    };
    let w = texture.window;
    IsophoteTexture {
        name,
        role,
        format: match texture.format {
            Format::R32 => ISOPHOTE_FORMAT_R32F,
            Format::Rg32 => ISOPHOTE_FORMAT_RG32F,
            Format::Rgba32 => ISOPHOTE_FORMAT_RGBA32F,
            Format::Rgba16 => ISOPHOTE_FORMAT_RGBA16F,
        },
        width: w.width(),
        height: w.height(),
        field: u32::from(texture.class == Class::Field),
        window: IsophoteRect { x0: w.x0, y0: w.y0, x1: w.x1, y1: w.y1 },
    }
}

fn pass(dispatch: &Dispatch, name: &mut impl FnMut(&str) -> *const c_char) -> IsophotePass {
    IsophotePass {
        kernel: name(&dispatch.shader.name),
        grid: (&raw const dispatch.grid).cast(),
        params: if dispatch.params.is_empty() { null() } else { dispatch.params.as_ptr().cast() },
        inputs: dispatch.inputs.as_ptr(),
        outputs: dispatch.outputs.as_ptr(),
        grid_size: size_of_val(&dispatch.grid) as u32,
        params_size: dispatch.params.len() as u32,
        input_count: dispatch.inputs.len() as u32,
        output_count: dispatch.outputs.len() as u32,
        workgroups: dispatch.workgroups,
        workgroup_size: [dispatch.shader.workgroup, dispatch.shader.workgroup, 1],
    }
}

pub(super) unsafe extern "C" fn create(
    from: IsophoteGraph,
    host_request: *const IsophoteRequest,
    region: *const IsophoteRect,
    error: *mut IsophoteText,
    plan: *mut IsophotePlan,
) -> IsophoteStatus {
    let make = || {
        let graph = GraphObject::slots().get(from.id)?.snapshot();
        // SAFETY: the host promised a request behind the pointer, and a rectangle or null.
        let (request, region) = unsafe {
            let request = request::request(&args::get(host_request, "the request")?)?;
            (request, request::region(region, &request)?)
        };
        PlanObject::new(graph, request, region)
    };
    // SAFETY: the host promised that both places may be written.
    unsafe { guard::create(plan, error, make) }
}

pub(super) unsafe extern "C" fn destroy(plan: IsophotePlan) -> IsophoteStatus {
    guard::destroy::<PlanObject>(plan)
}

pub(super) unsafe extern "C" fn error(plan: IsophotePlan, text: *mut IsophoteText) -> IsophoteStatus {
    // SAFETY: the host promised that the text may be written.
    unsafe { guard::last_message::<PlanObject>(plan, text) }
}

pub(super) unsafe extern "C" fn update(
    plan: IsophotePlan,
    graph: IsophoteGraph,
    host_request: *const IsophoteRequest,
    change: *mut IsophoteChange,
) -> IsophoteStatus {
    guard::on::<PlanObject>(plan, |object| {
        // SAFETY: the host promised a request behind the pointer, and that the place may be written.
        unsafe {
            updated(graph, host_request, change, |graph, request| lock(&object.state).update(graph, request))
        }
    })
}

/// Updates something for a graph and, where there is one, a host's request, and hands over the change that this was.
///
/// # Safety
/// `host_request` is null or points to a request, and `change` is null or may be written.
pub unsafe fn updated(
    graph: IsophoteGraph,
    host_request: *const IsophoteRequest,
    change: *mut IsophoteChange,
    update: impl FnOnce(Graph, Option<Request>) -> Outcome<IsophoteChange>,
) -> Outcome<()> {
    if change.is_null() {
        return Err(Failure::argument("the place for the change is null"));
    }
    let graph = GraphObject::slots().get(graph.id)?.snapshot();
    let request = if host_request.is_null() {
        None
    } else {
        // SAFETY: the caller promised a request behind the pointer.
        Some(request::request(&unsafe { args::get(host_request, "the request")? })?)
    };
    let found = update(graph, request)?;
    // SAFETY: the caller promised that the place may be written.
    unsafe { args::put(change, found, "the place for the change") }
}

pub(super) unsafe extern "C" fn textures(
    plan: IsophotePlan,
    textures: *mut *const IsophoteTexture,
    count: *mut u32,
) -> IsophoteStatus {
    let names = ["the place for the textures", "the place for the number of textures"];
    // SAFETY: the host promised that both places may be written.
    unsafe { list(plan, textures, count, names, |shown| &shown.textures) }
}

pub(super) unsafe extern "C" fn passes(
    plan: IsophotePlan,
    passes: *mut *const IsophotePass,
    count: *mut u32,
) -> IsophoteStatus {
    let names = ["the place for the passes", "the place for the number of passes"];
    // SAFETY: the host promised that both places may be written.
    unsafe { list(plan, passes, count, names, |shown| &shown.passes) }
}

/// Hands over a list of a plan's and its length; `names` are those of the places.
///
/// # Safety
/// Both places are null or may be written.
unsafe fn list<T>(
    plan: IsophotePlan,
    place: *mut *const T,
    count: *mut u32,
    names: [&str; 2],
    of: impl FnOnce(&Shown) -> &Vec<T>,
) -> IsophoteStatus {
    guard::on::<PlanObject>(plan, |object| {
        let state = lock(&object.state);
        let list = of(&state.shown);
        // SAFETY: as the caller promised.
        unsafe {
            args::put(place, list.as_ptr(), names[0])?;
            args::put(count, list.len() as u32, names[1])
        }
    })
}

pub(super) unsafe extern "C" fn shader(
    plan: IsophotePlan,
    pass: u32,
    language: IsophoteLanguage,
    shader: *mut *const IsophoteShader,
) -> IsophoteStatus {
    guard::on::<PlanObject>(plan, |object| {
        let state = lock(&object.state);
        let dispatches = &state.lowered.program().dispatches;
        let Some(dispatch) = dispatches.get(pass as usize) else {
            let count = dispatches.len();
            let message = format!("the plan has {count} passes, counted from 0, and no pass {pass}");
            return Err(Failure::new(ISOPHOTE_ERROR_UNKNOWN, message));
        };
        let kernel = Arc::clone(&dispatch.shader);
        drop(state);
        let found = shader::translated(&kernel, language)?;
        // SAFETY: the host promised that the place may be written.
        unsafe { args::put(shader, found, "the place for the shader") }
    })
}
