//! Mesa's driver for AMD cards, RADV, without a card: it compiles for the family that `RADV_FORCE_FAMILY` names and
//! tells what it made. Nothing is ever submitted.

// Vulkan is called through pointers; each block says why its call is in order.
#![allow(unsafe_code)]

use crate::error::{Error, Result};
use crate::shader::{Binding, BindingKind, Spirv};
use ash::vk;
use std::collections::BTreeMap;
use std::ffi::CStr;

/// The driver's device, which compiles and cannot compute.
pub struct Driver {
    // Vulkan's functions go with the library, which must be unloaded last.
    _entry: ash::Entry,
    instance: ash::Instance,
    device: ash::Device,
    executables: ash::khr::pipeline_executable_properties::Device,
    /// The device as the driver names it, and the driver's own version.
    pub name: String,
}

/// Result of the driver for a shader.
pub struct Executable {
    /// The driver's figures, by their names.
    pub statistics: BTreeMap<String, u64>,
    /// The machine code as text.
    pub assembly: String,
}

/// The function of compute shaders.
const ENTRY_POINT: &CStr = c"main";

impl Driver {
    /// Opens the only device there is.
    ///
    /// # Errors
    /// When there is no Vulkan, or when the device is not RADV's without a card.
    pub fn open() -> Result<Self> {
        // SAFETY: the system's loader of Vulkan does nothing unusual when it is loaded.
        let entry = unsafe { ash::Entry::load() }.map_err(|e| Error::Loader(e.to_string()))?;
        let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_3);
        let info = vk::InstanceCreateInfo::default().application_info(&application);
        // SAFETY: the structures live until the call returns.
        let instance = unsafe { entry.create_instance(&info, None) }.map_err(Error::vulkan("an instance"))?;
        match Self::open_device(&instance) {
            Ok((device, name)) => {
                let executables = ash::khr::pipeline_executable_properties::Device::new(&instance, &device);
                Ok(Self { _entry: entry, instance, device, executables, name })
            }
            Err(error) => {
                // SAFETY: nothing was made of it.
                unsafe { instance.destroy_instance(None) };
                Err(error)
            }
        }
    }

    fn open_device(instance: &ash::Instance) -> Result<(ash::Device, String)> {
        // SAFETY: the instance lives.
        let devices =
            unsafe { instance.enumerate_physical_devices() }.map_err(Error::vulkan("the list of devices"))?;
        let [physical] = devices[..] else { return Err(Error::Devices(devices.len())) };
        let mut driver = vk::PhysicalDeviceDriverProperties::default();
        let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
        // SAFETY: the chain of structures is the one that Vulkan 1.2 names, which the instance asks for.
        unsafe { instance.get_physical_device_properties2(physical, &mut properties) };
        let device = text(properties.properties.device_name_as_c_str());
        let name = format!("{device}, {}", text(driver.driver_info_as_c_str()));
        if !device.contains("RADV") {
            return Err(Error::Device(name));
        }
        let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(0).queue_priorities(&[1.0])];
        let extensions =
            [ash::khr::pipeline_executable_properties::NAME.as_ptr(), ash::ext::robustness2::NAME.as_ptr()];
        // What wgpu asks for, so that the driver compiles as it does under wgpu.
        let basic = vk::PhysicalDeviceFeatures::default().robust_buffer_access(true);
        let mut wanted = vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default()
            .pipeline_executable_info(true);
        let mut images = vk::PhysicalDeviceImageRobustnessFeatures::default().robust_image_access(true);
        let mut robust = vk::PhysicalDeviceRobustness2FeaturesEXT::default()
            .robust_buffer_access2(true)
            .robust_image_access2(true);
        let info = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queues)
            .enabled_extension_names(&extensions)
            .enabled_features(&basic)
            .push_next(&mut wanted)
            .push_next(&mut images)
            .push_next(&mut robust);
        // SAFETY: the structures live until the call returns; what the device lacks makes it fail.
        let device = unsafe { instance.create_device(physical, &info, None) };
        Ok((device.map_err(Error::vulkan("a device"))?, name))
    }

    /// Compiles a shader.
    ///
    /// # Errors
    /// When the driver does not, or does not tell what it made.
    pub fn compile(&self, shader: &Spirv) -> Result<Executable> {
        let mut made = Made::new(&self.device);
        made.create(shader)?;
        let statistics = self.statistics(made.pipeline)?;
        Ok(Executable { statistics, assembly: self.assembly(made.pipeline)? })
    }

    fn statistics(&self, pipeline: vk::Pipeline) -> Result<BTreeMap<String, u64>> {
        let info = vk::PipelineExecutableInfoKHR::default().pipeline(pipeline).executable_index(0);
        // SAFETY: the pipeline lives and was made to keep its statistics; compute pipelines have one executable.
        let found = unsafe { self.executables.get_pipeline_executable_statistics(&info) };
        let number = |s: &vk::PipelineExecutableStatisticKHR<'_>| {
            if s.format != vk::PipelineExecutableStatisticFormatKHR::UINT64 {
                return None;
            }
            // SAFETY: the field is the one that the format names.
            Some(unsafe { s.value.u64 })
        };
        let found = found.map_err(Error::vulkan("statistics"))?;
        Ok(found.iter().filter_map(|s| Some((text(s.name_as_c_str()), number(s)?))).collect())
    }

    fn assembly(&self, pipeline: vk::Pipeline) -> Result<String> {
        let info = vk::PipelineExecutableInfoKHR::default().pipeline(pipeline).executable_index(0);
        let wanted = Error::vulkan("the machine code");
        let ask = self.executables.fp().get_pipeline_executable_internal_representations_khr;
        let handle = self.executables.device();
        let mut count = 0;
        // SAFETY: without an array the call only counts.
        let result = unsafe { ask(handle, &info, &mut count, std::ptr::null_mut()) };
        result.result().map_err(&wanted)?;
        let mut kinds = vec![vk::PipelineExecutableInternalRepresentationKHR::default(); count as usize];
        // SAFETY: the array has the length that the driver asked for; without buffers the call tells their sizes.
        let result = unsafe { ask(handle, &info, &mut count, kinds.as_mut_ptr()) };
        result.result().map_err(&wanted)?;
        let mut texts: Vec<Vec<u8>> = kinds.iter().map(|kind| vec![0; kind.data_size]).collect();
        for (kind, text) in kinds.iter_mut().zip(&mut texts) {
            kind.p_data = text.as_mut_ptr().cast();
        }
        // SAFETY: each buffer has the size that the driver asked for.
        let result = unsafe { ask(handle, &info, &mut count, kinds.as_mut_ptr()) };
        result.result().map_err(&wanted)?;
        let is_assembly = |kind: &vk::PipelineExecutableInternalRepresentationKHR<'_>| {
            text(kind.name_as_c_str()) == "Assembly"
        };
        let at = kinds.iter().position(is_assembly).ok_or(Error::Assembly)?;
        Ok(String::from_utf8_lossy(&texts[at]).trim_end_matches('\0').to_owned())
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        // SAFETY: what was made of the device is gone with `Made`, and nothing was submitted.
        unsafe {
            self.device.destroy_device(None);
            self.instance.destroy_instance(None);
        }
    }
}

