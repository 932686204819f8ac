//! Filters on a Vulkan device of the host's, through the C table: what hosts get wrong, what drivers refuse, and what is
//! promised of memory. `tests/c/vulkan_host.c` compares pixels.

#![allow(unsafe_code, reason = "calls through the C table and of Vulkan")]

#[path = "abi_vulkan/faults.rs"]
mod faults;
#[path = "abi_vulkan/host.rs"]
mod host;
#[path = "abi_vulkan/studio.rs"]
mod studio;

use ash::vk;
use host::Host;
use isophote_tests::library::contract::*;
use std::ffi::{CStr, c_char, c_void};
use std::ptr::{null, null_mut};
use std::sync::atomic::{AtomicI32, Ordering};
use studio::{FLOATS, SIZE, STORED, Studio, create, image, images, load, with_message};

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
            IsophoteVulkanHost { api_version: vk::API_VERSION_1_1, extension_count: 1, ..shown },
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

#[test]
fn only_the_picture_is_written_in_a_larger_image() {
    let Some(host) = Host::new("only_the_picture_is_written_in_a_larger_image") else { return };
    let studio = Studio::new(&host, c"gaussian");
    let [color, _] = images(&host);
    let (larger, mark) = ([40, 30], [9.0, 8.0, 7.0, 6.0]);
    let effect = studio.effect(SIZE);
    let mut value = 1;
    for usage in [STORED, vk::ImageUsageFlags::TRANSFER_SRC | vk::ImageUsageFlags::TRANSFER_DST] {
        let output = host.picture(FLOATS, usage, larger);
        let [before, after] = [vk::ImageLayout::GENERAL, vk::ImageLayout::TRANSFER_SRC_OPTIMAL];
        host.fill(&output, mark, before, value + 1);
        assert_eq!(
            studio.submit(effect, &[color, image(c"output", &output, [before, after])], value + 2),
            ISOPHOTE_OK
        );
        host.wait(value + 2);
        for (index, texel) in (0..).zip(host.read(&output, value + 3)) {
            let (x, y) = (index % larger[0], index / larger[0]);
            if x < SIZE[0] && y < SIZE[1] {
                let wanted = [0.2, 0.4, 0.6, 1.0];
                let is_near = texel.iter().zip(wanted).all(|(a, b): (&f32, f32)| (a - b).abs() < 1e-4);
                assert!(is_near, "{texel:?} at ({x}, {y})");
            } else {
                assert_eq!(texel, mark, "at ({x}, {y})");
            }
        }
        value += 3;
    }
}

#[test]
fn an_object_takes_what_its_effects_hold_with_it() {
    let Some(host) = Host::new("an_object_takes_what_its_effects_hold_with_it") else { return };
    let studio = Studio::new(&host, c"gaussian");
    let images = images(&host);
    let effects = [(); 3].map(|()| studio.effect(SIZE));
    assert_eq!(studio.submit(effects[0], &images, 2), ISOPHOTE_OK);
    // SAFETY: handles may be destroyed at any time.
    assert_eq!(unsafe { (studio.table.effect_destroy)(effects[0]) }, ISOPHOTE_OK);
    host.wait(2);
    // SAFETY: as above; all has been executed.
    assert_eq!(unsafe { (studio.table.destroy)(studio.vulkan) }, ISOPHOTE_OK);
    assert_eq!(studio.submit(effects[1], &images, 3), ISOPHOTE_ERROR_INVALID_HANDLE);
    assert_eq!(
        studio.error(effects[1]),
        "the Vulkan object of the effect was destroyed; destroy the effect, too"
    );
    assert_eq!(studio.update(effects[2], None).0, ISOPHOTE_ERROR_INVALID_HANDLE);
    assert_eq!(studio.effect_of(SIZE).0, ISOPHOTE_ERROR_INVALID_HANDLE);
    for effect in &effects[1..] {
        // SAFETY: as above.
        assert_eq!(unsafe { (studio.table.effect_destroy)(*effect) }, ISOPHOTE_OK);
    }
}

