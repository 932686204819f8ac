//! Shaders cut into pieces, as the engine joins them (`isophote_engine::wgsl`), where naga finds what they are made of.

use crate::imports::{AT_PLACE, STORE};
use naga::{AddressSpace, Expression, ImageClass, Literal, Module, Span, TypeInner};
use std::ops::Range;

/// Load from the only texture of a kernel that is computed for the window of another, up to the place.
const LOAD: &str = "fetch(source, 0u, ";

/// Attribute of an entry point, up to the sides of its workgroups, and these.
const WORKGROUP: (&str, &str) = ("@workgroup_size(", "8, 8");

/// Beginning of the name of a constant that holds the number of an input.
const SLOT: &str = "INPUT_";

/// Piece of WGSL. Its debug text is the engine's piece as Rust has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Piece<'t> {
    /// Text that is the same in every shader.
    Text(&'t str),
    /// Name that the text declares for its whole module.
    Name(&'t str),
    /// Declaration of something bound, or a part of it.
    Binding(&'t str),
    /// Format of a storage texture.
    Format {
        /// Number of the output.
        output: usize,
        /// Format of 32-bit floats.
        exact: &'t str,
    },
    /// Uniform block.
    Params,
    /// Uniform block of the columns in a pair.
    ColumnsParams,
    /// Type of the uniform block.
    ParamsType,
    /// Number of an input, in a constant.
    Slot(u32),
    /// Two sides of a workgroup.
    Workgroup,
    /// Beginning of the statement that stores the result.
    Store,
    /// Beginning of a load from the only texture.
    Load,
}

/// Places in a text, and the pieces that stand there.
type Marks<'t> = Vec<(Range<usize>, Piece<'t>)>;

/// Text in pieces.
pub struct Cut<'t> {
    /// The pieces; what they stand for is the text.
    pub pieces: Vec<Piece<'t>>,
    /// Beginning of each in the text.
    starts: Vec<usize>,
}

impl<'t> Cut<'t> {
    /// Cuts `text` at marks and between them at `breaks`. Of marks that overlap the first counts.
    fn new(text: &'t str, mut marks: Marks<'t>, breaks: &[usize]) -> Self {
        marks.sort_by_key(|(place, _)| place.start);
        let mut cut = Self { pieces: Vec::new(), starts: Vec::new() };
        let mut end = 0;
        for (place, piece) in marks {
            if place.start >= end {
                cut.text(text, end..place.start, breaks);
                cut.push(place.start, piece);
                end = place.end;
            }
        }
        cut.text(text, end..text.len(), breaks);
        cut
    }

    fn push(&mut self, start: usize, piece: Piece<'t>) {
        self.pieces.push(piece);
        self.starts.push(start);
    }

    fn text(&mut self, text: &'t str, place: Range<usize>, breaks: &[usize]) {
        let mut start = place.start;
        for end in breaks.iter().copied().filter(|at| place.contains(at)).chain([place.end]) {
            if start < end {
                self.push(start, Piece::Text(&text[start..end]));
            }
            start = end;
        }
    }

    /// Number of pieces before a place of the text where one begins.
    pub fn before(&self, at: usize) -> usize {
        self.starts.partition_point(|start| *start < at)
    }
}

/// A kernel's own text and what naga found in it.
pub struct Own<'m> {
    text: &'m str,
    /// Its beginning in the text that was parsed.
    start: usize,
    module: &'m Module,
}

impl<'m> Own<'m> {
    /// That of a module whose text is `shared` and then `own`.
    pub fn new(module: &'m Module, shared: &str, own: &'m str) -> Self {
        Self { text: own, start: shared.len(), module }
    }

    /// Place of a declaration in the text, if it lies there.
    fn place(&self, span: Span) -> Option<Range<usize>> {
        let Range { start, end } = span.to_range()?;
        (start >= self.start && end <= self.start + self.text.len())
            .then(|| start - self.start..end - self.start)
    }

    /// Places and names of its declarations for the whole module, without entry points.
    fn declared(&self) -> Vec<(Range<usize>, &'m str)> {
        let m = self.module;
        let functions = m.functions.iter().map(|(at, f)| (m.functions.get_span(at), &f.name));
        let variables = m.global_variables.iter().map(|(at, v)| (m.global_variables.get_span(at), &v.name));
        let constants = m.constants.iter().map(|(at, c)| (m.constants.get_span(at), &c.name));
        let overrides = m.overrides.iter().map(|(at, o)| (m.overrides.get_span(at), &o.name));
        let types = m.types.iter().map(|(at, t)| (m.types.get_span(at), &t.name));
        let all = functions.chain(variables).chain(constants).chain(overrides).chain(types);
        let found = all.filter_map(|(span, name)| Some((self.place(span)?, name.as_deref()?)));
        found.chain(self.dropped()).collect()
    }

