//! The extension "isophote.vulkan/1" for Vulkan devices of the host's own: filters are recorded there, from and to its images.

use super::constants::*;
use super::types::*;
use core::ffi::{c_char, c_void};

/// Bit of features: `shaderStorageImageExtendedFormats` of `VkPhysicalDeviceFeatures`, for images of two floats.
pub const ISOPHOTE_VULKAN_STORAGE_IMAGE_EXTENDED_FORMATS: u32 = 1;
/// Bit of features: `timelineSemaphore` of `VkPhysicalDeviceVulkan12Features` or of the extension's own struct.
pub const ISOPHOTE_VULKAN_TIMELINE_SEMAPHORE: u32 = 2;

/// Recordings of one effect that may wait to be executed at once.
pub const ISOPHOTE_VULKAN_MOST_IN_FLIGHT: u32 = 64;

/// A Vulkan device of the host's, with the shaders compiled for it. Its number is never 0.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IsophoteVulkan {
    /// The handle.
    pub id: u64,
}

/// A graph made ready for pictures of one size on a Vulkan device of the host's. Its number is never 0.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IsophoteVulkanEffect {
    /// The handle.
    pub id: u64,
}

/// Features and extensions that a device must be created with.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteVulkanNeeds {
    /// Features to enable, a sum of `ISOPHOTE_VULKAN_...` bits.
    pub features: u32,
    /// Number of device extensions to enable.
    pub extension_count: u32,
    /// Their names.
    pub extensions: *const *const c_char,
}

/// A function of Vulkan, to be cast to its own type.
pub type IsophoteVulkanFunction = Option<unsafe extern "system" fn()>;

/// `vkGetInstanceProcAddr`, with the instance as a plain pointer.
pub type IsophoteVulkanLoader =
    Option<unsafe extern "system" fn(instance: *mut c_void, name: *const c_char) -> IsophoteVulkanFunction>;

/// A Vulkan device of the host's, which outlives the object made on it, as all does that is named here. Handles are cast to
/// plain pointers and numbers, so that this header needs no other.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteVulkanHost {
    /// Finds all functions of Vulkan.
    pub get_instance_proc_addr: IsophoteVulkanLoader,
    /// `VkInstance`.
    pub instance: *mut c_void,
    /// `VkPhysicalDevice`.
    pub physical_device: *mut c_void,
    /// `VkDevice`.
    pub device: *mut c_void,
    /// `VkQueue` for `submit`, of the family `queue_family`; null for a host that only records.
    pub queue: *mut c_void,
    /// The version that instance and device are used with, such as `VK_API_VERSION_1_2`: at least 1.1.
    pub api_version: u32,
    /// Family of the queues that all commands are executed on; it has compute.
    pub queue_family: u32,
    /// Features that the device was created with, a sum of `ISOPHOTE_VULKAN_...` bits.
    pub features: u32,
    /// Number of device extensions that it was created with.
    pub extension_count: u32,
    /// Their names; may be null when there are none.
    pub extensions: *const *const c_char,
    /// `VkSemaphore` of the timeline type, by which the library knows without waiting what has been executed.
    pub timeline: u64,
    /// `VkPipelineCache` of the host's, which shaders are compiled with; 0 for none. Vulkan itself guards it, or the host
    /// makes no effects while it uses it elsewhere.
    pub pipeline_cache: u64,
    /// Handed to both functions.
    pub user: *mut c_void,
    /// Called by `submit`, on its thread, before it touches the queue: the host's lock of it. May be null where no other
    /// thread uses the queue meanwhile. Must not call functions of this extension.
    pub lock_queue: Option<unsafe extern "C" fn(user: *mut c_void)>,
    /// Called when the queue was touched.
    pub unlock_queue: Option<unsafe extern "C" fn(user: *mut c_void)>,
}

/// An image of the host's and a view of it, which outlive the execution of what they are recorded in. Filters read and write
/// them where they are.
///
/// Inputs were created with `VK_IMAGE_USAGE_SAMPLED_BIT`, and their views have a format that is read as floats. `normal`,
/// `flow` and `rest_position` need four channels, `color` three or four, `motion` and `motion_forward` two; the others one.
/// `normal` needs signed or floating samples, and `depth`, `object_id`, `rest_position` and motions floating ones. Views of an
/// sRGB format give linear light, which the request's `space` must say. NaN and infinities are not replaced.
///
/// The output is written by the last filter itself where its view has the format `VK_FORMAT_R32G32B32A32_SFLOAT` (for
/// graphs that give one channel, `VK_FORMAT_R32_SFLOAT`; for colours in less than exact precision,
/// `VK_FORMAT_R16G16B16A16_SFLOAT`) and the image was created with `VK_IMAGE_USAGE_STORAGE_BIT` and
/// `VK_IMAGE_USAGE_SAMPLED_BIT`. Any other colour format needs `VK_IMAGE_USAGE_TRANSFER_DST_BIT`: the result is then blitted
/// there, converted as blits convert, which needs a queue family with graphics.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteVulkanImage {
    /// An input of the graph, such as `color`, or `output`. Inputs that the graph does not read are ignored.
    pub name: *const c_char,
    /// `VkImage`, of two dimensions and one sample.
    pub image: u64,
    /// `VkImageView` of one level and layer of the colour aspect, of the type 2D, without swizzling; 0 for an output that
    /// is blitted to.
    pub view: u64,
    /// `VkFormat` of the view, or of the image that is blitted to.
    pub format: u32,
    /// `VkImageUsageFlags` that the image was created with.
    pub usage: u32,
    /// Columns of the level: at least those of the picture, whose pixel (0, 0) is texel (0, 0).
    pub width: u32,
    /// Rows of the view, likewise.
    pub height: u32,
    /// Level that the view shows.
    pub level: u32,
    /// Layer that the view shows.
    pub layer: u32,
    /// `VkImageLayout` of the level and layer before: of an input anything but undefined; best
    /// `VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL`, or `VK_IMAGE_LAYOUT_GENERAL`, which take no transition.
    pub layout_before: u32,
    /// `VkImageLayout` that they are left in.
    pub layout_after: u32,
}

