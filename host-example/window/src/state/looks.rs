//! Looks at hand, of which one is shown: its parameters, its nodes, and the part of it that is looked at.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::chain::{self, Chain, Watched};
use super::look::{EditedLook, Parameter};
use super::values::TypedPreset;
use isophote_files::error::Result;
use isophote_finishing::stylize::preset::{Lengths, Title};
use isophote_finishing::stylize::style::Setting;
use isophote_loader::Library;
use isophote_loader::catalogue::Node;

/// Inputs that people make.
const MADE: [&str; 5] = ["mask", "control", "paper", "hatching", "line_paint"];

/// Those that a look reads; none where it cannot be made.
fn inputs(look: &EditedLook, library: &Library) -> Vec<&'static str> {
    let Ok(Some(style)) = look.style(library) else { return Vec::new() };
    MADE.into_iter().filter(|input| style.takes(input).unwrap_or_default()).collect()
}

/// The looks, at least one.
pub struct Looks {
    /// Look that the present one is compared with, if that is not the original.
    pub compared: Option<EditedLook>,
    library: Library,
    /// All of them in the order of the keys 1, 2, ...
    list: Vec<Arc<EditedLook>>,
    current: usize,
    /// Parameters of the present look.
    parameters: Arc<[Parameter]>,
    /// Inputs that it reads beside the picture, of those that people make.
    inputs: Vec<&'static str>,
    /// The list of nodes that the present look is, if it is one.
    chain: Option<Chain>,
    /// The part of it that is looked at, if not the whole.
    watched: Option<Watched>,
    /// The node whose parameters are shown, if not those of all.
    selected: Option<String>,
    /// Names of the parameters that have no effect at the moment.
    idle: HashSet<String>,
    /// Nodes that can be put into a list.
    fitting: Vec<Node>,
    /// Looks as their files have them, or as the command line has made them: that much is not lost with the window.
    /// Others are as they were opened.
    kept: HashMap<PathBuf, TypedPreset>,
}

impl Looks {
    /// Looks of which the first is shown.
    ///
    /// # Errors
    /// As [`EditedLook::parameters`].
    pub fn new(library: &Library, looks: Vec<EditedLook>) -> Result<Self> {
        let mut looks = Self {
            compared: None,
            library: library.clone(),
            list: looks.into_iter().map(Arc::new).collect(),
            current: 0,
            parameters: Arc::default(),
            inputs: Vec::new(),
            chain: None,
            watched: None,
            selected: None,
            idle: HashSet::new(),
            fitting: chain::fitting(library),
            kept: HashMap::new(),
        };
        if let Some(first) = looks.list.first() {
            looks.chain = first.chain(library)?;
            looks.parameters = first.parameters(library)?.into();
            looks.inputs = inputs(first, library);
        }
        Ok(looks)
    }

    /// All of them, in the order of the keys 1, 2, ...
    pub fn list(&self) -> &[Arc<EditedLook>] {
        &self.list
    }

    /// The look that is shown and edited.
    pub fn present(&self) -> &Arc<EditedLook> {
        &self.list[self.current]
    }

    /// Its place among the looks.
    pub fn current(&self) -> usize {
        self.current
    }

    /// Its parameters.
    pub fn parameters(&self) -> &Arc<[Parameter]> {
        &self.parameters
    }

    /// True where it reads an input that people make: a mask, a map that they paint, paper or hatching.
    pub fn takes(&self, input: &str) -> bool {
        self.inputs.contains(&input)
    }

    /// True where a parameter of it has no effect at the moment.
    pub fn is_idle(&self, parameter: &Parameter) -> bool {
        self.idle.contains(&parameter.name)
    }

    /// Takes over which parameters of the present look have no effect, by their names.
    pub fn set_idle(&mut self, idle: HashSet<String>) {
        self.idle = idle;
    }

    /// The list of nodes that it is, if it is one.
    pub fn chain(&self) -> Option<&Chain> {
        self.chain.as_ref()
    }

    /// The part of the list that is looked at, if not the whole.
    pub fn watched(&self) -> Option<&Watched> {
        self.watched.as_ref()
    }

    /// Looks at a part of the list, or at the whole.
    pub fn watch(&mut self, watched: Option<Watched>) {
        self.watched = watched.filter(|watched| self.has_node(watched.node()));
    }