/// A pipeline and what it is made of. Null handles may be destroyed, so that half of it may be missing.
struct Made<'d> {
    device: &'d ash::Device,
    module: vk::ShaderModule,
    bindings: vk::DescriptorSetLayout,
    layout: vk::PipelineLayout,
    pipeline: vk::Pipeline,
}

impl<'d> Made<'d> {
    fn new(device: &'d ash::Device) -> Self {
        Self {
            device,
            module: vk::ShaderModule::null(),
            bindings: vk::DescriptorSetLayout::null(),
            layout: vk::PipelineLayout::null(),
            pipeline: vk::Pipeline::null(),
        }
    }

    fn create(&mut self, shader: &Spirv) -> Result<()> {
        let module = vk::ShaderModuleCreateInfo::default().code(&shader.words);
        // SAFETY: naga wrote the words, after it had validated the shader.
        self.module =
            unsafe { self.device.create_shader_module(&module, None) }.map_err(Error::vulkan("a shader"))?;
        let bindings: Vec<_> = shader.bindings.iter().map(layout_binding).collect();
        let set = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the bindings live until the call returns.
        self.bindings = unsafe { self.device.create_descriptor_set_layout(&set, None) }
            .map_err(Error::vulkan("a layout of bindings"))?;
        let sets = [self.bindings];
        let layout = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets);
        // SAFETY: the set's layout lives.
        self.layout = unsafe { self.device.create_pipeline_layout(&layout, None) }
            .map_err(Error::vulkan("a layout of a pipeline"))?;
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(self.module)
            .name(ENTRY_POINT);
        let info = vk::ComputePipelineCreateInfo::default()
            .flags(
                vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR
                    | vk::PipelineCreateFlags::CAPTURE_INTERNAL_REPRESENTATIONS_KHR,
            )
            .stage(stage)
            .layout(self.layout);
        // SAFETY: shader and layout live, and the layout has every binding of the shader.
        let made = unsafe { self.device.create_compute_pipelines(vk::PipelineCache::null(), &[info], None) };
        // With one pipeline asked for, a failure leaves none.
        let made = made.map_err(|(_, result)| Error::vulkan("a pipeline")(result))?;
        self.pipeline = made.first().copied().unwrap_or_default();
        Ok(())
    }
}

impl Drop for Made<'_> {
    fn drop(&mut self) {
        // SAFETY: all was made of this device, and is used by nothing else.
        unsafe {
            self.device.destroy_pipeline(self.pipeline, None);
            self.device.destroy_pipeline_layout(self.layout, None);
            self.device.destroy_descriptor_set_layout(self.bindings, None);
            self.device.destroy_shader_module(self.module, None);
        }
    }
}

fn layout_binding(binding: &Binding) -> vk::DescriptorSetLayoutBinding<'static> {
    let kind = match binding.kind {
        BindingKind::Uniform => vk::DescriptorType::UNIFORM_BUFFER,
        BindingKind::Sampled => vk::DescriptorType::SAMPLED_IMAGE,
        BindingKind::Sampler => vk::DescriptorType::SAMPLER,
        BindingKind::Storage => vk::DescriptorType::STORAGE_IMAGE,
    };
    vk::DescriptorSetLayoutBinding::default()
        .binding(binding.number)
        .descriptor_type(kind)
        .descriptor_count(1)
        .stage_flags(vk::ShaderStageFlags::COMPUTE)
}

/// Text of a structure; the driver's are in English and short.
fn text<E>(text: std::result::Result<&CStr, E>) -> String {
    text.map(|text| text.to_string_lossy().into_owned()).unwrap_or_default()
}
