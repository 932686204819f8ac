//! Previews: what looks make of the picture that is open, small or in part, made beside the window and kept within a bound.

pub mod order;
pub mod picture;

use std::collections::HashMap;
use std::sync::Arc;

use egui::{ColorImage, Context, TextureHandle, TextureOptions};

use self::order::{Done, Order, Task};
use self::picture::Picture;
use super::samples::Thumbnails;
use isophote_files::error::Result;
use isophote_loader::process::Part;

/// Most bytes of previews in memory, but for those that are shown.
const MOST_BYTES: usize = 96 << 20;

/// Most places that are remembered.
const MOST_SLOTS: usize = 4000;

/// Place that a preview is for. Each shows one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Place {
    /// The picture without a look, behind cards that have no preview yet.
    Plain,
    /// The card of this number.
    Card(u64),
    /// The selected look, larger.
    Large,
    /// A pane of the comparison: all of the picture.
    Pane(usize),
    /// The same: the part that is seen, where it is magnified.
    Detail(usize),
}

/// Previews by their places, and what is known of the picture.
#[derive(Default)]
pub struct Previews {
    /// Pictures that come with the program.
    pub samples: Thumbnails,
    picture: Option<Arc<Picture>>,
    slots: HashMap<Place, Slot>,
    /// Places that were asked for in this frame, the most urgent first.
    wanted: Vec<Place>,
    serial: u64,
    /// Counts frames.
    now: u64,
}

struct Slot {
    order: Order,
    serial: u64,
    /// True where nothing is to be made.
    is_done: bool,
    problem: Option<String>,
    made: Option<Made>,
    /// The frame that asked for it last.
    used: u64,
}

struct Made {
    image: Arc<ColorImage>,
    /// The texture, and true where it shows single pixels.
    texture: Option<(bool, TextureHandle)>,
    /// Order that it shows.
    order: Order,
    picture: Arc<Picture>,
}

/// A preview that can be drawn.
#[derive(Clone, Debug)]
pub struct Preview {
    /// The texture.
    pub texture: egui::TextureId,
    /// Size of the whole picture in its pixels.
    pub size: (u32, u32),
    /// The pixels of the picture that it shows.
    pub part: Part,
    /// True where it is of the picture and the look that are asked for.
    pub is_current: bool,
}

impl Previews {
    /// The picture that previews are of from now on. What is being made of another is given up.
    pub fn set_picture(&mut self, picture: Arc<Picture>) {
        for slot in self.slots.values_mut() {
            self.serial += 1;
            (slot.serial, slot.is_done, slot.problem) = (self.serial, false, None);
        }
        self.picture = Some(picture);
    }

    /// The picture that previews are of.
    pub fn picture(&self) -> Option<&Arc<Picture>> {
        self.picture.as_ref()
    }

    /// Forgets the picture and all previews.
    pub fn clear(&mut self) {
        (self.picture, self.slots) = (None, HashMap::new());
    }

    /// Asks for a preview, in this frame. Those that are asked for first are made first.
    pub fn want(&mut self, place: Place, order: Order) {
        self.wanted.push(place);
        let used = self.now;
        if let Some(slot) = self.slots.get_mut(&place).filter(|slot| slot.order == order) {
            slot.used = used;
            return;
        }
        self.serial += 1;
        let made = self.slots.remove(&place).and_then(|slot| slot.made);
        let slot = Slot { order, serial: self.serial, is_done: false, problem: None, made, used };
        self.slots.insert(place, slot);
    }

    /// Preview to be drawn at a place, which may be of another picture or look than is asked for now. `crisp`: its
    /// pixels are to be seen where it is magnified.
    pub fn get(&mut self, context: &Context, place: Place, crisp: bool) -> Option<Preview> {
        let picture = self.picture.as_ref()?;
        let slot = self.slots.get_mut(&place)?;
        let made = slot.made.as_mut()?;
        let (_, texture) = match made.texture.take().filter(|(known, _)| *known == crisp) {
            Some(known) => made.texture.insert(known),
            None => {
                let options = if crisp { TextureOptions::NEAREST } else { TextureOptions::LINEAR };
                let image = Arc::clone(&made.image);
                made.texture.insert((crisp, context.load_texture("preview", image, options)))
            }
        };
        Some(Preview {
            texture: texture.id(),
            size: made.order.size,
            part: made.order.part,
            is_current: Arc::ptr_eq(&made.picture, picture) && made.order == slot.order,
        })
    }

    /// Reason why there is no preview at a place.
    pub fn problem(&self, place: Place) -> Option<&str> {
        self.slots.get(&place)?.problem.as_deref()
    }

    /// True while something that is asked for is still to be made.
    pub fn is_busy(&self) -> bool {
        self.picture.is_some() && self.slots.values().any(|slot| !slot.is_done && slot.used + 1 >= self.now)
    }

    /// Tasks for what was asked for since the last call.
    pub fn tasks(&mut self) -> Vec<Task> {
        let wanted = std::mem::take(&mut self.wanted);
        self.now += 1;
        let Some(picture) = &self.picture else { return Vec::new() };
        let slots = wanted.iter().filter_map(|place| self.slots.get(place));
        slots
            .filter(|slot| !slot.is_done)
            .map(|slot| Task { serial: slot.serial, picture: Arc::clone(picture), order: slot.order.clone() })
            .collect()
    }

    /// Takes what was made.
    pub fn take(&mut self, (serial, result): Done) {
        let Some(picture) = &self.picture else { return };
        let Some(slot) = self.slots.values_mut().find(|slot| slot.serial == serial) else { return };
        slot.is_done = true;
        slot.take(result, picture);
        self.make_room();
    }

    /// The device is gone, and with it all textures.
    pub fn forget_textures(&mut self) {
        for made in self.slots.values_mut().filter_map(|slot| slot.made.as_mut()) {
            made.texture = None;
        }
    }

    /// Gives up those that nobody has asked for for the longest time.
    fn make_room(&mut self) {
        let bytes = |slot: &Slot| slot.made.as_ref().map_or(0, |made| made.image.pixels.len() * 4);
        let mut sum: usize = self.slots.values().map(bytes).sum();
        while sum > MOST_BYTES || self.slots.len() > MOST_SLOTS {
            let idle = self.slots.iter().filter(|(_, slot)| slot.used + 1 < self.now);
            let Some(place) = idle.min_by_key(|(_, slot)| slot.used).map(|(place, _)| *place) else { return };
            sum -= self.slots.remove(&place).map_or(0, |slot| bytes(&slot));
        }
    }
}

impl Slot {
    fn take(&mut self, result: Result<ColorImage>, picture: &Arc<Picture>) {
        match result {
            Ok(image) => {
                self.problem = None;
                self.made = Some(Made {
                    image: Arc::new(image),
                    texture: None,
                    order: self.order.clone(),
                    picture: Arc::clone(picture),
                });
            }
            Err(error) => (self.problem, self.made) = (Some(error.to_string()), None),
        }
    }
}
