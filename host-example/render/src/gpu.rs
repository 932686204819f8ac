//! Opening the GPU: an adapter, a device with nothing but default limits, and a record of its errors, so that
//! they end in results and not in panics.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};

use isophote_files::error::{Error, Result};
use isophote_files::limits;

/// Advice for a machine without any adapter.
const NO_ADAPTER: &str = "install a graphics driver; a software one will do (on Debian: apt install mesa-vulkan-drivers libvulkan1)";

/// Bytes that a driver may take to be opened, of which those that compute on the CPU take most.
const DRIVER: u64 = 1 << 30;

/// A device with its queue and the errors it has reported.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The instance, which surfaces are made from.
    pub instance: wgpu::Instance,
    /// The adapter.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    faults: Arc<Mutex<Faults>>,
}

#[derive(Debug, Default)]
struct Faults {
    first: Option<String>,
    lost: Option<String>,
}

/// Message of wgpu about the kinds of drivers that it looked for, without those that this program was not made for.
fn reason(error: &wgpu::RequestAdapterError) -> String {
    let text = error.to_string();
    let said = text.split([';', ',']).map(str::trim).filter(|kind| !kind.contains("not compiled in"));
    let said: Vec<&str> = said.filter(|kind| *kind != "No suitable graphics adapter found").collect();
    if said.is_empty() { String::new() } else { format!(": {}", said.join(", ")) }
}

impl Gpu {
    /// Opens the best adapter there is, software drivers included; `WGPU_BACKEND` restricts the choice.
    ///
    /// # Errors
    /// [`Error::Failure`] without an adapter, with what to install, when its device cannot be opened, or without the
    /// memory that drivers take.
    pub fn open() -> Result<Self> {
        limits::must_have(DRIVER, "a graphics driver")?;
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        Self::with_instance(instance, None)
    }

    /// As [`Gpu::open`], on an adapter that can show its pictures on `surface`.
    ///
    /// # Errors
    /// As [`Gpu::open`].
    pub fn with_instance(instance: wgpu::Instance, surface: Option<&wgpu::Surface<'_>>) -> Result<Self> {
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: surface,
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&options)).map_err(|e| {
            Error::failure(format!("no graphics adapter was found{}", reason(&e)), NO_ADAPTER)
        })?;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("isophote"),
            // Only for measuring; everything works without.
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits: wgpu::Limits::default().or_worse_values_from(&adapter.limits()),
            ..Default::default()
        }))
        .map_err(|e| {
            let name = adapter.get_info().name;
            Error::failure(format!("the adapter '{name}' could not be opened: {e}"), NO_ADAPTER)
        })?;
        let faults = Arc::new(Mutex::new(Faults::default()));
        let record = Arc::clone(&faults);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            let mut faults = record.lock().unwrap_or_else(PoisonError::into_inner);
            faults.first.get_or_insert_with(|| error.to_string());
        }));
        let record = Arc::clone(&faults);
        // When the last clone is dropped this is called, too, and nobody is left to read it.
        device.set_device_lost_callback(move |_, message| {
            let message = if message.is_empty() { "its driver does not say why".into() } else { message };
            record.lock().unwrap_or_else(PoisonError::into_inner).lost = Some(message);
        });
        Ok(Self { instance, adapter, device, queue, faults })
    }

    /// True where the driver computes on the CPU.
    pub fn is_software(&self) -> bool {
        self.adapter.get_info().device_type == wgpu::DeviceType::Cpu
    }

    /// Error that the device has reported since the last call, if any, which is then forgotten. A lost device
    /// stays lost.
    ///
    /// # Errors
    /// [`Error::Failure`] with the first error reported.
    pub fn check(&self) -> Result<()> {
        let mut faults = self.faults.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(message) = &faults.lost {
            return Err(Error::failure(
                format!("the graphics device was lost: {message}"),
                "start again; use a smaller picture if it is lost again",
            ));
        }
        match faults.first.take() {
            Some(message) => Err(Error::failure(
                format!("the graphics device reported an error: {message}"),
                "use a smaller picture or update the graphics driver",
            )),
            None => Ok(()),
        }
    }

    /// Lets the device tell what has become of it: that it is gone is only told to those who ask.
    ///
    /// # Errors
    /// As [`Gpu::wait`].
    pub fn poll(&self) -> Result<()> {
        self.ask(wgpu::PollType::Poll)
    }

    /// Waits until everything submitted is done.
    ///
    /// # Errors
    /// [`Error::Failure`] when the device is lost or has reported an error.
    pub fn wait(&self) -> Result<()> {
        self.ask(wgpu::PollType::Wait { submission_index: None, timeout: None })
    }

    fn ask(&self, how: wgpu::PollType) -> Result<()> {
        // wgpu panics where a device is lost while it is waited for. It has noted the loss before.
        let answer = catch_unwind(AssertUnwindSafe(|| self.device.poll(how)));
        self.check()?;
        let problem = match answer {
            Ok(Ok(_)) => return Ok(()),
            Ok(Err(e)) => e.to_string(),
            Err(_) => "it does not answer".to_owned(),
        };
        Err(Error::failure(format!("waiting for the graphics device failed: {problem}"), "start again"))
    }
}
