//! Vulkan functions between the library and the driver: counted, and made to fail. Each thread has faults of its own.

use ash::vk;
use isophote_abi::IsophoteVulkanLoader;
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::ffi::{CStr, c_char, c_void};
use std::mem::transmute;

/// A function of any type.
type Plain = unsafe extern "system" fn();

thread_local! {
    static LOADER: Cell<Option<vk::PFN_vkGetInstanceProcAddr>> = const { Cell::new(None) };
    static DEVICE_LOADER: Cell<Option<vk::PFN_vkGetDeviceProcAddr>> = const { Cell::new(None) };
    static REAL: RefCell<BTreeMap<&'static str, Plain>> = const { RefCell::new(BTreeMap::new()) };
    static MISSING: Cell<&'static str> = const { Cell::new("") };
    static MADE: Cell<u32> = const { Cell::new(0) };
    static MAKING_FAILS_AFTER: Cell<Option<u32>> = const { Cell::new(None) };
    static IS_LOST: Cell<bool> = const { Cell::new(false) };
    static SUBMISSIONS: Cell<u32> = const { Cell::new(0) };
    static CACHE: Cell<u64> = const { Cell::new(0) };
}

/// Vulkan objects that the library has made through this thread.
pub fn made() -> u32 {
    MADE.get()
}

/// Submissions that the library has made through this thread.
pub fn submissions() -> u32 {
    SUBMISSIONS.get()
}

/// The pipeline cache that the library gave last.
pub fn cache() -> u64 {
    CACHE.get()
}

/// Lets one object be refused for want of memory, after so many that are made.
pub fn refuse_after(count: Option<u32>) {
    MAKING_FAILS_AFTER.set(count);
}

/// Sets whether the device is lost from now on.
pub fn lose(is_lost: bool) {
    IS_LOST.set(is_lost);
}

/// Lets a function be unknown from now on; none by an empty name.
pub fn hide(name: &'static str) {
    MISSING.set(name);
}

/// The driver's loader, with faults.
pub fn loader(real: vk::PFN_vkGetInstanceProcAddr) -> IsophoteVulkanLoader {
    LOADER.set(Some(real));
    Some(instance_function)
}

/// Result that the next object comes to.
fn next() -> Option<vk::Result> {
    match MAKING_FAILS_AFTER.get() {
        Some(0) => {
            MAKING_FAILS_AFTER.set(None);
            return Some(vk::Result::ERROR_OUT_OF_DEVICE_MEMORY);
        }
        Some(n) => MAKING_FAILS_AFTER.set(Some(n - 1)),
        None => {}
    }
    MADE.set(MADE.get() + 1);
    None
}

fn real(name: &str) -> Plain {
    REAL.with_borrow(|known| known[name])
}

unsafe extern "system" fn instance_function(instance: *mut c_void, name: *const c_char) -> Option<Plain> {
    // SAFETY: the library hands over names with a closing zero, and the instance that the test gave it.
    let (text, function) = unsafe {
        let real = LOADER.get()?;
        (CStr::from_ptr(name).to_str().ok()?, real(vk::Handle::from_raw(instance as u64), name)?)
    };
    if text == MISSING.get() {
        return None;
    }
    if text == "vkGetDeviceProcAddr" {
        // SAFETY: the function of this name has this type.
        unsafe {
            DEVICE_LOADER.set(Some(transmute::<Plain, vk::PFN_vkGetDeviceProcAddr>(function)));
            return Some(transmute::<vk::PFN_vkGetDeviceProcAddr, Plain>(device_function));
        }
    }
    Some(function)
}

unsafe extern "system" fn device_function(device: vk::Device, name: *const c_char) -> Option<Plain> {
    // SAFETY: as above.
    let (text, function) = unsafe {
        let real = DEVICE_LOADER.get()?;
        (CStr::from_ptr(name).to_str().ok()?, real(device, name)?)
    };
    if text == MISSING.get() {
        return None;
    }
    let Some((name, replacement)) = REPLACED.iter().find(|(name, _)| *name == text) else {
        return Some(function);
    };
    REAL.with_borrow_mut(|known| known.insert(name, function));
    Some(replacement.0)
}

/// One that takes the place of the driver's.
struct Function(Plain);

