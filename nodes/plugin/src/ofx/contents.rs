//! Contents of the images that a result is made from, row by row: a part of the result is what it was where the rows that
//! it is made from hold what they held.

use super::content;

/// Numbers of the contents of an image's rows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rows {
    /// Number of how they are read.
    form: u128,
    /// The first row.
    first: i32,
    numbers: Vec<u128>,
}

impl Rows {
    /// Rows from `first` on, of an image that is read as the text says.
    pub fn new(form: &str, first: i32, numbers: Vec<u128>) -> Self {
        Self { form: content::of_text(form), first, numbers }
    }

    /// Number of all of them.
    fn number(&self) -> u128 {
        content::of_all(&[&[self.form][..], &self.numbers].concat())
    }

    /// True where other rows, read in the same way, have all of these among them.
    fn are_among(&self, others: &Self) -> bool {
        let place = || {
            let from = usize::try_from(self.first.checked_sub(others.first)?).ok()?;
            others.numbers.get(from..from.checked_add(self.numbers.len())?)
        };
        self.form == others.form && place() == Some(&self.numbers[..])
    }
}

/// Content of an image that a plan reads, or of a part of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Content {
    /// Number of how it is made from the host's images.
    pub form: u128,
    /// The rows that are read of those.
    pub images: Vec<Rows>,
}

impl Content {
    /// Number of all of it.
    pub fn number(&self) -> u128 {
        let mut all = vec![self.form];
        all.extend(self.images.iter().map(Rows::number));
        content::of_all(&all)
    }

    /// True where another one, made in the same way, has all of it.
    pub fn is_part_of(&self, all: &Self) -> bool {
        let mut pairs = self.images.iter().zip(&all.images);
        self.form == all.form
            && self.images.len() == all.images.len()
            && pairs.all(|(rows, others)| rows.are_among(others))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_has_the_rows_of_its_place() {
        let content = |form, first, numbers: &[u128]| Content {
            form: 1,
            images: vec![Rows::new(form, first, numbers.to_vec())],
        };
        let all = content("a", -1, &[4, 5, 6, 7]);
        for (first, numbers) in [(-1, &[4, 5, 6, 7][..]), (0, &[5, 6]), (2, &[7]), (1, &[])] {
            assert!(content("a", first, numbers).is_part_of(&all));
        }
        for (first, numbers) in [(0, &[4, 5][..]), (-2, &[3, 4]), (2, &[7, 8]), (3, &[7]), (i32::MIN, &[4])] {
            assert!(!content("a", first, numbers).is_part_of(&all));
        }
        assert!(!content("b", 0, &[5]).is_part_of(&all));
        assert!(!Content { form: 2, ..all.clone() }.is_part_of(&all));
        assert!(!Content { images: Vec::new(), ..all.clone() }.is_part_of(&all));
        assert_ne!(content("a", 0, &[5]).number(), content("a", 0, &[6]).number());
    }
}