/// A semaphore that a submission waits for or signals.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteVulkanSemaphore {
    /// `VkSemaphore`.
    pub semaphore: u64,
    /// Value of a timeline; ignored of binary ones.
    pub value: u64,
}

/// The functions of the extension "isophote.vulkan/1", which is there on all systems but Apple's. Tags and ownership are
/// those of `IsophoteApi`.
///
/// The library never waits for the GPU, and never touches a queue but in `submit`, between the host's two functions. What
/// commands use (images for intermediate results, uniforms, bindings) is kept until the timeline has the value that the
/// host gave with them. An effect has one set of intermediate images: its recordings are executed one after another, in the
/// order of a queue or behind semaphores, and any number of them, up to `ISOPHOTE_VULKAN_MOST_IN_FLIGHT`, may be in flight.
/// Frames after the first few make no Vulkan objects and take no memory of the device. All effects of an object share its
/// timeline; a host with several queues makes an object for each.
///
/// After `ISOPHOTE_ERROR_DEVICE` that says that the device is lost, destroy effects and object, and make them on another.
/// After any other error go on: nothing was recorded or submitted.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteVulkanApi {
    /// Size of this table in bytes.
    pub struct_size: u32,

    /// [any-thread] What a device that is used with `api_version` (at least 1.1) must be created with. What is handed out
    /// lives as long as the process. The queue family needs compute, and graphics where outputs are blitted.
    pub needs: unsafe extern "C" fn(
        api_version: u32,
        error: *mut IsophoteText,
        needs: *mut IsophoteVulkanNeeds,
    ) -> IsophoteStatus,

    /// [any-thread] Makes an object on a device of the host's. The message of a failure names what the device lacks.
    /// The caller owns it, and destroys it before the device.
    pub create: unsafe extern "C" fn(
        host: *const IsophoteVulkanHost,
        error: *mut IsophoteText,
        vulkan: *mut IsophoteVulkan,
    ) -> IsophoteStatus,
    /// [any-thread] Destroys an object and all that its effects hold; their handles can then only be destroyed. All
    /// recordings have been executed, or will never be, as for `vkDestroyDevice`.
    pub destroy: unsafe extern "C" fn(vulkan: IsophoteVulkan) -> IsophoteStatus,

    /// [any-thread, needs-output] Makes a graph ready for the size, spaces and guides of a request. Compiles shaders that the
    /// object has not yet compiled, which takes milliseconds to seconds; other threads may record meanwhile. The caller
    /// owns it and destroys it. The graph may be destroyed.
    pub effect_create: unsafe extern "C" fn(
        vulkan: IsophoteVulkan,
        graph: IsophoteGraph,
        request: *const IsophoteRequest,
        error: *mut IsophoteText,
        effect: *mut IsophoteVulkanEffect,
    ) -> IsophoteStatus,
    /// [any-thread] Destroys an effect. What its recordings use is kept until they have been executed.
    pub effect_destroy: unsafe extern "C" fn(effect: IsophoteVulkanEffect) -> IsophoteStatus,
    /// [object-thread] Message of the last failed call on the effect; empty before the first.
    pub effect_error:
        unsafe extern "C" fn(effect: IsophoteVulkanEffect, text: *mut IsophoteText) -> IsophoteStatus,
    /// [object-thread, needs-output] Takes over the parameters of the graph and the request (null for the one before) for
    /// the next recording, also while commands are in flight. With `ISOPHOTE_CHANGE_UNIFORMS` no Vulkan object was made;
    /// with `ISOPHOTE_CHANGE_STRUCTURE`, which another size always is, intermediate images are others, and shaders that are
    /// new were compiled. After a failure the effect is as it was.
    pub effect_update: unsafe extern "C" fn(
        effect: IsophoteVulkanEffect,
        graph: IsophoteGraph,
        request: *const IsophoteRequest,
        change: *mut IsophoteChange,
    ) -> IsophoteStatus,

    /// [object-thread] Records the effect into a `VkCommandBuffer` of the host's, which is in the recording state and
    /// outside of a render pass; to be executed once. Barriers before and after order it with all commands around it on
    /// the queue, so that the host needs none. Afterwards other pipelines and descriptor sets are bound for compute.
    ///
    /// `value` is what the timeline will have once the commands have been executed: the host signals it with the
    /// submission of the command buffer or with a later one. It is above what the timeline has now.
    pub record: unsafe extern "C" fn(
        effect: IsophoteVulkanEffect,
        command_buffer: *mut c_void,
        images: *const IsophoteVulkanImage,
        image_count: u32,
        value: u64,
    ) -> IsophoteStatus,

    /// [object-thread] Records the effect into a command buffer of the library's and submits it to the host's queue: it
    /// begins after `waits`, signals `signals` when it is done, and sets the timeline to `value`. Values of the timeline
    /// grow from submission to submission.
    pub submit: unsafe extern "C" fn(
        effect: IsophoteVulkanEffect,
        images: *const IsophoteVulkanImage,
        image_count: u32,
        waits: *const IsophoteVulkanSemaphore,
        wait_count: u32,
        signals: *const IsophoteVulkanSemaphore,
        signal_count: u32,
        value: u64,
    ) -> IsophoteStatus,
}
