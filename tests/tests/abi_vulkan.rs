//! Filters on a Vulkan device of the host's, through the C table: what hosts get wrong, what drivers refuse, and what is
//! promised of memory. `tests/c/vulkan_host.c` compares pixels.

#![allow(unsafe_code, reason = "calls through the C table and of Vulkan")]

mod arguments;
mod faults;
mod host;
mod studio;

use ash::vk::{self, Handle};
use host::Host;
use isophote_abi::*;
use std::ffi::c_void;
use std::ptr::null_mut;
use std::sync::atomic::{AtomicI32, Ordering};
use studio::{FLOATS, READ, SIZE, STORED, Studio, image, images, output};

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
fn colours_in_half_precision_are_written_directly_and_blitted() {
    let Some(host) = Host::new("colours_in_half_precision_are_written_directly_and_blitted") else { return };
    let studio = Studio::new(&host, c"cartoon");
    let half = host.picture(vk::Format::R16G16B16A16_SFLOAT, STORED, SIZE);
    host.fill(&half, [0.2, 0.4, 0.6, 1.0], READ, 1);
    let color = image(c"color", &half, [READ, READ]);
    let written = host.picture(vk::Format::R16G16B16A16_SFLOAT, STORED, SIZE);
    let written = image(c"output", &written, [vk::ImageLayout::UNDEFINED, vk::ImageLayout::GENERAL]);
    let blitted = host.picture(FLOATS, STORED, SIZE);
    let layouts = [vk::ImageLayout::UNDEFINED, vk::ImageLayout::TRANSFER_SRC_OPTIMAL];
    let effect = studio.effect(SIZE);
    let mut value = 1;
    for precision in [ISOPHOTE_PRECISION_HALF, ISOPHOTE_PRECISION_FAST, ISOPHOTE_PRECISION_EXACT] {
        studio.set_precision(precision);
        assert_eq!(studio.update(effect, None), (ISOPHOTE_OK, ISOPHOTE_CHANGE_STRUCTURE));
        for output in [written, image(c"output", &blitted, layouts)] {
            value += 1;
            assert_eq!(
                studio.submit(effect, &[color, output], value),
                ISOPHOTE_OK,
                "{}",
                studio.error(effect)
            );
            host.wait(value);
        }
        value += 1;
        for texel in host.read(&blitted, value) {
            let is_near =
                texel.iter().zip([0.2, 0.4, 0.6, 1.0]).all(|(a, b): (&f32, f32)| (a - b).abs() < 0.1);
            assert!(is_near, "{texel:?}");
        }
    }
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
fn a_device_of_vulkan_1_1_and_a_pipeline_cache_will_do() {
    let version = vk::API_VERSION_1_1;
    let Some(host) = Host::of_version(version, "a_device_of_vulkan_1_1_and_a_pipeline_cache_will_do") else {
        return;
    };
    let empty = vk::PipelineCacheCreateInfo::default();
    // SAFETY: the device is alive.
    let cache = unsafe { host.device.create_pipeline_cache(&empty, None) }.unwrap();
    let shown = IsophoteVulkanHost { pipeline_cache: cache.as_raw(), ..host.shown() };
    let studio = Studio::on(&shown, c"gaussian");
    let (images, effect) = (images(&host), studio.effect(SIZE));
    assert_eq!(faults::cache(), cache.as_raw());
    for value in 2..6 {
        assert_eq!(studio.submit(effect, &images, value), ISOPHOTE_OK, "{}", studio.error(effect));
    }
    host.wait(5);
    // SAFETY: as above; all has been executed.
    unsafe {
        assert_eq!((studio.table.destroy)(studio.vulkan), ISOPHOTE_OK);
        host.device.destroy_pipeline_cache(cache, None);
    }
}

#[test]
fn threads_record_effects_at_the_same_time() {
    let Some(host) = Host::new("threads_record_effects_at_the_same_time") else { return };
    let studio = Studio::on(&host.shown_to_all(), c"quantize_luminance");
    let color = host.picture(FLOATS, STORED, SIZE);
    host.fill(&color, [0.2, 0.4, 0.6, 1.0], READ, 1);
    let (host, studio) = (&host, &studio);
    let recorded = std::thread::scope(|scope| {
        let threads = [(); 3].map(|()| {
            scope.spawn(move || {
                let images = [image(c"color", &color, [READ, READ]), output(host)];
                let (effect, pool) = (studio.effect(SIZE), host.pool());
                let commands = host.commands_of(pool);
                for _ in 0..40 {
                    assert_eq!(studio.update(effect, None), (ISOPHOTE_OK, ISOPHOTE_CHANGE_UNIFORMS));
                    assert_eq!(
                        studio.record(effect, commands, &images, 9),
                        ISOPHOTE_OK,
                        "{}",
                        studio.error(effect)
                    );
                }
                (pool, commands)
            })
        });
        threads.map(|thread| thread.join().unwrap())
    });
    for ((pool, commands), value) in recorded.into_iter().zip(7..) {
        host.execute(commands, value);
        // SAFETY: its commands have been executed.
        unsafe { host.device.destroy_command_pool(pool, None) };
    }
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
    let user = 41 as *mut c_void;
    let shown =
        IsophoteVulkanHost { user, lock_queue: Some(lock), unlock_queue: Some(unlock), ..host.shown() };
    let studio = Studio::on(&shown, c"gaussian");
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

    let studio = Studio::on(&IsophoteVulkanHost { queue: null_mut(), ..shown }, c"gaussian");
    let effect = studio.effect(SIZE);
    assert_eq!(studio.submit(effect, &images, 4), ISOPHOTE_ERROR_INVALID_ARGUMENT);
    assert_eq!(studio.error(effect), "the Vulkan object was made without a queue; give it one, or record");
    assert_eq!(faults::submissions(), 1);
}
