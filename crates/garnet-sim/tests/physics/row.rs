//! One line of the table of what was measured.

/// A figure beside the one that it has to be.
#[derive(Debug, Clone)]
pub(crate) struct Row {
    /// What was measured, with its unit.
    pub(crate) name: String,
    /// What it has to be.
    pub(crate) expected: f64,
    /// What it is.
    pub(crate) measured: f64,
    /// How far off it may be.
    pub(crate) bound: Bound,
}

/// How far off a figure may be.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Bound {
    /// By this share of what is expected.
    Relative(f64),
    /// By this much, in the unit of the figure.
    Absolute(f64),
}

impl Row {
    /// How far off the figure is, in the terms of its bound.
    pub(crate) fn error(&self) -> f64 {
        match self.bound {
            Bound::Relative(_) => self.measured / self.expected - 1.0,
            Bound::Absolute(_) => self.measured - self.expected,
        }
    }

    /// Whether it is within the bound.
    pub(crate) fn holds(&self) -> bool {
        let (Bound::Relative(bound) | Bound::Absolute(bound)) = self.bound;
        self.error().abs() <= bound
    }
}

/// Fails with all the figures that are off.
#[cfg(test)]
pub(crate) fn assert_all(rows: &[Row]) {
    assert!(!rows.is_empty());
    let off: Vec<&Row> = rows.iter().filter(|row| !row.holds()).collect();
    assert!(off.is_empty(), "{off:#?}");
}
