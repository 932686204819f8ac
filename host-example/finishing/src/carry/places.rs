//! Where the points of a frame are in another one, farther away than its neighbours: vectors from frame to frame, one after the
//! other. Places are carried and not the map itself, which is read once and stays as sharp as it was painted.

use rayon::prelude::*;

use isophote_pictures::pixels::Pixels;

/// Pixels by which there and back again may miss, and the share of their length by which they may more.
const MISSES: [f32; 2] = [0.5, 0.25];
/// Pixels by which neighbours of one thing lead apart at most.
const APART: f32 = 2.0;
/// Rounds in which what is uncovered takes the places of what is around, a pixel each.
const ROUNDS: usize = 48;

/// For each pixel of a frame, where its point is in the frame of a map: column and row, no finite numbers where that is not known.
#[derive(Clone, Debug)]
pub struct Places {
    size: [usize; 2],
    at: Vec<[f32; 2]>,
}

/// Place that is not known: another thing was there.
const COVERED: [f32; 2] = [f32::NAN; 2];
/// Place that is not known: it was beside the picture, or its vector leads nowhere.
const OUTSIDE: [f32; 2] = [f32::INFINITY; 2];

fn is_known([x, y]: [f32; 2]) -> bool {
    x.is_finite() && y.is_finite()
}

/// Pixels by which vectors of one thing differ at most from a pixel to the next, where things have no numbers.
const ALIKE: f32 = 0.5;

/// Vectors of a frame: x and y a pixel; and the numbers of its things, where they are known.
#[derive(Clone, Copy, Debug)]
pub struct Field<'v> {
    vectors: &'v [f32],
    things: Option<&'v [f32]>,
}

impl<'v> Field<'v> {
    /// Vectors, of two channels, and numbers of things, of one.
    pub fn new(vectors: &'v [f32], things: Option<&'v [f32]>) -> Self {
        Self { vectors, things }
    }

    /// The thing of a pixel; nothing where things have no numbers.
    fn thing(self, pixel: usize) -> Option<f32> {
        self.things.and_then(|things| things.get(pixel)).copied()
    }

    fn at(self, pixel: usize) -> [f32; 2] {
        self.vectors.get(2 * pixel..2 * pixel + 2).map_or(OUTSIDE, |vector| [vector[0], vector[1]])
    }
}

impl Places {
    /// The places of the frame of the map itself.
    pub fn own(width: u32, height: u32) -> Self {
        let [width, height] = [width as usize, height as usize];
        let at = (0..width * height).map(|pixel| [(pixel % width) as f32, (pixel / width) as f32]).collect();
        Self { size: [width, height], at }
    }

    /// The places of a neighbouring frame, whose vectors lead here; `back`, the vectors of this frame that lead there, and the
    /// numbers of things tell which of its points are not seen here.
    pub fn carried(&self, there: Field<'_>, back: Option<Field<'_>>) -> Self {
        let [width, height] = self.size;
        let place = |pixel: usize| {
            let [x, y] = there.at(pixel);
            let at = [(pixel % width) as f32 + x, (pixel / width) as f32 + y];
            let is_inside = at[0] > -0.5 && at[1] > -0.5;
            let nearest = [at[0].round() as usize, at[1].round() as usize];
            if !(is_known(at) && is_inside && nearest[0] < width && nearest[1] < height) {
                return OUTSIDE;
            }
            let other = nearest[1] * width + nearest[0];
            let things = (there.thing(pixel), back.and_then(|back| back.thing(other)));
            if matches!(things, (Some(own), Some(other)) if own != other) {
                return COVERED;
            }
            let returned = back.map_or([-x, -y], |back| back.at(other));
            // A vector that leads nowhere tells nothing.
            let misses = (returned[0] + x).hypot(returned[1] + y);
            if misses > MISSES[0] + MISSES[1] * x.hypot(y) {
                return COVERED;
            }
            self.between(at, nearest)
        };
        let at: Vec<[f32; 2]> = (0..self.at.len()).into_par_iter().map(place).collect();
        let mut carried = Self { size: self.size, at };
        carried.fill(there);
        carried
    }