#[test]
fn what_a_driver_refuses_leaves_everything_as_it_was() {
    let Some(host) = Host::new("what_a_driver_refuses_leaves_everything_as_it_was") else { return };
    let studio = Studio::new(&host, c"quantize_luminance");
    let images = images(&host);
    let before = faults::made();
    let mut count = 0;
    // Each object that is made is refused once, until none is left to refuse.
    let effect = loop {
        faults::refuse_after(Some(count));
        let (status, message, effect) = studio.effect_of(SIZE);
        if status == ISOPHOTE_OK {
            break effect;
        }
        assert_eq!((status, effect.id), (ISOPHOTE_ERROR_OUT_OF_MEMORY, 0), "{message}");
        assert!(
            message.ends_with("the graphics device is out of memory; use a smaller picture"),
            "{message}"
        );
        count += 1;
    };
    // Shaders that were compiled once stay.
    assert!(count > 5 && faults::made() > before, "{count}");
    let larger = studio.request([SIZE[0] - 1, SIZE[1]]);
    let mut value = 1;
    let mut refusals = [0; 2];
    for (index, mut is_done) in [false; 2].into_iter().enumerate() {
        while !is_done {
            faults::refuse_after(Some(refusals[index]));
            let status = match index {
                0 => studio.update(effect, Some(larger)).0,
                _ => studio.submit(effect, &images, value + 1),
            };
            is_done = status == ISOPHOTE_OK;
            refusals[index] += u32::from(!is_done);
            if index == 0 && !is_done {
                assert_eq!(status, ISOPHOTE_ERROR_OUT_OF_MEMORY, "{}", studio.error(effect));
                // The effect is as it was.
                faults::refuse_after(None);
                value += 1;
                assert_eq!(studio.submit(effect, &images, value), ISOPHOTE_OK, "{}", studio.error(effect));
                host.wait(value);
            }
        }
    }
    faults::refuse_after(None);
    assert!(refusals[0] > 1 && refusals[1] > 1, "{refusals:?}");
    host.wait(value + 1);
}

#[test]
fn a_lost_device_is_a_status_and_can_be_left() {
    let Some(host) = Host::new("a_lost_device_is_a_status_and_can_be_left") else { return };
    let studio = Studio::new(&host, c"gaussian");
    let images = images(&host);
    let effect = studio.effect(SIZE);
    assert_eq!(studio.submit(effect, &images, 2), ISOPHOTE_OK);
    host.wait(2);
    faults::lose(true);
    assert_eq!(studio.submit(effect, &images, 3), ISOPHOTE_ERROR_DEVICE);
    let message = studio.error(effect);
    assert!(message.contains("the graphics device is lost; destroy what was made on it"), "{message}");
    assert_eq!(studio.update(effect, None).0, ISOPHOTE_ERROR_DEVICE);
    assert_eq!(studio.effect_of(SIZE).0, ISOPHOTE_ERROR_DEVICE);
    // SAFETY: handles may be destroyed at any time.
    unsafe {
        assert_eq!((studio.table.effect_destroy)(effect), ISOPHOTE_OK);
        assert_eq!((studio.table.destroy)(studio.vulkan), ISOPHOTE_OK);
    }
    faults::lose(false);
}

#[test]
fn frames_with_other_parameters_make_no_objects() {
    let Some(host) = Host::new("frames_with_other_parameters_make_no_objects") else { return };
    let studio = Studio::new(&host, c"gaussian");
    let images = images(&host);
    let effect = studio.effect(SIZE);
    let mut made = 0;
    for value in 2..40_u32 {
        studio.set(c"sigma", 1.0 + f64::from(value) * 0.02);
        assert_eq!(studio.update(effect, None), (ISOPHOTE_OK, ISOPHOTE_CHANGE_UNIFORMS));
        assert_eq!(studio.submit(effect, &images, value.into()), ISOPHOTE_OK, "{}", studio.error(effect));
        if value == 3 {
            made = faults::made();
        }
        host.wait(value.into());
    }
    assert!(made > 0);
    assert_eq!(faults::made(), made);
}

