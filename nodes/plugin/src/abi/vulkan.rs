//! The extension for Vulkan devices of hosts' own: graphs are recorded there, from and to the hosts' images.
//!
//! Nothing here waits for the GPU or submits by itself. [`device`] is the host's device, [`objects`] what is made on it,
//! [`context`] what effects share, [`images`] what hosts hand in, [`passes`] a program made ready, [`mod@record`] its commands,
//! and [`effect`] all of a graph.

mod context;
mod device;
mod effect;
mod images;
mod objects;
mod passes;
mod record;

use super::args;
use super::failure::{Failure, Outcome};
use super::guard::{self, lock};
use super::handles::{Object, object};
use super::objects::GraphObject;
use super::plan;
use super::request;
use ash::vk::{self, Handle};
use context::Context;
use device::Device;
use effect::Effect;
use isophote_abi::*;
use std::ffi::{CStr, c_void};
use std::sync::{Arc, Mutex, Weak};

/// Name of the extension.
pub const EXTENSION: &CStr = c"isophote.vulkan/1";

/// The functions of the extension.
pub static API: IsophoteVulkanApi = IsophoteVulkanApi {
    struct_size: size_of::<IsophoteVulkanApi>() as u32,
    needs,
    create,
    destroy,
    effect_create,
    effect_destroy,
    effect_error,
    effect_update,
    record,
    submit,
};

/// Most semaphores of a submission.
const MOST_SEMAPHORES: u32 = 64;

/// Effect behind a handle; nothing once its device's object was destroyed.
type EffectSlot = Mutex<Option<Effect>>;

/// A Vulkan device of a host's.
pub struct VulkanObject {
    context: Arc<Context>,
    effects: Mutex<Vec<Weak<EffectSlot>>>,
    message: Mutex<String>,
}

object!(VulkanObject, IsophoteVulkan, 5, "Vulkan object");

/// An effect of a host's.
pub struct EffectObject {
    context: Arc<Context>,
    slot: Arc<EffectSlot>,
    message: Mutex<String>,
}

object!(EffectObject, IsophoteVulkanEffect, 6, "Vulkan effect");

impl EffectObject {
    /// Does something with the effect, while its device's object cannot be destroyed.
    fn with<T>(&self, body: impl FnOnce(&mut Effect) -> Outcome<T>) -> Outcome<T> {
        let _alive = self.context.enter()?;
        let mut slot = lock(&self.slot);
        let Some(effect) = slot.as_mut() else {
            return Err(Failure::new(ISOPHOTE_ERROR_INVALID_HANDLE, "the Vulkan effect was destroyed"));
        };
        body(effect)
    }
}

unsafe extern "C" fn needs(
    api_version: u32,
    error: *mut IsophoteText,
    needs: *mut IsophoteVulkanNeeds,
) -> IsophoteStatus {
    guard::call(
        // SAFETY: the host promised that the place may be written.
        || unsafe { args::put(needs, device::needs(api_version)?, "the place for the needs") },
        // SAFETY: as above.
        |message| unsafe { args::fill_message(error, message) },
    )
}

unsafe extern "C" fn create(
    host: *const IsophoteVulkanHost,
    error: *mut IsophoteText,
    vulkan: *mut IsophoteVulkan,
) -> IsophoteStatus {
    let make = || {
        // SAFETY: the host promised a struct behind the pointer, and living objects in it.
        let device = unsafe { Device::new(&args::get(host, "the host's device")?)? };
        let context = Arc::new(Context::new(device));
        Ok(VulkanObject { context, effects: Mutex::default(), message: Mutex::default() })
    };
    // SAFETY: the host promised that both places may be written.
    unsafe { guard::create(vulkan, error, make) }
}

unsafe extern "C" fn destroy(vulkan: IsophoteVulkan) -> IsophoteStatus {
    guard::call(
        || {
            let object = VulkanObject::slots().remove(vulkan.id)?;
            object.context.end(|| {
                for slot in lock(&object.effects).iter().filter_map(Weak::upgrade) {
                    let effect = lock(&slot).take();
                    drop(effect);
                }
            });
            Ok(())
        },
        |_| {},
    )
}

