//! The OpenFX face when things go wrong or go on for long: panics, bad calls, leaks. Each test has a process of
//! its own, since it measures or changes what belongs to all of one.

#![allow(unsafe_code, reason = "changing the environment, and calls that no host should make")]

#[path = "openfx/allocations.rs"]
mod allocations;
#[path = "openfx/card_faults.rs"]
mod card_faults;
#[path = "openfx/kept.rs"]
mod kept;
#[path = "openfx/small.rs"]
mod small;

use card_faults::{
    a_card_that_is_lost_is_opened_anew_but_not_for_ever, a_card_without_memory_leaves_frames_to_the_cpu,
    a_copy_of_the_process_computes_on_the_cpu, machines_without_a_card_compute_on_the_cpu,
};
use isophote_abi::openfx::*;
use isophote_tests::library;
use isophote_tests::ofx::effect::{Described, Wanted};
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::Layout;
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::state::Behaviour;
use isophote_tests::trials::Trials;
use kept::*;
use small::{SIZE, picture};
use std::ffi::CStr;
use std::process::{Command, ExitCode};
use std::ptr::null_mut;
use std::time::{Duration, Instant};

/// Allocations that the runner of the tests may make or free meanwhile.
const MOST_OF_OTHERS: i64 = 100;

/// Names the test that this process is for.
const TEST: &str = "ISOPHOTE_FAULT_TEST";

/// Tests by their names.
macro_rules! named {
    ($($test:ident)*) => { [$((stringify!($test), $test)),*] };
}

const TESTS: [(&str, fn()); 15] = named! {
    a_panic_becomes_a_status_and_the_host_goes_on
    failures_are_shown_once_through_whatever_messages_there_are
    bad_calls_are_answered
    allocations_of_this_process_are_counted
    a_thousand_instances_of_all_effects_leak_nothing
    a_hundred_loads_leak_nothing
    a_card_that_is_lost_is_opened_anew_but_not_for_ever
    a_card_without_memory_leaves_frames_to_the_cpu
    machines_without_a_card_compute_on_the_cpu
    a_copy_of_the_process_computes_on_the_cpu
    what_frames_have_in_common_is_computed_once
    strips_share_what_frames_have_in_common
    strips_are_made_anew_where_what_they_are_made_from_changes
    memory_is_given_back_when_caches_are_purged
    times_of_warm_renders
};

fn main() -> ExitCode {
    if let Ok(name) = std::env::var(TEST) {
        // A panic ends the process with a code that is not 0.
        TESTS.iter().filter(|(known, _)| *known == name).for_each(|(_, test)| test());
        return ExitCode::SUCCESS;
    }
    let mut trials = Trials::new();
    for (name, _) in TESTS {
        trials.add_plain(&format!("openfx_faults::{name}"), || in_a_process(name));
    }
    // The last measures, and asserts nothing.
    trials.ignore_last();
    trials.run()
}

