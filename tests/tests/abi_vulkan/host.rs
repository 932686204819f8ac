//! A host with a Vulkan device, under the validation layer where it is installed.

use super::faults;
use ash::khr;
use ash::vk::{self, Handle};
use isophote_abi::*;
use std::ffi::{CStr, c_char, c_void};
use std::mem::transmute;
use std::ptr::{null, null_mut};
use std::sync::{Mutex, PoisonError};

const LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

/// Extensions that devices before Vulkan 1.2 are created with.
struct Extensions([*const c_char; 1]);

// SAFETY: the names are constant.
unsafe impl Sync for Extensions {}

static EXTENSIONS: Extensions = Extensions([khr::timeline_semaphore::NAME.as_ptr()]);

/// A device, its timeline, and what the validation layer said.
pub struct Host {
    entry: ash::Entry,
    pub instance: ash::Instance,
    pub physical: vk::PhysicalDevice,
    pub device: ash::Device,
    pub queue: vk::Queue,
    pub family: u32,
    pub timeline: vk::Semaphore,
    version: u32,
    /// The functions of timelines before Vulkan 1.2.
    timelines: Option<khr::timeline_semaphore::Device>,
    pool: vk::CommandPool,
    pictures: Mutex<Vec<Picture>>,
    messenger: Option<(ash::ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    said: Box<Mutex<Vec<String>>>,
}

/// An image of the host's.
#[derive(Clone, Copy)]
pub struct Picture {
    pub image: vk::Image,
    pub view: vk::ImageView,
    pub format: vk::Format,
    pub usage: vk::ImageUsageFlags,
    pub size: [u32; 2],
    memory: vk::DeviceMemory,
}

unsafe extern "system" fn hear(
    _: vk::DebugUtilsMessageSeverityFlagsEXT,
    _: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    user: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: the layer hands over its message; the list outlives the messenger.
    let (message, said) =
        unsafe { (CStr::from_ptr((*data).p_message), &*user.cast_const().cast::<Mutex<Vec<String>>>()) };
    said.lock().unwrap_or_else(PoisonError::into_inner).push(message.to_string_lossy().into_owned());
    vk::FALSE
}

/// True where a device is required and not only welcome.
fn is_required() -> bool {
    std::env::var_os("CI").is_some() || std::env::var("ISOPHOTE_REQUIRE_GPU").is_ok_and(|v| v == "1")
}

impl Host {
    /// A host for a test, or `None`, loudly, where there is no device.
    pub fn new(test: &str) -> Option<Self> {
        Self::of_version(vk::API_VERSION_1_2, test)
    }

    /// A host that uses Vulkan 1.1 or 1.2.
    pub fn of_version(version: u32, test: &str) -> Option<Self> {
        match Self::open(version) {
            Ok(host) => Some(host),
            Err(reason) => {
                assert!(!is_required(), "{test} needs a Vulkan device: {reason}");
                eprintln!("\n*** SKIPPED: {test} had no Vulkan device: {reason} ***\n");
                None
            }
        }
    }

    fn open(version: u32) -> Result<Self, String> {
        let said = Box::new(Mutex::new(Vec::new()));
        let mut messenger = vk::DebugUtilsMessengerCreateInfoEXT::default()
            .message_severity(
                vk::DebugUtilsMessageSeverityFlagsEXT::WARNING | vk::DebugUtilsMessageSeverityFlagsEXT::ERROR,
            )
            .message_type(vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION)
            .pfn_user_callback(Some(hear))
            .user_data((&raw const *said).cast_mut().cast());
        let application = vk::ApplicationInfo::default().api_version(version);
        let enabled = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
        let mut validation = vk::ValidationFeaturesEXT::default().enabled_validation_features(&enabled);
        let (layers, extensions) = ([LAYER.as_ptr()], [ash::ext::debug_utils::NAME.as_ptr()]);
        // SAFETY: the system's loader is one; all that is created follows Vulkan's rules.
        unsafe {
            let entry = ash::Entry::load().map_err(|e| e.to_string())?;
            let known = entry.enumerate_instance_layer_properties().map_err(|e| e.to_string())?;
            let is_validated = known.iter().any(|layer| layer.layer_name_as_c_str() == Ok(LAYER));
            let mut info = vk::InstanceCreateInfo::default().application_info(&application);
            if is_validated {
                info = info.enabled_layer_names(&layers).enabled_extension_names(&extensions);
                info = info.push_next(&mut messenger).push_next(&mut validation);
            }
            let instance = entry.create_instance(&info, None).map_err(|e| e.to_string())?;
            let messenger = is_validated.then(|| {
                let functions = ash::ext::debug_utils::Instance::new(&entry, &instance);
                let info = vk::DebugUtilsMessengerCreateInfoEXT { p_next: null(), ..messenger };
                let made = functions.create_debug_utils_messenger(&info, None).unwrap();
                (functions, made)
            });
            Self::on(version, entry, instance, messenger, said)
        }
    }

