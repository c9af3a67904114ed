//! What a mistyped name may be meant for.

/// The name that a mistyped one differs from least, if that is by little; capitals do not count.
pub(crate) fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let name = &name.to_lowercase();
    let with_changes = known.map(|known| (changes(name, &known.to_lowercase()), known));
    let (least, near) = with_changes.min_by_key(|(changes, _)| *changes)?;
    (least <= 1 + name.chars().count() / 4).then_some(near)
}

/// Asks whether a known name is meant by one that is not, if one is near.
pub(crate) fn did_you_mean<'a>(
    name: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> Option<String> {
    let near = nearest(name, known.into_iter())?;
    Some(format!("did you mean `{near}`?"))
}

/// The same before other advice, of which that alone is left where no name is near.
pub(crate) fn did_you_mean_or<'a>(
    name: &str,
    known: impl IntoIterator<Item = &'a str>,
    advice: &str,
) -> String {
    match did_you_mean(name, known) {
        Some(question) => format!("{question} {advice}"),
        None => advice.to_owned(),
    }
}

/// How many letters are to be added, left out or changed to come from one word to another
/// (*Levenshtein 1966*).
fn changes(from: &str, to: &str) -> usize {
    let mut row: Vec<usize> = (0..=to.chars().count()).collect();
    for (index, letter) in from.chars().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], index + 1);
        for (place, other) in to.chars().enumerate() {
            let changed = diagonal + usize::from(letter != other);
            diagonal = row[place + 1];
            row[place + 1] = changed.min(diagonal + 1).min(row[place] + 1);
        }
    }
    row[row.len() - 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mistyped_names_have_a_nearest_one() {
        let known = ["local", "global", "pose-space", "midway"];
        for (name, near) in [
            ("locl", Some("local")),
            ("lokal", Some("local")),
            ("pose_space", Some("pose-space")),
            ("midwya", Some("midway")),
            ("LOCAL", Some("local")),
            ("Midwya", Some("midway")),
            ("my-shirt", None),
        ] {
            assert_eq!(nearest(name, known.into_iter()), near, "{name}");
        }
        assert_eq!(changes("kitten", "sitting"), 3);
    }
}