/// Runs a test in a process of its own: it measures or changes what belongs to all of one.
fn in_a_process(name: &str) {
    let program = std::env::current_exe().unwrap();
    let run = Command::new(program).env(TEST, name).output().unwrap();
    let printed = [run.stdout, run.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
    print!("{printed}");
    assert!(run.status.success(), "{}\n{printed}", run.status);
}

/// Bytes of this process that are in memory.
fn resident() -> i64 {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    text.split_whitespace().nth(1).and_then(|pages| pages.parse::<i64>().ok()).unwrap_or(0) * 4096
}

fn a_panic_becomes_a_status_and_the_host_goes_on() {
    if !cfg!(debug_assertions) {
        return;
    }
    let binary = Binary::open(library::path());
    let host = Host::new(Behaviour::default());
    let (plugin, layout) = (binary.plugin("org.isophote.gaussian"), Layout::default());
    let ask = |action: Option<&CStr>| {
        const VARIABLE: &str = "ISOPHOTE_OFX_PANIC";
        // SAFETY: no other test runs in this process, and no other thread reads the environment now.
        unsafe {
            match action {
                Some(action) => {
                    std::env::set_var(VARIABLE, format!("org.isophote.gaussian:{}", action.to_string_lossy()))
                }
                None => std::env::remove_var(VARIABLE),
            }
        }
    };
    ask(Some(kOfxActionDescribe));
    assert_eq!(Described::attempt(&host, plugin).err(), Some(("Describe", kOfxStatFailed)));
    ask(Some(kOfxActionCreateInstance));
    let described = Described::new(&host, plugin);
    let handle = described.descriptor.handle();
    assert_eq!(plugin.act(kOfxActionCreateInstance, handle, None, None), kOfxStatFailed);
    ask(None);
    let instance = described.instance(kOfxImageEffectContextFilter);
    instance.connect("Source", picture(layout));
    let wanted = Wanted::new([0, 0, SIZE, SIZE]);
    ask(Some(kOfxImageEffectActionRender));
    assert_eq!(instance.try_render(layout, [SIZE; 2], &wanted).0, kOfxStatFailed);
    ask(None);
    assert_eq!(instance.try_render(layout, [SIZE; 2], &wanted).0, kOfxStatOK);
    drop(instance);
    host.no_faults();
}

fn failures_are_shown_once_through_whatever_messages_there_are() {
    if !cfg!(debug_assertions) {
        return;
    }
    const VARIABLE: &str = "ISOPHOTE_OFX_FAILURE";
    let binary = Binary::open(library::path());
    let (plugin, layout) = (binary.plugin("org.isophote.gaussian"), Layout::default());
    let usual = Behaviour::default();
    for (behaviour, shown, kept) in [
        (usual.clone(), 1, 0),
        // A host of old: it cannot take messages back.
        (Behaviour { message_version: 1, ..usual.clone() }, 1, 1),
        (Behaviour { null_functions: true, ..usual.clone() }, 0, 0),
        (Behaviour { without: vec![kOfxMessageSuite], ..usual.clone() }, 0, 0),
        (Behaviour { name: c"DaVinciResolve", ..usual.clone() }, 0, 0),
    ] {
        let host = Host::new(behaviour);
        let messages = || host.inner.messages.lock().unwrap().len();
        let instance = Described::new(&host, plugin).instance(kOfxImageEffectContextFilter);
        instance.connect("Source", picture(layout));
        let render = || instance.try_render(layout, [SIZE; 2], &Wanted::new([0, 0, SIZE, SIZE])).0;
        // SAFETY: no other test runs in this process, and no other thread reads the environment now.
        unsafe { std::env::set_var(VARIABLE, plugin.identifier()) };
        assert_eq!([render(), render()], [kOfxStatErrMemory; 2]);
        assert_eq!(messages(), shown, "{:?}", host.inner.behaviour);
        // SAFETY: as above.
        unsafe { std::env::remove_var(VARIABLE) };
        assert_eq!([render(), render()], [kOfxStatOK; 2]);
        assert_eq!(messages(), kept, "{:?}", host.inner.behaviour);
        drop(instance);
        host.no_faults();
    }
}

fn bad_calls_are_answered() {
    let binary = Binary::open(library::path());
    let host = Host::new(Behaviour::default());
    for plugin in binary.plugins() {
        plugin.set_host(&host);
        assert_eq!(plugin.act(kOfxActionLoad, null_mut(), None, None), kOfxStatOK);
        assert_eq!(plugin.act(c"OfxActionOfTomorrow", null_mut(), None, None), kOfxStatReplyDefault);
        for action in [kOfxActionDescribe, kOfxImageEffectActionRender, kOfxActionCreateInstance] {
            assert_eq!(plugin.act(action, null_mut(), None, None), kOfxStatErrBadHandle);
        }
        let entry = plugin.raw().mainEntry.unwrap();
        // SAFETY: a null action is what is tested.
        let status = unsafe { entry(std::ptr::null(), std::ptr::null(), null_mut(), null_mut()) };
        assert_eq!(status, kOfxStatFailed);
        // Unloaded and asked all the same, as hosts do that do not count.
        assert_eq!(plugin.act(kOfxActionUnload, null_mut(), None, None), kOfxStatOK);
        assert_eq!(plugin.act(kOfxActionUnload, null_mut(), None, None), kOfxStatOK);
        let described = Described::new(&host, *plugin);
        assert_eq!(plugin.act(kOfxActionUnload, null_mut(), None, None), kOfxStatOK);
        drop(described.instance(kOfxImageEffectContextGeneral));
    }
}

/// Allocations that are alive once threads that end have ended.
fn allocations_at_rest() -> i64 {
    let (mut last, mut same) = (allocations::alive(), 0);
    while same < 5 {
        std::thread::sleep(Duration::from_millis(10));
        let now = allocations::alive();
        same = if now == last { same + 1 } else { 0 };
        last = now;
    }
    last
}

/// Cycles leave nothing behind. Returns the time of the fastest among the first, and among the last: of many,
/// since other work disturbs the others.
fn steady(what: &str, count: usize, mut cycle: impl FnMut()) -> [Duration; 2] {
    let part = count / 4;
    let mut quarter = || {
        let mut least = Duration::MAX;
        for _ in 0..part {
            let started = Instant::now();
            cycle();
            least = least.min(started.elapsed());
        }
        least
    };
    let first = quarter();
    let before = (resident(), allocations_at_rest());
    quarter();
    quarter();
    let last = quarter();
    let left = allocations_at_rest() - before.1;
    println!("{what}: {left} allocations more, {first:?} at first, {last:?} at last");
    // One for each cycle would be twelve times as many. Queues of threads may hold one more or less.
    assert!(left <= part as i64 / 4, "{what}: {left} allocations more after {count} cycles");
    let grown = resident() - before.0;
    assert!(grown < 3 << 20, "{what}: {grown} bytes more after {count} cycles");
    [first, last]
}

/// Cycles do not become slower.
fn assert_as_fast([first, last]: [Duration; 2]) {
    assert!(last < first * 3 + Duration::from_millis(2), "{first:?} at first, {last:?} at last");
}

fn allocations_of_this_process_are_counted() {
    if !cfg!(all(target_os = "linux", target_env = "gnu")) {
        return;
    }
    assert!(allocations::are_counted());
    let before = allocations::alive();
    let kept: Vec<Box<u64>> = (0..1000).map(Box::new).collect();
    assert!(allocations::alive() - before >= 1000 - MOST_OF_OTHERS);
    drop(kept);
    assert!((allocations::alive() - before).abs() <= MOST_OF_OTHERS);
    // Those of the library as well.
    let binary = Binary::open(library::path());
    let host = Host::new(Behaviour::default());
    let described: Vec<_> = binary.plugins().iter().map(|plugin| Described::new(&host, *plugin)).collect();
    let before = allocations::alive();
    for plugin in binary.plugins() {
        assert_eq!(plugin.act(kOfxActionUnload, null_mut(), None, None), kOfxStatOK);
    }
    // What it knew of the host, once for each effect.
    assert!(before - allocations::alive() >= described.len() as i64 / 2);
}

/// Instances of each effect that are created, rendered and destroyed: more than a thousand altogether.
const INSTANCES: usize = 48;

fn a_thousand_instances_of_all_effects_leak_nothing() {
    let binary = Binary::open(library::path());
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let source = picture(layout);
    assert!(binary.plugins().len() * INSTANCES > 1000);
    let mut all = [Duration::ZERO; 2];
    for plugin in binary.plugins() {
        let described = Described::new(&host, *plugin);
        let times = steady(&plugin.identifier(), INSTANCES, || {
            let instance = described.instance(kOfxImageEffectContextFilter);
            instance.connect("Source", source.clone());
            instance.render(layout, [SIZE; 2]);
        });
        all = [all[0] + times[0], all[1] + times[1]];
    }
    assert_as_fast(all);
    host.no_faults();
}

fn a_hundred_loads_leak_nothing() {
    let layout = Layout::default();
    let source = picture(layout);
    let mut turn = 0;
    let times = steady("loading", 100, || {
        // A new one each time, since a host keeps the texts that it has handed out.
        let host = Host::new(Behaviour::default());
        let binary = Binary::open(library::path());
        for plugin in binary.plugins() {
            let described = Described::new(&host, *plugin);
            drop(described.instance(kOfxImageEffectContextGeneral));
        }
        // Each load renders another effect.
        let plugin = binary.plugins()[turn % binary.plugins().len()];
        turn += 1;
        {
            let instance = Described::new(&host, plugin).instance(kOfxImageEffectContextFilter);
            instance.connect("Source", source.clone());
            instance.render(layout, [SIZE; 2]);
        }
        for plugin in binary.plugins() {
            assert_eq!(plugin.act(kOfxActionUnload, null_mut(), None, None), kOfxStatOK);
        }
        host.no_faults();
    });
    assert_as_fast(times);
}
