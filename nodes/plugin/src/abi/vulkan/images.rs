//! Images of a host's: read from its list and checked.

use crate::abi::args;
use crate::abi::failure::{Failure, Outcome};
use crate::abi::graph;
use ash::vk::{self, Handle};
use isophote::graph::GraphInput;
use isophote::spec::ImageKind;
use isophote_abi::*;
use std::ffi::CStr;

/// The name of what leaves a graph.
const OUTPUT: &str = "output";

/// More images than a graph has inputs and outputs.
const MOST: u32 = 16;

/// Type of the samples of a format.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Samples {
    Unsigned,
    Signed,
    Float,
}

/// An image of the host's.
#[derive(Clone, Copy)]
pub struct Given {
    /// The input that it is; `None` for the output.
    pub input: Option<GraphInput>,
    /// The image.
    pub image: vk::Image,
    /// Its view.
    pub view: vk::ImageView,
    /// Format of the view.
    pub format: vk::Format,
    /// Usage that the image was created for.
    pub usage: vk::ImageUsageFlags,
    /// Texels of the view.
    pub size: [u32; 2],
    /// The level and layer that the view shows.
    pub range: vk::ImageSubresourceRange,
    /// Layout before.
    pub before: vk::ImageLayout,
    /// Layout after.
    pub after: vk::ImageLayout,
}

impl Given {
    /// Name of it in messages.
    pub fn name(&self) -> &'static str {
        self.input.map_or(OUTPUT, GraphInput::id)
    }

    /// The layout in which shaders read it.
    pub fn read_layout(&self) -> vk::ImageLayout {
        match self.before {
            vk::ImageLayout::GENERAL => vk::ImageLayout::GENERAL,
            _ => vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
        }
    }

    /// Fails unless it shows `size` texels.
    ///
    /// # Errors
    /// Geometry.
    pub fn must_hold(&self, size: [u32; 2]) -> Outcome<()> {
        if self.size[0] >= size[0] && self.size[1] >= size[1] {
            return Ok(());
        }
        let ([w, h], [width, height]) = (self.size, size);
        let message = format!("the image '{}' has {w}x{h} texels; {width}x{height} are needed", self.name());
        Err(Failure::geometry(message))
    }

    /// Fails for a name, or a level and layer, that is given twice.
    fn must_differ(&self, other: &Self) -> Outcome<()> {
        let place = |g: &Self| (g.image, g.range.base_mip_level, g.range.base_array_layer);
        let (name, other_name) = (self.name(), other.name());
        if name == other_name {
            return Err(Failure::argument(format!("the image '{name}' is given twice")));
        }
        if place(self) == place(other) {
            return Err(Failure::argument(format!("the images '{other_name}' and '{name}' are the same")));
        }
        Ok(())
    }

    fn must_be_used_for(&self, usage: vk::ImageUsageFlags, name: &str) -> Outcome<()> {
        if self.usage.contains(usage) {
            return Ok(());
        }
        let message = format!("the image '{}' was created without {name}", self.name());
        Err(Failure::new(ISOPHOTE_ERROR_INPUT, message))
    }

    /// Fails where kernels could not read it.
    fn check_input(&self, input: GraphInput) -> Outcome<()> {
        use vk::ImageUsageFlags as Usage;
        let refuse = |why: String| {
            let message = format!("the image '{}' {why}", input.id());
            Err(Failure::new(ISOPHOTE_ERROR_INPUT, message))
        };
        let Some((channels, samples)) = format(self.format) else {
            return refuse(format!("has the format {:?}, which is not read as floats", self.format));
        };
        self.must_be_used_for(Usage::SAMPLED, "VK_IMAGE_USAGE_SAMPLED_BIT")?;
        if self.before == vk::ImageLayout::UNDEFINED {
            return refuse("is in the undefined layout, in which it shows nothing".into());
        }
        let (wanted, lowest) = match input.kind() {
            ImageKind::Color => (3, Samples::Unsigned),
            ImageKind::Normal => (4, Samples::Signed),
            ImageKind::Control | ImageKind::Hatching | ImageKind::Flow => (4, Samples::Unsigned),
            ImageKind::Position | ImageKind::Cryptomatte => (4, Samples::Float),
            ImageKind::Motion => (2, Samples::Float),
            ImageKind::Depth | ImageKind::ObjectId => (1, Samples::Float),
            _ => (1, Samples::Unsigned),
        };
        if channels < wanted {
            return refuse(format!("has {channels} channels; {wanted} are needed"));
        }
        match lowest {
            Samples::Float if samples != Samples::Float => refuse("must have floating samples".into()),
            Samples::Signed if samples == Samples::Unsigned => {
                refuse("must have signed or floating samples".into())
            }
            _ => Ok(()),
        }
    }

    fn check_output(&self) -> Outcome<()> {
        if format(self.format).is_none() {
            let message =
                format!("the image '{OUTPUT}' has the format {:?}, which holds no colours", self.format);
            return Err(Failure::new(ISOPHOTE_ERROR_INPUT, message));
        }
        Ok(())
    }

    /// True where the last kernel can write it, whose results have the format `result`.
    pub fn is_written_directly(&self, result: vk::Format) -> bool {
        let needed = vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::SAMPLED;
        self.format == result && self.usage.contains(needed) && !self.view.is_null()
    }

    /// Fails unless a result can be blitted to it.
    ///
    /// # Errors
    /// Input.
    pub fn must_take_blits(&self) -> Outcome<()> {
        self.must_be_used_for(vk::ImageUsageFlags::TRANSFER_DST, "VK_IMAGE_USAGE_TRANSFER_DST_BIT")
    }
}

