//! The passes of every node's plans, run on the CPU, so that each can be repeated elsewhere on equal
//! input. Only what leads to the kernel in question is computed, and nothing twice.

use crate::pictures::{self, Kind};
use crate::plans::{self, Case};
use crate::run;
use half::f16;
use isophote::graph::GraphInput;
use isophote_engine::cpu::{Control, CpuExecutor};
use isophote_engine::fearless_simd::Level;
use isophote_engine::plan::Port;
use isophote_engine::program::{Format, Precision};
use isophote_engine::{Image, Kernel, Plan, Rect};
use std::collections::{BTreeSet, HashMap};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// One pass with its inputs and what the CPU made of them.
#[derive(Clone, Debug)]
pub struct Step {
    /// Node, parameter set, picture, size and pass, for messages.
    pub label: String,
    /// The pass's kernel.
    pub kernel: &'static Kernel,
    case: &'static Case,
    index: usize,
    /// The images read.
    pub inputs: Vec<Arc<Image>>,
    /// Result of the CPU twin.
    pub outputs: Vec<Arc<Image>>,
}

impl Step {
    /// A plan of this pass alone, run by `kernel`.
    ///
    /// # Panics
    /// When `kernel` has other bindings than the pass's own.
    pub fn plan_with(&self, kernel: &'static Kernel) -> Plan {
        match self.case.plan.single_pass(self.index, kernel) {
            Ok(plan) => plan,
            Err(e) => panic!("{}: {e}", self.label),
        }
    }

    /// The inputs by the names that a plan of one pass gives them.
    pub fn named_inputs(&self) -> Vec<(&'static str, &Image)> {
        const NAMES: [&str; 6] = ["0", "1", "2", "3", "4", "5"];
        NAMES.into_iter().zip(self.inputs.iter().map(Arc::as_ref)).collect()
    }

    /// The same with those rounded to 16-bit floats that such programs keep so, and what the CPU twin makes of them.
    ///
    /// # Panics
    /// When the executor refuses.
    pub fn in_half(&self) -> (Vec<Image>, Vec<Image>) {
        let plan = self.plan_with(self.kernel);
        let is_half = |port: &Port| Format::of(plan.desc(port.image), Precision::Half) == Format::Rgba16;
        let inputs = plan.inputs().iter().zip(&self.inputs).map(|(port, image)| match is_half(port) {
            true => rounded(image),
            false => Image::clone(image),
        });
        let inputs: Vec<Image> = inputs.collect();
        let named: Vec<(&str, &Image)> = plan.inputs().iter().map(|p| p.name.as_str()).zip(&inputs).collect();
        let control = Control::default();
        match CpuExecutor::new().run(&plan, &named, self.region(), &run::CALLING, control) {
            Ok(outputs) => {
                let outputs = plan.outputs().iter().zip(outputs).map(|(port, image)| match is_half(port) {
                    true => within_half(image),
                    false => image,
                });
                let outputs = outputs.collect();
                (inputs, outputs)
            }
            Err(e) => panic!("{}: {e}", self.label),
        }
    }

    /// The region that a plan of one pass is run for.
    pub fn region(&self) -> Rect {
        let [width, height] = self.case.plan.size();
        Rect::of_size(width, height)
    }

    /// Result of the CPU twin with the instructions of `level`.
    ///
    /// # Panics
    /// When the executor refuses.
    pub fn on_cpu(&self, level: Level) -> Vec<Image> {
        let plan = self.plan_with(self.kernel);
        let mut executor = CpuExecutor::with_level(level);
        match executor.run(&plan, &self.named_inputs(), self.region(), &run::CALLING, Control::default()) {
            Ok(images) => images,
            Err(e) => panic!("{}: {e}", self.label),
        }
    }
}

/// An image with its values rounded to 16-bit floats.
fn rounded(image: &Image) -> Image {
    let mut rounded = within_half(image.clone());
    rounded.data_mut().iter_mut().for_each(|value| *value = f16::from_f32(*value).to_f32());
    rounded
}

/// An image with the largest 16-bit float in the place of what is larger.
fn within_half(mut image: Image) -> Image {
    let largest = f16::MAX.to_f32();
    image.data_mut().iter_mut().for_each(|value| *value = value.clamp(-largest, largest));
    image
}

