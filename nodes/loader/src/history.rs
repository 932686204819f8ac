//! Images of frames before its own that a frame reads, by the names of a plan's inputs and outputs.
//!
//! A plan for frames in order writes outputs `stage0`, `stage1` and so on, and reads inputs such as `stage0@-1` and
//! `depth@-1`. A host keeps as many images of each as frames are known at the same time, and these take turns: frame by
//! frame the next one is written, so that nothing is copied but the host's own images, which it draws into anew.

/// Images of a frame that later frames will read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Past {
    /// Frames before the one at hand that plans read at most.
    pub frames: usize,
    /// Stages and inputs of the host's, such as `depth`, that are read of them, each with the frames before at most.
    depths: Vec<(String, usize)>,
}

impl Past {
    /// The images of a plan that knows as many frames before as may count, by the names of its inputs.
    pub fn of<'n>(names: impl Iterator<Item = &'n str>) -> Self {
        let mut depths: Vec<(String, usize)> = Vec::new();
        for (base, before) in names.filter_map(split) {
            match depths.iter_mut().find(|(known, _)| known == base) {
                Some((_, most)) => *most = before.max(*most),
                None => depths.push((base.to_owned(), before)),
            }
        }
        let frames = depths.iter().map(|(_, depth)| *depth).max().unwrap_or(0);
        Self { frames, depths }
    }

    /// Inputs of the host's that are read of frames before.
    pub fn inputs(&self) -> impl Iterator<Item = &str> {
        self.depths.iter().map(|(name, _)| name.as_str()).filter(|name| !is_stage(name))
    }

    /// Number of images that a name needs where all begin anew after so many frames: more than the frames before that it is
    /// read of, and a divisor of `turns`.
    pub fn images(&self, name: &str, turns: usize) -> usize {
        let depth = self.depths.iter().find(|(known, _)| known == name).map_or(0, |(_, depth)| *depth);
        (depth + 1..turns).find(|count| turns.is_multiple_of(*count)).unwrap_or(turns.max(1))
    }

    /// Number of frames after which all images begin anew, as it takes the fewest of them.
    pub fn turns(&self) -> usize {
        let least = self.frames + 1;
        let all = |turns: usize| self.depths.iter().map(|(name, _)| self.images(name, turns)).sum::<usize>();
        (least..2 * least).min_by_key(|turns| all(*turns)).unwrap_or(least)
    }
}

/// The name of an input and how many frames before it belongs to: `depth@-2` is of 2 before.
pub fn split(name: &str) -> Option<(&str, usize)> {
    let (base, frame) = name.split_once("@-")?;
    Some((base, frame.parse().ok()?))
}

/// True where an output is kept for later frames.
pub fn is_stage(name: &str) -> bool {
    name.strip_prefix("stage").is_some_and(|number| number.parse::<u32>().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_what_is_kept() {
        let names = ["color", "stage0@-1", "depth@-1", "motion@-1", "depth@-2", "stage1@-2"];
        let past = Past::of(names.into_iter());
        assert_eq!((past.frames, past.inputs().collect::<Vec<_>>()), (2, vec!["depth", "motion"]));
        assert!(is_stage("stage12") && !is_stage("stages") && !is_stage("result"));
        assert_eq!(split("depth@-2"), Some(("depth", 2)));
        assert_eq!(split("depth"), None);
    }

    #[test]
    fn what_is_read_of_few_frames_is_kept_of_few() {
        let few = Past::of(["stage0@-1", "stage0@-2", "depth@-2"].into_iter());
        assert_eq!((few.turns(), few.images("stage0", 3), few.images("stage1", 3)), (3, 3, 1));
        // Motion of six frames, all else of two.
        let names = ["stage0@-2", "stage1@-2", "stage2@-2", "depth@-2", "motion@-6"];
        let past = Past::of(names.into_iter());
        let turns = past.turns();
        assert_eq!(turns, 9);
        assert_eq!((past.images("stage0", turns), past.images("motion", turns)), (3, 9));
    }
}
