//! A graphics device: the library's own, or a host's.

use super::pipeline::{self, Pipeline, Pipelines};
use crate::error::{Error, Result};
use crate::memory;
use crate::program::Shader;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Duration;

/// Environment variable that chooses the adapter where [`Options::adapter`] does not: `gpu`,
/// `software`, a number such as `#2`, or a part of an adapter's name.
const ADAPTER_VARIABLE: &str = "ISOPHOTE_ADAPTER";

/// Bytes that a driver may take to be opened, of which those that compute on the CPU take most. Drivers that do not
/// get it end the process.
const DRIVER: u64 = 1 << 30;

/// Options for opening a device.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// `gpu` for hardware only, `software` for a driver on the CPU, `#2` for the second adapter, counted from the best
    /// in one backend, anything else for a part of the adapter's name in any case. `None` takes the environment
    /// variable `ISOPHOTE_ADAPTER`, and without one the best adapter there is: hardware before software.
    pub adapter: Option<String>,
    /// Ask for timestamps, where the adapter has them ([`Device::has_timestamps`]).
    pub timestamps: bool,
    /// Use of windows of neighbours in workgroup memory. `None` takes what is faster:
    /// yes on hardware; no on drivers that compute on the CPU, where textures are in its caches and
    /// workgroup memory is read lane by lane. The taps and their order are the same.
    pub shared_windows: Option<bool>,
}

/// GPU objects created, and submissions made, by this library on a device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Buffers.
    pub buffers: u64,
    /// Textures, each with its view.
    pub textures: u64,
    /// Bind groups.
    pub bind_groups: u64,
    /// Compute pipelines, each with its layout and shader module.
    pub pipelines: u64,
    /// Query sets.
    pub query_sets: u64,
    /// Calls of `Queue::submit`.
    pub submissions: u64,
    /// Calls of `Queue::write_buffer` for uniform blocks.
    pub uniform_writes: u64,
}

#[derive(Debug, Default)]
pub(super) struct Counters {
    pub buffers: AtomicU64,
    pub textures: AtomicU64,
    pub bind_groups: AtomicU64,
    pub pipelines: AtomicU64,
    pub query_sets: AtomicU64,
    pub submissions: AtomicU64,
    pub uniform_writes: AtomicU64,
}

pub(super) fn count(counter: &AtomicU64) {
    counter.fetch_add(1, Ordering::Relaxed);
}

/// State that the device's callbacks reported.
#[derive(Debug, Default)]
struct State {
    lost: Mutex<Option<String>>,
    errors: Mutex<Vec<String>>,
}

/// A graphics device and its queue. Any thread may use it; executors share it by `Arc`.
#[derive(Debug)]
pub struct Device {
    pub(super) raw: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    pub(super) counters: Counters,
    pipelines: Pipelines,
    sampler: OnceLock<wgpu::Sampler>,
    shared_windows: bool,
    info: wgpu::AdapterInfo,
    owned: bool,
    state: Arc<State>,
}

impl Device {
    /// Opens a device of the library's own.
    ///
    /// # Errors
    /// [`Error::NoDevice`] when there is no adapter, none as asked for, none that can compute, or too little memory
    /// for a driver.
    pub fn open(options: &Options) -> Result<Arc<Self>> {
        memory::must_have(DRIVER).map_err(|_| {
            let needed = DRIVER >> 20;
            Error::NoDevice(format!(
                "drivers take {needed} MiB of memory, more than there is; run on the CPU"
            ))
        })?;
        let from_environment = || std::env::var(ADAPTER_VARIABLE).ok().filter(|v| !v.is_empty());
        let wanted = options.adapter.clone().or_else(from_environment);
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
        if adapters.is_empty() {
            return Err(Error::NoDevice(
                "no graphics adapter was found: install a Vulkan driver (on Debian a software one is in the \
                 packages mesa-vulkan-drivers and libvulkan1), or run on the CPU"
                    .into(),
            ));
        }
        let found: Vec<String> = adapters.iter().map(|a| a.get_info().name).collect();
        adapters.sort_by_key(|a| rank(a.get_info().device_type));
        keep_wanted(&mut adapters, wanted.as_deref());
        if adapters.is_empty() {
            return Err(Error::NoDevice(format!(
                "no graphics adapter matches '{}'; there is {}",
                wanted.unwrap_or_default(),
                found.join(", ")
            )));
        }
        let mut reason = String::new();
        for adapter in &adapters {
            match Self::request(adapter, options) {
                Ok(device) => return Ok(Arc::new(device)),
                Err(e) => reason = format!("{}: {e}", adapter.get_info().name),
            }
        }
        Err(Error::NoDevice(format!("no graphics adapter can run compute shaders ({reason})")))
    }

