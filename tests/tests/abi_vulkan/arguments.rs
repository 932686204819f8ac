//! What hosts may hand in wrongly: each is a status with words.

use super::faults;
use super::host::Host;
use super::studio::{SIZE, Studio, create, images, load, with_message};
use ash::vk;
use isophote_tests::library::contract::*;
use std::ffi::{CStr, c_char};
use std::ptr::{null, null_mut};

#[test]
fn a_host_is_told_what_its_device_needs() {
    let (_library, table) = load();
    let ask = |version| {
        let mut needs = IsophoteVulkanNeeds { features: 0, extension_count: 7, extensions: null() };
        // SAFETY: the pointers lead to what the table asks for.
        let (status, message) = with_message(|t| unsafe { (table.needs)(version, t, &raw mut needs) });
        (status, message, needs)
    };
    let (status, message, _) = ask(vk::API_VERSION_1_0);
    assert_eq!(status, ISOPHOTE_ERROR_UNSUPPORTED);
    assert_eq!(message, "Vulkan 1.0 is too old; create instance and device for 1.1 or later");
    let (status, _, needs) = ask(vk::API_VERSION_1_1);
    assert_eq!((status, needs.extension_count), (ISOPHOTE_OK, 1));
    // SAFETY: there is one name.
    assert_eq!(unsafe { CStr::from_ptr(*needs.extensions) }, c"VK_KHR_timeline_semaphore");
    let (status, _, needs) = ask(vk::API_VERSION_1_3);
    assert_eq!((status, needs.extension_count), (ISOPHOTE_OK, 0));
    assert_eq!(needs.features, 3);
    // SAFETY: null is what must not matter.
    assert_eq!(
        unsafe { (table.needs)(vk::API_VERSION_1_2, null_mut(), null_mut()) },
        ISOPHOTE_ERROR_INVALID_ARGUMENT
    );
}

#[test]
fn what_a_device_lacks_is_named() {
    let Some(host) = Host::new("what_a_device_lacks_is_named") else { return };
    let (_library, table) = load();
    let shown = host.shown();
    let argument = ISOPHOTE_ERROR_INVALID_ARGUMENT;
    let names: [*const c_char; 1] = [c"VK_KHR_swapchain".as_ptr()];
    let cases = [
        (
            IsophoteVulkanHost { get_instance_proc_addr: None, ..shown },
            argument,
            "get_instance_proc_addr is null",
        ),
        (IsophoteVulkanHost { instance: null_mut(), ..shown }, argument, "the instance is null"),
        (
            IsophoteVulkanHost { physical_device: null_mut(), ..shown },
            argument,
            "the physical device is null",
        ),
        (IsophoteVulkanHost { device: null_mut(), ..shown }, argument, "the device is null"),
        (IsophoteVulkanHost { timeline: 0, ..shown }, argument, "the timeline is null"),
        (
            IsophoteVulkanHost { features: 0, ..shown },
            ISOPHOTE_ERROR_UNSUPPORTED,
            "the device was created without the feature shaderStorageImageExtendedFormats and the feature \
             timelineSemaphore; enable what `needs` names",
        ),
        (
            IsophoteVulkanHost {
                api_version: vk::API_VERSION_1_1,
                extension_count: 1,
                extensions: names.as_ptr(),
                ..shown
            },
            ISOPHOTE_ERROR_UNSUPPORTED,
            "the device was created without the extension VK_KHR_timeline_semaphore; enable what `needs` names",
        ),
        (
            IsophoteVulkanHost { api_version: 0, ..shown },
            ISOPHOTE_ERROR_UNSUPPORTED,
            "Vulkan 0.0 is too old; ",
        ),
        (
            IsophoteVulkanHost {
                api_version: vk::API_VERSION_1_1,
                extension_count: 1,
                extensions: null(),
                ..shown
            },
            argument,
            "the list of extensions is null",
        ),
        (
            IsophoteVulkanHost { queue_family: 99, ..shown },
            ISOPHOTE_ERROR_UNSUPPORTED,
            "the graphics device '",
        ),
    ];
    for (shown, expected, words) in cases {
        let (status, message, vulkan) = create(table, &shown);
        assert!(message.starts_with(words), "{message} does not begin with {words}");
        assert_eq!((status, vulkan.id), (expected, 0), "{message}");
    }
    for name in [
        "vkGetDeviceProcAddr",
        "vkGetPhysicalDeviceProperties",
        "vkCmdDispatch",
        "vkGetSemaphoreCounterValue",
    ] {
        faults::hide(name);
        let (status, message, _) = create(table, &shown);
        assert_eq!((status, message), (argument, format!("get_instance_proc_addr finds no {name}")));
    }
    faults::hide("");
    // SAFETY: null is what must not matter.
    unsafe {
        assert_eq!((table.create)(null(), null_mut(), null_mut()), argument);
        assert_eq!((table.create)(&raw const shown, null_mut(), null_mut()), argument);
    }
}

