//! Looks on the processor, for pages without a graphics device.

use crate::ask::{Picture, region};
use crate::parts::planned;
use crate::response::Response;
use isophote::Error;
use isophote::engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote::engine::pixels::{Sample, read_row, write_row};
use isophote::engine::{Image, Plan};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Bytes of a pixel that comes and goes: red, green, blue and alpha.
const PIXEL: usize = 4;

/// Computes parts of pictures, and keeps its memory from part to part.
#[derive(Debug, Default)]
pub struct Processor {
    executor: CpuExecutor,
}

impl Processor {
    /// The pixels of `part`, of four bytes each. `windows` says by input which part of it `pixels` holds, one after the
    /// other in the order of their names.
    ///
    /// # Errors
    /// What is wrong with the look, the picture or the windows; too little memory.
    pub fn compute(
        &mut self,
        (look, picture): (&Value, &Picture),
        part: [i32; 4],
        windows: &BTreeMap<String, [i32; 4]>,
        pixels: &[u8],
    ) -> Result<Response, Error> {
        let planned = planned(look, picture)?;
        let images = read(planned.plan(), windows, pixels)?;
        let inputs: Vec<(&str, &Image)> = images.iter().map(|(name, image)| (*name, image)).collect();
        let control = Control::default();
        let results = self.executor.run(planned.plan(), &inputs, region(part), &CallingThread, control)?;
        let Some(result) = results.into_iter().next() else {
            return Err(Error::Connection("the look has no result".into()));
        };
        let response = written(&result);
        self.executor.recycle(result);
        Ok(response)
    }
}

/// The inputs of a plan, cut out of bytes.
fn read<'a>(
    plan: &Plan,
    windows: &'a BTreeMap<String, [i32; 4]>,
    mut pixels: &[u8],
) -> Result<Vec<(&'a str, Image)>, Error> {
    let mut images = Vec::new();
    for (name, window) in windows {
        let Some(port) = plan.inputs().iter().find(|port| port.name == *name) else {
            return Err(Error::Unknown(format!("the look reads no '{name}'")));
        };
        let mut image = Image::with_window(region(*window), plan.desc(port.image).channels)?;
        let row_bytes = image.width() as usize * PIXEL;
        let Some((own, rest)) = pixels.split_at_checked(row_bytes * image.height() as usize) else {
            return Err(Error::Format(format!("too few pixels are given for '{name}'")));
        };
        let channels = image.channels() as usize;
        for (y, bytes) in (image.window().y0..).zip(own.chunks_exact(row_bytes)) {
            read_row(bytes, Sample::U8, PIXEL, image.row_mut(y), channels);
        }
        pixels = rest;
        images.push((name.as_str(), image));
    }
    Ok(images)
}

fn written(result: &Image) -> Response {
    let window = result.window();
    let mut response = Response::from(json!({ "width": result.width(), "height": result.height() }));
    let row_bytes = result.width() as usize * PIXEL;
    response.bytes = vec![0; row_bytes * result.height() as usize];
    for (y, bytes) in (window.y0..).zip(response.bytes.chunks_exact_mut(row_bytes)) {
        write_row(result.row(y), result.channels() as usize, bytes, Sample::U8, PIXEL);
    }
    response
}
