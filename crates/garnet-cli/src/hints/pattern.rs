//! Advice for what can be wrong with patterns.

use garnet::pattern::{GarmentKind, PatternError, PatternLength, Size};

use super::did_you_mean_or;

/// What to do about an error, as a clause.
pub(crate) fn for_pattern(error: &PatternError) -> Option<String> {
    Some(match error {
        PatternError::UnknownGarment { name } => {
            one_of(name, GarmentKind::ALL.map(GarmentKind::name))
        }
        PatternError::UnknownSize { name } => {
            let names = Size::ALL.map(|size| size.to_string());
            let names = names.iter().map(String::as_str).chain(["auto"]);
            let names = one_of(name, names);
            format!("{names}, or of trousers waist and inner leg in inches, as 32x34")
        }
        PatternError::NoTrousers { .. } => {
            let names = Size::ALL.map(|size| size.to_string());
            format!("its sizes are {} and auto", names.join(", "))
        }
        PatternError::UnknownParameter { garment, name } => {
            one_of(name, garment.specs().iter().map(|spec| spec.name))
        }
        PatternError::ParameterOutOfRange { spec, .. } => {
            format!("`{}` is this: {}", spec.name, spec.help)
        }
        PatternError::Impossible { what, .. } => for_length(*what)?.to_owned(),
        PatternError::BadWearer { .. } => {
            "patterns are for people from about 1.4 m on; measures and joints are in metres, y up, with the \
             feet on y = 0"
                .to_owned()
        }
        PatternError::Folded { far, .. } => for_folded(far),
        PatternError::VertexCount { .. } => "the default is 5000".to_owned(),
        PatternError::WrongGarment { .. } => "make the template from the same garment".to_owned(),
        PatternError::Triangulation { .. } => {
            "this is a fault of the program: report it with the parameters".to_owned()
        }
        _ => return None,
    })
}

fn for_length(length: PatternLength) -> Option<&'static str> {
    Some(match length {
        PatternLength::Underarm => {
            "make `sleeve` longer, `sleeve-ease` larger or `armhole` smaller"
        }
        PatternLength::SideSeam => "make `length` longer, or `armhole` or `sleeve-ease` smaller",
        PatternLength::Shoulder => "make `neck-width` smaller or `shoulder` larger",
        PatternLength::Skirt => "make `length` longer",
        PatternLength::Rise => "make `rise` larger or `waistband` smaller",
        _ => return None,
    })
}

/// With the parameters that lie far from their defaults.
fn for_folded(far: &[&str]) -> String {
    match far {
        [] => "this body is far from those that the pattern is made for".to_owned(),
        [name] => format!("bring {name} closer to the default"),
        [all @ .., last] => format!(
            "these together fold it: bring some of {} and {last} closer to the defaults",
            all.join(", ")
        ),
    }
}

/// What a name may be that is none of these.
fn one_of<'a>(name: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.into_iter().collect();
    let all = format!("it is one of {}", names.join(", "));
    did_you_mean_or(name, names, &all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_there_are_are_listed() {
        let mut tshirt = GarmentKind::Tshirt.parameters();
        let hint = for_pattern(&tshirt.set("inseam", 0.7).unwrap_err()).unwrap();
        assert!(
            hint.starts_with("it is one of ") && hint.contains("sleeve"),
            "{hint}"
        );
        let hint = for_pattern(&tshirt.set("sleev", 0.7).unwrap_err()).unwrap();
        assert!(
            hint.starts_with("did you mean `sleeve`? it is one of "),
            "{hint}"
        );
    }

    #[test]
    fn parameters_that_fold_a_pattern_are_named() {
        assert_eq!(
            for_folded(&["sleeve"]),
            "bring sleeve closer to the default"
        );
        assert!(for_folded(&["a", "b", "c"]).contains("some of a, b and c closer"));
    }
}
