//! Graphics cards that fail: lost, without memory, not there, or in a process that was forked. The CPU computes the frame.

use crate::small::{SIZE, picture};
use isophote_abi::openfx::*;
use isophote_tests::ofx::effect::{Described, Instance, Wanted};
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::Layout;
use isophote_tests::ofx::plugin::{Binary, Plugin};
use isophote_tests::ofx::state::Behaviour;
use isophote_tests::{device, library};
use std::ptr::null_mut;

/// Words of drivers and of wgpu for a device that is lost.
const LOST: [&str; 2] = ["lost", "destroyed"];

/// Fault that the device is to have.
fn ask(fault: Option<&str>) {
    set("ISOPHOTE_OFX_DEVICE", fault);
}

fn set(name: &str, value: Option<&str>) {
    // SAFETY: no other test runs in this process, and no other thread reads the environment now.
    unsafe {
        match value {
            Some(value) => std::env::set_var(name, value),
            None => std::env::remove_var(name),
        }
    }
}

/// A host of one thread, and an effect.
fn prepare(binary: &Binary) -> (Host, Plugin) {
    let host = Host::new(Behaviour { processors: 1, ..Behaviour::default() });
    (host, binary.plugin("org.isophote.gaussian"))
}

fn instance<'h>(host: &'h Host, plugin: Plugin) -> Instance<'h> {
    let instance = Described::new(host, plugin).instance(kOfxImageEffectContextFilter);
    instance.connect("Source", picture(Layout::default()));
    // Its frames are others than those of the CPU.
    instance.set("precision", 1);
    instance
}

/// A frame on the CPU, or on the card.
fn render(instance: &Instance<'_>, card: bool) -> Vec<u8> {
    instance.set("compute_on", i32::from(card));
    let (status, picture) =
        instance.try_render(Layout::default(), [SIZE; 2], &Wanted::new([0, 0, SIZE, SIZE]));
    assert_eq!(status, kOfxStatOK);
    picture.packed()
}

fn messages(host: &Host) -> Vec<String> {
    host.inner.messages.lock().unwrap().clone()
}

/// Holds when there is one message, which says why, in one of some words.
fn says(host: &Host, why: &[&str]) {
    let said = messages(host);
    assert!(
        said.len() == 1
            && said[0].starts_with("The CPU computes here. ")
            && why.iter().any(|why| said[0].contains(why)),
        "{said:?}"
    );
}

fn purge(plugin: Plugin) {
    assert_eq!(plugin.act(kOfxActionPurgeCaches, null_mut(), None, None), kOfxStatOK);
}

pub fn a_card_that_is_lost_is_opened_anew_but_not_for_ever() {
    if !cfg!(debug_assertions) || device::device("a card that is lost").is_none() {
        return;
    }
    let binary = Binary::open(library::path());
    let (host, plugin) = prepare(&binary);
    let instance = instance(&host, plugin);
    let (on_cpu, on_card) = (render(&instance, false), render(&instance, true));
    assert!(on_cpu != on_card);
    for _ in 0..2 {
        ask(Some("lost"));
        assert!(render(&instance, true) == on_cpu);
        says(&host, &LOST);
        assert!(render(&instance, true) == on_cpu);
        says(&host, &LOST);
        ask(None);
        assert!(render(&instance, true) == on_card && messages(&host).is_empty());
    }
    ask(Some("lost"));
    (0..3).for_each(|_| assert!(render(&instance, true) == on_cpu));
    ask(None);
    assert!(render(&instance, true) == on_cpu);
    says(&host, &LOST);
    purge(plugin);
    assert!(render(&instance, true) == on_card && messages(&host).is_empty());
    drop(instance);
    purge(plugin);
    host.no_faults();
}

pub fn a_card_without_memory_leaves_frames_to_the_cpu() {
    if !cfg!(debug_assertions) || device::device("a card without memory").is_none() {
        return;
    }
    let binary = Binary::open(library::path());
    let (host, plugin) = prepare(&binary);
    let instance = instance(&host, plugin);
    let (on_cpu, on_card) = (render(&instance, false), render(&instance, true));
    ask(Some("full"));
    assert!(render(&instance, true) == on_cpu && render(&instance, true) == on_cpu);
    says(&host, &["asked for"]);
    ask(None);
    assert!(render(&instance, true) == on_card && messages(&host).is_empty());
    drop(instance);
    purge(plugin);
    host.no_faults();
}

pub fn machines_without_a_card_compute_on_the_cpu() {
    let binary = Binary::open(library::path());
    let (host, plugin) = prepare(&binary);
    let instance = instance(&host, plugin);
    let on_cpu = render(&instance, false);
    set("ISOPHOTE_ADAPTER", Some("no such card"));
    for name in ["VK_ICD_FILENAMES", "VK_DRIVER_FILES"] {
        set(name, Some("/no/such/driver"));
    }
    assert!(render(&instance, true) == on_cpu && render(&instance, true) == on_cpu);
    says(&host, &["graphics adapter"]);
    // It is looked for again when the host purges.
    purge(plugin);
    assert!(render(&instance, true) == on_cpu);
    says(&host, &["graphics adapter"]);
    drop(instance);
    host.no_faults();
}

#[cfg(unix)]
unsafe extern "C" {
    fn fork() -> i32;
    fn waitpid(process: i32, status: *mut i32, options: i32) -> i32;
    fn alarm(seconds: u32) -> u32;
    fn _exit(code: i32) -> !;
}

#[cfg(unix)]
pub fn a_copy_of_the_process_computes_on_the_cpu() {
    if device::device("a process that forks").is_none() {
        return;
    }
    let binary = Binary::open(library::path());
    let (host, plugin) = prepare(&binary);
    let instance = instance(&host, plugin);
    let (on_cpu, on_card) = (render(&instance, false), render(&instance, true));
    // SAFETY: this is the only thread of the process that has anything to do with the host; the child ends without the
    // work that is left for the end of the parent.
    unsafe {
        let child = fork();
        if child == 0 {
            // A child that waits for ever ends by this.
            alarm(120);
            let right = std::panic::catch_unwind(|| {
                assert!(render(&instance, true) == on_cpu);
                says(&host, &["copy"]);
                purge(plugin);
                assert!(render(&instance, true) == on_cpu);
                assert_eq!(instance.act(kOfxActionDestroyInstance, None, None), kOfxStatOK);
                host.no_faults();
            });
            _exit(i32::from(right.is_err()));
        }
        let mut status = -1;
        assert!(child > 0 && waitpid(child, &raw mut status, 0) == child);
        assert_eq!(status, 0, "the child did not end well");
    }
    assert!(render(&instance, true) == on_card && messages(&host).is_empty());
    drop(instance);
    purge(plugin);
    host.no_faults();
}

#[cfg(not(unix))]
pub fn a_copy_of_the_process_computes_on_the_cpu() {}
