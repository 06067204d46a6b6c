//! Names of presets: what they may be, what their files are called, which are near each other.

/// The longest name, in characters.
pub(super) const MAX_NAME_CHARACTERS: usize = 64;
/// How alike (0..1, Jaro-Winkler) a name must be to be suggested, and how many are.
const MIN_LIKENESS: f64 = 0.75;
const MAX_SUGGESTIONS: usize = 3;

/// What is wrong with a name, for people.
pub(super) fn check(name: &str) -> Result<(), String> {
    let length = name.chars().count();
    let refused = |why: String| Err(format!("the name {name:?} {why}"));
    if !(1..=MAX_NAME_CHARACTERS).contains(&length) {
        return refused(format!("has {length} characters, it takes 1 to {MAX_NAME_CHARACTERS}"));
    }
    if let Some(bad) = name.chars().find(|character| matches!(character, '/' | '\\')) {
        return refused(format!("holds `{bad}`, which separates folders: leave it out"));
    }
    if name.chars().any(char::is_control) {
        return refused("holds a control character: leave it out".to_owned());
    }
    if name.trim() != name {
        return refused("begins or ends with a space: leave it out".to_owned());
    }
    if !name.chars().any(char::is_alphanumeric) {
        return refused("has no letter and no digit: its file could not be named after it".to_owned());
    }
    Ok(())
}

/// The name of a preset's file without its ending, and what tells presets apart: small letters and digits, a hyphen for
/// everything between them.
pub(super) fn slug(name: &str) -> String {
    let small: String = name.to_lowercase();
    let words = small.split(|character: char| !character.is_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("-")
}

/// Of the known names those that could have been meant, the nearest first.
pub(super) fn near<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let wanted = slug(name);
    let likeness = |known: &str| {
        let slug = slug(known);
        let is_part = wanted.len() >= 3 && slug.contains(&wanted);
        if is_part { 1.0 } else { strsim::jaro_winkler(&slug, &wanted) }
    };
    let mut alike: Vec<_> = known
        .map(|known| (likeness(known), known))
        .filter(|(likeness, _)| *likeness >= MIN_LIKENESS)
        .collect();
    alike.sort_by(|(one, _), (other, _)| other.total_cmp(one));
    alike.into_iter().take(MAX_SUGGESTIONS).map(|(_, name)| name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_cannot_be_used_say_why() {
        let long = "x".repeat(65);
        for (name, word) in [
            ("", "0 characters"),
            (long.as_str(), "65 characters"),
            ("a/b", "`/`"),
            ("a\\b", "`\\`"),
            ("a\nb", "control"),
            ("a\u{7f}", "control"),
            (" a", "space"),
            ("..", "letter"),
            ("…", "letter"),
        ] {
            let why = check(name).unwrap_err();
            assert!(why.contains(word), "{name:?}: {why}");
        }
        for name in ["A", "Alpine ridge", "Schräge 30°", "山の尾根", &"ä".repeat(64)] {
            assert_eq!(check(name), Ok(()), "{name}");
        }
    }

    #[test]
    fn slugs_are_file_names_anywhere() {
        for (name, expected) in [
            ("Alpine ridge", "alpine-ridge"),
            ("ALPINE  Ridge!", "alpine-ridge"),
            ("../x: 30 %", "x-30"),
            ("Schräge", "schräge"),
        ] {
            assert_eq!(slug(name), expected);
        }
    }

    #[test]
    fn near_names_are_found() {
        let known = ["Soft hill", "Sharp peak", "Trench", "Plateau edge"];
        assert_eq!(near("Soft hil", known.into_iter()), ["Soft hill"]);
        assert_eq!(near("trenhc", known.into_iter()), ["Trench"]);
        assert_eq!(near("edge", known.into_iter()), ["Plateau edge"]);
        assert!(near("xyzzy", known.into_iter()).is_empty());
    }
}
