//! A host's Vulkan device: its functions, what it must have, and how far it has come.

use crate::abi::args;
use crate::abi::failure::{Failure, Outcome};
use crate::abi::threads::User;
use ash::vk::{self, Handle};
use isophote::engine::program::Format;
use isophote_abi::*;
use std::collections::BTreeSet;
use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr::null;

/// Features that every device needs, as bits and as hosts know them.
const FEATURES: [(u32, &str); 2] = [
    (ISOPHOTE_VULKAN_STORAGE_IMAGE_EXTENDED_FORMATS, "shaderStorageImageExtendedFormats"),
    (ISOPHOTE_VULKAN_TIMELINE_SEMAPHORE, "timelineSemaphore"),
];

/// Before Vulkan 1.2 timelines are an extension.
const TIMELINES: &CStr = c"VK_KHR_timeline_semaphore";

/// The extensions that a device of a version needs.
struct Names([*const c_char; 1]);

// SAFETY: the names are constant.
unsafe impl Sync for Names {}

static NAMES: Names = Names([TIMELINES.as_ptr()]);

/// Functions that are called here; a driver of Vulkan 1.1 has them all.
const FUNCTIONS: [&CStr; 44] = [
    c"vkAllocateCommandBuffers",
    c"vkAllocateDescriptorSets",
    c"vkAllocateMemory",
    c"vkBeginCommandBuffer",
    c"vkBindBufferMemory",
    c"vkBindImageMemory",
    c"vkCmdBindDescriptorSets",
    c"vkCmdBindPipeline",
    c"vkCmdBlitImage",
    c"vkCmdDispatch",
    c"vkCmdPipelineBarrier",
    c"vkCmdUpdateBuffer",
    c"vkCreateBuffer",
    c"vkCreateCommandPool",
    c"vkCreateComputePipelines",
    c"vkCreateDescriptorPool",
    c"vkCreateDescriptorSetLayout",
    c"vkCreateImage",
    c"vkCreateImageView",
    c"vkCreatePipelineLayout",
    c"vkCreateSampler",
    c"vkCreateShaderModule",
    c"vkDestroyBuffer",
    c"vkDestroyCommandPool",
    c"vkDestroyDescriptorPool",
    c"vkDestroyDescriptorSetLayout",
    c"vkDestroyImage",
    c"vkDestroyImageView",
    c"vkDestroyPipeline",
    c"vkDestroyPipelineLayout",
    c"vkDestroySampler",
    c"vkDestroyShaderModule",
    c"vkEndCommandBuffer",
    c"vkFreeMemory",
    c"vkGetBufferMemoryRequirements",
    c"vkGetDeviceProcAddr",
    c"vkGetImageMemoryRequirements",
    c"vkGetPhysicalDeviceFormatProperties",
    c"vkGetPhysicalDeviceMemoryProperties",
    c"vkGetPhysicalDeviceProperties",
    c"vkGetPhysicalDeviceQueueFamilyProperties",
    c"vkGetSemaphoreCounterValue",
    c"vkQueueSubmit",
    c"vkUpdateDescriptorSets",
];

/// Needs of a device that is used with `api_version`, for its creation.
///
/// # Errors
/// Unsupported before Vulkan 1.1.
pub fn needs(api_version: u32) -> Outcome<IsophoteVulkanNeeds> {
    if api_version < vk::API_VERSION_1_1 {
        return Err(Failure::new(
            ISOPHOTE_ERROR_UNSUPPORTED,
            format!(
                "Vulkan {}.{} is too old; create instance and device for 1.1 or later",
                vk::api_version_major(api_version),
                vk::api_version_minor(api_version)
            ),
        ));
    }
    let extension_count = u32::from(api_version < vk::API_VERSION_1_2);
    let features = FEATURES.iter().fold(0, |all, (bit, _)| all | bit);
    Ok(IsophoteVulkanNeeds { features, extension_count, extensions: NAMES.0.as_ptr() })
}

/// A format of a program in the words of Vulkan.
pub const fn format_of(format: Format) -> vk::Format {
    match format {
        Format::R32 => vk::Format::R32_SFLOAT,
        Format::Rg32 => vk::Format::R32G32_SFLOAT,
        Format::Rgba32 => vk::Format::R32G32B32A32_SFLOAT,
        Format::Rgba16 => vk::Format::R16G16B16A16_SFLOAT,
    }
}