/// Functions that make an object, with the types of their arguments.
macro_rules! makers {
    ($($name:literal $function:ident($($argument:ident: $type:ty),*))*) => {
        $(unsafe extern "system" fn $function($($argument: $type),*) -> vk::Result {
            if let Some(refused) = next() {
                return refused;
            }
            // SAFETY: the driver's function of this name has this type, and gets what the library gave.
            unsafe {
                let real = transmute::<Plain, unsafe extern "system" fn($($type),*) -> vk::Result>(real($name));
                real($($argument),*)
            }
        })*

        const REPLACED: [(&str, Function); 15] = [
            // SAFETY: they are called with their own types by who asked for them by name.
            $(($name, Function(unsafe {
                transmute::<unsafe extern "system" fn($($type),*) -> vk::Result, Plain>($function)
            })),)*
            // SAFETY: as above.
            ("vkCreateComputePipelines", Function(unsafe {
                transmute::<vk::PFN_vkCreateComputePipelines, Plain>(create_pipelines)
            })),
            // SAFETY: as above.
            ("vkQueueSubmit", Function(unsafe { transmute::<vk::PFN_vkQueueSubmit, Plain>(queue_submit) })),
            // SAFETY: as above.
            ("vkGetSemaphoreCounterValue", Function(unsafe {
                transmute::<vk::PFN_vkGetSemaphoreCounterValue, Plain>(counter)
            })),
        ];
    };
}

type Any = *const c_void;

makers! {
    "vkAllocateMemory" allocate_memory(device: vk::Device, info: Any, with: Any, made: *mut u64)
    "vkCreateBuffer" create_buffer(device: vk::Device, info: Any, with: Any, made: *mut u64)
    "vkCreateImage" create_image(device: vk::Device, info: Any, with: Any, made: *mut u64)
    "vkCreateImageView" create_image_view(device: vk::Device, info: Any, with: Any, made: *mut u64)
    "vkCreateDescriptorSetLayout" create_set_layout(device: vk::Device, info: Any, with: Any, made: *mut u64)
    "vkCreatePipelineLayout" create_pipeline_layout(device: vk::Device, info: Any, with: Any, made: *mut u64)
    "vkCreateShaderModule" create_shader_module(device: vk::Device, info: Any, with: Any, made: *mut u64)
    "vkCreateSampler" create_sampler(device: vk::Device, info: Any, with: Any, made: *mut u64)
    "vkCreateDescriptorPool" create_descriptor_pool(device: vk::Device, info: Any, with: Any, made: *mut u64)
    "vkCreateCommandPool" create_command_pool(device: vk::Device, info: Any, with: Any, made: *mut u64)
    "vkAllocateDescriptorSets" allocate_sets(device: vk::Device, info: Any, made: *mut u64)
    "vkAllocateCommandBuffers" allocate_commands(device: vk::Device, info: Any, made: *mut u64)
}

unsafe extern "system" fn create_pipelines(
    device: vk::Device,
    cache: vk::PipelineCache,
    count: u32,
    infos: *const vk::ComputePipelineCreateInfo<'_>,
    with: *const vk::AllocationCallbacks<'_>,
    made: *mut vk::Pipeline,
) -> vk::Result {
    if let Some(refused) = next() {
        return refused;
    }
    CACHE.set(vk::Handle::as_raw(cache));
    // SAFETY: the driver's function of this name has this type, and gets what the library gave.
    unsafe {
        let real = transmute::<Plain, vk::PFN_vkCreateComputePipelines>(real("vkCreateComputePipelines"));
        real(device, cache, count, infos, with, made)
    }
}

unsafe extern "system" fn queue_submit(
    queue: vk::Queue,
    count: u32,
    submits: *const vk::SubmitInfo<'_>,
    fence: vk::Fence,
) -> vk::Result {
    if IS_LOST.get() {
        return vk::Result::ERROR_DEVICE_LOST;
    }
    SUBMISSIONS.set(SUBMISSIONS.get() + 1);
    // SAFETY: the driver's function of this name has this type, and gets what the library gave.
    unsafe { transmute::<Plain, vk::PFN_vkQueueSubmit>(real("vkQueueSubmit"))(queue, count, submits, fence) }
}

unsafe extern "system" fn counter(
    device: vk::Device,
    semaphore: vk::Semaphore,
    value: *mut u64,
) -> vk::Result {
    if IS_LOST.get() {
        return vk::Result::ERROR_DEVICE_LOST;
    }
    // SAFETY: as above.
    unsafe {
        let real = real("vkGetSemaphoreCounterValue");
        transmute::<Plain, vk::PFN_vkGetSemaphoreCounterValue>(real)(device, semaphore, value)
    }
}