#[test]
fn wrong_handles_and_nulls_are_statuses() {
    let Some(host) = Host::new("wrong_handles_and_nulls_are_statuses") else { return };
    let studio = Studio::new(&host, c"gaussian");
    let (table, mut effect) = (studio.table, IsophoteVulkanEffect::default());
    let request = studio.request(SIZE);
    for id in [0, studio.graph.id, studio.vulkan.id ^ 1 << 30, u64::MAX] {
        let (wrong, none) = (IsophoteVulkanEffect { id }, ISOPHOTE_ERROR_INVALID_HANDLE);
        // SAFETY: that handles are wrong is what must not matter.
        unsafe {
            assert_eq!((table.destroy)(IsophoteVulkan { id }), none);
            let vulkan = IsophoteVulkan { id };
            let made =
                (table.effect_create)(vulkan, studio.graph, &raw const request, null_mut(), &raw mut effect);
            assert_eq!((made, effect.id), (none, 0));
            assert_eq!((table.effect_destroy)(wrong), none);
            assert_eq!((table.effect_error)(wrong, null_mut()), none);
        }
        assert_eq!(studio.submit(wrong, &[], 1), none);
    }
    let effect = studio.effect(SIZE);
    let (graph, argument) = (studio.graph, ISOPHOTE_ERROR_INVALID_ARGUMENT);
    // SAFETY: null is what must not matter.
    unsafe {
        let mut change = 0;
        assert_eq!((table.effect_create)(studio.vulkan, graph, null(), null_mut(), null_mut()), argument);
        assert_eq!((table.effect_error)(effect, null_mut()), argument);
        assert_eq!((table.effect_update)(effect, graph, null(), null_mut()), argument);
        assert_eq!(
            (table.effect_update)(effect, IsophoteGraph { id: 9 }, null(), &raw mut change),
            ISOPHOTE_ERROR_INVALID_HANDLE
        );
        assert_eq!((table.record)(effect, null_mut(), null(), 0, 1), argument);
        assert_eq!(studio.error(effect), "the command buffer is null");
        assert_eq!((table.submit)(effect, null(), 1, null(), 0, null(), 0, 1), argument);
        assert_eq!((table.submit)(effect, null(), u32::MAX, null(), 0, null(), 0, 1), argument);
        assert_eq!((table.submit)(effect, null(), 0, null(), 1, null(), 0, 1), argument);
        assert_eq!(studio.error(effect), "the list of semaphores is null");
        assert_eq!((table.submit)(effect, null(), 0, null(), 0, null(), 65, 1), argument);
        let none = IsophoteVulkanSemaphore { semaphore: 0, value: 1 };
        assert_eq!((table.submit)(effect, null(), 0, &raw const none, 1, null(), 0, 1), argument);
        assert_eq!(studio.error(effect), "a semaphore is null");
    }
    let most = u32::from(u16::MAX) + 1;
    let (status, message, _) = studio.effect_of([most, 1]);
    assert_eq!(status, ISOPHOTE_ERROR_GEOMETRY, "{message}");
    assert!(message.contains("texels are more than images of the device"), "{message}");
    assert_eq!(studio.effect_of([0, 1]).0, ISOPHOTE_ERROR_GEOMETRY);
    assert_eq!(studio.update(effect, Some(studio.request([most, 1]))).0, ISOPHOTE_ERROR_GEOMETRY);
    assert_eq!(studio.update(effect, None), (ISOPHOTE_OK, ISOPHOTE_CHANGE_UNIFORMS));
}