/// Failure that a result of Vulkan other than success comes to.
pub fn refused(answer: vk::Result, what: &str) -> Failure {
    match answer {
        vk::Result::ERROR_OUT_OF_HOST_MEMORY
        | vk::Result::ERROR_OUT_OF_DEVICE_MEMORY
        | vk::Result::ERROR_FRAGMENTATION => Failure::new(
            ISOPHOTE_ERROR_OUT_OF_MEMORY,
            format!("{what}: the graphics device is out of memory; use a smaller picture"),
        ),
        vk::Result::ERROR_DEVICE_LOST => Failure::new(
            ISOPHOTE_ERROR_DEVICE,
            format!(
                "{what}: the graphics device is lost; destroy what was made on it, and make it on another"
            ),
        ),
        other => Failure::new(ISOPHOTE_ERROR_DEVICE, format!("{what}: Vulkan answers {other:?}")),
    }
}

/// Fails for a host that gives too little, with the names of what is missing.
///
/// # Safety
/// The names of extensions must be text with a closing zero.
unsafe fn check_host(host: &IsophoteVulkanHost) -> Outcome<()> {
    let handles =
        [(host.instance, "instance"), (host.physical_device, "physical device"), (host.device, "device")];
    let null = handles.iter().find(|(handle, _)| handle.is_null()).map(|(_, what)| *what);
    if let Some(what) = null.or((host.timeline == 0).then_some("timeline")) {
        return Err(Failure::argument(format!("the {what} is null")));
    }
    let needs = needs(host.api_version)?;
    let mut missing: Vec<String> = Vec::new();
    for (bit, name) in FEATURES {
        if host.features & bit == 0 {
            missing.push(format!("the feature {name}"));
        }
    }
    // SAFETY: as the caller promised.
    if needs.extension_count > 0 && !unsafe { has_extension(host, TIMELINES)? } {
        missing.push(format!("the extension {}", TIMELINES.to_string_lossy()));
    }
    if missing.is_empty() {
        return Ok(());
    }
    let missing = missing.join(" and ");
    let message = format!("the device was created without {missing}; enable what `needs` names");
    Err(Failure::new(ISOPHOTE_ERROR_UNSUPPORTED, message))
}

/// # Safety
/// As [`check_host`].
unsafe fn has_extension(host: &IsophoteVulkanHost, wanted: &CStr) -> Outcome<bool> {
    for index in 0..host.extension_count as usize {
        // SAFETY: as the caller promised.
        let name = unsafe {
            let name = args::get(host.extensions.wrapping_add(index), "the list of extensions")?;
            args::text(name, "the name of an extension")?
        };
        if name.as_bytes() == wanted.to_bytes() {
            return Ok(true);
        }
    }
    Ok(false)
}

/// A function as ash takes it; those that are not found are noted.
fn found(function: vk::PFN_vkVoidFunction, name: &CStr, missing: &mut BTreeSet<CString>) -> *const c_void {
    match function {
        Some(function) => function as *const c_void,
        None => {
            missing.insert(name.to_owned());
            null()
        }
    }
}

/// The functions of the host's instance and device.
///
/// # Safety
/// As [`Device::new`].
unsafe fn functions(host: &IsophoteVulkanHost) -> Outcome<(ash::Instance, ash::Device)> {
    let Some(loader) = host.get_instance_proc_addr else {
        return Err(Failure::argument("get_instance_proc_addr is null"));
    };
    let mut missing = BTreeSet::new();
    // SAFETY: the caller promised the loader's function and the instance; names end with a zero.
    let instance = unsafe {
        let load = |name: &CStr| found(loader(host.instance, name.as_ptr()), name, &mut missing);
        ash::Instance::load_with(load, vk::Instance::from_raw(host.instance as u64))
    };
    if missing.contains(c"vkGetDeviceProcAddr") {
        return Err(Failure::argument("get_instance_proc_addr finds no vkGetDeviceProcAddr"));
    }
    let device = vk::Device::from_raw(host.device as u64);
    let get = instance.fp_v1_0().get_device_proc_addr;
    // SAFETY: as above, of the device.
    let raw = unsafe {
        let load = |name: &CStr| {
            let is_extension =
                host.api_version < vk::API_VERSION_1_2 && name == c"vkGetSemaphoreCounterValue";
            let symbol = if is_extension { c"vkGetSemaphoreCounterValueKHR" } else { name };
            found(get(device, symbol.as_ptr()), name, &mut missing)
        };
        ash::Device::load_with(load, device)
    };
    if let Some(name) = FUNCTIONS.iter().find(|name| missing.contains(**name)) {
        let name = name.to_string_lossy();
        return Err(Failure::argument(format!("get_instance_proc_addr finds no {name}")));
    }
    Ok((instance, raw))
}

