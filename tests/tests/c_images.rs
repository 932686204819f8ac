//! Images and graphs for the tests of the C table.

#![allow(unsafe_code, reason = "calls through the C table")]

use isophote_abi::*;
use isophote_tests::library::{Loaded, text};
use std::ffi::{CString, c_void};
use std::ptr::{null, null_mut};

pub const WIDTH: u32 = 45;
pub const HEIGHT: u32 = 31;

/// RGBA floats: edges, a ramp and grain.
pub fn picture() -> Vec<f32> {
    let pixel = |x: u32, y: u32| {
        let edge = if x * 2 + y < 50 { 0.2 } else { 0.7 };
        let grain = (x * 7919 + y * 104_729) % 97;
        [edge, x as f32 / WIDTH as f32, grain as f32 / 97.0, 1.0]
    };
    (0..HEIGHT).flat_map(|y| (0..WIDTH).flat_map(move |x| pixel(x, y))).collect()
}

pub fn image(data: *const c_void, sample: IsophoteSample, channels: u32, stride: isize) -> IsophoteImage {
    IsophoteImage { data, row_stride: stride, sample, channels, width: WIDTH, height: HEIGHT, x: 0, y: 0 }
}

pub fn floats(data: &[f32]) -> IsophoteImage {
    image(data.as_ptr().cast(), ISOPHOTE_SAMPLE_F32, 4, WIDTH as isize * 16)
}

pub fn target(image: IsophoteImage) -> IsophoteTarget {
    let IsophoteImage { data, row_stride, sample, channels, width, height, x, y } = image;
    IsophoteTarget { data: data.cast_mut(), row_stride, sample, channels, width, height, x, y }
}

/// A graph of one node, and how it is run.
pub struct Run<'a> {
    pub api: &'a IsophoteApi,
    pub graph: IsophoteGraph,
    pub device: IsophoteDevice,
    pub request: IsophoteRequest,
    pub region: Option<IsophoteRect>,
    pub control: Option<IsophoteControl>,
}

impl<'a> Run<'a> {
    pub fn new(library: &'a Loaded, node: &str) -> Self {
        let api = library.api;
        let mut graph = IsophoteGraph::default();
        let mut request = IsophoteRequest::default();
        let id = CString::new(node).unwrap();
        // SAFETY: the text ends with a zero, the places are writable.
        unsafe {
            assert_eq!((api.graph_create_single)(id.as_ptr(), null_mut(), &raw mut graph), ISOPHOTE_OK);
            assert_eq!((api.request_init)(WIDTH, HEIGHT, &raw mut request), ISOPHOTE_OK);
        }
        Self { api, graph, device: IsophoteDevice::default(), request, region: None, control: None }
    }

    /// Status, message and report of a run.
    pub fn run(
        &self,
        inputs: &[IsophoteInput],
        target: &IsophoteTarget,
    ) -> (IsophoteStatus, String, IsophoteReport) {
        let mut report = IsophoteReport::default();
        // SAFETY: the pointers lead to what the table asks for, or to null where they may.
        let status = unsafe {
            (self.api.process)(
                self.graph,
                self.device,
                &raw const self.request,
                inputs.as_ptr(),
                inputs.len() as u32,
                self.region.as_ref().map_or(null(), |r| &raw const *r),
                &raw const *target,
                self.control.as_ref().map_or(null(), |c| &raw const *c),
                &raw mut report,
            )
        };
        // SAFETY: the text is writable.
        let said = text(|t| unsafe { assert_eq!((self.api.graph_error)(self.graph, t), ISOPHOTE_OK) });
        (status, said, report)
    }

    /// The picture, and the result for it.
    pub fn pictures(&self) -> (Vec<f32>, Vec<f32>) {
        let data = picture();
        let result = self.result(&color(floats(&data)));
        (data, result)
    }

    /// The result as RGBA floats.
    pub fn result(&self, inputs: &[IsophoteInput]) -> Vec<f32> {
        let out = vec![-7.0_f32; (WIDTH * HEIGHT * 4) as usize];
        let (status, said, _) = self.run(inputs, &target(floats(&out)));
        assert_eq!(status, ISOPHOTE_OK, "{said}");
        out
    }
}

pub fn color(image: IsophoteImage) -> [IsophoteInput; 1] {
    [IsophoteInput { name: c"color".as_ptr(), image }]
}
