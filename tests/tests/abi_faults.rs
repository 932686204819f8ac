//! Every function of the C table, called wrongly: a status and a message, never a crash.

#![allow(unsafe_code, reason = "calls through the C table")]

use isophote_abi::*;
use isophote_tests::library::{Loaded, text};
use std::ffi::{CStr, CString, c_char};
use std::ptr::{null, null_mut};

fn c(text: &str) -> CString {
    CString::new(text).unwrap()
}

/// A graph of one node, by handle.
fn single(api: &IsophoteApi, node: &str) -> IsophoteGraph {
    let mut graph = IsophoteGraph::default();
    // SAFETY: the pointers lead to what the table asks for.
    let status = unsafe { (api.graph_create_single)(c(node).as_ptr(), null_mut(), &raw mut graph) };
    assert_eq!(status, ISOPHOTE_OK);
    graph
}

fn message(api: &IsophoteApi, graph: IsophoteGraph) -> String {
    // SAFETY: the text is writable.
    text(|t| unsafe { assert_eq!((api.graph_error)(graph, t), ISOPHOTE_OK) })
}

type Call = (&'static str, fn(&IsophoteApi, u64) -> IsophoteStatus);

/// Calls of functions of the table on a handle.
macro_rules! calls {
    ($type:ident $handle:ident: $($name:ident($($argument:expr),*))*) => {
        [$((stringify!($name), |api, id| {
            let $handle = $type { id };
            let _ = $handle;
            // SAFETY: that handles are wrong and pointers null is what must not matter.
            unsafe { (api.$name)($($argument),*) }
        })),*]
    };
}

/// Functions that are not called on a graph, a plan or a device: everything null.
const FREE: [Call; 8] = calls! { IsophoteGraph h:
    catalogue(null_mut())
    find_node(null(), null_mut(), null_mut())
    graph_create(null_mut(), null_mut())
    graph_create_single(null(), null_mut(), null_mut())
    graph_create_from_json(null(), null_mut(), null_mut())
    request_init(4, 4, null_mut())
    plan_create(h, null(), null(), null_mut(), null_mut())
    device_create(null(), null_mut(), null_mut())
};

/// Functions on a graph, every pointer null. The last two have no pointer, and succeed.
const GRAPH: [Call; 22] = calls! { IsophoteGraph h:
    graph_error(h, null_mut())
    graph_to_json(h, null_mut())
    graph_add(h, null(), null(), null_mut())
    graph_count(h, null_mut())
    graph_find(h, null(), null_mut())
    graph_name(h, 0, null_mut())
    graph_spec(h, 0, null_mut())
    graph_set_float(h, 0, null(), 1.0)
    graph_set_int(h, 0, null(), 1)
    graph_set_bool(h, 0, null(), 1)
    graph_set_choice(h, 0, null(), null())
    graph_set_color(h, 0, null(), null())
    graph_set_text(h, 0, null(), null())
    graph_get(h, 0, null(), null_mut())
    graph_connect(h, 0, 0, null())
    graph_connect_input(h, null(), 0, null())
    graph_disconnect(h, 0, null())
    graph_output_kind(h, null_mut())
    graph_support(h, null(), null(), null(), null_mut())
    process(h, IsophoteDevice::default(), null(), null(), 0, null(), null(), null(), null_mut())
    graph_set_output(h, 0)
    graph_destroy(h)
};

/// Functions on a plan, every pointer null.
const PLAN: [Call; 6] = calls! { IsophotePlan h:
    plan_error(h, null_mut())
    plan_update(h, IsophoteGraph::default(), null(), null_mut())
    plan_textures(h, null_mut(), null_mut())
    plan_passes(h, null_mut(), null_mut())
    plan_shader(h, 0, 0, null_mut())
    plan_destroy(h)
};

/// Functions on a device, every pointer null.
const DEVICE: [Call; 3] = calls! { IsophoteDevice h:
    device_error(h, null_mut())
    device_name(h, null_mut(), null_mut())
    device_destroy(h)
};

#[test]
fn every_function_is_in_these_lists() {
    // Three functions cannot be called wrongly: status_name, trim and extension.
    let listed = FREE.len() + GRAPH.len() + PLAN.len() + DEVICE.len() + 3;
    let header = std::mem::offset_of!(IsophoteApi, status_name);
    assert_eq!((size_of::<IsophoteApi>() - header) / size_of::<fn()>(), listed);
    let library = Loaded::new();
    for status in [0, 5, 16, 17, u32::MAX] {
        // SAFETY: the name is text with a closing zero.
        let name = unsafe { CStr::from_ptr((library.api.status_name)(status)) };
        assert!(!name.to_bytes().is_empty());
        assert_eq!(name == c"unknown status", status > 16);
    }
    // SAFETY: it takes nothing.
    assert_eq!(unsafe { (library.api.trim)() }, ISOPHOTE_OK);
}

#[test]
fn unknown_extensions_are_null() {
    let library = Loaded::new();
    for id in [null(), c"".as_ptr(), c"isophote.none".as_ptr(), c"\xff".as_ptr()] {
        // SAFETY: text with a closing zero, or null.
        assert!(unsafe { (library.api.extension)(id) }.is_null());
    }
}

#[test]
fn stale_foreign_and_invented_handles_are_noticed() {
    let library = Loaded::new();
    let api = library.api;
    let graph = single(api, "gaussian");
    let stale = single(api, "gaussian");
    let request = request(api, 8, 8);
    let mut plan = IsophotePlan::default();
    // SAFETY: the pointers lead to what the table asks for.
    unsafe {
        assert_eq!((api.graph_destroy)(stale), ISOPHOTE_OK);
        let status = (api.plan_create)(graph, &raw const request, null(), null_mut(), &raw mut plan);
        assert_eq!(status, ISOPHOTE_OK);
    }
    let invented = [0, 1, 0xdead_beef, u64::MAX, stale.id, graph.id ^ (1 << 24), graph.id + 1000];
    for (calls, foreign) in
        [(&GRAPH[..], &[plan.id][..]), (&PLAN[..], &[graph.id][..]), (&DEVICE[..], &[graph.id, plan.id][..])]
    {
        for handle in invented.iter().chain(foreign) {
            for (name, call) in calls {
                assert_eq!(call(api, *handle), ISOPHOTE_ERROR_INVALID_HANDLE, "{name}({handle:#x})");
            }
        }
    }
    // SAFETY: as before; here the place for the handle is there, and must become 0.
    unsafe {
        for handle in invented.map(|id| IsophoteGraph { id }) {
            let mut made = IsophotePlan { id: 77 };
            let mut status = 0;
            let said = text(|t| {
                status = (api.plan_create)(handle, &raw const request, null(), t, &raw mut made);
            });
            assert_eq!((status, made.id), (ISOPHOTE_ERROR_INVALID_HANDLE, 0));
            assert!(said.contains("graph"), "{said}");
            status = (api.plan_update)(plan, handle, null(), &raw mut status);
            assert_eq!(status, ISOPHOTE_ERROR_INVALID_HANDLE);
        }
        assert_eq!((api.plan_destroy)(plan), ISOPHOTE_OK);
        assert_eq!((api.plan_destroy)(plan), ISOPHOTE_ERROR_INVALID_HANDLE);
        assert_eq!((api.graph_destroy)(graph), ISOPHOTE_OK);
    }
}

#[test]
fn null_pointers_are_named() {
    let library = Loaded::new();
    let api = library.api;
    for (name, call) in FREE {
        assert_eq!(call(api, single(api, "gaussian").id), ISOPHOTE_ERROR_INVALID_ARGUMENT, "{name}");
    }
    let graph = single(api, "gaussian");
    for (name, call) in &GRAPH[..GRAPH.len() - 2] {
        assert_eq!(call(api, graph.id), ISOPHOTE_ERROR_INVALID_ARGUMENT, "{name}");
        if *name != "graph_error" {
            assert!(message(api, graph).ends_with(" is null"), "{name}: {}", message(api, graph));
        }
    }
    let request = request(api, 8, 8);
    let mut plan = IsophotePlan::default();
    // SAFETY: the pointers lead to what the table asks for.
    unsafe {
        (api.plan_create)(graph, &raw const request, null(), null_mut(), &raw mut plan);
        for (name, call) in &PLAN[..PLAN.len() - 1] {
            assert_eq!(call(api, plan.id), ISOPHOTE_ERROR_INVALID_ARGUMENT, "{name}");
        }
        let mut shader = null();
        assert_eq!((api.plan_shader)(plan, 99, 0, &raw mut shader), ISOPHOTE_ERROR_UNKNOWN);
        assert_eq!((api.plan_shader)(plan, 0, 99, &raw mut shader), ISOPHOTE_ERROR_INVALID_ARGUMENT);
        let said = text(|t| assert_eq!((api.plan_error)(plan, t), ISOPHOTE_OK));
        assert_eq!(said, "99 is no shader language");
        assert_eq!((api.plan_destroy)(plan), ISOPHOTE_OK);
        assert_eq!((api.graph_destroy)(graph), ISOPHOTE_OK);
    }
}

/// A graph that is called wrongly.
struct Called<'a> {
    api: &'a IsophoteApi,
    graph: IsophoteGraph,
}