/// A device of a host's, which owns it.
pub struct Device {
    /// Its functions.
    pub raw: ash::Device,
    /// Limits, name and kind.
    pub properties: vk::PhysicalDeviceProperties,
    /// Family of the queues that commands are executed on.
    pub family: u32,
    /// The host's pipeline cache, or null.
    pub cache: vk::PipelineCache,
    instance: ash::Instance,
    physical: vk::PhysicalDevice,
    memory: vk::PhysicalDeviceMemoryProperties,
    has_graphics: bool,
    timeline: vk::Semaphore,
    queue: vk::Queue,
    user: User,
    lock: Option<unsafe extern "C" fn(*mut c_void)>,
    unlock: Option<unsafe extern "C" fn(*mut c_void)>,
}

impl Device {
    /// The device behind a host's handles.
    ///
    /// # Errors
    /// Invalid argument for a handle or function that is missing; unsupported for what the device lacks.
    ///
    /// # Safety
    /// The handles must be of living objects, and the names text with a closing zero.
    pub unsafe fn new(host: &IsophoteVulkanHost) -> Outcome<Self> {
        // SAFETY: as the caller promised.
        let (instance, raw) = unsafe {
            check_host(host)?;
            functions(host)?
        };
        let physical = vk::PhysicalDevice::from_raw(host.physical_device as u64);
        // SAFETY: the caller promised the physical device.
        let (properties, memory, families) = unsafe {
            (
                instance.get_physical_device_properties(physical),
                instance.get_physical_device_memory_properties(physical),
                instance.get_physical_device_queue_family_properties(physical),
            )
        };
        let flags =
            families.get(host.queue_family as usize).map_or(vk::QueueFlags::empty(), |f| f.queue_flags);
        let device = Self {
            raw,
            properties,
            family: host.queue_family,
            cache: vk::PipelineCache::from_raw(host.pipeline_cache),
            instance,
            physical,
            memory,
            has_graphics: flags.contains(vk::QueueFlags::GRAPHICS),
            timeline: vk::Semaphore::from_raw(host.timeline),
            queue: vk::Queue::from_raw(host.queue as u64),
            user: User(host.user),
            lock: host.lock_queue,
            unlock: host.unlock_queue,
        };
        device.check(flags)?;
        Ok(device)
    }

    /// Fails where the hardware lacks something.
    fn check(&self, flags: vk::QueueFlags) -> Outcome<()> {
        let lacks = |what: String| {
            let message = format!("the graphics device '{}' {what}", self.name());
            Err(Failure::new(ISOPHOTE_ERROR_UNSUPPORTED, message))
        };
        if !flags.contains(vk::QueueFlags::COMPUTE) {
            return lacks(format!("has no compute in its queue family {}", self.family));
        }
        let wanted = vk::FormatFeatureFlags::SAMPLED_IMAGE | vk::FormatFeatureFlags::STORAGE_IMAGE;
        for format in [Format::R32, Format::Rg32, Format::Rgba32, Format::Rgba16].map(format_of) {
            if !self.format_features(format).contains(wanted) {
                return lacks(format!("cannot read and write images of {format:?} in shaders"));
            }
        }
        Ok(())
    }

