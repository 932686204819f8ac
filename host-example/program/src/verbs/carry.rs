//! `isophote carry`: painted maps of key frames, carried along the motion of a shot.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::{Args, ValueHint};

use super::places::ESTIMATE;
use super::shared::{ForceArgs, QuietArgs};
use isophote_files::error::{Error, Result};
use isophote_files::frames::{self, Pattern};
use isophote_files::replacing::{Inputs, Made};
use isophote_files::{files, output};
use isophote_finishing::carry::files::MapFiles;
use isophote_finishing::carry::{Carried, Key, Shot, Vectors};
use isophote_loader::Library;
use isophote_pictures::exr::{Convention, Selection};
use isophote_pictures::write::Format;

/// Share of a frame without a map from which on it is warned of.
const TOLD: f32 = 0.01;

/// Options of `carry`.
#[derive(Args, Debug)]
#[command(after_help = "`isophote carry control.####.png shot.####.exr carried/control.####.png` and then \
                  `isophote apply ink shot.####.exr out.####.exr --control carried/control.####.png`. Masks are carried likewise. Between \
                  two key frames both maps are seen, each the more the nearer it is.")]
pub struct CarryArgs {
    /// Maps of the frames that were painted on: control.####.png, of which those files count that there are; or one file.
    #[arg(value_hint = ValueHint::AnyPath)]
    maps: PathBuf,
    /// The frames of the shot: shot.####.exr.
    #[arg(value_hint = ValueHint::AnyPath)]
    shot: PathBuf,
    /// Maps of all frames, such as carried/control.####.png.
    #[arg(value_hint = ValueHint::AnyPath)]
    out: PathBuf,
    /// Frame of the map, where that is one file [default: the first].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    key: Option<i64>,
    /// EXR files with motion vectors, one for each frame: mv.####.exr; or estimate, for optical flow of the pictures [default: the
    /// vectors of the shot's own files].
    #[arg(long, value_name = "FILES", value_hint = ValueHint::FilePath)]
    motion: Option<PathBuf>,
    /// Meaning of motion vectors, as for `isophote apply` [default: what the name of their layer says].
    #[arg(long, value_name = "NAME")]
    motion_convention: Option<Convention>,
    #[command(flatten)]
    force: ForceArgs,
    #[command(flatten)]
    quiet: QuietArgs,
}

/// Runs the verb.
///
/// # Errors
/// [`Error::Input`] for maps and frames that do not fit or cannot be read, before anything is written where that can be known;
/// [`Error::Failure`] when the library fails or nothing can be written.
pub fn run(args: &CarryArgs) -> Result<()> {
    let (shot, out) = (pattern(&args.shot, "shot.####.exr")?, pattern(&args.out, "control.####.png")?);
    let numbers = shot.on_disk()?;
    let keys = args.keys(&numbers)?;
    args.check(&out, &numbers, &keys)?;
    let keys = Key::read_all(&keys)?;
    let mut vectors = args.vectors(shot)?;
    let mut worst: Vec<Carried> = Vec::new();
    let mut told = |carried: Carried| {
        if carried.unknown > TOLD {
            worst.push(carried);
        }
    };
    let mut files = MapFiles::new(&out, args.force.existing(), &keys, &mut told);
    Shot { frames: &numbers, keys: &keys }.carry(&mut vectors, &mut files)?;
    if let Some(most) = worst.iter().max_by(|a, b| a.unknown.total_cmp(&b.unknown)) {
        let frames: Vec<i64> = worst.iter().map(|carried| carried.frame).collect();
        output::warn(format_args!(
            "in the frames {} no map is seen in parts of the picture, {:.0} % of it in frame {}; nothing is painted there. Paint \
             another key frame",
            frames::summary(&frames),
            most.unknown * 100.0,
            most.frame
        ));
    }
    if args.quiet.quiet {
        return Ok(());
    }
    output::print(&format!("{} maps written: {}\n", numbers.len(), args.out.display()))
}

/// The pattern of files for each frame.
fn pattern(path: &Path, example: &str) -> Result<Pattern> {
    let none = || Error::file(path, "has no place for a frame number", format!("write {example}"));
    Pattern::new(path)?.ok_or_else(none)
}

impl CarryArgs {
    /// Frames that were painted on, with their maps; at least one.
    fn keys(&self, frames: &[i64]) -> Result<Vec<(i64, PathBuf)>> {
        let (first, last) =
            (frames.first().copied().unwrap_or_default(), frames.last().copied().unwrap_or_default());
        let Some(maps) = Pattern::new(&self.maps)? else {
            let key = self.key.unwrap_or(first);
            if !frames.contains(&key) {
                let fix = format!("name one from {first} to {last}");
                return Err(Error::input("--key", format!("the shot has no frame {key}"), fix));
            }
            return Ok(vec![(key, self.maps.clone())]);
        };
        if self.key.is_some() {
            let problem = "each of several maps has the number of its frame";
            return Err(Error::input("--key", problem, "leave it out, or name one map"));
        }
        let keys: Vec<i64> = maps.on_disk()?.into_iter().filter(|key| frames.contains(key)).collect();
        if keys.is_empty() {
            let problem = format!("has maps of none of the shot's frames, {first} to {last}");
            return Err(Error::file(&self.maps, problem, "give a map the number of its frame"));
        }
        Ok(keys.into_iter().map(|key| (key, maps.file(key))).collect())
    }

    /// Refuses results that would replace what is read, or are there, before anything is made.
    fn check(&self, out: &Pattern, frames: &[i64], keys: &[(i64, PathBuf)]) -> Result<()> {
        let results: Vec<PathBuf> = frames.iter().map(|frame| out.file(*frame)).collect();
        let made: Vec<Made<'_>> = results.iter().map(|to| Made { from: None, to }).collect();
        let wanted: BTreeSet<i64> = frames.iter().copied().collect();
        self.force.consent().check(&made, true, || {
            let mut inputs = Inputs::of(keys.iter().map(|(_, path)| path));
            inputs.add_frames(&self.shot, Some(&wanted))?;
            let files = self.motion.iter().filter(|_| !self.estimates());
            files.map(|files| inputs.add_frames(files, Some(&wanted))).collect::<Result<Vec<()>>>()?;
            Ok(inputs)
        })?;
        let Some(first) = results.first() else { return Ok(()) };
        if matches!(Format::of(first)?, Format::Jpeg | Format::Svg) {
            return Err(Error::file(
                first,
                "would not hold maps as they are",
                "write .png, .tif or .exr files",
            ));
        }
        if let Some(folder) = first.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            std::fs::create_dir_all(folder).map_err(|e| files::unwritable(folder, Some(e.kind()), e))?;
        }
        files::check_writable(first, self.force.existing())
    }

    fn estimates(&self) -> bool {
        self.motion.as_deref() == Some(Path::new(ESTIMATE))
    }

    fn vectors(&self, shot: Pattern) -> Result<Vectors> {
        if self.estimates() {
            return Vectors::estimated(shot, &Library::open()?);
        }
        let files = self.motion.as_deref().map(|files| pattern(files, "mv.####.exr")).transpose()?;
        let selection = Selection { convention: self.motion_convention, ..Selection::default() };
        Ok(Vectors::of_files(shot, files, selection))
    }
}
