//! `isophote preset`: styles with their parameters as files.

mod rules;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use serde_json::Value;

use super::shared::{ForceArgs, PaletteArgs, QuietArgs};
use isophote_files::error::{AtPlace, Error, Result};
use isophote_files::identity::is_same;
use isophote_files::replacing::{Consent, Inputs, Made};
use isophote_files::{files, output};
use isophote_finishing::stylize::preset::{self, Look, Preset, Title, Track};
use isophote_finishing::stylize::source;
use isophote_finishing::stylize::style::{Setting, Style};
use isophote_loader::Library;
use isophote_loader::catalogue::ParamKind;

const AFTER_HELP: &str = "A parameter in the file may have keyframes instead of a value, such as \
    \"sigma_d\": {\"1001\": 2, \"1050\": 6}; with \"between\": \"step\" among them each value holds until the \
    next key. \"name\", \"about\" and \"tags\" beside the style tell people what the preset is.";

/// Options of `preset`.
#[derive(Args, Debug)]
#[command(after_help = AFTER_HELP)]
pub struct PresetArgs {
    /// What to do.
    #[command(subcommand)]
    command: PresetCommand,
}

/// Commands on presets.
#[derive(Debug, Subcommand)]
enum PresetCommand {
    /// Lists the looks that ship with the program.
    List(ListArgs),
    /// Writes a style with its parameters to a file.
    Save(SaveArgs),
    /// Prints the parameters of a preset.
    Show {
        /// The preset or look.
        file: PathBuf,
        /// Prints the values at this frame instead of the keyframes.
        #[arg(long, value_name = "N", allow_negative_numbers = true)]
        frame: Option<i64>,
    },
    /// Checks presets, and says what is wrong with those that do not work.
    Check {
        /// The presets.
        #[arg(required = true)]
        files: Vec<PathBuf>,
    },
}

/// Options of `preset list`.
#[derive(Args, Debug)]
#[command(
    after_help = "A look goes wherever a style goes: `isophote apply look:copperplate in.png out.png`."
)]
struct ListArgs {
    /// Lists those with this tag. May be repeated: all of them are wanted.
    #[arg(long, value_name = "TAG")]
    tag: Vec<String>,
    /// Prints JSON.
    #[arg(long)]
    json: bool,
}

/// Options of `preset save`.
#[derive(Args, Debug)]
struct SaveArgs {
    /// The id of a node, a graph file, a look or another preset, whose name, description and tags are kept.
    style: PathBuf,
    /// The file: .json.
    file: PathBuf,
    /// Sets a parameter; node.id=value for one node of a graph. May be repeated.
    #[arg(long, value_name = "ID=VALUE")]
    set: Vec<Setting>,
    #[command(flatten)]
    palette: PaletteArgs,
    /// Also writes the parameters that are not set, so that later changes of defaults do not matter.
    #[arg(long)]
    all: bool,
    /// Name of the preset, as lists show it.
    #[arg(long, value_name = "TEXT", value_parser = line)]
    name: Option<String>,
    /// A sentence on the look.
    #[arg(long, value_name = "TEXT", value_parser = line)]
    about: Option<String>,
    /// A word by which it is found. May be repeated; takes the place of all tags of another preset.
    #[arg(long, value_name = "TAG", value_parser = line)]
    tag: Vec<String>,
    /// Writes names with * and ? in rules for things out, by the Cryptomatte of this EXR file, and looks in files of their own: for
    /// compositors, C and Python, which know things by whole names.
    #[arg(long, value_name = "FRAME")]
    names_from: Option<PathBuf>,
    /// Replaces the preset that the file starts from.
    #[arg(long)]
    in_place: bool,
    #[command(flatten)]
    force: ForceArgs,
    #[command(flatten)]
    quiet: QuietArgs,
}

impl SaveArgs {
    fn consent(&self) -> Consent {
        Consent { in_place: self.in_place, ..self.force.consent() }
    }
}

/// A text for the title of a preset.
fn line(text: &str) -> std::result::Result<String, String> {
    preset::is_line(text).then(|| text.to_owned()).ok_or_else(|| "write something on one line".to_owned())
}

/// Runs the verb.
///
/// # Errors
/// [`Error::Input`] for styles, parameters, values and files that are not as they should be,
/// [`Error::Failure`] without a library.
pub fn run(args: &PresetArgs) -> Result<()> {
    match &args.command {
        PresetCommand::List(args) => list(args),
        PresetCommand::Save(args) => {
            let read = || Ok(Inputs::of(args.palette.file().into_iter().chain(args.names_from.as_deref())));
            args.consent().check(&[made(args)], false, read)?;
            save(&Library::open()?, args)
        }
        PresetCommand::Show { file, frame } => show(&Library::open()?, file, *frame),
        PresetCommand::Check { files } => check(&Library::open()?, files),
    }
}

