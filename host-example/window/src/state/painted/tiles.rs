//! One number a pixel of a painted map, in tiles that copies share: a step that undo takes back holds what it has changed alone.

use std::sync::Arc;

/// Pixels across and down a tile.
const SIDE: usize = 128;

/// Numbers of a tile, row by row.
type Tile = [u8; SIDE * SIDE];

/// A part of a picture: its left, upper, right and lower border.
pub type Part = [u32; 4];

/// Numbers over a picture; where nothing was painted there is the plain one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tiles {
    size: (u32, u32),
    plain: u8,
    across: usize,
    tiles: Vec<Option<Arc<Tile>>>,
}

impl Tiles {
    /// Numbers that are all plain.
    pub fn new(size: (u32, u32), plain: u8) -> Self {
        let [across, down] = [size.0, size.1].map(|length| (length as usize).div_ceil(SIDE));
        Self { size, plain, across, tiles: vec![None; across * down] }
    }

    /// Pixels across and down.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Bytes of the tiles that are not plain.
    pub fn bytes_held(&self) -> usize {
        self.tiles.iter().flatten().count() * size_of::<Tile>()
    }

    /// True where nothing is painted.
    pub fn is_plain(&self) -> bool {
        self.tiles.iter().all(Option::is_none)
    }

    /// The number of a pixel of the picture.
    pub fn get(&self, x: u32, y: u32) -> u8 {
        let (x, y) = (x as usize, y as usize);
        match self.tiles.get(y / SIDE * self.across + x / SIDE) {
            Some(Some(tile)) => tile[y % SIDE * SIDE + x % SIDE],
            _ => self.plain,
        }
    }

    /// Gives all pixels one number.
    pub fn fill(&mut self, value: u8) {
        let tile = (value != self.plain).then(|| Arc::new([value; SIDE * SIDE]));
        self.tiles.fill(tile);
    }

    /// Changes the numbers of a part by their places; the part may reach beyond the picture.
    pub fn change(&mut self, part: Part, mut change: impl FnMut(u32, u32, u8) -> u8) {
        let [left, top] = [part[0], part[1]];
        let (right, bottom) = (part[2].min(self.size.0), part[3].min(self.size.1));
        if left >= right || top >= bottom {
            return;
        }
        let side = SIDE as u32;
        for row in top / side..=(bottom - 1) / side {
            for column in left / side..=(right - 1) / side {
                let place = &mut self.tiles[row as usize * self.across + column as usize];
                let tile = place.get_or_insert_with(|| Arc::new([self.plain; SIDE * SIDE]));
                let tile = Arc::make_mut(tile);
                for y in top.max(row * side)..bottom.min((row + 1) * side) {
                    for x in left.max(column * side)..right.min((column + 1) * side) {
                        let value = &mut tile[(y % side * side + x % side) as usize];
                        *value = change(x, y, *value);
                    }
                }
            }
        }
    }

    /// Gives back tiles in which all is plain.
    pub fn tidy(&mut self) {
        let plain = self.plain;
        for place in &mut self.tiles {
            if place.as_ref().is_some_and(|tile| tile.iter().all(|value| *value == plain)) {
                *place = None;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_are_shared_until_they_are_changed_and_given_back_when_plain() {
        let mut tiles = Tiles::new((300, 140), 127);
        let before = tiles.clone();
        tiles.change([120, 126, 136, 500], |x, y, old| if (x, y) == (130, 139) { 9 } else { old });
        assert_eq!((tiles.get(130, 139), tiles.get(129, 139), tiles.get(299, 0)), (9, 127, 127));
        assert_eq!(before.get(130, 139), 127);
        tiles.tidy();
        assert_eq!(tiles.tiles.iter().flatten().count(), 1);
        tiles.change([130, 139, 131, 140], |_, _, _| 127);
        tiles.tidy();
        assert!(tiles.is_plain() && tiles == before);
        tiles.fill(3);
        assert_eq!([tiles.get(0, 0), tiles.get(299, 139)], [3, 3]);
        tiles.fill(127);
        assert!(tiles.is_plain());
    }
}
