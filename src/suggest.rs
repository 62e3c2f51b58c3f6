//! Slips of the keyboard: which known name somebody meant.

/// The known name nearest to what was typed, if at most a third of its letters (and at least two) were mistyped, or if
/// what was typed begins it.
pub(crate) fn nearest<'a>(typed: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let typed = typed.to_lowercase();
    let allowed = (typed.chars().count() / 3).max(2);
    let mistyped = |candidate: &str| {
        let candidate = candidate.to_lowercase();
        let begins = !typed.is_empty() && candidate.starts_with(&typed);
        if begins { 1 } else { strsim::damerau_levenshtein(&typed, &candidate) }
    };
    let near = known.into_iter().map(|candidate| (mistyped(candidate), candidate));
    near.filter(|&(distance, _)| distance <= allowed).min().map(|(_, candidate)| candidate)
}

/// " (did you mean 'x'?)", or nothing.
pub(crate) fn hint<'a>(typed: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    nearest(typed, known).map_or_else(String::new, |name| format!(" (did you mean '{name}'?)"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_recognised_and_other_words_are_not() {
        let known = ["map", "volume", "planar"];
        assert_eq!(nearest("mpa", known), Some("map"));
        assert_eq!(nearest("Volmue", known), Some("volume"));
        assert_eq!(nearest("plan", known), Some("planar"));
        assert_eq!(nearest("raytrace", known), None);
        assert_eq!(hint("", ["size"]), "");
    }
}
