//! Moving a slider rewrites uniform bytes in place: no pass changes, nothing is allocated, and the
//! result is that of a plan made anew.

use isophote::request::Change;
use isophote::{Request, Value};
use isophote_engine::Rect;
use isophote_engine::program::Program;
use isophote_tests::cases;
use isophote_tests::pictures::{self, Kind};
use isophote_tests::random::Random;
use isophote_tests::{device, run};

/// True when both plans would run the same.
fn same(a: &isophote_engine::Plan, b: &isophote_engine::Plan) -> bool {
    a.images() == b.images()
        && a.passes().len() == b.passes().len()
        && a.passes().iter().zip(b.passes()).all(|(a, b)| {
            a.kernel == b.kernel
                && a.inputs == b.inputs
                && a.outputs == b.outputs
                && a.params == b.params
                && a.support == b.support
        })
}

#[test]
fn parameters_that_are_not_structural_only_rewrite_uniforms_and_allocate_nothing() {
    let mut random = Random::new(5);
    let mut wrong = Vec::new();
    let mut edits = 0;
    for spec in cases::nodes() {
        for setting in cases::settings(spec, 2) {
            for wired in [false, true] {
                let mut setup = cases::setup(spec, wired);
                setting.apply(&mut setup.graph, setup.node);
                let request = cases::request(Kind::Steps, 61, 37, wired);
                let mut planned = run::planned(&setup.graph, request);
                for param in spec.params().filter(|p| !p.structural) {
                    let before = setup.graph.value(setup.node, param.id).unwrap();
                    let Some(value) = cases::other(param, before, &mut random) else { continue };
                    setup.graph.set(setup.node, param.id, value).unwrap();
                    let mut change = Ok(Change::Structure);
                    let memory = allocation_counter::measure(|| change = planned.update(&setup.graph));
                    edits += 1;
                    let what = format!("{} ({}): {} = {value:?}", spec.id, setting.label, param.id);
                    match change {
                        Ok(Change::Uniforms) if memory.count_total > 0 => {
                            wrong.push(format!("{what} allocates {} times", memory.count_total));
                        }
                        Ok(Change::Uniforms) => {
                            if !same(planned.plan(), run::planned(&setup.graph, request).plan()) {
                                wrong.push(format!("{what} is not what a new plan would be"));
                            }
                        }
                        Ok(Change::Structure) => wrong.push(format!("{what} changes the passes")),
                        Err(e) => wrong.push(format!("{what}: {e}")),
                    }
                }
            }
        }
    }
    println!("{edits} edits");
    wrong.sort();
    wrong.dedup();
    assert!(edits > 0 && wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn structural_parameters_lead_to_the_plan_that_a_new_one_would_be() {
    let mut random = Random::new(6);
    for spec in cases::nodes() {
        let mut setup = cases::setup(spec, false);
        let request = cases::request(Kind::Steps, 61, 37, false);
        let mut planned = run::planned(&setup.graph, request);
        for param in spec.params().filter(|p| p.structural) {
            let before = setup.graph.value(setup.node, param.id).unwrap();
            let Some(value) = cases::other(param, before, &mut random) else { continue };
            setup.graph.set(setup.node, param.id, value).unwrap();
            planned.update(&setup.graph).unwrap();
            assert!(
                same(planned.plan(), run::planned(&setup.graph, request).plan()),
                "{}: {} = {value:?}",
                spec.id,
                param.id
            );
        }
    }
}

#[test]
fn an_edited_plan_gives_the_picture_of_a_new_one() {
    let picture = pictures::color(Kind::Steps, 61, 37);
    for spec in cases::nodes() {
        let Some(param) = spec.params().find(|p| !p.structural && float_default(p).is_some()) else {
            continue;
        };
        let mut setup = cases::setup(spec, false);
        let mut planned = run::planned(&setup.graph, Request::new(61, 37));
        let before = setup.graph.value(setup.node, param.id).unwrap();
        let value = cases::other(param, before, &mut Random::new(7)).unwrap();
        setup.graph.set(setup.node, param.id, value).unwrap();
        planned.update(&setup.graph).unwrap();
        let inputs = [("color", picture.clone())];
        let fresh = run::planned(&setup.graph, Request::new(61, 37));
        assert_eq!(run::whole(planned.plan(), &inputs), run::whole(fresh.plan(), &inputs), "{}", spec.id);
    }
}

fn float_default(param: &isophote::spec::Param) -> Option<f32> {
    match param.default {
        Value::Float(v) => Some(v),
        _ => None,
    }
}

#[test]
fn a_warm_frame_creates_nothing_on_the_gpu_and_submits_once() {
    let Some(device) = device::device("a_warm_frame_creates_nothing_on_the_gpu_and_submits_once") else {
        return;
    };
    let executor = isophote_engine::gpu::Executor::new(device.clone());
    for spec in cases::nodes() {
        let mut setup = cases::setup(spec, false);
        let mut planned = run::planned(&setup.graph, Request::new(320, 180));
        let region = Rect::of_size(320, 180);
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
            assert_eq!(planned.update(&setup.graph).unwrap(), Change::Uniforms, "{}", spec.id);
            let mut encoder = device.raw().create_command_encoder(&Default::default());
            let mut fits = false;
            let memory = allocation_counter::measure(|| fits = program.repack(planned.plan()));
            assert!(fits, "{}: the program does not take the edit", spec.id);
            assert_eq!(memory.count_total, 0, "{}: repacking allocates", spec.id);
            prepared.repack(&program).unwrap();
            prepared.encode(&mut encoder).unwrap();
            // The one submission is the caller's.
            device.queue().submit([encoder.finish()]);
            device.check().unwrap();
            let after = device.counts();
            let made = |c: isophote_engine::gpu::Counts| {
                [c.buffers, c.textures, c.bind_groups, c.pipelines, c.query_sets, c.submissions]
            };
            assert_eq!(made(before), made(after), "{}, frame {frame}", spec.id);
        }
    }
}
