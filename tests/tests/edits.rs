//! Moving a slider rewrites uniform bytes in place: no pass changes, nothing is allocated, and the
//! result is that of a plan made anew.

use isophote::planned::Change;
use isophote::spec::NodeSpec;
use isophote::{Planned, Request, Value};
use isophote_engine::Rect;
use isophote_engine::gpu::Counts;
use isophote_engine::program::Program;
use isophote_tests::cases::{self, Setup};
use isophote_tests::pictures::{self, Kind};
use isophote_tests::random::Random;
use isophote_tests::trials::Trials;
use isophote_tests::{device, run};
use std::sync::{Mutex, PoisonError};

/// Adds the trials of this file.
pub fn add(trials: &mut Trials) {
    for spec in isophote::registry::nodes() {
        trials
            .add("edits::uniforms", spec.id, || parameters_only_rewrite_uniforms_and_allocate_nothing(spec));
        trials.add("edits::structure", spec.id, || structural_parameters_lead_to_a_new_plan(spec));
        trials.add("edits::picture", spec.id, || an_edited_plan_gives_the_picture_of_a_new_one(spec));
        trials.add("edits::warm_frame", spec.id, || a_warm_frame_creates_nothing_and_submits_once(spec));
    }
}

/// True when both plans would run the same.
fn same(a: &isophote_engine::Plan, b: &isophote_engine::Plan) -> bool {
    a.images() == b.images()
        && a.passes().len() == b.passes().len()
        && a.passes().iter().zip(b.passes()).all(|(a, b)| {
            a.kernel == b.kernel
                && a.inputs == b.inputs
                && a.outputs == b.outputs
                && a.params == b.params
                && a.supports == b.supports
        })
}

/// One edit of a plan: the parameter becomes `value`. What is wrong, if anything.
fn edit(
    setup: &mut Setup,
    planned: &mut Planned,
    request: Request,
    id: &str,
    value: Value,
) -> Option<String> {
    setup.graph.set(setup.node, id, value).unwrap();
    let mut change = Ok(Change::Structure);
    let memory = allocation_counter::measure(|| change = planned.update(&setup.graph));
    match change {
        Ok(Change::Uniforms) if memory.count_total > 0 => {
            Some(format!("allocates {} times", memory.count_total))
        }
        Ok(Change::Uniforms) if same(planned.plan(), run::planned(&setup.graph, request).plan()) => None,
        Ok(Change::Uniforms) => Some("is not what a new plan would be".into()),
        Ok(Change::Structure) => Some("changes the passes".into()),
        Err(e) => Some(e.to_string()),
    }
}

fn parameters_only_rewrite_uniforms_and_allocate_nothing(spec: &'static NodeSpec) -> Vec<String> {
    let mut random = Random::new(5);
    let mut wrong = Vec::new();
    let mut edits = 0;
    for setting in cases::settings(spec, 2) {
        for wired in [false, true] {
            let mut setup = cases::setup(spec, wired);
            setting.apply(&mut setup.graph, setup.node);
            let request = cases::request(Kind::Steps, 61, 37, wired);
            let mut planned = run::planned(&setup.graph, request);
            for param in spec.params().filter(|p| !p.structural) {
                let before = setup.graph.value(setup.node, param.id).unwrap();
                let Some(value) = cases::other(param, before, &mut random) else { continue };
                edits += 1;
                if let Some(fault) = edit(&mut setup, &mut planned, request, param.id, value) {
                    wrong.push(format!("({}) {} = {value:?}: {fault}", setting.label, param.id));
                }
            }
        }
    }
    println!("edits::uniforms::{}: {edits} edits", spec.id);
    let can_be_edited = spec.params().any(|p| !p.structural);
    if can_be_edited && edits == 0 {
        wrong.push("nothing was edited".into());
    }
    wrong.sort();
    wrong.dedup();
    wrong
}

