//! Every node on ordinary and on the hardest pictures and guides: results are finite, and the same to the bit on every
//! processor that multiplies and adds in one step. What they were is in `tests/data/bits.txt`, which `cargo xtask bless`
//! makes anew, so that processors of other kinds are compared by running the same test.

use isophote::registry;
use isophote::spec::NodeSpec;
use isophote::{Planned, Value};
use isophote_engine::cpu::{Control, CpuExecutor};
use isophote_engine::dispatch::levels;
use isophote_engine::fearless_simd::Level;
use isophote_engine::{Image, Rect};
use isophote_tests::cases::{self, Setting};
use isophote_tests::pictures::{Hard, Kind};
use isophote_tests::trials::{Report, Trials};
use isophote_tests::{run, sweep};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Once;

/// Size of the ordinary pictures.
const SIZE: [u32; 2] = [48, 40];
/// Size of the hard ones, of which there are many.
const HARD_SIZE: [u32; 2] = [24, 20];

/// Input of a plan.
#[derive(Clone, Copy, Debug)]
enum Entering {
    Ordinary(Kind),
    /// Hard guides beside an ordinary picture.
    Guides(Hard),
    /// A hard picture beside ordinary guides.
    Colour(Hard),
}

impl Entering {
    fn all() -> impl Iterator<Item = Self> {
        let ordinary = [Kind::Steps, Kind::Hdr, Kind::CutOut].map(Self::Ordinary);
        ordinary.into_iter().chain(Hard::ALL.map(Self::Guides)).chain(Hard::ALL.map(Self::Colour))
    }

    fn kind(self) -> Kind {
        match self {
            Self::Ordinary(kind) => kind,
            _ => Kind::CutOut,
        }
    }

    fn size(self) -> [u32; 2] {
        if let Self::Ordinary(_) = self { SIZE } else { HARD_SIZE }
    }

    /// The image that enters under `name`.
    fn image(self, name: &str) -> Image {
        let image = sweep::input(name, self.kind(), self.size());
        match self {
            Self::Guides(hard) if !name.starts_with("color") => hard.of(image),
            Self::Colour(hard) if name.starts_with("color") => hard.of(image),
            _ => image,
        }
    }
}

/// Adds the trials of this file.
pub fn add(trials: &mut Trials) {
    for spec in registry::nodes() {
        trials.add("bits::finite", spec.id, move || that_are_not_finite(spec));
        trials.add("bits::same", spec.id, move || other_than_known(spec));
    }
}

/// A node with its defaults, with each option of each choice, with marks that motion carries or that fade, and on materials.
fn settings(spec: &'static NodeSpec) -> impl Iterator<Item = Setting> {
    let all = cases::settings(spec, 0).into_iter().filter(|s| s.values.len() <= 1);
    all.chain(cases::carrying(spec)).chain(cases::fading(spec)).chain(cases::on_materials(spec))
}

/// All numbers that are 0 by default at half of their sliders, since what they weigh may not be read before.
fn switched_on(spec: &'static NodeSpec) -> Setting {
    let off = spec.params().filter(|p| p.default == Value::Float(0.0));
    let values = off.map(|p| (p.id, Value::Float(0.5 * p.slider[1]))).collect();
    Setting { label: "what is off by default".into(), values }
}

/// Results of a node on its inputs, setting by setting.
fn results(
    spec: &'static NodeSpec,
    settings: impl Iterator<Item = Setting>,
    entering: Entering,
    level: Level,
) -> Vec<(String, Image)> {
    let [width, height] = entering.size();
    let mut results = Vec::new();
    for setting in settings {
        let mut setup = cases::setup(spec, true);
        setting.apply(&mut setup.graph, setup.node);
        let request = match setting.label.as_str() {
            "carrying marks" => cases::request_without_rest(entering.kind(), width, height),
            "on materials" => cases::request_on_materials(entering.kind(), width, height),
            _ => cases::request(entering.kind(), width, height, true),
        };
        let planned = run::planned(&setup.graph, request);
        results.push((setting.label, result(&planned, entering, level)));
    }
    results
}

fn result(planned: &Planned, entering: Entering, level: Level) -> Image {
    let plan = planned.plan();
    let images: Vec<Image> = plan.inputs().iter().map(|port| entering.image(&port.name)).collect();
    let inputs: Vec<(&str, &Image)> = plan.inputs().iter().map(|p| p.name.as_str()).zip(&images).collect();
    let [width, height] = plan.size();
    let whole = Rect::of_size(width, height);
    match CpuExecutor::with_level(level).run(plan, &inputs, whole, &run::CALLING, Control::default()) {
        Ok(mut images) => images.swap_remove(0),
        Err(e) => panic!("{entering:?}: {e}"),
    }
}

fn that_are_not_finite(spec: &'static NodeSpec) -> Vec<String> {
    let mut wrong = Vec::new();
    for (name, level) in levels() {
        for entering in Entering::all() {
            let settings = settings(spec).chain([switched_on(spec)]);
            for (setting, image) in results(spec, settings, entering, level) {
                let broken = image.data().iter().filter(|v| !v.is_finite()).count();
                if broken > 0 {
                    wrong.push(format!(
                        "{entering:?} ({setting}, {name}): {broken} of {}",
                        image.data().len()
                    ));
                }
            }
        }
    }
    wrong
}

/// The levels that multiply and add in one step; the others round twice.
fn fused() -> impl Iterator<Item = (&'static str, Level)> {
    levels().into_iter().filter(|(name, _)| *name != "SSE2")
}

fn other_than_known(spec: &'static NodeSpec) -> Report {
    static BLESSED: Once = Once::new();
    if std::env::var("ISOPHOTE_BLESS").is_ok_and(|v| v == "1") {
        BLESSED.call_once(bless);
    }
    let table = std::fs::read_to_string(table()).unwrap_or_default();
    let Some(known) = table.lines().find_map(|line| line.strip_prefix(spec.id)?.strip_prefix(' ')) else {
        return Report::Failed("it is not in the table; look at its golden image and bless it".into());
    };
    let mut wrong = Vec::new();
    let mut count = 0;
    for (name, level) in fused() {
        count += 1;
        for (entering, known) in Entering::all().zip(known.split(' ')) {
            let found = digest(spec, entering, level);
            if found != known {
                wrong.push(format!("{name}: {entering:?}: other bits than known"));
            }
        }
    }
    if count == 0 { Report::Skipped("no fused multiplication and addition".into()) } else { wrong.into() }
}

/// FNV-1a of the bits of all results.
fn digest(spec: &'static NodeSpec, entering: Entering, level: Level) -> String {
    let mut hash = 0x811c_9dc5_u32;
    for (_, image) in results(spec, settings(spec), entering, level) {
        for byte in image.data().iter().flat_map(|v| v.to_bits().to_le_bytes()) {
            hash = (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
        }
    }
    format!("{hash:08x}")
}

fn table() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/bits.txt")
}

/// Writes the table of what the widest instruction set gives.
fn bless() {
    let (_, level) = fused().last().expect("a processor that multiplies and adds in one step");
    let mut text = String::new();
    for spec in registry::nodes() {
        let _ = write!(text, "{}", spec.id);
        for entering in Entering::all() {
            let _ = write!(text, " {}", digest(spec, entering, level));
        }
        text.push('\n');
    }
    std::fs::write(table(), text).unwrap();
}