    /// Constants without a type of their own: naga has put their values in their places, and keeps them no longer.
    fn dropped(&self) -> impl Iterator<Item = (Range<usize>, &'m str)> {
        let text = self.text;
        let lines = text.match_indices("\nconst ").map(move |(at, _)| line(text, at + 1));
        lines.filter_map(move |place| {
            let (name, _) = text[place.clone()].strip_prefix("const ")?.split_once(" = ")?;
            (!name.contains(':')).then_some((place, name))
        })
    }

    /// True when it declares a function of this name.
    pub fn has_function(&self, name: &str) -> bool {
        self.module.functions.iter().any(|(_, function)| function.name.as_deref() == Some(name))
    }

    /// Names of the textures that it reads, by their bindings.
    pub fn textures(&self) -> Vec<&'m str> {
        let mut found: Vec<(u32, &str)> = Vec::new();
        for (_, variable) in self.module.global_variables.iter() {
            let inner = &self.module.types[variable.ty].inner;
            if let TypeInner::Image { class: ImageClass::Sampled { .. }, .. } = inner {
                let binding = variable.binding.map_or(0, |binding| binding.binding);
                found.push((binding, variable.name.as_deref().unwrap_or_default()));
            }
        }
        found.sort_unstable();
        found.into_iter().map(|(_, name)| name).collect()
    }

    /// The textures, by their slots, that a shader of single pixels reads itself: those that have a constant for their slot.
    pub fn around(&self) -> Vec<usize> {
        let has_constant = |name: &str| {
            let constant = format!("{SLOT}{}", name.to_uppercase());
            self.module.constants.iter().any(|(_, c)| c.name.as_ref() == Some(&constant))
        };
        let textures = self.textures().into_iter().enumerate();
        textures.filter(|(_, name)| has_constant(name)).map(|(slot, _)| slot).collect()
    }

    /// Place of the struct of the uniform block, with the end of its last line.
    pub fn block(&self) -> Option<Range<usize>> {
        let (place, _) = self.declared().into_iter().find(|(_, name)| *name == "Params")?;
        Some(place.start..line(self.text, place.end - 1).end)
    }

    /// Beginning of what needs a workgroup: its memory or the entry point.
    pub fn workgroup(&self) -> Option<usize> {
        let m = self.module;
        let shared = m.global_variables.iter().filter(|(_, v)| v.space == AddressSpace::WorkGroup);
        let shared = shared.filter_map(|(at, _)| self.place(m.global_variables.get_span(at)));
        let entry = self.text.match_indices("@compute").map(|(at, _)| at);
        shared.map(|place| place.start).chain(entry).map(|at| line(self.text, at).start).min()
    }

    /// Lines of what is bound, with the formats of storage textures.
    fn bindings(&self) -> Result<Marks<'m>, String> {
        let mut marks = Vec::new();
        let m = self.module;
        let mut bound: Vec<_> = m.global_variables.iter().filter(|(_, v)| v.binding.is_some()).collect();
        bound.sort_by_key(|(_, v)| v.binding);
        let mut output = 0;
        for (at, variable) in bound {
            let Some(place) = self.place(m.global_variables.get_span(at)) else { continue };
            let whole = line(self.text, place.start);
            if place.end > whole.end || !self.text[whole.clone()].starts_with("@group(0) @binding(") {
                let name = variable.name.as_deref().unwrap_or_default();
                return Err(format!(
                    "`{name}` is bound by one line, which begins with `@group(0) @binding(`"
                ));
            }
            let mut start = whole.start;
            if let TypeInner::Image { class: ImageClass::Storage { .. }, .. } = m.types[variable.ty].inner {
                let (_, after) = self.text[whole.clone()]
                    .split_once("texture_storage_2d<")
                    .ok_or("results are stored in `texture_storage_2d`")?;
                let begin = whole.end - after.len();
                let end = begin + after.find(',').ok_or("a storage texture is for writing")?;
                marks.push((start..begin, Piece::Binding(&self.text[start..begin])));
                marks.push((begin..end, Piece::Format { output, exact: &self.text[begin..end] }));
                (output, start) = (output + 1, end);
            }
            marks.push((start..whole.end, Piece::Binding(&self.text[start..whole.end])));
        }
        Ok(marks)
    }

    /// Numbers of inputs in constants.
    fn slots(&self) -> Marks<'m> {
        let m = self.module;
        let constants = m.constants.iter().filter_map(|(at, constant)| {
            self.place(m.constants.get_span(at))?;
            constant.name.as_ref()?.starts_with(SLOT).then_some(constant.init)
        });
        let slots = constants.filter_map(|init| {
            let Expression::Literal(Literal::U32(slot)) = m.global_expressions[init] else { return None };
            let Range { start, .. } = self.place(m.global_expressions.get_span(init))?;
            Some((start..start + slot.to_string().len(), Piece::Slot(slot)))
        });
        slots.collect()
    }

    /// Words that stand for what it declares, if others may declare the same, and for its uniform block.
    fn words(&self, are_names_own: bool) -> Marks<'m> {
        let declared = self.declared();
        let structs: Vec<&Range<usize>> = declared
            .iter()
            .filter(|(place, _)| self.text[place.clone()].starts_with("struct"))
            .map(|(p, _)| p)
            .collect();
        let mark = |word: Range<usize>| {
            let text = &self.text[word.clone()];
            // The fields of a struct keep their names.
            let is_field =
                self.text[word.end..].starts_with(':') && structs.iter().any(|s| s.contains(&word.start));
            let is_declared = || declared.iter().any(|(_, name)| *name == text) && text != "target_image";
            let piece = match text {
                _ if is_field => return None,
                "params" => Piece::Params,
                "Params" => Piece::ParamsType,
                _ if are_names_own && is_declared() => Piece::Name(text),
                _ => return None,
            };
            Some((word, piece))
        };
        words(self.text).filter_map(mark).collect()
    }

    /// Cuts the text; what a kernel of single pixels declares are names of its own.
    ///
    /// # Errors
    /// The rule of the house that it breaks.
    pub fn cut(&self, is_of_single_pixels: bool) -> Result<Cut<'m>, String> {
        let mut marks = self.bindings()?;
        marks.extend(self.words(is_of_single_pixels));
        if is_of_single_pixels {
            marks.extend(self.slots());
        } else if self.has_function(AT_PLACE) {
            marks.extend(literal(self.text, LOAD, Piece::Load));
        }
        marks.extend(literal(self.text, STORE, Piece::Store));
        let sides = literal(self.text, &[WORKGROUP.0, WORKGROUP.1].concat(), Piece::Workgroup);
        marks.extend(
            sides.into_iter().map(|(place, piece)| (place.start + WORKGROUP.0.len()..place.end, piece)),
        );
        let block = self.block().into_iter().flat_map(|place| [place.start, place.end]);
        let mut breaks: Vec<usize> = block.chain(self.workgroup()).collect();
        breaks.sort_unstable();
        Ok(Cut::new(self.text, marks, &breaks))
    }
}

