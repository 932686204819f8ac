//! The library on a host's Vulkan device: its calls, as tests make them.

use super::host::{Host, Picture};
use ash::vk::{self, Handle};
use isophote_abi::*;
use isophote_tests::library::{Loaded, text};
use std::ffi::{CStr, c_void};
use std::ptr::{null, null_mut};

pub const SIZE: [u32; 2] = [33, 21];
pub const READ: vk::ImageLayout = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;
pub const FLOATS: vk::Format = vk::Format::R32G32B32A32_SFLOAT;
pub const STORED: vk::ImageUsageFlags = vk::ImageUsageFlags::from_raw(
    vk::ImageUsageFlags::STORAGE.as_raw()
        | vk::ImageUsageFlags::SAMPLED.as_raw()
        | vk::ImageUsageFlags::TRANSFER_SRC.as_raw()
        | vk::ImageUsageFlags::TRANSFER_DST.as_raw(),
);

/// The library on a host's device, with a graph of one node. It is dropped before the host.
pub struct Studio {
    pub library: Loaded,
    pub table: &'static IsophoteVulkanApi,
    pub graph: IsophoteGraph,
    pub vulkan: IsophoteVulkan,
}

pub fn load() -> (Loaded, &'static IsophoteVulkanApi) {
    let library = Loaded::new();
    // SAFETY: the name ends with a zero; the table is of the type that its name says.
    let table = unsafe {
        (library.api.extension)(c"isophote.vulkan/1".as_ptr()).cast::<IsophoteVulkanApi>().as_ref()
    };
    let table = table.expect("the library knows Vulkan");
    assert_eq!(table.struct_size as usize, size_of::<IsophoteVulkanApi>());
    (library, table)
}

/// The status of a call that hands out its message.
pub fn with_message(call: impl FnOnce(*mut IsophoteText) -> IsophoteStatus) -> (IsophoteStatus, String) {
    let mut status = ISOPHOTE_OK;
    let message = text(|t| status = call(t));
    (status, message)
}

pub fn create(
    table: &IsophoteVulkanApi,
    shown: &IsophoteVulkanHost,
) -> (IsophoteStatus, String, IsophoteVulkan) {
    let mut vulkan = IsophoteVulkan { id: 7 };
    // SAFETY: the pointers lead to what the table asks for.
    let (status, message) = with_message(|t| unsafe { (table.create)(shown, t, &raw mut vulkan) });
    (status, message, vulkan)
}

impl Studio {
    pub fn new(host: &Host, node: &CStr) -> Self {
        Self::on(&host.shown(), node)
    }

    /// On a device as it is told of.
    pub fn on(shown: &IsophoteVulkanHost, node: &CStr) -> Self {
        let (library, table) = load();
        let mut graph = IsophoteGraph::default();
        // SAFETY: the pointers lead to what the table asks for.
        let status = unsafe { (library.api.graph_create_single)(node.as_ptr(), null_mut(), &raw mut graph) };
        assert_eq!(status, ISOPHOTE_OK);
        let (status, message, vulkan) = create(table, shown);
        assert_eq!(status, ISOPHOTE_OK, "{message}");
        Self { library, table, graph, vulkan }
    }

    pub fn request(&self, [width, height]: [u32; 2]) -> IsophoteRequest {
        let mut request = std::mem::MaybeUninit::uninit();
        // SAFETY: the request is written.
        unsafe {
            assert_eq!((self.library.api.request_init)(width, height, request.as_mut_ptr()), ISOPHOTE_OK);
            request.assume_init()
        }
    }

    pub fn effect_of(&self, size: [u32; 2]) -> (IsophoteStatus, String, IsophoteVulkanEffect) {
        let request = self.request(size);
        let mut effect = IsophoteVulkanEffect { id: 7 };
        // SAFETY: the pointers lead to what the table asks for.
        let (status, message) = with_message(|t| unsafe {
            (self.table.effect_create)(self.vulkan, self.graph, &raw const request, t, &raw mut effect)
        });
        (status, message, effect)
    }

