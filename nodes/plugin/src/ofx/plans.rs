//! The plans of a frame, and what is computed by them.

use super::colours::working;
use super::executors::{Executors, Work};
use super::inputs::{Gathered, Inputs, Read};
use super::known::Known;
use super::neighbours::{Cut, Found, Lasting, Looked, Search, Stages};
use super::prepared::{Prepared, Quality};
use super::segments::Part;
use super::settings::Settings;
use super::stop::Stop;
use isophote::engine::cpu::{Control, CpuExecutor, Threads};
use isophote::engine::{Image, Rect};
use isophote::graph::GraphInput;
use isophote::kernels::shared::host_colour::has_light;
use isophote_abi::openfx::*;

/// Pixels of a frame that are computed at once, and the means for it.
#[derive(Clone, Copy)]
pub struct Bands<'b> {
    pub inside: Rect,
    pub threads: &'b dyn Threads,
    pub control: Control<'b>,
}

/// The plans of a frame.
pub struct Plans<'a, 'h> {
    pub(super) inputs: &'a Inputs<'h>,
    settings: &'a Settings,
    quality: Quality,
    pub(super) known: Known,
    /// The plan for all of it.
    pub prepared: Prepared,
    /// What other frames have in common with this one, where it was looked for.
    stages: Stages,
    /// The plan for what is not found there.
    pub cut: Cut,
    /// The one for light beyond coverage, once a band has any.
    emissive: Option<Cut>,
    /// Contents of images that were looked at.
    pub(super) looked: Vec<Looked>,
}

impl<'a, 'h> Plans<'a, 'h> {
    /// The plans for these images and values.
    ///
    /// # Errors
    /// Memory; failed, when the graph cannot be planned.
    pub fn new(inputs: &'a Inputs<'h>, settings: &'a Settings, quality: Quality) -> Result<Self, Stop> {
        let has = inputs.available();
        let mut known = Known::of(&settings.graph, settings.motion_from, has, inputs.host.temporal)?;
        known.limit_to_source(inputs.host, inputs.instance, inputs.time);
        let prepared = prepared(inputs, settings, quality, &known)?;
        let stages = Stages::default();
        let cut = stages.cut(prepared.planned.plan());
        Ok(Self {
            inputs,
            settings,
            quality,
            known,
            prepared,
            stages,
            cut,
            emissive: None,
            looked: Vec::new(),
        })
    }

    /// Goes on without a frame that lacks an image, and those behind it.
    pub(super) fn forget_from(&mut self, missing: i32) -> Result<(), Stop> {
        self.known.forget_from(missing);
        self.looked.clear();
        self.prepared = prepared(self.inputs, self.settings, self.quality, &self.known)?;
        self.cut = self.stages.cut(self.prepared.planned.plan());
        self.emissive = None;
        Ok(())
    }

    /// The parts of `inside`, each in the segment of which other frames have something in common with this one, if any has.
    pub fn parts(&self, inside: Rect) -> Vec<Part> {
        Lasting::parts(&self.prepared, self.inputs.frame.size(), inside)
    }

    /// What is done to pixels between their reading and the plan, beside what is prepared.
    pub(super) fn treatment(&self) -> String {
        format!("{:?} {}", self.settings.space, self.inputs.is_straight())
    }

    /// Finds what other frames have in common with the segment of a part of this one, if it is of any.
    ///
    /// # Errors
    /// As reading and running.
    pub fn find_stages(
        &mut self,
        part: Part,
        executor: &mut CpuExecutor,
        work: &Bands<'_>,
    ) -> Result<(), Stop> {
        let Some(segment) = part.segment else {
            self.take(Stages::default());
            return Ok(());
        };
        let Bands { threads, control, .. } = *work;
        let is_part = part.is_strip(self.inputs.frame.size());
        loop {
            let (inputs, treatment) = (self.inputs, self.treatment());
            let (prepared, known) = (&self.prepared, &self.looked[..]);
            let search = Search { inputs, prepared, segment, is_part, known, treatment, threads, control };
            match search.run(executor)? {
                Found::All(stages) => {
                    self.take(stages);
                    return Ok(());
                }
                Found::Without(missing) => self.forget_from(missing)?,
            }
        }
    }