    /// # Safety
    /// The instance must be alive.
    unsafe fn on(
        version: u32,
        entry: ash::Entry,
        instance: ash::Instance,
        messenger: Option<(ash::ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
        said: Box<Mutex<Vec<String>>>,
    ) -> Result<Self, String> {
        let features = vk::PhysicalDeviceFeatures::default().shader_storage_image_extended_formats(true);
        let mut timelines = vk::PhysicalDeviceTimelineSemaphoreFeatures::default().timeline_semaphore(true);
        let is_old = version < vk::API_VERSION_1_2;
        let names = if is_old { &EXTENSIONS.0[..] } else { &[] };
        let wanted = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
        // SAFETY: as the caller promised.
        unsafe {
            let physical =
                *instance.enumerate_physical_devices().map_err(|e| e.to_string())?.first().ok_or("none")?;
            let families = instance.get_physical_device_queue_family_properties(physical);
            let family =
                families.iter().position(|f| f.queue_flags.contains(wanted)).ok_or("no queue")? as u32;
            let queues =
                [vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&[1.0])];
            let info = vk::DeviceCreateInfo::default()
                .queue_create_infos(&queues)
                .enabled_features(&features)
                .enabled_extension_names(names)
                .push_next(&mut timelines);
            let device = instance.create_device(physical, &info, None).map_err(|e| e.to_string())?;
            let mut kind = vk::SemaphoreTypeCreateInfo::default().semaphore_type(vk::SemaphoreType::TIMELINE);
            let info = vk::SemaphoreCreateInfo::default().push_next(&mut kind);
            let timeline = device.create_semaphore(&info, None).map_err(|e| e.to_string())?;
            let info = vk::CommandPoolCreateInfo::default().queue_family_index(family);
            let pool = device.create_command_pool(&info, None).map_err(|e| e.to_string())?;
            let queue = device.get_device_queue(family, 0);
            let timelines = is_old.then(|| khr::timeline_semaphore::Device::new(&instance, &device));
            let pictures = Mutex::default();
            Ok(Self {
                entry,
                instance,
                physical,
                device,
                queue,
                family,
                timeline,
                version,
                timelines,
                pool,
                pictures,
                messenger,
                said,
            })
        }
    }

    /// Description of the device for the library. Its functions go by way of [`faults`], so that this thread alone
    /// may use it.
    pub fn shown(&self) -> IsophoteVulkanHost {
        let real = self.entry.static_fn().get_instance_proc_addr;
        IsophoteVulkanHost { get_instance_proc_addr: faults::loader(real), ..self.shown_to_all() }
    }

    /// As [`Host::shown`], without faults and for all threads.
    pub fn shown_to_all(&self) -> IsophoteVulkanHost {
        let real = self.entry.static_fn().get_instance_proc_addr;
        IsophoteVulkanHost {
            // SAFETY: the types differ in the name of the instance's pointer.
            get_instance_proc_addr: unsafe {
                transmute::<vk::PFN_vkGetInstanceProcAddr, IsophoteVulkanLoader>(real)
            },
            instance: self.instance.handle().as_raw() as *mut c_void,
            physical_device: self.physical.as_raw() as *mut c_void,
            device: self.device.handle().as_raw() as *mut c_void,
            queue: self.queue.as_raw() as *mut c_void,
            api_version: self.version,
            queue_family: self.family,
            features: ISOPHOTE_VULKAN_STORAGE_IMAGE_EXTENDED_FORMATS | ISOPHOTE_VULKAN_TIMELINE_SEMAPHORE,
            extension_count: u32::from(self.timelines.is_some()),
            extensions: EXTENSIONS.0.as_ptr(),
            timeline: self.timeline.as_raw(),
            pipeline_cache: 0,
            user: null_mut(),
            lock_queue: None,
            unlock_queue: None,
        }
    }