    /// The place between pixels, by those of the four around that belong to what the nearest belongs to.
    fn between(&self, at: [f32; 2], nearest: [usize; 2]) -> [f32; 2] {
        let [width, height] = self.size;
        let seen = |[x, y]: [usize; 2]| {
            let [u, v] = self.at[y * width + x];
            [u + at[0] - x as f32, v + at[1] - y as f32]
        };
        let own = seen(nearest);
        if !is_known(own) {
            return own;
        }
        let (mut sum, mut weight) = ([0.0_f32; 2], 0.0_f32);
        let corner = at.map(f32::floor);
        for step in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0_f32]] {
            let [x, y] = [corner[0] + step[0], corner[1] + step[1]];
            let share = (1.0 - (at[0] - x).abs()) * (1.0 - (at[1] - y).abs());
            let near = [x.clamp(0.0, (width - 1) as f32), y.clamp(0.0, (height - 1) as f32)];
            let found = seen(near.map(|v| v as usize));
            // What is no number is not near.
            if (found[0] - own[0]).abs() < APART && (found[1] - own[1]).abs() < APART {
                (sum[0], sum[1], weight) =
                    (sum[0] + share * found[0], sum[1] + share * found[1], weight + share);
            }
        }
        if weight > 0.0 { sum.map(|v| v / weight) } else { own }
    }

    /// Gives what was uncovered the places of what is around and belongs to the same thing, or moves likewise.
    fn fill(&mut self, there: Field<'_>) {
        let mut unknown: Vec<usize> =
            (0..self.at.len()).filter(|pixel| self.at[*pixel][0].is_nan()).collect();
        for _ in 0..ROUNDS {
            let found: Vec<(usize, [f32; 2])> =
                unknown.par_iter().map(|pixel| (*pixel, self.around(*pixel, there))).collect();
            for (pixel, place) in &found {
                self.at[*pixel] = *place;
            }
            let before = unknown.len();
            unknown.retain(|pixel| !is_known(self.at[*pixel]));
            if unknown.is_empty() || unknown.len() == before {
                break;
            }
        }
    }

    /// The place of a neighbour that is of the same thing, or moves likewise. It is not gone on from: there the frame of the map
    /// has what has covered this.
    fn around(&self, pixel: usize, there: Field<'_>) -> [f32; 2] {
        let [width, height] = self.size.map(|side| side as i64);
        let (x, y, own) = (pixel as i64 % width, pixel as i64 / width, there.at(pixel));
        for (dx, dy) in [(-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (1, -1), (-1, 1), (1, 1)] {
            let (u, v) = (x + dx, y + dy);
            if !((0..width).contains(&u) && (0..height).contains(&v)) {
                continue;
            }
            let other = (v * width + u) as usize;
            let (place, vector) = (self.at[other], there.at(other));
            let is_alike = match (there.thing(pixel), there.thing(other)) {
                (Some(own), Some(other)) => own == other,
                _ => (vector[0] - own[0]).hypot(vector[1] - own[1]) < ALIKE,
            };
            if is_known(place) && is_alike {
                return place;
            }
        }
        COVERED
    }

    /// A map as this frame sees it, channels a pixel; no numbers where its places are not known.
    pub fn seen(&self, map: &Pixels) -> Vec<f32> {
        let numbers = map.to_f32();
        let channels = map.channels() as usize;
        let mut seen = vec![f32::NAN; self.at.len() * channels];
        let [width, height] = self.size;
        seen.par_chunks_exact_mut(channels).zip(&self.at).for_each(|(pixel, at)| {
            if !is_known(*at) {
                return;
            }
            let [x, y] = [at[0].clamp(0.0, (width - 1) as f32), at[1].clamp(0.0, (height - 1) as f32)];
            let [column, row] = [x as usize, y as usize];
            let [right, below] = [(column + 1).min(width - 1), (row + 1).min(height - 1)];
            let [across, down] = [x - column as f32, y - row as f32];
            for (channel, value) in pixel.iter_mut().enumerate() {
                let at = |x: usize, y: usize| numbers[(y * width + x) * channels + channel];
                let above = at(column, row) + (at(right, row) - at(column, row)) * across;
                let under = at(column, below) + (at(right, below) - at(column, below)) * across;
                *value = above + (under - above) * down;
            }
        });
        seen
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_pictures::pixels::Samples;

    const SIZE: [usize; 2] = [40, 20];

    /// Share of the frame whose places are not known.
    fn unknown(places: &Places) -> f32 {
        let unknown = places.at.iter().filter(|at| !is_known(**at)).count();
        unknown as f32 / places.at.len() as f32
    }

    /// A square of ten pixels that moves by `step` to the right each frame over ground that stays.
    fn field(left: f32, vector: f32) -> Vec<f32> {
        let inside = |pixel: usize| {
            let x = (pixel % SIZE[0]) as f32 - left;
            (0.0..10.0).contains(&x) && (5..15).contains(&(pixel / SIZE[0]))
        };
        (0..SIZE[0] * SIZE[1]).flat_map(|pixel| [if inside(pixel) { vector } else { 0.0 }, 0.0]).collect()
    }

    #[test]
    fn a_map_stays_on_its_thing_and_as_sharp_as_it_was() {
        let mut places = Places::own(SIZE[0] as u32, SIZE[1] as u32);
        let painted = |left: usize| {
            let value = |pixel: usize| {
                let (x, y) = (pixel % SIZE[0], pixel / SIZE[0]);
                u8::from((left..left + 10).contains(&x) && (5..15).contains(&y)) * 200
            };
            (0..SIZE[0] * SIZE[1]).map(value).collect::<Vec<u8>>()
        };
        let map = Pixels::new(SIZE[0] as u32, SIZE[1] as u32, 1, Samples::U8(painted(2))).unwrap();
        for frame in 1..6 {
            let (before, now) = (2.0 + 3.0 * (frame - 1) as f32, 2.0 + 3.0 * frame as f32);
            places = places
                .carried(Field::new(&field(now, -3.0), None), Some(Field::new(&field(before, 3.0), None)));
            let seen = places.seen(&map);
            let wanted = painted(now as usize);
            let other = seen.iter().zip(&wanted).filter(|(a, b)| (**a * 255.0).round() != f32::from(**b));
            // The ground that the square has left was not seen before, and takes what is beside it.
            assert_eq!((other.count(), unknown(&places)), (0, 0.0), "frame {frame}");
        }
    }

    #[test]
    fn what_comes_from_outside_or_nowhere_is_not_known() {
        let own = Places::own(SIZE[0] as u32, SIZE[1] as u32);
        // All moves by 4 to the left, so that four columns come in at the right.
        let all = |x: f32| (0..SIZE[0] * SIZE[1]).flat_map(|_| [x, 0.0]).collect::<Vec<f32>>();
        let carried = own.carried(Field::new(&all(4.0), None), Some(Field::new(&all(-4.0), None)));
        assert_eq!(unknown(&carried), 0.1);
        let nowhere = own.carried(Field::new(&all(f32::NAN), None), None);
        assert_eq!(unknown(&nowhere), 1.0);
        let map = Pixels::new(SIZE[0] as u32, SIZE[1] as u32, 1, Samples::U8(vec![9; 800])).unwrap();
        assert!(nowhere.seen(&map).iter().all(|v| v.is_nan()));
        // Half pixels add up without a loss.
        let mut places = own;
        for _ in 0..8 {
            places = places.carried(Field::new(&all(-0.5), None), None);
        }
        assert_eq!(places.at[20], [16.0, 0.0]);
    }
}
