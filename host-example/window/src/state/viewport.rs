//! Placement of pictures on the canvas: which ones, where, how large and how bright.

/// A rectangle of the window in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Area {
    /// Left border.
    pub x: f32,
    /// Upper border.
    pub y: f32,
    /// Width.
    pub width: f32,
    /// Height.
    pub height: f32,
}

/// The way in which two pictures are compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compare {
    /// Not at all: the look alone.
    #[default]
    Off,
    /// One on each side of a line that can be dragged.
    Wipe,
    /// Beside each other.
    Side,
    /// Their difference, made stronger, in the place of both.
    Difference,
}

/// Picture that is shown instead of the look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Overlay {
    /// Nothing.
    #[default]
    None,
    /// The surfaces' directions.
    Normal,
    /// Distances.
    Depth,
    /// Objects.
    ObjectId,
    /// Motion.
    Motion,
    /// The orientation that styles follow.
    Orientation,
    /// The lines alone.
    Lines,
}

impl Overlay {
    /// All of them, with what they are called.
    pub const ALL: [(Self, &'static str); 7] = [
        (Self::None, "The look"),
        (Self::Normal, "Normals"),
        (Self::Depth, "Depth"),
        (Self::ObjectId, "Objects"),
        (Self::Motion, "Motion"),
        (Self::Orientation, "Directions that strokes follow"),
        (Self::Lines, "Lines alone"),
    ];

    /// The node that makes it, if it is not a picture that is there anyway.
    pub const fn node(self) -> Option<&'static str> {
        match self {
            Self::Orientation => Some("tensor_view"),
            Self::Lines => Some("flow_dog"),
            _ => None,
        }
    }
}

/// Least and greatest pixels of the window to a pixel of the picture.
const ZOOMS: [f32; 2] = [1.0 / 32.0, 64.0];

/// The arrangement that an artist has made.
#[derive(Clone, Debug)]
pub struct Viewport {
    /// The way in which pictures are compared.
    pub compare: Compare,
    /// Position of the line of the wipe, as a share of the canvas from the left.
    pub wipe: f32,
    /// Factor on the difference, where that is shown.
    pub amplification: f32,
    /// True where the original is shown for the moment.
    pub peek: bool,
    /// Picture that is shown instead of the look.
    pub overlay: Overlay,
    /// Brightness of all pictures in stops.
    pub exposure: f32,
    /// The part of the window that is the canvas.
    pub area: Area,
    /// Position of the pointer on the picture, in pixels of the window.
    pub pointer: Option<[f32; 2]>,
    /// Pixels of the window to a pixel of the picture; none: all of it fits.
    zoom: Option<f32>,
    /// From the middle of the canvas to that of the picture, in pixels of the picture.
    offset: [f32; 2],
}

impl Default for Viewport {
    fn default() -> Self {
        Self {
            compare: Compare::Off,
            wipe: 0.5,
            amplification: 4.0,
            peek: false,
            overlay: Overlay::None,
            exposure: 0.0,
            area: Area { x: 0.0, y: 0.0, width: 1.0, height: 1.0 },
            pointer: None,
            zoom: None,
            offset: [0.0; 2],
        }
    }
}

impl Viewport {
    /// The part of the canvas that belongs to each picture.
    pub fn halves(&self) -> [Area; 2] {
        let area = self.area;
        if self.compare != Compare::Side || self.peek {
            return [area; 2];
        }
        let width = (area.width * 0.5).floor().max(1.0);
        [Area { width, ..area }, Area { x: area.x + width, width: (area.width - width).max(1.0), ..area }]
    }

    /// True where the difference of two pictures is shown.
    pub fn is_difference(&self) -> bool {
        self.compare == Compare::Difference
    }

    /// Column of the window at which the right picture begins.
    pub fn split(&self) -> f32 {
        match self.compare {
            Compare::Off | Compare::Difference => self.area.x,
            Compare::Wipe => self.area.x + (self.area.width * self.wipe).round(),
            Compare::Side => self.halves()[1].x,
        }
    }

    /// Pixels of the window to a pixel of a picture of a size.
    pub fn scale(&self, size: (u32, u32)) -> f32 {
        let [_, area] = self.halves();
        let fit = (area.width / size.0 as f32).min(area.height / size.1 as f32);
        self.zoom.unwrap_or(fit)
    }

    /// Areas of both pictures, which are of a size.
    pub fn places(&self, size: (u32, u32)) -> [Area; 2] {
        let scale = self.scale(size);
        let (width, height) = (size.0 as f32 * scale, size.1 as f32 * scale);
        self.halves().map(|half| {
            let x = half.x + half.width * 0.5 + self.offset[0] * scale - width * 0.5;
            let y = half.y + half.height * 0.5 + self.offset[1] * scale - height * 0.5;
            // Pixels of the window and of the picture meet at their borders.
            Area { x: x.round(), y: y.round(), width, height }
        })
    }

