//! What is said of cloth that is longer than it is made, and what may be done about it.

use std::path::Path;

use garnet::{knn::TORN_STRETCH, mesh::StretchSummary};

use super::warning::Problem;

/// A garment of which 1 % of the edges are longer than this, over their length at rest, is
/// strained.
const TIGHT_STRETCH: f32 = 1.25;

/// How longer cloth than it is made came about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Draped {
    /// Whether the garment was cut for who wears it, so that its size is right.
    pub(crate) is_cut_for_wearer: bool,
    /// What would give the cloth way.
    pub(crate) remedy: Remedy,
}

/// What has not been done yet and gives strained cloth way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Remedy {
    /// It was warped alone.
    Settle,
    /// A network has draped it, or it has settled.
    Simulate,
    /// It was simulated.
    Nothing,
}

/// So much longer than at rest, and how it came about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Strained {
    /// Length over length at rest.
    pub(crate) stretch: f32,
    draped: Draped,
}

impl Remedy {
    const fn text(self) -> &'static str {
        match self {
            Self::Settle => ", which gives way if it settles (`--settle`) or is simulated",
            Self::Simulate => ", which gives way if it is simulated (`--method sim`)",
            Self::Nothing => "",
        }
    }
}

impl Strained {
    /// Of the longest edge.
    pub(super) fn torn(self, path: &Path) -> String {
        let (path, stretch) = (path.display(), self.stretch);
        let cause = if self.draped.is_cut_for_wearer {
            format!("the pose strains it there{}", self.draped.remedy.text())
        } else {
            "the body may be of another size than it or the clearance too wide".to_owned()
        };
        format!(
            "an edge of `{path}` is {stretch:.1} times as long as in the garment: cloth would tear, \
             and {cause}"
        )
    }

    /// Of one in a hundred edges.
    pub(super) fn tight(self, path: &Path) -> String {
        let (path, stretch) = (path.display(), self.stretch);
        let cause = if self.draped.is_cut_for_wearer {
            "the pose strains it"
        } else {
            "it may be too small for the body, or the pose strains it"
        };
        format!(
            "1 % of the edges of `{path}` are more than {stretch:.2} times as long as in the \
             garment: {cause}{}",
            self.draped.remedy.text()
        )
    }
}

/// Of the longest edge at a vertex that is caught.
pub(super) fn torn_where_caught(path: &Path, stretch: f32) -> String {
    let path = path.display();
    format!(
        "an edge of `{path}` is {stretch:.1} times as long as in the garment where it is caught: parts \
         of the body run through each other there, which a pose that keeps them apart mends"
    )
}

/// Whether cloth is longer than it can be, or much of it longer than it should be.
pub(crate) fn of_stretch(stretch: &StretchSummary, draped: Draped) -> Vec<Problem> {
    let strained = |stretch| Strained { stretch, draped };
    let torn = (stretch.max > TORN_STRETCH).then(|| Problem::Torn(strained(stretch.max)));
    let tight = (stretch.p99 > TIGHT_STRETCH).then(|| Problem::Tight(strained(stretch.p99)));
    torn.into_iter().chain(tight).collect()
}

/// The same of edges at vertices that are caught.
pub(crate) fn of_caught(stretch: &StretchSummary) -> Option<Problem> {
    (stretch.max > TORN_STRETCH).then_some(Problem::TornWhereCaught(stretch.max))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tight_cloth_and_torn_cloth_are_told_apart() {
        let kinds = |p99, max| {
            let mut stretch = StretchSummary::default();
            (stretch.p99, stretch.max, stretch.count) = (p99, max, 100);
            let draped = Draped {
                is_cut_for_wearer: false,
                remedy: Remedy::Settle,
            };
            let problems = of_stretch(&stretch, draped);
            problems.iter().map(Problem::kind).collect::<Vec<_>>()
        };
        assert!(kinds(1.2, 1.9).is_empty());
        assert_eq!(kinds(1.3, 1.9), ["tight"]);
        assert_eq!(kinds(1.3, 2.1), ["torn", "tight"]);
    }

    #[test]
    fn nothing_is_advised_that_was_done() {
        let told = |is_cut_for_wearer, remedy| {
            let draped = Draped {
                is_cut_for_wearer,
                remedy,
            };
            let strained = Strained {
                stretch: 2.0,
                draped,
            };
            let path = Path::new("tee.obj");
            strained.torn(path) + &strained.tight(path)
        };
        assert!(told(false, Remedy::Settle).contains("--settle"));
        assert!(!told(false, Remedy::Simulate).contains("--settle"));
        assert!(!told(true, Remedy::Nothing).contains("`--"));
        assert!(told(false, Remedy::Nothing).contains("another size"));
        assert!(!told(true, Remedy::Nothing).contains("size"));
    }
}
