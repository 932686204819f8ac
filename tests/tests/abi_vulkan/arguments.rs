//! Arguments that hosts may hand in wrongly: each is a status with words.

use super::faults;
use super::host::Host;
use super::studio::{SIZE, Studio, create, images, load, with_message};
use ash::vk;
use isophote_abi::*;
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
    let status = unsafe { (table.needs)(vk::API_VERSION_1_2, null_mut(), null_mut()) };
    assert_eq!(status, ISOPHOTE_ERROR_INVALID_ARGUMENT);
}

/// Calls of `create` that are refused: with which status, and how the message begins.
fn assert_refused(table: &IsophoteVulkanApi, cases: &[(IsophoteVulkanHost, IsophoteStatus, &str)]) {
    for (shown, expected, words) in cases {
        let (status, message, vulkan) = create(table, shown);
        assert!(message.starts_with(words), "{message} does not begin with {words}");
        assert_eq!((status, vulkan.id), (*expected, 0), "{message}");
    }
}

#[test]
fn what_a_device_lacks_is_named() {
    use IsophoteVulkanHost as Shown;
    let Some(host) = Host::new("what_a_device_lacks_is_named") else { return };
    let (_library, table) = load();
    let own = host.shown();
    let names: [*const c_char; 1] = [c"VK_KHR_swapchain".as_ptr()];
    let old =
        Shown { api_version: vk::API_VERSION_1_1, extension_count: 1, extensions: names.as_ptr(), ..own };
    let lacking = [
        (
            Shown { features: 0, ..own },
            "the device was created without the feature shaderStorageImageExtendedFormats and the feature \
             timelineSemaphore; enable what `needs` names",
        ),
        (
            old,
            "the device was created without the extension VK_KHR_timeline_semaphore; enable what `needs` names",
        ),
        (Shown { api_version: 0, ..own }, "Vulkan 0.0 is too old; "),
        (Shown { queue_family: 99, ..own }, "the graphics device '"),
    ];
    assert_refused(table, &lacking.map(|(shown, words)| (shown, ISOPHOTE_ERROR_UNSUPPORTED, words)));
    let nulls = [
        (Shown { get_instance_proc_addr: None, ..own }, "get_instance_proc_addr is null"),
        (Shown { instance: null_mut(), ..own }, "the instance is null"),
        (Shown { physical_device: null_mut(), ..own }, "the physical device is null"),
        (Shown { device: null_mut(), ..own }, "the device is null"),
        (Shown { timeline: 0, ..own }, "the timeline is null"),
        (Shown { extensions: null(), ..old }, "the list of extensions is null"),
    ];
    assert_refused(table, &nulls.map(|(shown, words)| (shown, ISOPHOTE_ERROR_INVALID_ARGUMENT, words)));
    // SAFETY: null is what must not matter.
    unsafe {
        assert_eq!((table.create)(null(), null_mut(), null_mut()), ISOPHOTE_ERROR_INVALID_ARGUMENT);
        assert_eq!((table.create)(&raw const own, null_mut(), null_mut()), ISOPHOTE_ERROR_INVALID_ARGUMENT);
    }
}