    pub fn effect(&self, size: [u32; 2]) -> IsophoteVulkanEffect {
        let (status, message, effect) = self.effect_of(size);
        assert_eq!(status, ISOPHOTE_OK, "{message}");
        effect
    }

    pub fn error(&self, effect: IsophoteVulkanEffect) -> String {
        // SAFETY: the text is writable.
        text(|t| unsafe { assert_eq!((self.table.effect_error)(effect, t), ISOPHOTE_OK) })
    }

    pub fn record(
        &self,
        effect: IsophoteVulkanEffect,
        commands: vk::CommandBuffer,
        images: &[IsophoteVulkanImage],
        value: u64,
    ) -> IsophoteStatus {
        let commands = commands.as_raw() as *mut c_void;
        // SAFETY: the images are those of the list, and alive.
        unsafe { (self.table.record)(effect, commands, images.as_ptr(), images.len() as u32, value) }
    }

    pub fn submit(
        &self,
        effect: IsophoteVulkanEffect,
        images: &[IsophoteVulkanImage],
        value: u64,
    ) -> IsophoteStatus {
        let count = images.len() as u32;
        // SAFETY: the images are those of the list, and alive.
        unsafe { (self.table.submit)(effect, images.as_ptr(), count, null(), 0, null(), 0, value) }
    }

    pub fn update(
        &self,
        effect: IsophoteVulkanEffect,
        request: Option<IsophoteRequest>,
    ) -> (IsophoteStatus, IsophoteChange) {
        let mut change = 7;
        let request = request.as_ref().map_or(null(), std::ptr::from_ref);
        // SAFETY: the pointers lead to what the table asks for, or are null where that is allowed.
        let status = unsafe { (self.table.effect_update)(effect, self.graph, request, &raw mut change) };
        (status, change)
    }

    pub fn set_precision(&self, precision: IsophotePrecision) {
        // SAFETY: the name ends with a zero; the table is of the type that its name says.
        let status = unsafe {
            let table = (self.library.api.extension)(c"isophote.precision/1".as_ptr());
            let table = table.cast::<IsophotePrecisionApi>().as_ref().expect("the library knows precisions");
            (table.graph_set_precision)(self.graph, precision)
        };
        assert_eq!(status, ISOPHOTE_OK);
    }

    pub fn set(&self, name: &CStr, value: f64) {
        // SAFETY: the name ends with a zero.
        let status = unsafe { (self.library.api.graph_set_float)(self.graph, 0, name.as_ptr(), value) };
        assert_eq!(status, ISOPHOTE_OK);
    }
}

impl Drop for Studio {
    fn drop(&mut self) {
        // SAFETY: handles may be destroyed at any time; tests may have done it.
        unsafe {
            (self.table.destroy)(self.vulkan);
            (self.library.api.graph_destroy)(self.graph);
        }
    }
}

pub fn image(name: &'static CStr, picture: &Picture, layouts: [vk::ImageLayout; 2]) -> IsophoteVulkanImage {
    IsophoteVulkanImage {
        name: name.as_ptr(),
        image: picture.image.as_raw(),
        view: picture.view.as_raw(),
        format: picture.format.as_raw() as u32,
        usage: picture.usage.as_raw(),
        width: picture.size[0],
        height: picture.size[1],
        level: 0,
        layer: 0,
        layout_before: layouts[0].as_raw() as u32,
        layout_after: layouts[1].as_raw() as u32,
    }
}

/// A colour in the layout in which shaders read it, and a result.
pub fn images(host: &Host) -> [IsophoteVulkanImage; 2] {
    let color = host.picture(FLOATS, STORED, SIZE);
    host.fill(&color, [0.2, 0.4, 0.6, 1.0], READ, 1);
    [image(c"color", &color, [READ, READ]), output(host)]
}

/// A result.
pub fn output(host: &Host) -> IsophoteVulkanImage {
    let output = host.picture(FLOATS, STORED, SIZE);
    image(c"output", &output, [vk::ImageLayout::UNDEFINED, vk::ImageLayout::TRANSFER_SRC_OPTIMAL])
}