    fn request(adapter: &wgpu::Adapter, options: &Options) -> std::result::Result<Self, String> {
        let capable =
            adapter.get_downlevel_capabilities().flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS);
        if !capable {
            return Err("it has no compute shaders".into());
        }
        let wanted =
            if options.timestamps { wgpu::Features::TIMESTAMP_QUERY } else { wgpu::Features::empty() };
        let most = adapter.limits();
        let required_limits = wgpu::Limits {
            max_buffer_size: most.max_buffer_size,
            ..wgpu::Limits::downlevel_defaults().using_resolution(most.clone()).using_alignment(most)
        };
        let request = adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("isophote"),
            required_features: adapter.features() & wanted,
            required_limits,
            ..Default::default()
        });
        let (raw, queue) = pollster::block_on(request).map_err(|e| one_line(&e.to_string()))?;
        let state = Arc::new(State::default());
        // Without a handler of ours wgpu panics on the first error.
        let errors = Arc::clone(&state);
        raw.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            errors.errors.lock().unwrap_or_else(PoisonError::into_inner).push(one_line(&error.to_string()));
        }));
        let lost = Arc::clone(&state);
        raw.set_device_lost_callback(move |reason, message| {
            let text = one_line(&format!("{reason:?}: {message}"));
            lost.lost.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(text);
        });
        let mut device = Self::with_state(raw, queue, true, state);
        device.shared_windows = options.shared_windows.unwrap_or(device.shared_windows);
        Ok(device)
    }

    /// Uses a device that the caller owns and goes on using.
    ///
    /// Its error and device-lost callbacks stay the caller's: creation of objects and what
    /// [`Executor::run_images`](super::Executor::run_images) submits is still checked here, but what
    /// fails in the caller's own submissions is reported to the caller.
    pub fn wrap(device: wgpu::Device, queue: wgpu::Queue) -> Arc<Self> {
        Arc::new(Self::with_state(device, queue, false, Arc::default()))
    }

    fn with_state(raw: wgpu::Device, queue: wgpu::Queue, owned: bool, state: Arc<State>) -> Self {
        let info = raw.adapter_info();
        Self {
            raw,
            queue,
            counters: Counters::default(),
            pipelines: Pipelines::default(),
            sampler: OnceLock::new(),
            shared_windows: info.device_type != wgpu::DeviceType::Cpu,
            info,
            owned,
            state,
        }
    }

    /// The wgpu device.
    pub fn raw(&self) -> &wgpu::Device {
        &self.raw
    }

    /// The wgpu queue.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// The adapter's name, as its driver gives it.
    pub fn name(&self) -> &str {
        &self.info.name
    }

    /// True for a driver that computes on the CPU.
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }

    /// True when kernels hold windows of neighbours in workgroup memory ([`Options::shared_windows`]).
    pub fn shares_windows(&self) -> bool {
        self.shared_windows
    }

    /// True when passes can be timed.
    pub fn has_timestamps(&self) -> bool {
        self.raw.features().contains(wgpu::Features::TIMESTAMP_QUERY)
    }

    /// Largest side of a texture, in texels.
    pub fn max_side(&self) -> u32 {
        self.raw.limits().max_texture_dimension_2d
    }

    /// Objects created and submissions made through this library so far.
    pub fn counts(&self) -> Counts {
        let get = |c: &AtomicU64| c.load(Ordering::Relaxed);
        let c = &self.counters;
        Counts {
            buffers: get(&c.buffers),
            textures: get(&c.textures),
            bind_groups: get(&c.bind_groups),
            pipelines: get(&c.pipelines),
            query_sets: get(&c.query_sets),
            submissions: get(&c.submissions),
            uniform_writes: get(&c.uniform_writes),
        }
    }

    /// Checks that the device still works, and that nothing went wrong on it since the last call.
    ///
    /// # Errors
    /// [`Error::Device`] with the first error that was not yet reported, or when the device is lost;
    /// a lost device must be opened anew, with everything made on it.
    pub fn check(&self) -> Result<()> {
        if let Some(reason) = &*self.state.lost.lock().unwrap_or_else(PoisonError::into_inner) {
            return Err(Error::Device(format!(
                "the graphics device '{}' was lost ({reason}): open a new one, or run on the CPU",
                self.info.name
            )));
        }
        let errors = std::mem::take(&mut *self.state.errors.lock().unwrap_or_else(PoisonError::into_inner));
        match errors.into_iter().next() {
            Some(error) => Err(Error::Device(format!("graphics device '{}': {error}", self.info.name))),
            None => Ok(()),
        }
    }

    /// Runs `make`, turning everything that the device reports about it into an error.
    pub(super) fn guarded<T>(&self, what: &str, make: impl FnOnce(&wgpu::Device) -> T) -> Result<T> {
        let scopes =
            [wgpu::ErrorFilter::Validation, wgpu::ErrorFilter::Internal, wgpu::ErrorFilter::OutOfMemory]
                .map(|filter| self.raw.push_error_scope(filter));
        let value = make(&self.raw);
        let mut first = None;
        // Scopes end in the reverse of the order in which they began.
        for scope in scopes.into_iter().rev() {
            first = first.or(pollster::block_on(scope.pop()));
        }
        self.check()?;
        match first {
            None => Ok(value),
            Some(wgpu::Error::OutOfMemory { .. }) => Err(Error::Memory(format!(
                "{what}: the graphics device '{}' is out of memory; use a smaller picture, smaller tiles or the CPU",
                self.info.name
            ))),
            Some(error) => Err(Error::Device(format!("{what}: {}", one_line(&error.to_string())))),
        }
    }

    /// The pipeline of `shader`, compiled at the first request.
    ///
    /// # Errors
    /// [`Error::Device`] with the compiler's words when the shader is refused.
    pub(super) fn pipeline(&self, shader: &Arc<Shader>) -> Result<Arc<Pipeline>> {
        self.pipelines.get(shader, || {
            let create = |raw: &wgpu::Device| pipeline::create(raw, shader, self.shared_windows);
            let made = self.guarded(&format!("kernel '{}'", shader.name), create)?;
            count(&self.counters.pipelines);
            Ok(made)
        })
    }

    /// The sampler of shaders that interpolate by one: linear, and clamped to the edge as all of wgpu's are by default.
    pub(super) fn sampler(&self) -> &wgpu::Sampler {
        self.sampler.get_or_init(|| {
            self.raw.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("isophote"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            })
        })
    }

    /// Waits until the submission is done; without one, until everything submitted is done.
    pub(super) fn wait(&self, submission: Option<wgpu::SubmissionIndex>) -> Result<()> {
        // Longer than a busy machine needs for any submission: wgpu 30 panics where a wait runs out at the moment at which
        // another thread's finds the queue empty (gfx-rs/wgpu#9958). The loss of a device ends a wait.
        let timeout = Some(Duration::from_secs(60));
        loop {
            self.check()?;
            let poll = wgpu::PollType::Wait { submission_index: submission.clone(), timeout };
            match self.poll(poll) {
                Some(Ok(_)) => return self.check(),
                Some(Err(wgpu::PollError::Timeout)) => {}
                // A submission that was never accepted cannot be waited for.
                Some(Err(wgpu::PollError::WrongSubmissionIndex(..))) | None => {
                    // The device-lost callback is called by a poll.
                    self.poll(wgpu::PollType::Poll);
                    self.check()?;
                    return Err(Error::Device(format!(
                        "the graphics device '{}' did not take the commands; it is lost: open a new one, or run \
                         on the CPU",
                        self.info.name
                    )));
                }
            }
        }
    }

    /// `None` when wgpu panicked, which it does when the device is lost during the wait; that must
    /// end here.
    fn poll(&self, poll: wgpu::PollType) -> Option<std::result::Result<wgpu::PollStatus, wgpu::PollError>> {
        catch_unwind(AssertUnwindSafe(|| self.raw.poll(poll))).ok()
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // Drivers dislike being unloaded while they compute. A failure can be reported to no one.
        if self.owned {
            let _ = self.wait(None);
        }
    }
}

