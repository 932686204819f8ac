//! Executors of a frame's plans: a graphics card's as long as it works, the CPU's otherwise.

use super::card::Card;
use super::device;
use super::host::Host;
use super::prepared::Prepared;
use super::stop::Stop;
use crate::pool;
use isophote::Error;
use isophote::engine::cpu::{Control, CpuExecutor, Threads};
use isophote::engine::plan::WORKING_MEMORY;
use isophote::engine::{Error as EngineError, Image, ImageId, Plan, Rect};
use isophote_abi::openfx::Handle;

/// Executors of one frame.
pub struct Executors<'h> {
    host: &'h Host,
    instance: Handle,
    card: Option<Card>,
    cpu: CpuExecutor,
}

/// Work for an executor.
pub struct Work<'w> {
    pub plan: &'w Plan,
    pub images: &'w [(&'w str, &'w Image)],
    pub region: Rect,
    pub control: Control<'w>,
}

impl<'h> Executors<'h> {
    /// The executors of a frame that wants this card, or none. The card's device is opened here if it has to be.
    pub fn new(host: &'h Host, instance: Handle, wanted: Option<Card>) -> Self {
        let mut executors = Self { host, instance, card: wanted, cpu: pool::executor() };
        if let Some(card) = wanted
            && let Err(error) = device::ready(card)
        {
            executors.leave_card(&error);
        }
        executors
    }

    /// Rows of a band of `inside` in a run of `plan`. A card cuts what is too large for it into tiles, so that a band there is as much as this
    /// machine should hold of pictures on their way.
    pub fn band_rows(&self, prepared: &Prepared, plan: &Plan, inside: Rect) -> i32 {
        let windows = plan.windows(prepared.plan_window(inside));
        let bytes = |id: ImageId| windows[id.index()].area() * u64::from(plan.desc(id).channels) * 4;
        let moved: u64 = plan.inputs().iter().chain(plan.outputs()).map(|port| bytes(port.image)).sum();
        if self.card.is_some() && moved <= WORKING_MEMORY[0] {
            inside.height() as i32
        } else {
            prepared.band_rows(plan, inside)
        }
    }

    /// The results; nothing when the card has failed, after which the CPU computes the frame from its first band on: one frame
    /// is of one device.
    pub fn run(&mut self, work: &Work<'_>, threads: &dyn Threads) -> Result<Option<Vec<Image>>, Stop> {
        let Work { plan, images, region, control } = *work;
        let Some(card) = self.card else {
            let results = self.cpu.run(plan, images, region, threads, control).map_err(Error::from)?;
            return Ok(Some(results));
        };
        match device::run(card, plan, images, region, control) {
            Ok(results) => {
                self.host.card_computes(self.instance);
                Ok(Some(results))
            }
            Err(EngineError::Cancelled) => Err(Stop::Aborted),
            Err(error) => {
                self.leave_card(&error);
                Ok(None)
            }
        }
    }

    fn leave_card(&mut self, error: &EngineError) {
        self.card = None;
        self.host.warn_of_card(self.instance, &format!("The CPU computes here. {error}"));
    }

    /// The CPU's executor, where no graphics card computes.
    pub fn cpu(&mut self) -> Option<&mut CpuExecutor> {
        self.card.is_none().then_some(&mut self.cpu)
    }

    /// Keeps the memory of an image for the next band.
    pub fn recycle(&mut self, image: Image) {
        if self.card.is_some() {
            pool::keep_image(image);
        } else {
            self.cpu.recycle(image);
        }
    }

    /// Gives back what is kept for the next band, unless the next frame may have it.
    pub fn purge(&mut self) {
        if self.cpu.kept() > pool::most() {
            self.cpu = CpuExecutor::new();
        }
    }

    /// Leaves its memory to other frames.
    pub fn keep_memory(self) {
        pool::keep_executor(self.cpu);
    }
}