    /// The device's name, as its driver gives it.
    pub fn name(&self) -> String {
        self.properties.device_name_as_c_str().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// True for a driver that computes on the CPU.
    pub fn is_software(&self) -> bool {
        self.properties.device_type == vk::PhysicalDeviceType::CPU
    }

    /// Features that images of a format can be used for.
    pub fn format_features(&self, format: vk::Format) -> vk::FormatFeatureFlags {
        // SAFETY: the host keeps the instance as long as the object that this belongs to.
        unsafe { self.instance.get_physical_device_format_properties(self.physical, format) }
            .optimal_tiling_features
    }

    /// Fails where images of a format cannot be interpolated.
    ///
    /// # Errors
    /// Unsupported, naming the image.
    pub fn must_filter(&self, format: vk::Format, image: &str) -> Outcome<()> {
        if self.format_features(format).contains(vk::FormatFeatureFlags::SAMPLED_IMAGE_FILTER_LINEAR) {
            return Ok(());
        }
        Err(Failure::new(
            ISOPHOTE_ERROR_UNSUPPORTED,
            format!(
                "the image '{image}' has the format {format:?}, which the graphics device '{}' does not filter; give another \
                 one, such as VK_FORMAT_R16G16B16A16_SFLOAT, or set ISOPHOTE_PRECISION_HALF",
                self.name()
            ),
        ))
    }

    /// True where results can be blitted to images of a format.
    pub fn can_blit(&self, from: vk::Format, to: vk::Format) -> bool {
        self.has_graphics
            && self.format_features(from).contains(vk::FormatFeatureFlags::BLIT_SRC)
            && self.format_features(to).contains(vk::FormatFeatureFlags::BLIT_DST)
    }

    /// A type of memory that the device can use for what `bits` allow; its own where there is a choice.
    pub fn memory_type(&self, bits: u32) -> Option<u32> {
        use vk::MemoryPropertyFlags as Flags;
        let types = self.memory.memory_types_as_slice().iter().map(|kind| kind.property_flags);
        // These are for other things.
        let others = Flags::PROTECTED | Flags::LAZILY_ALLOCATED | Flags::DEVICE_COHERENT_AMD;
        let is_plain = |flags: Flags| !flags.intersects(others);
        let allowed = (0..).zip(types).filter(|(index, flags)| bits >> index & 1 == 1 && is_plain(*flags));
        // The first of equal ones, as drivers list them from the best on.
        allowed.min_by_key(|(_, flags)| !flags.contains(Flags::DEVICE_LOCAL)).map(|(index, _)| index)
    }

    /// The value that the timeline has.
    ///
    /// # Errors
    /// Device, when it is lost.
    pub fn reached(&self) -> Outcome<u64> {
        // SAFETY: the host keeps device and semaphore as long as the object that this belongs to.
        unsafe { self.raw.get_semaphore_counter_value(self.timeline) }
            .map_err(|e| refused(e, "reading the timeline"))
    }

    /// Submits to the host's queue, between its two functions, and sets the timeline to `value`.
    ///
    /// # Errors
    /// Unsupported without a queue; what Vulkan answers.
    pub fn submit(
        &self,
        commands: vk::CommandBuffer,
        waits: &[IsophoteVulkanSemaphore],
        signals: &[IsophoteVulkanSemaphore],
        value: u64,
    ) -> Outcome<()> {
        let semaphores = |list: &[IsophoteVulkanSemaphore]| -> (Vec<vk::Semaphore>, Vec<u64>) {
            list.iter().map(|s| (vk::Semaphore::from_raw(s.semaphore), s.value)).unzip()
        };
        let (waits, wait_values) = semaphores(waits);
        let (mut signals, mut signal_values) = semaphores(signals);
        signals.push(self.timeline);
        signal_values.push(value);
        let stages = vec![vk::PipelineStageFlags::ALL_COMMANDS; waits.len()];
        let mut timelines = vk::TimelineSemaphoreSubmitInfo::default()
            .wait_semaphore_values(&wait_values)
            .signal_semaphore_values(&signal_values);
        let commands = [commands];
        let info = vk::SubmitInfo::default()
            .command_buffers(&commands)
            .wait_semaphores(&waits)
            .wait_dst_stage_mask(&stages)
            .signal_semaphores(&signals)
            .push_next(&mut timelines);
        // SAFETY: the host promised the functions, and keeps queue and semaphores.
        let result = unsafe {
            if let Some(lock) = self.lock {
                lock(self.user.0);
            }
            let result = self.raw.queue_submit(self.queue, &[info], vk::Fence::null());
            if let Some(unlock) = self.unlock {
                unlock(self.user.0);
            }
            result
        };
        result.map_err(|e| refused(e, "submitting"))
    }

    /// Fails for a host that gave no queue.
    pub fn must_have_queue(&self) -> Outcome<()> {
        if self.queue.is_null() {
            return Err(Failure::argument(
                "the Vulkan object was made without a queue; give it one, or record",
            ));
        }
        Ok(())
    }
}
