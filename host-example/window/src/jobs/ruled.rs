//! Rules of looks for things, on frames that the window shows: what their things cover of a frame, and what rules make of it.

use std::mem;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::state::document::frame::{Frame, GuideImage};
use crate::state::document::{Info, reduce};
use crate::state::look::EditedLook;
use crate::state::things::{Sampled, Things};
use isophote_files::error::{Error, Result};
use isophote_files::limits;
use isophote_finishing::apply::masks::{MaskChoice, Masks};
use isophote_finishing::apply::square;
use isophote_finishing::directed::{Directed, Followed, Given};
use isophote_finishing::stylize::preset::ObjectRule;
use isophote_finishing::stylize::style::Style;
use isophote_finishing::stylize::things;
use isophote_loader::Library;
use isophote_loader::process::Part;
use isophote_pictures::exr::{Guide, MaskSource, OnUnknown, Selection};
use isophote_pictures::mix::Encoding;
use isophote_pictures::pixels::{Pixels, Samples};
use isophote_pictures::read;

/// A frame as rules direct it.
#[derive(Clone, Debug)]
pub struct Ruled {
    /// The frame, with the maps that they are.
    pub frame: Arc<Frame>,
    /// By rule, where its look is.
    masks: Arc<[Pixels]>,
}

impl Ruled {
    /// By rule, where its look is in a part of the frame that is made as small as `size`, and how it is laid over what is below.
    pub fn places(&self, size: (u32, u32), part: Part) -> (Vec<Pixels>, Encoding) {
        let frame = &self.frame;
        let [[left, top], [right, bottom]] = part;
        let placed = |mask: &Pixels| {
            if (frame.width, frame.height) == size && part == reduce::whole(size) {
                return Some(mask.clone());
            }
            let numbers = reduce::numbers(&mask.to_f32(), (frame.width, frame.height), size, part);
            Pixels::new(right.abs_diff(left), bottom.abs_diff(top), 1, Samples::F32(numbers))
        };
        let encoding = Encoding { is_premultiplied: frame.is_premultiplied(), space: frame.request.space };
        (self.masks.iter().filter_map(placed).collect(), encoding)
    }
}

/// Coverage of the things of each rule, from 0 to 1 by pixel; empty where nothing is known of any.
type Coverage = Arc<[Vec<f32>]>;

/// A frame that rules were followed on last, and what came of it; nothing where they are for nothing in it.
#[derive(Debug)]
struct Last {
    of: Arc<Frame>,
    objects: Vec<ObjectRule>,
    ruled: Option<Ruled>,
}

/// Coverage that was read from a file last, for frames of a size.
#[derive(Debug)]
struct FromFile {
    file: PathBuf,
    info: Arc<Info>,
    sources: Vec<MaskSource>,
    size: (u32, u32),
    coverage: Coverage,
}

/// Rules of looks, with what is kept of the last frame.
#[derive(Debug)]
pub struct Rules {
    library: Library,
    last: Option<Last>,
    from_file: Option<FromFile>,
    /// Rules that nothing was found for, and where that was told.
    told: Vec<(Things, Vec<MaskSource>)>,
    /// Sentences that are to be told.
    news: Vec<String>,
}

impl Rules {
    /// None that were followed.
    pub fn new(library: Library) -> Self {
        Self { library, last: None, from_file: None, told: Vec::new(), news: Vec::new() }
    }

    /// Sentences about rules that nothing was found for, each once.
    pub fn take_news(&mut self) -> Vec<String> {
        mem::take(&mut self.news)
    }

    /// Gives memory back.
    pub fn rest(&mut self) {
        (self.last, self.from_file) = (None, None);
    }