#[test]
fn images_that_do_not_do_are_refused_by_name() {
    let Some(host) = Host::new("images_that_do_not_do_are_refused_by_name") else { return };
    let studio = Studio::new(&host, c"gaussian");
    let effect = studio.effect(SIZE);
    let [color, output] = images(&host);
    let (argument, input) = (ISOPHOTE_ERROR_INVALID_ARGUMENT, ISOPHOTE_ERROR_INPUT);
    let none = vk::ImageLayout::UNDEFINED.as_raw() as u32;
    type Image = IsophoteVulkanImage;
    let of = |format: vk::Format, image: Image| Image { format: format.as_raw() as u32, ..image };
    let named =
        |name: &'static CStr, format, image: Image| Image { name: name.as_ptr(), ..of(format, image) };
    let other = |image: Image| Image { image: 0x77, ..image };
    let cases: &[(&[Image], IsophoteStatus, &str)] = &[
        (&[color], input, "the image 'output' is missing"),
        (&[output], input, "the image 'color' is missing"),
        (&[color, color, output], argument, "the image 'color' is given twice, or is that of 'color'"),
        (
            &[color, Image { name: output.name, ..color }],
            argument,
            "the image 'output' is given twice, or is that of 'color'",
        ),
        (&[Image { name: null(), ..color }, output], argument, "the input's name is null"),
        (&[Image { name: c"colour".as_ptr(), ..color }, output], ISOPHOTE_ERROR_UNKNOWN, ""),
        (&[Image { image: 0, ..color }, output], argument, "the image 'color' or its view is null"),
        (&[Image { view: 0, ..color }, output], argument, "the image 'color' or its view is null"),
        (
            &[Image { layout_before: none, ..color }, output],
            input,
            "the image 'color' is in the undefined layout, in which it shows nothing",
        ),
        (
            &[Image { layout_after: none, ..color }, output],
            argument,
            "the image 'color' cannot be left in UNDEFINED",
        ),
        (
            &[Image { usage: 0, ..color }, output],
            input,
            "the image 'color' was created without VK_IMAGE_USAGE_SAMPLED_BIT",
        ),
        (
            &[Image { width: 32, ..color }, output],
            ISOPHOTE_ERROR_GEOMETRY,
            "the image 'color' has 32x21 texels; 33x21 are needed",
        ),
        (
            &[color, Image { height: 20, ..output }],
            ISOPHOTE_ERROR_GEOMETRY,
            "the image 'output' has 33x20 texels; 33x21 are needed",
        ),
        (
            &[of(vk::Format::R8G8B8A8_UINT, color), output],
            input,
            "the image 'color' has the format R8G8B8A8_UINT, which is not read as floats",
        ),
        (&[Image { format: u32::MAX, ..color }, output], input, "the image 'color' has the format "),
        (
            &[of(vk::Format::R32G32_SFLOAT, color), output],
            input,
            "the image 'color' has 2 channels; 3 are needed",
        ),
        (
            &[color, output, named(c"normal", vk::Format::R8G8B8A8_UNORM, other(color))],
            input,
            "the image 'normal' must have signed or floating samples",
        ),
        (
            &[color, output, named(c"depth", vk::Format::R16_UNORM, other(color))],
            input,
            "the image 'depth' must have floating samples",
        ),
        (
            &[color, of(vk::Format::R8G8B8A8_UINT, output)],
            input,
            "the image 'output' has the format R8G8B8A8_UINT, which holds no colours",
        ),
        (
            &[color, Image { usage: vk::ImageUsageFlags::STORAGE.as_raw(), ..output }],
            input,
            "the image 'output' was created without VK_IMAGE_USAGE_TRANSFER_DST_BIT",
        ),
    ];
    let commands = host.commands();
    for (images, expected, words) in cases {
        let status = studio.record(effect, commands, images, 2);
        let message = studio.error(effect);
        assert!(message.starts_with(words), "{message} does not begin with {words}");
        assert_eq!(status, *expected, "{message}");
    }
    assert_eq!(studio.record(effect, commands, &[color, output], 1), argument);
    assert_eq!(studio.error(effect), "the timeline stands at 1 already; the value must be above, not 1");
    // Nothing was recorded, and the effect goes on.
    assert_eq!(studio.record(effect, commands, &[color, output], 2), ISOPHOTE_OK);
    host.execute(commands, 2);
}