impl Called<'_> {
    /// The call gave this status, and its message has this part.
    fn check(&self, status: IsophoteStatus, expected: IsophoteStatus, part: &str) {
        let said = message(self.api, self.graph);
        assert_eq!(status, expected, "{said}");
        assert!(said.contains(part), "'{said}' lacks '{part}'");
    }

    fn json(&self) -> String {
        // SAFETY: the text is writable.
        text(|t| unsafe { assert_eq!((self.api.graph_to_json)(self.graph, t), ISOPHOTE_OK) })
    }

    fn set_wrong_values(&self) {
        let Self { api, graph } = *self;
        let (rho, derivative) = (c("rho"), c("derivative"));
        let (rho, derivative) = (rho.as_ptr(), derivative.as_ptr());
        let check = |status, expected, part| self.check(status, expected, part);
        // SAFETY: the texts end with zeros.
        unsafe {
            for value in [f64::NAN, f64::INFINITY, -1.0, 1e300, -1e-300 - 1.0] {
                check((api.graph_set_float)(graph, 0, rho, value), ISOPHOTE_ERROR_OUT_OF_RANGE, "'rho'");
            }
            let (misspelt, sobal) = (c("rhoo"), c("sobal"));
            let unknown = (api.graph_set_float)(graph, 0, misspelt.as_ptr(), 1.0);
            check(unknown, ISOPHOTE_ERROR_UNKNOWN, "did you mean 'rho'?");
            check((api.graph_set_float)(graph, 7, rho, 1.0), ISOPHOTE_ERROR_UNKNOWN, "no node 7");
            let last = (api.graph_set_float)(graph, u32::MAX, rho, 1.0);
            check(last, ISOPHOTE_ERROR_UNKNOWN, "no node 4294967295");
            check((api.graph_set_bool)(graph, 0, rho, 1), ISOPHOTE_ERROR_WRONG_TYPE, "graph_set_float");
            let color = [0.5_f32; 4];
            check(
                (api.graph_set_color)(graph, 0, rho, color.as_ptr()),
                ISOPHOTE_ERROR_WRONG_TYPE,
                "is a number",
            );
            let number = (api.graph_set_float)(graph, 0, derivative, 1.0);
            check(number, ISOPHOTE_ERROR_WRONG_TYPE, "graph_set_choice");
            let choice = (api.graph_set_choice)(graph, 0, derivative, sobal.as_ptr());
            check(choice, ISOPHOTE_ERROR_UNKNOWN, "did you mean 'sobel'?");
            let wide = c("wide");
            let worded = (api.graph_set_text)(graph, 0, rho, wide.as_ptr());
            check(worded, ISOPHOTE_ERROR_OUT_OF_RANGE, "not 'wide'");
            let bytes = (api.graph_set_float)(graph, 0, c"\xff\xfe".as_ptr(), 1.0);
            check(bytes, ISOPHOTE_ERROR_INVALID_ARGUMENT, "not UTF-8");
        }
    }

    fn connect_wrongly(&self) {
        let Self { api, graph } = *self;
        let (color, depth) = (c"color".as_ptr(), c"depth".as_ptr());
        let (colour, dept) = (c"colour".as_ptr(), c"dept".as_ptr());
        let check = |status, expected, part| self.check(status, expected, part);
        // SAFETY: the texts end with zeros.
        unsafe {
            check((api.graph_connect)(graph, 0, 0, color), ISOPHOTE_ERROR_CONNECTION, "takes color");
            check((api.graph_connect)(graph, 0, 0, colour), ISOPHOTE_ERROR_UNKNOWN, "'color'");
            check((api.graph_connect_input)(graph, depth, 0, color), ISOPHOTE_ERROR_CONNECTION, "not depth");
            check((api.graph_connect_input)(graph, dept, 0, depth), ISOPHOTE_ERROR_UNKNOWN, "object_id");
            check((api.graph_set_output)(graph, 1), ISOPHOTE_ERROR_UNKNOWN, "no node 1");
        }
    }

    fn add_wrongly(&self) {
        let mut index = 0;
        let mut check = |name: &str, node: &str, expected, part| {
            let (name, node) = (c(name), c(node));
            // SAFETY: the texts end with zeros, the place is writable.
            let status =
                unsafe { (self.api.graph_add)(self.graph, name.as_ptr(), node.as_ptr(), &raw mut index) };
            self.check(status, expected, part);
        };
        check("structure_tensor", "gaussian", ISOPHOTE_ERROR_INVALID_ARGUMENT, "two nodes");
        check("", "gaussian", ISOPHOTE_ERROR_INVALID_ARGUMENT, "cannot name");
        check("new", "gausian", ISOPHOTE_ERROR_UNKNOWN, "did you mean 'gaussian'?");
    }

    /// Right values still work, and can be read back.
    fn set_right_values(&self) {
        let Self { api, graph } = *self;
        let (rho, derivative, sobel) = (c("rho"), c("derivative"), c("sobel"));
        // SAFETY: the texts end with zeros, the places are writable.
        unsafe {
            assert_eq!((api.graph_set_float)(graph, 0, rho.as_ptr(), 0.1), ISOPHOTE_OK);
            let status = (api.graph_set_choice)(graph, 0, derivative.as_ptr(), sobel.as_ptr());
            assert_eq!(status, ISOPHOTE_OK);
            let mut value = IsophoteValue { kind: 9, choice_index: 9, choice: null(), number: [9.0; 4] };
            assert_eq!((api.graph_get)(graph, 0, rho.as_ptr(), &raw mut value), ISOPHOTE_OK);
            assert_eq!((value.kind, value.number[0]), (ISOPHOTE_PARAM_FLOAT, 0.1));
            assert_eq!((api.graph_get)(graph, 0, derivative.as_ptr(), &raw mut value), ISOPHOTE_OK);
            assert_eq!((value.kind, value.choice_index), (ISOPHOTE_PARAM_CHOICE, 1));
            assert_eq!(CStr::from_ptr(value.choice), c"sobel");
        }
    }
}