#[test]
fn recordings_outlive_updates_and_their_effect() {
    let Some(host) = Host::new("recordings_outlive_updates_and_their_effect") else { return };
    let studio = Studio::new(&host, c"gaussian");
    let images = images(&host);
    let effect = studio.effect(SIZE);
    let commands = host.commands();
    assert_eq!(studio.record(effect, commands, &images, 2), ISOPHOTE_OK, "{}", studio.error(effect));
    let smaller = studio.request([SIZE[0] - 2, SIZE[1]]);
    assert_eq!(studio.update(effect, Some(smaller)), (ISOPHOTE_OK, ISOPHOTE_CHANGE_STRUCTURE));
    assert_eq!(studio.record(effect, commands, &images, 3), ISOPHOTE_OK, "{}", studio.error(effect));
    // SAFETY: handles may be destroyed at any time.
    assert_eq!(unsafe { (studio.table.effect_destroy)(effect) }, ISOPHOTE_OK);
    host.execute(commands, 3);
}

#[test]
fn recordings_in_flight_are_bounded() {
    let Some(host) = Host::new("recordings_in_flight_are_bounded") else { return };
    let studio = Studio::new(&host, c"gaussian");
    let images = images(&host);
    let effect = studio.effect(SIZE);
    let commands = host.commands();
    for _ in 0..ISOPHOTE_VULKAN_MOST_IN_FLIGHT {
        assert_eq!(studio.record(effect, commands, &images, 2), ISOPHOTE_OK, "{}", studio.error(effect));
    }
    assert_eq!(studio.record(effect, commands, &images, 2), ISOPHOTE_ERROR_OUT_OF_MEMORY);
    assert_eq!(
        studio.error(effect),
        "64 recordings of the effect wait to be executed; the timeline stands at 1"
    );
    host.execute(commands, 2);
    let commands = host.commands();
    assert_eq!(studio.record(effect, commands, &images, 3), ISOPHOTE_OK);
    host.execute(commands, 3);
}

static LOCKED: AtomicI32 = AtomicI32::new(0);
static LOCKS: AtomicI32 = AtomicI32::new(0);

unsafe extern "C" fn lock(user: *mut c_void) {
    assert_eq!(user as usize, 41);
    assert_eq!(LOCKED.fetch_add(1, Ordering::SeqCst), 0);
    LOCKS.fetch_add(1, Ordering::SeqCst);
}

unsafe extern "C" fn unlock(user: *mut c_void) {
    assert_eq!(user as usize, 41);
    assert_eq!(LOCKED.fetch_sub(1, Ordering::SeqCst), 1);
}

#[test]
fn the_queue_is_touched_by_submissions_alone_and_under_its_lock() {
    let Some(host) = Host::new("the_queue_is_touched_by_submissions_alone_and_under_its_lock") else {
        return;
    };
    let mut studio = Studio::new(&host, c"gaussian");
    // SAFETY: nothing was made with it.
    assert_eq!(unsafe { (studio.table.destroy)(studio.vulkan) }, ISOPHOTE_OK);
    let user = 41 as *mut c_void;
    let shown =
        IsophoteVulkanHost { user, lock_queue: Some(lock), unlock_queue: Some(unlock), ..host.shown() };
    let (status, message, vulkan) = create(studio.table, &shown);
    assert_eq!(status, ISOPHOTE_OK, "{message}");
    studio.vulkan = vulkan;
    let images = images(&host);
    let effect = studio.effect(SIZE);
    let commands = host.commands();
    assert_eq!(studio.record(effect, commands, &images, 2), ISOPHOTE_OK);
    assert_eq!((LOCKS.load(Ordering::SeqCst), faults::submissions()), (0, 0));
    host.execute(commands, 2);
    assert_eq!(studio.submit(effect, &images, 3), ISOPHOTE_OK);
    host.wait(3);
    assert_eq!(
        (LOCKS.load(Ordering::SeqCst), LOCKED.load(Ordering::SeqCst), faults::submissions()),
        (1, 0, 1)
    );

    let (status, message, silent) = create(studio.table, &IsophoteVulkanHost { queue: null_mut(), ..shown });
    assert_eq!(status, ISOPHOTE_OK, "{message}");
    // SAFETY: nothing is executed any more.
    assert_eq!(unsafe { (studio.table.destroy)(studio.vulkan) }, ISOPHOTE_OK);
    studio.vulkan = silent;
    let effect = studio.effect(SIZE);
    assert_eq!(studio.submit(effect, &images, 4), ISOPHOTE_ERROR_INVALID_ARGUMENT);
    assert_eq!(studio.error(effect), "the Vulkan object was made without a queue; give it one, or record");
    assert_eq!(faults::submissions(), 1);
}