/// Cuts a text that kernels share: it may know of the first kernel's uniform block.
pub fn shared(text: &str) -> Vec<Piece<'_>> {
    named(text, &[("params", Piece::Params)]).pieces
}

/// Cuts the text of rows and columns in one dispatch.
pub fn pair(text: &str) -> Vec<Piece<'_>> {
    named(text, &[("rows_params", Piece::Params), ("columns_params", Piece::ColumnsParams)]).pieces
}

/// Cuts the text of an entry point that was written for a kernel of single pixels.
pub fn entry(text: &str) -> Vec<Piece<'_>> {
    named(text, &[]).pieces
}

/// Cuts a text at these words and where it stores a result.
fn named<'t>(text: &'t str, names: &[(&str, Piece<'t>)]) -> Cut<'t> {
    let piece = |word: Range<usize>| {
        let (_, piece) = names.iter().find(|(name, _)| *name == &text[word.clone()])?;
        Some((word, *piece))
    };
    let marks = words(text).filter_map(piece).chain(literal(text, STORE, Piece::Store)).collect();
    Cut::new(text, marks, &[])
}

/// Places where a text has these words.
fn literal<'t>(text: &str, words: &str, piece: Piece<'t>) -> Marks<'t> {
    text.match_indices(words).map(|(at, _)| (at..at + words.len(), piece)).collect()
}

/// The line that holds a place, with its end.
fn line(text: &str, at: usize) -> Range<usize> {
    let start = text[..at].rfind('\n').map_or(0, |end| end + 1);
    start..text[at..].find('\n').map_or(text.len(), |end| at + end + 1)
}

/// Words of a text, but for those in comments and what follows a dot.
fn words(text: &str) -> impl Iterator<Item = Range<usize>> {
    let is_letter = |c: u8| c.is_ascii_alphanumeric() || c == b'_';
    let (bytes, mut at) = (text.as_bytes(), 0);
    std::iter::from_fn(move || {
        while at < bytes.len() {
            let start = at;
            if text[at..].starts_with("//") {
                at = line(text, at).end;
                continue;
            }
            if !is_letter(bytes[at]) {
                at += 1;
                while !text.is_char_boundary(at) {
                    at += 1;
                }
                continue;
            }
            while at < bytes.len() && is_letter(bytes[at]) {
                at += 1;
            }
            if start == 0 || bytes[start - 1] != b'.' {
                return Some(start..at);
            }
        }
        None
    })
}