fn list(args: &ListArgs) -> Result<()> {
    let all = preset::looks()?.into_iter().map(|look| Ok((preset::of_look(&look)?, look)));
    let mut looks: Vec<(Preset, Look)> = all.collect::<Result<_>>()?;
    let all_tags = |looks: &[(Preset, Look)]| -> Vec<String> {
        looks.iter().flat_map(|(preset, _)| preset.title.tags.clone()).collect()
    };
    let mut tags = all_tags(&looks);
    looks.retain(|(preset, _)| args.tag.iter().all(|tag| preset.title.tags.contains(tag)));
    if looks.is_empty() {
        tags.sort();
        tags.dedup();
        let place = format!("--tag {}", args.tag.join(" --tag "));
        return Err(Error::input(place, "no look has that", format!("choose from {}", tags.join(", "))));
    }
    if args.json {
        let objects = looks.iter().map(|(_, look)| {
            let mut object: Value = serde_json::from_str(look.json).unwrap_or_default();
            object["look"] = look.name().into();
            object
        });
        return output::print(&format!("{:#}\n", objects.collect::<Value>()));
    }
    let width = |text: fn(&(Preset, Look)) -> usize| looks.iter().map(text).max().unwrap_or(0) + 2;
    let ids = width(|(_, look)| look.name().len());
    let names = width(|(preset, _)| preset.title.name.as_deref().unwrap_or_default().len());
    let mut text = format!("{} look{}\n", looks.len(), if looks.len() == 1 { "" } else { "s" });
    let mut style = "";
    for (preset, look) in &looks {
        if style != preset.style {
            style = &preset.style;
            text += &format!("\n{style}\n");
        }
        let [name, about] =
            [&preset.title.name, &preset.title.about].map(|t| t.as_deref().unwrap_or_default());
        text += &format!("  {:ids$}{name:names$}{about}\n", look.name());
    }
    output::print(&text)
}

/// The file, and what it starts from.
fn made(args: &SaveArgs) -> Made<'_> {
    Made { from: Some(&args.style), to: &args.file }
}

/// Start of a file.
fn base(library: &Library, style: &Style, args: &SaveArgs) -> Result<Preset> {
    let SaveArgs { style: base, file, .. } = args;
    let plain = |style| Preset {
        title: Title::default(),
        style,
        lengths: None,
        params: Vec::new(),
        objects: Vec::new(),
    };
    if library.find_node(&style.name).is_ok() {
        return Ok(plain(style.name.clone()));
    }
    let text = source::read(base)?;
    if preset::is_graph(&text) {
        return Ok(plain(rules::from(file, base)?));
    }
    let preset = preset::parse(base, &text)?;
    let inner = preset::style_beside(&preset.style, base);
    let is_same = inner == *preset.style;
    let style = if is_same { preset.style } else { rules::from(file, Path::new(&inner))? };
    let mut objects = preset.objects;
    match &args.names_from {
        Some(frame) => rules::write_out(&mut objects, base, frame)?,
        None => rules::move_looks(&mut objects, base, file)?,
    }
    Ok(Preset { style, objects, ..preset })
}

/// The style that is written, and all that is set in it.
fn styled(library: &Library, args: &SaveArgs) -> Result<(Style, Vec<Setting>)> {
    let style = Style::any(library, &args.style, &[])?;
    let mut settings = match args.palette.read(library)? {
        Some(palette) => style.palette_settings(&palette)?,
        None => Vec::new(),
    };
    settings.extend(args.set.iter().cloned());
    settings.iter().try_for_each(|setting| style.set(setting))?;
    Ok((style, settings))
}