/// Result of one pass.
#[derive(Debug)]
struct Made {
    /// Kernel, parameters and the inputs' values: equal for passes that must give the same.
    content: u64,
    inputs: Vec<Arc<Image>>,
    outputs: Vec<Arc<Image>>,
}

type Shared<T> = Mutex<HashMap<u64, Arc<OnceLock<T>>>>;

/// The cell of `key`, to be filled by whoever comes first.
fn cell<T>(cells: &Shared<T>, key: u64) -> Arc<OnceLock<T>> {
    Arc::clone(cells.lock().unwrap_or_else(PoisonError::into_inner).entry(key).or_default())
}

/// The results of this process.
#[derive(Default)]
struct Results {
    /// By what leads to a pass: its kernel and parameters, those of the passes before it, and what enters.
    passes: Shared<Made>,
    /// By the content of a pass, since passes of other origin often read the same.
    outputs: Shared<Vec<Arc<Image>>>,
    /// Pictures and fields that enter.
    inputs: Shared<Arc<Image>>,
}

/// All cases, planned once in a process.
pub fn cases() -> &'static [Case] {
    static CASES: OnceLock<Vec<Case>> = OnceLock::new();
    CASES.get_or_init(plans::all)
}

/// Most steps of one kernel with the same parameters, image sizes and kind of picture: what leads to them differs, and more
/// of them would show nothing new.
const MOST_ALIKE: usize = 4;

/// Most steps of one kernel: all styles use some, with thousands of parameters that hardly differ.
const MOST: usize = 600;

/// Distinct passes of `kernel` in all cases, those of the smallest pictures first: all parameters on all kinds of pictures,
/// of each at most so many, and evenly chosen ones where those are too many.
pub fn steps(kernel: &'static Kernel) -> Vec<Step> {
    static RESULTS: OnceLock<Results> = OnceLock::new();
    let results = RESULTS.get_or_init(Results::default);
    let (mut known, mut alike) = (BTreeSet::new(), HashMap::<_, usize>::new());
    let mut steps = Vec::new();
    for case in cases().iter().filter(|case| case.plan.passes().iter().any(|p| p.kernel == kernel)) {
        for (index, made) in results.of(case, kernel) {
            if let Some(made) = made.get()
                && known.insert(made.content)
            {
                let count = alike.entry((description(&case.plan, index), case.kind as u8)).or_default();
                *count += 1;
                if *count > MOST_ALIKE {
                    continue;
                }
                let (label, inputs) = (format!("{} pass {index}", case.label), made.inputs.clone());
                steps.push(Step { label, kernel, case, index, inputs, outputs: made.outputs.clone() });
            }
        }
    }
    let all = steps.len();
    let is_chosen = |index: usize| index * MOST / all != (index + 1) * MOST / all;
    let mut index = 0..;
    steps.retain(|_| all <= MOST || index.next().is_some_and(is_chosen));
    steps
}

/// An image of a case, and the hash of what leads to it.
#[derive(Clone)]
struct Slot {
    key: u64,
    image: Arc<Image>,
}

impl Results {
    /// The passes of `kernel` in a case, by their places, with all that leads to them.
    fn of(&self, case: &'static Case, kernel: &'static Kernel) -> Vec<(usize, Arc<OnceLock<Made>>)> {
        let needed = needed(&case.plan, kernel);
        let mut slots: Vec<Option<Slot>> = vec![None; case.plan.images().len()];
        for port in case.plan.inputs() {
            slots[port.image.index()] =
                Some(self.entering((&port.name, case.kind, case.size), || {
                    input(&port.name, case.kind, case.size)
                }));
        }
        let mut found = Vec::new();
        for (index, pass) in case.plan.passes().iter().enumerate().filter(|(index, _)| needed[*index]) {
            let inputs: Vec<Slot> = pass.inputs.iter().filter_map(|i| slots[i.index()].clone()).collect();
            assert_eq!(
                inputs.len(),
                pass.inputs.len(),
                "{}: pass {index} reads what nobody wrote",
                case.label
            );
            let key =
                hash((description(&case.plan, index), inputs.iter().map(|i| i.key).collect::<Vec<_>>()));
            let made = cell(&self.passes, key);
            let outputs = &made.get_or_init(|| self.make(case, index, &inputs)).outputs;
            for (place, (id, image)) in pass.outputs.iter().zip(outputs).enumerate() {
                slots[id.index()] = Some(match case.fields[id.index()] {
                    Some(kind) => {
                        let [width, height] = case.size;
                        self.entering((kind as u8, case.size), || pictures::field(kind, width, height))
                    }
                    None => Slot { key: hash((key, place)), image: Arc::clone(image) },
                });
            }
            if pass.kernel == kernel {
                found.push((index, made));
            }
        }
        found
    }