    /// An image; it is destroyed with the host.
    pub fn picture(&self, format: vk::Format, usage: vk::ImageUsageFlags, size: [u32; 2]) -> Picture {
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(vk::Extent3D { width: size[0], height: size[1], depth: 1 })
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .usage(usage);
        let is_seen = usage.intersects(vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::STORAGE);
        // SAFETY: the device is alive; memory and view are those of the image.
        unsafe {
            let image = self.device.create_image(&info, None).unwrap();
            let needed = self.device.get_image_memory_requirements(image);
            let kind = needed.memory_type_bits.trailing_zeros();
            let memory =
                vk::MemoryAllocateInfo::default().allocation_size(needed.size).memory_type_index(kind);
            let memory = self.device.allocate_memory(&memory, None).unwrap();
            self.device.bind_image_memory(image, memory, 0).unwrap();
            let view = vk::ImageViewCreateInfo::default()
                .image(image)
                .view_type(vk::ImageViewType::TYPE_2D)
                .format(format)
                .subresource_range(WHOLE);
            let view = if is_seen {
                self.device.create_image_view(&view, None).unwrap()
            } else {
                vk::ImageView::null()
            };
            let made = Picture { image, view, format, usage, size, memory };
            self.pictures.lock().unwrap().push(made);
            made
        }
    }

    /// A command buffer in the recording state, for the thread of the host.
    pub fn commands(&self) -> vk::CommandBuffer {
        self.commands_of(self.pool)
    }

    /// A command buffer of a pool in the recording state.
    pub fn commands_of(&self, pool: vk::CommandPool) -> vk::CommandBuffer {
        let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
        let begin = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the device is alive, and the pool is used by one thread.
        unsafe {
            let commands = self.device.allocate_command_buffers(&info).unwrap()[0];
            self.device.begin_command_buffer(commands, &begin).unwrap();
            commands
        }
    }

    /// A pool of command buffers for another thread; it is the caller's.
    pub fn pool(&self) -> vk::CommandPool {
        let info = vk::CommandPoolCreateInfo::default().queue_family_index(self.family);
        // SAFETY: the device is alive.
        unsafe { self.device.create_command_pool(&info, None) }.unwrap()
    }

    /// Executes commands, which bring the timeline to `value`, and waits for them.
    pub fn execute(&self, commands: vk::CommandBuffer, value: u64) {
        let (values, buffers, signals) = ([value], [commands], [self.timeline]);
        let mut timelines = vk::TimelineSemaphoreSubmitInfo::default().signal_semaphore_values(&values);
        let info = vk::SubmitInfo::default()
            .command_buffers(&buffers)
            .signal_semaphores(&signals)
            .push_next(&mut timelines);
        // SAFETY: the commands are in the recording state, and nothing else uses the queue.
        unsafe {
            self.device.end_command_buffer(commands).unwrap();
            self.device.queue_submit(self.queue, &[info], vk::Fence::null()).unwrap();
        }
        self.wait(value);
    }

    /// Waits until the timeline has a value.
    pub fn wait(&self, value: u64) {
        let (values, semaphores) = ([value], [self.timeline]);
        let info = vk::SemaphoreWaitInfo::default().semaphores(&semaphores).values(&values);
        // SAFETY: the device is alive.
        unsafe {
            match &self.timelines {
                Some(extension) => extension.wait_semaphores(&info, u64::MAX),
                None => self.device.wait_semaphores(&info, u64::MAX),
            }
        }
        .unwrap();
    }

    /// Brings an image from nothing to `layout`, all of it of one colour.
    pub fn fill(&self, picture: &Picture, color: [f32; 4], layout: vk::ImageLayout, value: u64) {
        let commands = self.commands();
        let [none, written] = [vk::AccessFlags::empty(), vk::AccessFlags::TRANSFER_WRITE];
        let between = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
        self.transition(commands, picture, [vk::ImageLayout::UNDEFINED, between], [none, written]);
        let color = vk::ClearColorValue { float32: color };
        // SAFETY: the commands are in the recording state.
        unsafe { self.device.cmd_clear_color_image(commands, picture.image, between, &color, &[WHOLE]) };
        self.transition(commands, picture, [between, layout], [written, vk::AccessFlags::MEMORY_READ]);
        self.execute(commands, value);
    }

