//! Lists of names in sentences.

/// Names with commas and a last `and` between them; of many the first alone.
pub fn list(names: &[String]) -> String {
    const MOST: usize = 12;
    let (shown, rest) = names.split_at(names.len().min(MOST));
    match (shown, rest.len()) {
        ([first @ .., last], 0) if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        (_, 0) => shown.concat(),
        (_, more) => format!("{} and {more} more", shown.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn names_are_listed() {
        let list = |count: usize| super::list(&(1..=count).map(|i| i.to_string()).collect::<Vec<_>>());
        assert_eq!([0, 1, 2, 3].map(list), ["", "1", "1 and 2", "1, 2 and 3"]);
        assert!(list(20).ends_with("11, 12 and 8 more"));
    }
}