    /// Rules of a look, whose style this is, for things; nothing where it has none.
    ///
    /// # Errors
    /// [`Error::Input`] for rules that the style does not follow, and for looks of things that cannot be made.
    pub fn directed(
        &mut self,
        look: &EditedLook,
        style: &Style,
        things: Option<&Things>,
    ) -> Result<Option<Directed>> {
        let Some(things) = things.filter(|_| !style.objects.is_empty()) else { return Ok(None) };
        let sources = style.things()?;
        let looks = things::looks(&self.library, None, style)?;
        match things {
            Things::Scene { scene, name, .. } => {
                let names = [scene.object_names(), scene.material_names()];
                let names = names.each_ref().map(Vec::as_slice);
                let unknown = |source: &MaskSource| source.among(name, names, OnUnknown::Fail).err();
                let unknown = sources.iter().find_map(unknown);
                unknown.iter().for_each(|error| self.tell(look, things, &sources, error));
                Directed::new(&self.library, style, looks, (scene, name), OnUnknown::Quiet)
            }
            Things::File { .. } => Directed::covered(&self.library, style, looks).map(Some),
        }
    }

    /// A frame as the rules of a look direct it; nothing where they are for nothing in it.
    ///
    /// # Errors
    /// [`Error::Failure`] when memory is short.
    pub fn follow(
        &mut self,
        directed: &Directed,
        (look, style): (&EditedLook, &Style),
        (frame, things): (&Arc<Frame>, &Things),
    ) -> Result<Option<Ruled>> {
        let objects = &style.objects;
        let is_known = |last: &&Last| Arc::ptr_eq(&last.of, frame) && last.objects == *objects;
        if let Some(last) = self.last.as_ref().filter(is_known) {
            return Ok(last.ruled.clone());
        }
        let coverage = match things {
            Things::Scene { sampled, .. } => counted(directed, frame, sampled.as_deref()),
            Things::File { info, number } => self.of_file(look, style.things()?, (frame, info, *number))?,
        };
        let ruled = (!coverage.is_empty()).then(|| ruled(directed, frame, &coverage));
        self.last = Some(Last { of: Arc::clone(frame), objects: objects.clone(), ruled: ruled.clone() });
        Ok(ruled)
    }

    /// Coverage of a frame by the things of rules, as its file says, which is kept until another is asked for; empty where it knows
    /// none of them.
    fn of_file(
        &mut self,
        look: &EditedLook,
        sources: Vec<MaskSource>,
        (frame, info, number): (&Frame, &Arc<Info>, Option<i64>),
    ) -> Result<Coverage> {
        let Some(file) = info.file_of(number) else { return Ok(Coverage::default()) };
        let size = (frame.width, frame.height);
        let known = self.from_file.take().filter(|known| {
            Arc::ptr_eq(&known.info, info)
                && (&known.file, &known.sources, known.size) == (&file, &sources, size)
        });
        let read = match known {
            Some(known) => known,
            None => {
                let masks = self.masks(look, &sources, (info, &file, number))?;
                let fitting = |mask: &Option<Pixels>| match mask {
                    Some(mask) => {
                        let own = (mask.width(), mask.height());
                        reduce::numbers(&mask.to_f32(), own, size, reduce::whole(size))
                    }
                    None => vec![0.0; frame.color.len()],
                };
                let is_any = masks.iter().any(Option::is_some);
                let coverage = if is_any { masks.iter().map(fitting).collect() } else { Coverage::default() };
                FromFile { file, info: Arc::clone(info), sources, size, coverage }
            }
        };
        Ok(Arc::clone(&self.from_file.insert(read).coverage))
    }

    /// Masks of the things of rules in a file. Those that it does not have are told of.
    fn masks(
        &mut self,
        look: &EditedLook,
        sources: &[MaskSource],
        (info, file, number): (&Arc<Info>, &Path, Option<i64>),
    ) -> Result<Vec<Option<Pixels>>> {
        let things = Things::File { info: Arc::clone(info), number };
        let on_unknown = if self.is_told(&things, sources) { OnUnknown::Quiet } else { OnUnknown::Fail };
        let all = |on_unknown| read_masks(&self.library, (info, file), sources, on_unknown);
        match all(on_unknown) {
            Ok((masks, None)) => Ok(masks),
            Ok((_, Some(refused))) => {
                let (masks, _) = all(OnUnknown::Quiet)?;
                self.tell(look, &things, sources, &refused);
                Ok(masks)
            }
            Err(failure @ Error::Failure { .. }) => Err(failure),
            // Where it lacks what one rule wants, such as numbers of objects, it may have that of others.
            Err(refused) => {
                self.tell(look, &things, sources, &refused);
                let one = |source: &MaskSource| {
                    let source = std::slice::from_ref(source);
                    match read_masks(&self.library, (info, file), source, OnUnknown::Quiet) {
                        Ok((masks, _)) => Ok(masks.into_iter().next().flatten()),
                        Err(failure @ Error::Failure { .. }) => Err(failure),
                        Err(_) => Ok(None),
                    }
                };
                sources.iter().map(one).collect()
            }
        }
    }