    /// The node whose parameters are shown, if not those of all.
    pub fn selected(&self) -> Option<&str> {
        self.selected.as_deref()
    }

    /// Shows the parameters of one node, or of all.
    pub fn select(&mut self, node: Option<String>) {
        self.selected = node.filter(|name| self.has_node(name));
    }

    /// Nodes that can be put into a list.
    pub fn fitting(&self) -> &[Node] {
        &self.fitting
    }

    fn has_node(&self, name: &str) -> bool {
        self.chain.as_ref().is_some_and(|chain| chain.has(name))
    }

    /// The look as far as it is looked at.
    pub fn seen(&self) -> Cow<'_, EditedLook> {
        let (Some(chain), Some(watched)) = (&self.chain, &self.watched) else {
            return Cow::Borrowed(self.present());
        };
        let part = self.present().watched(&self.library, chain, watched);
        part.map_or_else(|_| Cow::Borrowed(&**self.present()), Cow::Owned)
    }

    /// Shows the look of an index, which may have changed.
    ///
    /// # Errors
    /// As [`EditedLook::parameters`]; those of before stay.
    pub fn turn_to(&mut self, index: usize) -> Result<()> {
        if index != self.current {
            (self.watched, self.selected) = (None, None);
        }
        self.current = index;
        self.chain = self.present().chain(&self.library).unwrap_or_default();
        let (selected, watched) = (self.selected.take(), self.watched.take());
        self.select(selected);
        self.watch(watched);
        self.idle.clear();
        self.inputs = inputs(self.present(), &self.library);
        self.parameters = self.present().parameters(&self.library)?.into();
        Ok(())
    }

    /// Changes the present look; says whether it is another then.
    pub fn edit(&mut self, change: impl FnOnce(&mut EditedLook)) -> bool {
        let before = Arc::clone(self.present());
        change(Arc::make_mut(&mut self.list[self.current]));
        **self.present() != *before
    }

    /// Puts a look in the place of the present one.
    pub fn replace(&mut self, look: EditedLook) {
        self.list[self.current] = Arc::new(look);
    }

    /// The look that was opened as something.
    pub fn find(&self, source: &Path) -> Option<usize> {
        self.list.iter().position(|look| look.source == source)
    }

    /// Takes a look in the place of one that was opened as the same, or behind all others; returns its place.
    pub fn put(&mut self, look: Arc<EditedLook>) -> usize {
        match self.find(&look.source) {
            Some(index) => {
                self.list[index] = look;
                index
            }
            None => {
                self.list.push(look);
                self.list.len() - 1
            }
        }
    }

    /// Has these looks, in the place of all, and shows the one of an index.
    ///
    /// # Errors
    /// As [`Looks::turn_to`].
    pub fn restore(&mut self, list: Vec<Arc<EditedLook>>, index: usize) -> Result<()> {
        self.list = list;
        self.turn_to(index)
    }

    /// A file has what this look was opened as.
    pub fn keep(&mut self, look: &EditedLook) {
        self.kept.insert(look.source.clone(), look.opened().clone());
    }

    /// The window's own copies of a look whose file has a new title.
    pub fn retitle(&mut self, file: &Path, title: &Title) {
        for look in self.list.iter_mut().filter(|look| look.source == file) {
            Arc::make_mut(look).retitle(title);
        }
    }

    /// Settings of the command line, for all looks that have such parameters, and what lengths mean.
    pub fn prepare(&mut self, settings: &[Setting], lengths: Option<Lengths>) {
        for look in self.list.iter_mut().filter(|look| !look.is_plain()) {
            let look = Arc::make_mut(look);
            if lengths.is_some() {
                look.preset.lengths = lengths;
            }
            let parameters = look.parameters(&self.library).unwrap_or_default();
            settings.iter().for_each(|setting| look.take(&parameters, setting));
            self.kept.insert(look.source.clone(), look.preset.clone());
        }
    }

    /// Looks that are in no file as they are now, by their places: closing the window loses them.
    pub fn unsaved(&self) -> Vec<usize> {
        let is_lost = |index: &usize| {
            let look = &self.list[*index];
            let kept = self.kept.get(&look.source).unwrap_or_else(|| look.opened());
            !look.is_plain() && !kept.says_the_same(&look.preset)
        };
        (0..self.list.len()).filter(is_lost).collect()
    }
}