    /// Something that enters, made once for equal `what`.
    fn entering(&self, what: impl Hash, make: impl FnOnce() -> Image) -> Slot {
        let key = hash(what);
        let image = cell(&self.inputs, key).get_or_init(|| Arc::new(make())).clone();
        Slot { key, image }
    }

    fn make(&self, case: &'static Case, index: usize, inputs: &[Slot]) -> Made {
        let inputs: Vec<Arc<Image>> = inputs.iter().map(|i| Arc::clone(&i.image)).collect();
        let values: Vec<&[u8]> = inputs.iter().map(|i| bytemuck::cast_slice(i.data())).collect();
        let content = hash((description(&case.plan, index), values));
        let step = Step {
            label: format!("{} pass {index}", case.label),
            kernel: case.plan.passes()[index].kernel,
            case,
            index,
            inputs: inputs.clone(),
            outputs: Vec::new(),
        };
        let outputs = cell(&self.outputs, content);
        let run = || step.on_cpu(Level::new()).into_iter().map(Arc::new).collect();
        let outputs = outputs.get_or_init(run).clone();
        Made { content, inputs, outputs }
    }
}

/// Mask of the passes that lead to those of `kernel`, and of these themselves.
fn needed(plan: &Plan, kernel: &'static Kernel) -> Vec<bool> {
    let mut read = vec![false; plan.images().len()];
    let mut needed = vec![false; plan.passes().len()];
    for (index, pass) in plan.passes().iter().enumerate().rev() {
        if pass.kernel == kernel || pass.outputs.iter().any(|id| read[id.index()]) {
            needed[index] = true;
            pass.inputs.iter().for_each(|id| read[id.index()] = true);
        }
    }
    needed
}

/// The picture or guide that enters a plan under `name`, such as `color` or `depth@-1`. Other frames show what this one does,
/// moved by a few pixels.
///
/// # Panics
/// For a name that graphs do not have.
pub fn input(name: &str, kind: Kind, [width, height]: [u32; 2]) -> Image {
    let (base, frame) = name.split_once('@').unwrap_or((name, "0"));
    let mut image = match GraphInput::from_id(base) {
        Some(GraphInput::Color) => pictures::color(kind, width, height),
        Some(guide) if kind == Kind::Broken => pictures::broken(pictures::field(guide.kind(), width, height)),
        Some(guide) => pictures::field(guide.kind(), width, height),
        None => panic!("no graph has an input '{name}'"),
    };
    if base == GraphInput::MotionForward.id() {
        // It leads back more or less to where other motion comes from.
        let row = 2 * width as usize;
        for (y, row) in image.data_mut().chunks_exact_mut(row).enumerate() {
            row.iter_mut().for_each(|v| *v *= -1.0 - 0.1 * (y % 8) as f32);
        }
    }
    match frame.parse::<i32>() {
        Ok(0) | Err(_) => image,
        Ok(frame) => pictures::moved(&image, [2 * frame, frame]),
    }
}

/// Description of a pass, apart from the values that it reads.
fn description(plan: &Plan, index: usize) -> u64 {
    let pass = &plan.passes()[index];
    let images = pass.inputs.iter().chain(&pass.outputs).map(|id| plan.desc(*id));
    // Passes that read nothing, those that make noise, know the picture by its size alone.
    hash((pass.kernel.name, &pass.params, pass.supports.clone(), plan.size(), images.collect::<Vec<_>>()))
}

fn hash(what: impl Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    what.hash(&mut hasher);
    hasher.finish()
}