/// Leaves the adapters that are wanted of all, which are in order.
fn keep_wanted(adapters: &mut Vec<wgpu::Adapter>, wanted: Option<&str>) {
    let Some(wanted) = wanted else { return };
    let number = wanted.strip_prefix('#').and_then(|number| number.parse::<usize>().ok());
    let Some(number) = number else {
        return adapters.retain(|adapter| is_wanted(&adapter.get_info(), wanted));
    };
    // Each backend lists the same cards.
    let backend = adapters.first().map(|adapter| adapter.get_info().backend);
    adapters.retain(|adapter| Some(adapter.get_info().backend) == backend);
    let chosen = number.checked_sub(1).filter(|index| *index < adapters.len());
    *adapters = chosen.map(|index| adapters.swap_remove(index)).into_iter().collect();
}

fn is_wanted(info: &wgpu::AdapterInfo, wanted: &str) -> bool {
    match wanted {
        "gpu" => info.device_type != wgpu::DeviceType::Cpu,
        "software" => info.device_type == wgpu::DeviceType::Cpu,
        name => info.name.to_lowercase().contains(&name.to_lowercase()),
    }
}

fn rank(device: wgpu::DeviceType) -> u32 {
    match device {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

/// A driver's or validator's message without its line breaks and runs of blanks.
pub(super) fn one_line(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    line.strip_prefix("Validation Error Caused by: ").map_or(line.clone(), str::to_owned)
}