#[test]
fn functions_that_a_loader_lacks_are_named() {
    let Some(host) = Host::new("functions_that_a_loader_lacks_are_named") else { return };
    let (_library, table) = load();
    let lacking = [
        "vkGetDeviceProcAddr",
        "vkGetPhysicalDeviceProperties",
        "vkCmdDispatch",
        "vkGetSemaphoreCounterValue",
    ];
    for name in lacking {
        faults::hide(name);
        let words = format!("get_instance_proc_addr finds no {name}");
        assert_refused(table, &[(host.shown(), ISOPHOTE_ERROR_INVALID_ARGUMENT, &words)]);
    }
    faults::hide("");
    assert_eq!(create(table, &host.shown()).0, ISOPHOTE_OK);
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

type Image = IsophoteVulkanImage;

/// Recordings of a colour and a result that are refused: with which status, and how the message begins.
fn assert_recordings_refused(
    test: &str,
    cases: impl FnOnce(Image, Image) -> Vec<(Vec<Image>, IsophoteStatus, &'static str)>,
) {
    let Some(host) = Host::new(test) else { return };
    let studio = Studio::new(&host, c"gaussian");
    let effect = studio.effect(SIZE);
    let [color, output] = images(&host);
    let commands = host.commands();
    for (images, expected, words) in cases(color, output) {
        let status = studio.record(effect, commands, &images, 2);
        let message = studio.error(effect);
        assert!(message.starts_with(words), "{message} does not begin with {words}");
        assert_eq!(status, expected, "{message}");
    }
    // Nothing was recorded, and the effect goes on.
    assert_eq!(studio.record(effect, commands, &[color, output], 2), ISOPHOTE_OK);
    host.execute(commands, 2);
    assert_eq!(studio.submit(effect, &[color, output], 2), ISOPHOTE_ERROR_INVALID_ARGUMENT);
    let late = "the timeline stands at 2 already; the value must be above, not 2";
    assert_eq!(studio.error(effect), late);
}

#[test]
fn images_that_are_missing_or_doubled_are_refused_by_name() {
    let test = "images_that_are_missing_or_doubled_are_refused_by_name";
    assert_recordings_refused(test, |color, output| {
        let (argument, input) = (ISOPHOTE_ERROR_INVALID_ARGUMENT, ISOPHOTE_ERROR_INPUT);
        let same = Image { name: output.name, ..color };
        vec![
            (vec![color], input, "the image 'output' is missing"),
            (vec![output], input, "the image 'color' is missing"),
            (vec![color, color, output], argument, "the image 'color' is given twice"),
            (vec![color, same], argument, "the images 'color' and 'output' are the same"),
            (vec![color; 17], argument, "17 images are more than any graph has; give at most 16"),
            (vec![Image { name: null(), ..color }, output], argument, "the input's name is null"),
            (vec![Image { name: c"colour".as_ptr(), ..color }, output], ISOPHOTE_ERROR_UNKNOWN, ""),
            (vec![Image { image: 0, ..color }, output], argument, "the image 'color' or its view is null"),
            (vec![Image { view: 0, ..color }, output], argument, "the image 'color' or its view is null"),
        ]
    });
}

#[test]
fn images_that_cannot_be_used_are_refused_by_name() {
    let test = "images_that_cannot_be_used_are_refused_by_name";
    assert_recordings_refused(test, |color, output| {
        let (input, geometry) = (ISOPHOTE_ERROR_INPUT, ISOPHOTE_ERROR_GEOMETRY);
        let layout = vk::ImageLayout::UNDEFINED.as_raw().cast_unsigned();
        let no_layout = "the image 'color' is in the undefined layout, in which it shows nothing";
        let no_sampling = "the image 'color' was created without VK_IMAGE_USAGE_SAMPLED_BIT";
        let no_blits = "the image 'output' was created without VK_IMAGE_USAGE_TRANSFER_DST_BIT";
        let (narrow, low) = (Image { width: 32, ..color }, Image { height: 20, ..output });
        let kept = Image { layout_after: layout, ..color };
        let stored = Image { usage: vk::ImageUsageFlags::STORAGE.as_raw(), ..output };
        vec![
            (vec![Image { layout_before: layout, ..color }, output], input, no_layout),
            (vec![Image { usage: 0, ..color }, output], input, no_sampling),
            (vec![color, stored], input, no_blits),
            (vec![narrow, output], geometry, "the image 'color' has 32x21 texels; 33x21 are needed"),
            (vec![color, low], geometry, "the image 'output' has 33x20 texels; 33x21 are needed"),
            (
                vec![kept, output],
                ISOPHOTE_ERROR_INVALID_ARGUMENT,
                "the image 'color' cannot be left in UNDEFINED",
            ),
        ]
    });
}

#[test]
fn formats_that_do_not_do_are_refused_by_name() {
    use vk::Format as F;
    assert_recordings_refused("formats_that_do_not_do_are_refused_by_name", |color, output| {
        let of = |format: F, image: Image| Image { format: format.as_raw().cast_unsigned(), ..image };
        // Another image, which is not looked at before its format is.
        let guide =
            |name: &'static CStr, format| Image { name: name.as_ptr(), image: 9, ..of(format, color) };
        let integers = "the image 'color' has the format R8G8B8A8_UINT, which is not read as floats";
        let colourless = "the image 'output' has the format R8G8B8A8_UINT, which holds no colours";
        let (normal, depth) = (guide(c"normal", F::R8G8B8A8_UNORM), guide(c"depth", F::R16_UNORM));
        let cases = vec![
            (vec![of(F::R8G8B8A8_UINT, color), output], integers),
            (vec![Image { format: u32::MAX, ..color }, output], "the image 'color' has the format "),
            (vec![of(F::R32G32_SFLOAT, color), output], "the image 'color' has 2 channels; 3 are needed"),
            (vec![color, output, normal], "the image 'normal' must have signed or floating samples"),
            (vec![color, output, depth], "the image 'depth' must have floating samples"),
            (vec![color, of(F::R8G8B8A8_UINT, output)], colourless),
        ];
        cases.into_iter().map(|(images, words)| (images, ISOPHOTE_ERROR_INPUT, words)).collect()
    });
}