fn save(library: &Library, args: &SaveArgs) -> Result<()> {
    let SaveArgs { file, all, name, about, tag, .. } = args;
    let (style, settings) = styled(library, args)?;
    let mut preset = base(library, &style, args)?;
    if args.names_from.is_some() && preset.objects.is_empty() {
        let problem = "is for presets with rules for things, and this style has none";
        return Err(Error::input("--names-from", problem, "leave it out"));
    }
    let title = Title { name: name.clone(), about: about.clone(), tags: tag.clone() };
    preset.title = title.or(preset.title);
    for setting in &settings {
        let param = match &setting.node {
            Some(node) => format!("{node}.{}", setting.param),
            None => setting.param.clone(),
        };
        preset.params.retain(|(name, _)| *name != param);
        preset.params.push((param, Track::Still(setting.value.clone())));
    }
    if *all {
        if library.find_node(&preset.style).is_err() {
            let problem = "is for nodes; a graph file holds the values of its own parameters";
            return Err(Error::input("--all", problem, "leave --all out"));
        }
        let spec = style.graph.spec(0).map_err(|e| e.at(&style.name, "choose another style"))?;
        for param in &spec.params {
            if !preset.params.iter().any(|(name, _)| name == param.id) {
                // What has a kind that this program does not know keeps its default.
                let value = default(&param.kind);
                preset.params.extend(value.map(|value| (param.id.to_owned(), Track::Still(value))));
            }
        }
    }
    // A preset may start from another, whose graph is a third file.
    if is_same(&file.with_file_name(&preset.style), file) {
        return Err(Error::file(file, "is the graph that the preset is for", "name another file"));
    }
    let text = preset::text(&preset)?;
    let write = |existing| files::write_bytes(file, existing, text.as_bytes());
    args.consent().write(made(args), |_| false, write)?;
    if args.quiet.quiet { Ok(()) } else { output::print(&summary(file, &preset)) }
}

/// The line on a preset that is as it should be.
fn summary(file: &Path, preset: &Preset) -> String {
    let frames: Vec<i64> = preset.params.iter().flat_map(|(_, track)| track.frames()).collect();
    let animated = match (frames.iter().min(), frames.iter().max()) {
        (Some(first), Some(last)) => format!(", keyframes {first} to {last}"),
        _ => String::new(),
    };
    let count = preset.params.len();
    let plural = if count == 1 { "" } else { "s" };
    let style = preset::style_shown(preset);
    format!("{}: {style} with {count} parameter{plural}{animated}\n", file.display())
}

fn show(library: &Library, file: &Path, frame: Option<i64>) -> Result<()> {
    let (style, preset) = open(library, file)?;
    let Title { name, about, tags } = &preset.title;
    let mut text: String = name.iter().chain(about).map(|line| format!("{line}\n")).collect();
    if !tags.is_empty() {
        text += &format!("tags: {}\n", tags.join(", "));
    }
    text += &format!("{}\n", preset::style_shown(&preset));
    for (name, track) in &preset.params {
        let value = match track {
            Track::Still(value) => value.clone(),
            Track::Keys { keys, step } => match frame.and_then(|frame| style.animated_at(name, frame)) {
                Some(value) => value,
                None => {
                    let keys: Vec<String> =
                        keys.iter().map(|(frame, value)| format!("{value} at {frame}")).collect();
                    let suffix = if *step == Some(true) { ", held between" } else { "" };
                    keys.join(", ") + suffix
                }
            },
        };
        text += &format!("  {name} = {value}\n");
    }
    if preset.params.is_empty() {
        text += "  nothing but defaults\n";
    }
    output::print(&text)
}

fn check(library: &Library, files: &[PathBuf]) -> Result<()> {
    let mut wrong = 0;
    for file in files {
        match source::read(file).and_then(|text| Style::faults(library, file, &text)) {
            Ok((preset, faults)) if faults.is_empty() => {
                output::print(&summary(file, &preset))?;
            }
            Ok((_, faults)) => {
                wrong += 1;
                faults.into_iter().try_for_each(report)?;
            }
            Err(fault) => {
                wrong += 1;
                report(fault)?;
            }
        }
    }
    if wrong > 0 {
        let problem = format!("{wrong} of {} cannot be used", files.len());
        return Err(Error::input("presets", problem, "correct what is reported above"));
    }
    Ok(())
}

/// Prints what is wrong with a preset; what is wrong with the machine ends the run.
fn report(fault: Error) -> Result<()> {
    if let Error::Failure { .. } = fault {
        return Err(fault);
    }
    output::complain(&fault);
    Ok(())
}

/// The preset of a file, and the style that it makes.
fn open(library: &Library, file: &Path) -> Result<(Style, Preset)> {
    let preset = preset::parse(file, &source::read(file)?)?;
    let style = Style::any(library, file, &[])?;
    Ok((style, preset))
}

/// The default of a parameter as `--set` takes it; nothing of a kind that this program does not know.
fn default(kind: &ParamKind) -> Option<String> {
    Some(match kind {
        ParamKind::Unknown { .. } => return None,
        ParamKind::Float { default, .. } => default.to_string(),
        ParamKind::Int { default, .. } => default.to_string(),
        ParamKind::Bool { default } => default.to_string(),
        ParamKind::Choice { default, .. } => (*default).to_owned(),
        ParamKind::Color { default } => default.map(|v| v.to_string()).join(","),
    })
}