    pub fn transition(
        &self,
        commands: vk::CommandBuffer,
        picture: &Picture,
        layouts: [vk::ImageLayout; 2],
        access: [vk::AccessFlags; 2],
    ) {
        let barrier = vk::ImageMemoryBarrier::default()
            .image(picture.image)
            .old_layout(layouts[0])
            .new_layout(layouts[1])
            .src_access_mask(access[0])
            .dst_access_mask(access[1])
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .subresource_range(WHOLE);
        let stages = vk::PipelineStageFlags::ALL_COMMANDS;
        let flags = vk::DependencyFlags::empty();
        // SAFETY: the commands are in the recording state.
        unsafe { self.device.cmd_pipeline_barrier(commands, stages, stages, flags, &[], &[], &[barrier]) };
    }

    /// The texels of an image of four floats, which is in the layout for copies.
    pub fn read(&self, picture: &Picture, value: u64) -> Vec<[f32; 4]> {
        let count = (picture.size[0] * picture.size[1]) as usize;
        let info =
            vk::BufferCreateInfo::default().size(count as u64 * 16).usage(vk::BufferUsageFlags::TRANSFER_DST);
        let copy = vk::BufferImageCopy::default()
            .image_subresource(vk::ImageSubresourceLayers {
                aspect_mask: vk::ImageAspectFlags::COLOR,
                mip_level: 0,
                base_array_layer: 0,
                layer_count: 1,
            })
            .image_extent(vk::Extent3D { width: picture.size[0], height: picture.size[1], depth: 1 });
        let visible = vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
        // SAFETY: the device is alive; the buffer has room for all texels, and is read when they are there.
        unsafe {
            let buffer = self.device.create_buffer(&info, None).unwrap();
            let needed = self.device.get_buffer_memory_requirements(buffer);
            let kinds = self.instance.get_physical_device_memory_properties(self.physical);
            let fits = |(i, kind): &(usize, &vk::MemoryType)| {
                needed.memory_type_bits >> i & 1 == 1 && kind.property_flags.contains(visible)
            };
            let kind = kinds.memory_types_as_slice().iter().enumerate().find(fits).unwrap().0 as u32;
            let memory =
                vk::MemoryAllocateInfo::default().allocation_size(needed.size).memory_type_index(kind);
            let memory = self.device.allocate_memory(&memory, None).unwrap();
            self.device.bind_buffer_memory(buffer, memory, 0).unwrap();
            let commands = self.commands();
            let layout = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
            self.device.cmd_copy_image_to_buffer(commands, picture.image, layout, buffer, &[copy]);
            self.execute(commands, value);
            let flags = vk::MemoryMapFlags::empty();
            let data = self.device.map_memory(memory, 0, vk::WHOLE_SIZE, flags).unwrap();
            let texels = std::slice::from_raw_parts(data.cast::<[f32; 4]>(), count).to_vec();
            self.device.destroy_buffer(buffer, None);
            self.device.free_memory(memory, None);
            texels
        }
    }
}

/// The one level and layer of an image.
const WHOLE: vk::ImageSubresourceRange = vk::ImageSubresourceRange {
    aspect_mask: vk::ImageAspectFlags::COLOR,
    base_mip_level: 0,
    level_count: 1,
    base_array_layer: 0,
    layer_count: 1,
};

impl Drop for Host {
    /// Destroys everything; what the library left on the device is a message of the validation layer.
    fn drop(&mut self) {
        // SAFETY: all that was submitted has been waited for, or is here.
        unsafe {
            self.device.device_wait_idle().unwrap();
            for picture in self.pictures.lock().unwrap_or_else(PoisonError::into_inner).iter() {
                self.device.destroy_image_view(picture.view, None);
                self.device.destroy_image(picture.image, None);
                self.device.free_memory(picture.memory, None);
            }
            self.device.destroy_command_pool(self.pool, None);
            self.device.destroy_semaphore(self.timeline, None);
            self.device.destroy_device(None);
            if let Some((functions, messenger)) = &self.messenger {
                functions.destroy_debug_utils_messenger(*messenger, None);
            }
            self.instance.destroy_instance(None);
        }
        let said = self.said.lock().unwrap_or_else(PoisonError::into_inner);
        assert!(
            said.is_empty() || std::thread::panicking(),
            "the validation layer says:\n{}",
            said.join("\n")
        );
    }
}