/// Channels and samples of the formats that shaders read as floats.
fn format(format: vk::Format) -> Option<(u32, Samples)> {
    use vk::Format as F;
    let known = match format {
        F::R8_UNORM | F::R16_UNORM => (1, Samples::Unsigned),
        F::R8G8_UNORM | F::R16G16_UNORM => (2, Samples::Unsigned),
        F::R8G8B8A8_UNORM | F::R8G8B8A8_SRGB | F::B8G8R8A8_UNORM | F::B8G8R8A8_SRGB => (4, Samples::Unsigned),
        F::A8B8G8R8_UNORM_PACK32 | F::A8B8G8R8_SRGB_PACK32 => (4, Samples::Unsigned),
        F::A2R10G10B10_UNORM_PACK32 | F::A2B10G10R10_UNORM_PACK32 => (4, Samples::Unsigned),
        F::R16G16B16A16_UNORM => (4, Samples::Unsigned),
        F::R8G8B8A8_SNORM | F::R16G16B16A16_SNORM => (4, Samples::Signed),
        F::R16_SFLOAT | F::R32_SFLOAT => (1, Samples::Float),
        F::R16G16_SFLOAT | F::R32G32_SFLOAT => (2, Samples::Float),
        F::B10G11R11_UFLOAT_PACK32 => (3, Samples::Float),
        F::R16G16B16A16_SFLOAT | F::R32G32B32A32_SFLOAT => (4, Samples::Float),
        _ => return None,
    };
    Some(known)
}

/// The host's images.
///
/// # Errors
/// Invalid argument for nulls, unknown for a name that is none, input for a format or usage that does not do.
///
/// # Safety
/// `images` is null or points to `count` of them, whose names are text with a closing zero.
pub unsafe fn read(images: *const IsophoteVulkanImage, count: u32) -> Outcome<Vec<Given>> {
    if count > MOST {
        return Err(Failure::argument(format!(
            "{count} images are more than any graph has; give at most {MOST}"
        )));
    }
    let mut read: Vec<Given> = Vec::new();
    for index in 0..count as usize {
        // SAFETY: as the caller promised.
        let given = unsafe {
            let host = args::get(images.wrapping_add(index), "the list of images")?;
            let is_output = !host.name.is_null() && CStr::from_ptr(host.name).to_bytes() == OUTPUT.as_bytes();
            given(&host, if is_output { None } else { Some(graph::input(host.name)?) })?
        };
        for other in &read {
            given.must_differ(other)?;
        }
        read.push(given);
    }
    Ok(read)
}

fn given(host: &IsophoteVulkanImage, input: Option<GraphInput>) -> Outcome<Given> {
    // Numbers above what Vulkan knows stay what they are, and are no format that is known here.
    let given = Given {
        input,
        image: vk::Image::from_raw(host.image),
        view: vk::ImageView::from_raw(host.view),
        format: vk::Format::from_raw(host.format.cast_signed()),
        usage: vk::ImageUsageFlags::from_raw(host.usage),
        size: [host.width, host.height],
        range: vk::ImageSubresourceRange {
            aspect_mask: vk::ImageAspectFlags::COLOR,
            base_mip_level: host.level,
            level_count: 1,
            base_array_layer: host.layer,
            layer_count: 1,
        },
        before: vk::ImageLayout::from_raw(host.layout_before.cast_signed()),
        after: vk::ImageLayout::from_raw(host.layout_after.cast_signed()),
    };
    let name = given.name();
    if given.image.is_null() || (given.view.is_null() && input.is_some()) {
        return Err(Failure::argument(format!("the image '{name}' or its view is null")));
    }
    if [vk::ImageLayout::UNDEFINED, vk::ImageLayout::PREINITIALIZED].contains(&given.after) {
        return Err(Failure::argument(format!("the image '{name}' cannot be left in {:?}", given.after)));
    }
    match input {
        Some(input) => given.check_input(input)?,
        None => given.check_output()?,
    }
    Ok(given)
}