    fn take(&mut self, stages: Stages) {
        self.cut = stages.cut(self.prepared.planned.plan());
        self.emissive = None;
        self.stages = stages;
    }

    /// The plan's result over the pixels that are wanted, in one.
    pub(super) fn over(&mut self, executors: &mut Executors<'_>, work: &Bands<'_>) -> Result<Image, Stop> {
        let rows = executors.band_rows(&self.prepared, &self.cut.plan, work.inside);
        let window = self.prepared.plan_window(work.inside);
        let mut all: Option<Image> = None;
        for band in bands(work.inside, rows) {
            let found = self.run(executors, &Bands { inside: band, ..*work })?;
            let (result, images) = found.ok_or(kOfxStatFailed)?;
            images.into_iter().for_each(Read::keep_memory);
            if result.window() == window {
                return Ok(result);
            }
            let all = match &mut all {
                Some(all) => all,
                None => {
                    all.insert(Image::with_window(window, result.channels()).map_err(|_| kOfxStatErrMemory)?)
                }
            };
            let part = result.window();
            let first = (part.x0 - window.x0) as usize * result.channels() as usize;
            for y in part.y0..part.y1 {
                all.row_mut(y)[first..first + result.stride()].copy_from_slice(result.row(y));
            }
            executors.recycle(result);
        }
        Ok(all.ok_or(kOfxStatFailed)?)
    }

    /// The plan's result over a band, and what was read for it; nothing when the graphics card has failed.
    ///
    /// # Errors
    /// As reading and running.
    pub fn run(
        &mut self,
        executors: &mut Executors<'_>,
        work: &Bands<'_>,
    ) -> Result<Option<(Image, Vec<Read>)>, Stop> {
        let Bands { inside: band, threads, control } = *work;
        let images = self.gather(band, threads)?;
        let region = self.prepared.plan_window(band);
        let cut = self.planned(&images)?;
        let read = images.iter().map(|read| (&read.name[..], &read.pixels));
        let handed = cut.handed.iter().map(|(name, image)| (&name[..], &**image));
        let named: Vec<(&str, &Image)> = read.chain(handed).collect();
        let work = Work { plan: &cut.plan, images: &named, region, control };
        let Some(results) = executors.run(&work, threads)? else { return Ok(None) };
        let result = results.into_iter().next().ok_or(kOfxStatFailed)?;
        Ok(Some((result, images)))
    }

    /// Images that a band is computed from. Frames are known up to the first that lacks an image.
    fn gather(&mut self, band: Rect, threads: &dyn Threads) -> Result<Vec<Read>, Stop> {
        loop {
            let (prepared, plan) = (&self.prepared, &self.cut.plan);
            let windows = plan.windows(prepared.plan_window(band));
            match self.inputs.gather(prepared, plan, &windows, threads)? {
                Gathered::All(mut images) => {
                    for read in &mut images {
                        self.inputs.make_ready(prepared, read, threads)?;
                    }
                    return Ok(images);
                }
                Gathered::Without(missing) => self.forget_from(missing)?,
            }
        }
    }

    /// The plan for what was read.
    fn planned(&mut self, images: &[Read]) -> Result<&Cut, Stop> {
        let color = images.iter().find(|read| read.name == GraphInput::Color.id());
        let premultiplied = self.prepared.planned.request().premultiplied;
        if !(premultiplied && color.is_some_and(|read| has_light(read.pixels.data()))) {
            return Ok(&self.cut);
        }
        if self.emissive.is_none() {
            let planned = self.prepared.emissive(&self.known)?;
            self.emissive = Some(self.stages.cut(planned.plan()));
        }
        Ok(self.emissive.as_ref().unwrap_or(&self.cut))
    }
}

fn prepared(
    inputs: &Inputs<'_>,
    settings: &Settings,
    quality: Quality,
    known: &Known,
) -> isophote::Result<Prepared> {
    Prepared::new(known, working(settings.space), &inputs.frame, !inputs.is_straight(), quality)
}

/// Bands of `rows` rows, from the top.
pub fn bands(window: Rect, rows: i32) -> impl Iterator<Item = Rect> {
    (window.y0..window.y1).step_by(rows.max(1) as usize).map(move |y0| Rect {
        y0,
        y1: (y0 + rows).min(window.y1),
        ..window
    })
}