    fn is_told(&self, things: &Things, sources: &[MaskSource]) -> bool {
        self.told.iter().any(|(known, of)| known.are_of_same(things) && of == sources)
    }

    /// Tells why rules of a look are for nothing, once where the same are open.
    fn tell(&mut self, look: &EditedLook, things: &Things, sources: &[MaskSource], problem: &Error) {
        if self.is_told(things, sources) {
            return;
        }
        self.told.retain(|(known, _)| known.are_of_same(things));
        self.told.push((things.unsampled(), sources.to_vec()));
        self.news.push(format!("{} has a rule for something that is not here: {problem}", look.name));
    }
}

/// Coverage of a frame by the things of each rule, counted in samples of its pixels.
fn counted(directed: &Directed, frame: &Frame, sampled: Option<&Sampled>) -> Coverage {
    let mut coverage = Vec::new();
    match (sampled, frame.guide(Guide::ObjectId)) {
        (Some(sampled), _) => {
            sampled.each(|numbers| directed.count(&mut coverage, numbers, sampled.count()));
        }
        (None, Some(numbers)) => directed.count(&mut coverage, &numbers.data, 1),
        (None, None) => {}
    }
    coverage.into()
}

/// A frame as rules direct it whose things cover so much of it.
fn ruled(directed: &Directed, frame: &Arc<Frame>, coverage: &[Vec<f32>]) -> Ruled {
    let size = (frame.width, frame.height);
    let guide = |guide: Guide| frame.guide(guide).map(|image| image.data.as_slice());
    let given = Given {
        size,
        encoding: Encoding { is_premultiplied: frame.is_premultiplied(), space: frame.request.space },
        control: guide(Guide::Control),
        line_paint: guide(Guide::LinePaint),
        depth: guide(Guide::Depth),
    };
    let Followed { maps, masks } = directed.follow(coverage, &given);
    let frame = if maps.is_empty() {
        Arc::clone(frame)
    } else {
        let image = |(guide, map): (Guide, Pixels)| {
            Arc::new(GuideImage { guide, channels: map.channels(), data: map.to_f32() })
        };
        Arc::new(frame.painted(maps.into_iter().map(image), frame.mask.clone()))
    };
    Ruled { frame, masks: masks.into() }
}

/// Masks of things in the file of a document, and why one of them is missing.
fn read_masks(
    library: &Library,
    (info, file): (&Info, &Path),
    sources: &[MaskSource],
    on_unknown: OnUnknown,
) -> Result<(Vec<Option<Pixels>>, Option<Error>)> {
    let name = file.display().to_string();
    let (masks, rules) = (sources.to_vec(), sources.len());
    let selection = Selection { masks, rules, on_unknown, ..info.selection.clone() };
    let opened = read::open(file, &selection)?;
    limits::must_have(opened.weight(false), &name)?;
    let mut source = opened.decode(file)?;
    source.exr = None;
    source.pictures.truncate(1);
    let choice = |source: &MaskSource| MaskChoice { source: source.clone(), invert: false };
    let choices: Vec<MaskChoice> = sources.iter().map(choice).collect();
    Masks::new(&choices, None, on_unknown)?.add(&mut source, None)?;
    if !square::is_square(&source) {
        square::make(library, &name, &mut source)?;
    }
    let picture = source.pictures.pop();
    Ok(picture.map_or((Vec::new(), None), |picture| (picture.masks, picture.refused)))
}