    /// The pixel of a picture of a size that lies at a place of the window.
    pub fn pixel(&self, size: (u32, u32), [x, y]: [f32; 2]) -> Option<(u32, u32)> {
        let right = x >= self.split();
        let place = self.places(size)[usize::from(right)];
        let within = [(x - place.x) / place.width, (y - place.y) / place.height];
        let inside = within.iter().all(|share| (0.0..1.0).contains(share));
        inside.then(|| ((within[0] * size.0 as f32) as u32, (within[1] * size.1 as f32) as u32))
    }

    /// A place of the window in pixels of a picture of a size, which may lie beside it.
    pub fn on_picture(&self, size: (u32, u32), [x, y]: [f32; 2]) -> [f32; 2] {
        let place = self.places(size)[usize::from(x >= self.split())];
        let scale = self.scale(size);
        [(x - place.x) / scale, (y - place.y) / scale]
    }

    /// Zooms by a factor about a place of the window.
    pub fn zoom_about(&mut self, size: (u32, u32), [x, y]: [f32; 2], factor: f32) {
        let before = self.scale(size);
        let after = (before * factor).clamp(ZOOMS[0], ZOOMS[1]);
        let half = self.halves()[usize::from(x >= self.split())];
        let from_middle = [x - half.x - half.width * 0.5, y - half.y - half.height * 0.5];
        for (offset, distance) in self.offset.iter_mut().zip(from_middle) {
            *offset += distance / after - distance / before;
        }
        self.zoom = Some(after);
    }

    /// Moves the pictures by pixels of the window.
    pub fn pan(&mut self, size: (u32, u32), by: [f32; 2]) {
        let scale = self.scale(size);
        self.zoom = Some(scale);
        for (offset, by) in self.offset.iter_mut().zip(by) {
            *offset += by / scale;
        }
    }

    /// Shows all of the picture again.
    pub fn fit(&mut self) {
        (self.zoom, self.offset) = (None, [0.0; 2]);
    }

    /// True where all of the picture is shown, as large as it can be.
    pub fn is_fitting(&self) -> bool {
        self.zoom.is_none()
    }

    /// Shows one pixel of the picture as one of the window, or all of the picture where it is so already.
    pub fn toggle_actual(&mut self) {
        match self.zoom {
            Some(zoom) if (zoom - 1.0).abs() < 1e-3 => self.fit(),
            _ => self.zoom = Some(1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn viewport() -> Viewport {
        Viewport { area: Area { x: 10.0, y: 20.0, width: 400.0, height: 300.0 }, ..Viewport::default() }
    }

    #[test]
    fn pictures_fit_and_stay_under_the_cursor_when_zoomed() {
        let mut viewport = viewport();
        let size = (200, 100);
        assert_eq!(viewport.places(size)[1], Area { x: 10.0, y: 70.0, width: 400.0, height: 200.0 });
        assert_eq!(viewport.pixel(size, [10.0, 70.0]), Some((0, 0)));
        assert_eq!(viewport.pixel(size, [409.0, 269.0]), Some((199, 99)));
        assert_eq!(viewport.pixel(size, [10.0, 69.0]), None);
        assert_eq!(viewport.on_picture(size, [110.0, 60.0]), [50.0, -5.0]);
        let cursor = [110.5, 120.5];
        let before = viewport.pixel(size, cursor);
        viewport.zoom_about(size, cursor, 4.0);
        assert_eq!(viewport.pixel(size, cursor), before);
        assert_eq!(viewport.scale(size), 8.0);
        viewport.zoom_about(size, cursor, 1e9);
        assert_eq!(viewport.scale(size), 64.0);
        viewport.fit();
        assert_eq!(viewport.scale(size), 2.0);
    }

    #[test]
    fn side_by_side_both_pictures_show_the_same_pixel_alike() {
        let mut viewport = Viewport { compare: Compare::Side, ..viewport() };
        let size = (100, 100);
        let [left, right] = viewport.places(size);
        assert_eq!((left.width, right.x - left.x), (200.0, 200.0));
        assert_eq!(viewport.pixel(size, [60.0, 170.0]), viewport.pixel(size, [260.0, 170.0]));
        viewport.pan(size, [20.0, -10.0]);
        assert_eq!(viewport.pixel(size, [80.0, 160.0]), viewport.pixel(size, [280.0, 160.0]));
    }
}