fn structural_parameters_lead_to_a_new_plan(spec: &'static NodeSpec) -> Vec<String> {
    let mut random = Random::new(6);
    let mut wrong = Vec::new();
    let mut setup = cases::setup(spec, false);
    let request = cases::request(Kind::Steps, 61, 37, false);
    let mut planned = run::planned(&setup.graph, request);
    for param in spec.params().filter(|p| p.structural) {
        let before = setup.graph.value(setup.node, param.id).unwrap();
        let Some(value) = cases::other(param, before, &mut random) else { continue };
        setup.graph.set(setup.node, param.id, value).unwrap();
        planned.update(&setup.graph).unwrap();
        if !same(planned.plan(), run::planned(&setup.graph, request).plan()) {
            wrong.push(format!("{} = {value:?} is not what a new plan would be", param.id));
        }
    }
    wrong
}

fn an_edited_plan_gives_the_picture_of_a_new_one(spec: &'static NodeSpec) {
    let picture = pictures::color(Kind::Steps, 61, 37);
    let Some(param) = spec.params().find(|p| !p.structural && float_default(p).is_some()) else { return };
    let mut setup = cases::setup(spec, false);
    let mut planned = run::planned(&setup.graph, Request::new(61, 37));
    let before = setup.graph.value(setup.node, param.id).unwrap();
    let value = cases::other(param, before, &mut Random::new(7)).unwrap();
    setup.graph.set(setup.node, param.id, value).unwrap();
    planned.update(&setup.graph).unwrap();
    let inputs = [("color", picture)];
    let fresh = run::planned(&setup.graph, Request::new(61, 37));
    assert_eq!(run::whole(planned.plan(), &inputs), run::whole(fresh.plan(), &inputs));
}

fn float_default(param: &isophote::spec::Param) -> Option<f32> {
    match param.default {
        Value::Float(v) => Some(v),
        _ => None,
    }
}

fn a_warm_frame_creates_nothing_and_submits_once(spec: &'static NodeSpec) -> Option<()> {
    // What is created on the device is counted for all of its users.
    static COUNTED: Mutex<()> = Mutex::new(());
    let _alone = COUNTED.lock().unwrap_or_else(PoisonError::into_inner);
    let device = device::device(spec.id)?;
    let executor = isophote_engine::gpu::Executor::new(device.clone());
    // Large enough for every level of the pyramids that people use.
    let [width, height] = [320, 180];
    let mut setup = cases::setup(spec, false);
    let mut planned = run::planned(&setup.graph, Request::new(width, height));
    let region = Rect::of_size(width, height);
    let mut program = Program::lower(planned.plan(), region).unwrap();
    let mut prepared = executor.prepare(&program).unwrap();
    for port in planned.plan().inputs() {
        prepared.own_input(&port.name).unwrap();
    }
    prepared.own_output("output").unwrap();
    let mut random = Random::new(8);
    for frame in 0..3 {
        let before = device.counts();
        for param in spec.params().filter(|p| !p.structural) {
            let now = setup.graph.value(setup.node, param.id).unwrap();
            if let Some(value) = cases::other(param, now, &mut random) {
                setup.graph.set(setup.node, param.id, value).unwrap();
            }
        }
        assert_eq!(planned.update(&setup.graph).unwrap(), Change::Uniforms);
        let mut encoder = device.raw().create_command_encoder(&Default::default());
        let mut fits = false;
        let memory = allocation_counter::measure(|| fits = program.repack(planned.plan()));
        assert!(fits, "the program does not take the edit");
        assert_eq!(memory.count_total, 0, "repacking allocates");
        prepared.repack(&program).unwrap();
        prepared.encode(&mut encoder).unwrap();
        // The one submission is the caller's.
        device.queue().submit([encoder.finish()]);
        device.check().unwrap();
        assert_eq!(made(before), made(device.counts()), "frame {frame}");
    }
    Some(())
}

/// Counts of what was created and submitted, without the uniforms that were written.
fn made(counts: Counts) -> [u64; 6] {
    let Counts { buffers, textures, bind_groups, pipelines, query_sets, submissions, .. } = counts;
    [buffers, textures, bind_groups, pipelines, query_sets, submissions]
}