unsafe extern "C" fn effect_create(
    vulkan: IsophoteVulkan,
    graph: IsophoteGraph,
    host_request: *const IsophoteRequest,
    error: *mut IsophoteText,
    effect: *mut IsophoteVulkanEffect,
) -> IsophoteStatus {
    let make = || {
        let object = VulkanObject::slots().get(vulkan.id)?;
        let graph = GraphObject::slots().get(graph.id)?.snapshot();
        // SAFETY: the host promised a request behind the pointer.
        let request = request::request(&unsafe { args::get(host_request, "the request")? })?;
        let context = Arc::clone(&object.context);
        let alive = context.enter()?;
        let slot = Arc::new(Mutex::new(Some(Effect::new(&context, graph, request)?)));
        let mut effects = lock(&object.effects);
        effects.retain(|slot| slot.strong_count() > 0);
        effects.push(Arc::downgrade(&slot));
        drop(effects);
        drop(alive);
        Ok(EffectObject { context, slot, message: Mutex::default() })
    };
    // SAFETY: the host promised that both places may be written.
    unsafe { guard::create(effect, error, make) }
}

unsafe extern "C" fn effect_destroy(effect: IsophoteVulkanEffect) -> IsophoteStatus {
    guard::call(
        || {
            let object = EffectObject::slots().remove(effect.id)?;
            // One whose device's object is gone holds nothing any more.
            if let Ok(_alive) = object.context.enter() {
                let effect = lock(&object.slot).take();
                if let Some(effect) = effect {
                    effect.retire();
                }
                // What can be destroyed is; a device that is lost tells nothing, and is asked again at its end.
                let _ = object.context.advance();
            }
            Ok(())
        },
        |_| {},
    )
}

unsafe extern "C" fn effect_error(effect: IsophoteVulkanEffect, text: *mut IsophoteText) -> IsophoteStatus {
    // SAFETY: the host promised that the text may be written.
    unsafe { guard::last_message::<EffectObject>(effect, text) }
}

unsafe extern "C" fn effect_update(
    effect: IsophoteVulkanEffect,
    graph: IsophoteGraph,
    host_request: *const IsophoteRequest,
    change: *mut IsophoteChange,
) -> IsophoteStatus {
    guard::on::<EffectObject>(effect, |object| {
        let update = |graph, request| {
            let found = object.with(|effect| effect.update(graph, request))?;
            Ok(plan::change_number(found))
        };
        // SAFETY: the host promised a request behind the pointer, and that the place may be written.
        unsafe { plan::updated(graph, host_request, change, update) }
    })
}

unsafe extern "C" fn record(
    effect: IsophoteVulkanEffect,
    command_buffer: *mut c_void,
    host_images: *const IsophoteVulkanImage,
    image_count: u32,
    value: u64,
) -> IsophoteStatus {
    guard::on::<EffectObject>(effect, |object| {
        if command_buffer.is_null() {
            return Err(Failure::argument("the command buffer is null"));
        }
        // SAFETY: the host promised so many images, and text in them.
        let images = unsafe { images::read(host_images, image_count)? };
        let commands = vk::CommandBuffer::from_raw(command_buffer as u64);
        object.with(|effect| effect.record(commands, &images, value))
    })
}

unsafe extern "C" fn submit(
    effect: IsophoteVulkanEffect,
    host_images: *const IsophoteVulkanImage,
    image_count: u32,
    waits: *const IsophoteVulkanSemaphore,
    wait_count: u32,
    signals: *const IsophoteVulkanSemaphore,
    signal_count: u32,
    value: u64,
) -> IsophoteStatus {
    guard::on::<EffectObject>(effect, |object| {
        // SAFETY: the host promised so many images and semaphores, and text in the images.
        let (images, waits, signals) = unsafe {
            let images = images::read(host_images, image_count)?;
            (images, semaphores(waits, wait_count)?, semaphores(signals, signal_count)?)
        };
        object.with(|effect| effect.submit(&images, &waits, &signals, value))
    })
}

/// A list of the host's.
///
/// # Safety
/// `list` is null or points to `count` semaphores.
unsafe fn semaphores(
    list: *const IsophoteVulkanSemaphore,
    count: u32,
) -> Outcome<Vec<IsophoteVulkanSemaphore>> {
    if count > MOST_SEMAPHORES {
        let message = format!("{count} semaphores are too many; give at most {MOST_SEMAPHORES}");
        return Err(Failure::argument(message));
    }
    let mut read = Vec::new();
    for index in 0..count as usize {
        // SAFETY: as the caller promised.
        let semaphore = unsafe { args::get(list.wrapping_add(index), "the list of semaphores")? };
        if semaphore.semaphore == 0 {
            return Err(Failure::argument("a semaphore is null"));
        }
        read.push(semaphore);
    }
    Ok(read)
}