#[test]
fn unknown_names_and_wrong_values_leave_the_graph_as_it_was() {
    let library = Loaded::new();
    let called = Called { api: library.api, graph: single(library.api, "structure_tensor") };
    let before = called.json();
    called.set_wrong_values();
    called.connect_wrongly();
    called.add_wrongly();
    assert_eq!(called.json(), before);
    called.set_right_values();
    assert_ne!(called.json(), before);
    // SAFETY: it takes any handle.
    assert_eq!(unsafe { (library.api.graph_destroy)(called.graph) }, ISOPHOTE_OK);
}

#[test]
fn broken_graph_files_are_refused_with_a_reason() {
    let api = Loaded::new();
    let api = api.api;
    let cases = [
        ("", ISOPHOTE_ERROR_MALFORMED, "not a graph file"),
        ("{", ISOPHOTE_ERROR_MALFORMED, "line 1"),
        ("[]", ISOPHOTE_ERROR_MALFORMED, "not a graph file"),
        (r#"{"format":"x","version":1,"nodes":[],"output":"a"}"#, ISOPHOTE_ERROR_MALFORMED, "'x'"),
        (r#"{"format":"isophote-graph","version":1,"nodes":[],"output":"a"}"#, ISOPHOTE_ERROR_UNKNOWN, "'a'"),
        (
            r#"{"format":"isophote-graph","version":1,"nodes":[{"name":"a","node":"blur"}],"output":"a"}"#,
            ISOPHOTE_ERROR_UNKNOWN,
            "'blur'",
        ),
        (
            r#"{"format":"isophote-graph","version":1,"nodes":[{"name":"a","node":"gaussian","params":{"sigma":-3}}],"output":"a"}"#,
            ISOPHOTE_ERROR_OUT_OF_RANGE,
            "'sigma'",
        ),
        (
            r#"{"format":"isophote-graph","version":1,"nodes":[{"name":"a","node":"gaussian","inputs":{"color":"a"}}],"output":"a"}"#,
            ISOPHOTE_ERROR_CONNECTION,
            "cycle",
        ),
    ];
    for (json, expected, part) in cases {
        let (mut graph, mut status) = (IsophoteGraph { id: 77 }, 0);
        // SAFETY: the text ends with a zero, the places are writable.
        let said = text(|t| unsafe {
            status = (api.graph_create_from_json)(c(json).as_ptr(), t, &raw mut graph);
        });
        assert_eq!((status, graph.id), (expected, 0), "{json}: {said}");
        assert!(said.contains(part) && said.lines().count() == 1, "{json}: {said}");
    }
    // And a good one comes back as it went in.
    let graph = single(api, "gaussian");
    // SAFETY: as before.
    unsafe {
        (api.graph_set_float)(graph, 0, c("sigma").as_ptr(), 3.25);
        let json = text(|t| assert_eq!((api.graph_to_json)(graph, t), ISOPHOTE_OK));
        let mut again = IsophoteGraph::default();
        let status = (api.graph_create_from_json)(c(&json).as_ptr(), null_mut(), &raw mut again);
        assert_eq!(status, ISOPHOTE_OK);
        assert_eq!(text(|t| assert_eq!((api.graph_to_json)(again, t), ISOPHOTE_OK)), json);
        // Too small a buffer says how much is needed.
        let mut bytes = [1 as c_char; 8];
        let mut small = IsophoteText { data: bytes.as_mut_ptr(), capacity: 8, length: 0 };
        assert_eq!((api.graph_to_json)(graph, &raw mut small), ISOPHOTE_ERROR_TRUNCATED);
        assert_eq!((small.length, bytes[7]), (json.len(), 0));
        small = IsophoteText { data: null_mut(), capacity: 0, length: 0 };
        assert_eq!((api.graph_to_json)(graph, &raw mut small), ISOPHOTE_OK);
        assert_eq!(small.length, json.len());
        small.capacity = 8;
        assert_eq!((api.graph_to_json)(graph, &raw mut small), ISOPHOTE_ERROR_INVALID_ARGUMENT);
    }
}

fn request(api: &IsophoteApi, width: u32, height: u32) -> IsophoteRequest {
    let mut request = IsophoteRequest { space: 9, alpha: 9, guides: 9, ..Default::default() };
    // SAFETY: the place is writable.
    assert_eq!(unsafe { (api.request_init)(width, height, &raw mut request) }, ISOPHOTE_OK);
    request
}

#[test]
fn impossible_requests_are_refused() {
    let library = Loaded::new();
    let api = library.api;
    let graph = single(api, "gaussian");
    let good = request(api, 64, 48);
    let make = |request: IsophoteRequest, region: Option<IsophoteRect>| {
        let (mut plan, mut status) = (IsophotePlan::default(), 0);
        let region = region.as_ref().map_or(null(), |r| &raw const *r);
        // SAFETY: the pointers lead to what the table asks for.
        let said = text(|t| unsafe {
            status = (api.plan_create)(graph, &raw const request, region, t, &raw mut plan);
        });
        // SAFETY: a handle of a plan, or 0.
        unsafe { (api.plan_destroy)(plan) };
        (status, said)
    };
    assert_eq!(make(good, None).0, ISOPHOTE_OK);
    for (width, height) in [(0, 48), (64, 0), (0, 0), (65537, 1), (u32::MAX, u32::MAX), (1 << 31, 1 << 31)] {
        let (status, said) = make(IsophoteRequest { width, height, ..good }, None);
        assert_eq!(status, ISOPHOTE_ERROR_GEOMETRY, "{width}x{height}: {said}");
    }
    for scale in [0.0, -1.0, f32::NAN, f32::INFINITY, 65.0] {
        let (status, said) = make(IsophoteRequest { scale, ..good }, None);
        assert_eq!(status, ISOPHOTE_ERROR_OUT_OF_RANGE, "{scale}: {said}");
    }
    let bad = [
        IsophoteRequest { space: 3, ..good },
        IsophoteRequest { alpha: 3, ..good },
        IsophoteRequest { guides: 1 << 16, ..good },
    ];
    for request in bad {
        assert_eq!(make(request, None).0, ISOPHOTE_ERROR_INVALID_ARGUMENT, "{request:?}");
    }
    let rect = |x0, y0, x1, y1| IsophoteRect { x0, y0, x1, y1 };
    let (least, most) = (i32::MIN, i32::MAX);
    for region in [
        rect(0, 0, 0, 0),
        rect(5, 5, 5, 9),
        rect(9, 5, 5, 9),
        rect(-1, 0, 4, 4),
        rect(0, 0, 65, 48),
        rect(0, 0, 64, 49),
        rect(least, least, most, most),
        rect(most, most, least, least),
        rect(64, 48, 65, 49),
    ] {
        let (status, said) = make(good, Some(region));
        assert_eq!(status, ISOPHOTE_ERROR_GEOMETRY, "{region:?}");
        assert!(said.contains("64x48"), "{said}");
    }
    assert_eq!(make(good, Some(rect(63, 47, 64, 48))).0, ISOPHOTE_OK);
    // A graph that cannot be planned.
    // SAFETY: the texts end with zeros.
    unsafe { assert_eq!((api.graph_disconnect)(graph, 0, c("color").as_ptr()), ISOPHOTE_OK) };
    let (status, said) = make(good, None);
    assert_eq!(status, ISOPHOTE_ERROR_CONNECTION);
    assert!(said.contains("'color'") && said.contains("not connected"), "{said}");
}

#[test]
fn a_failed_update_leaves_the_plan_as_it_was() {
    let library = Loaded::new();
    let api = library.api;
    let graph = single(api, "gaussian");
    let request = request(api, 64, 48);
    let (mut plan, mut change) = (IsophotePlan::default(), 9);
    // SAFETY: the pointers lead to what the table asks for; plan data is read while it is valid.
    unsafe {
        (api.plan_create)(graph, &raw const request, null(), null_mut(), &raw mut plan);
        let passes = || {
            let (mut passes, mut count) = (null(), 0);
            assert_eq!((api.plan_passes)(plan, &raw mut passes, &raw mut count), ISOPHOTE_OK);
            std::slice::from_raw_parts(passes, count as usize)
        };
        let bytes = |passes: &[IsophotePass]| -> Vec<Vec<u8>> {
            let of = |p: &IsophotePass| std::slice::from_raw_parts(p.params.cast(), p.params_size as usize);
            passes.iter().map(|p| of(p).to_vec()).collect()
        };
        let shown = passes();
        let before = bytes(shown);
        let sigma = c("sigma");
        assert_eq!((api.graph_set_float)(graph, 0, sigma.as_ptr(), 5.5), ISOPHOTE_OK);
        assert_eq!((api.plan_update)(plan, graph, null(), &raw mut change), ISOPHOTE_OK);
        assert_eq!(change, ISOPHOTE_CHANGE_UNIFORMS);
        assert_eq!(passes().as_ptr(), shown.as_ptr(), "a slider moved the passes");
        let edited = bytes(shown);
        assert_ne!(before, edited);

        let other = single(api, "gaussian");
        assert_eq!((api.graph_disconnect)(other, 0, c("color").as_ptr()), ISOPHOTE_OK);
        assert_eq!((api.plan_update)(plan, other, null(), &raw mut change), ISOPHOTE_ERROR_CONNECTION);
        assert_eq!(bytes(passes()), edited);

        assert_eq!((api.graph_set_float)(graph, 0, c("mix").as_ptr(), 0.5), ISOPHOTE_OK);
        assert_eq!((api.plan_update)(plan, graph, null(), &raw mut change), ISOPHOTE_OK);
        assert_eq!(change, ISOPHOTE_CHANGE_STRUCTURE);
        // The picture that is mixed in joins a pass, whose parameters are more then.
        let mixed = bytes(passes());
        assert_ne!(mixed.iter().flatten().count(), before.iter().flatten().count());
        // The plan does not need its graph.
        assert_eq!((api.graph_destroy)(graph), ISOPHOTE_OK);
        assert_eq!(bytes(passes()), mixed);
        (api.plan_destroy)(plan);
    }
}
