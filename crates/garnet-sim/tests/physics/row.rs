//! One line of the table of what was measured.

/// A figure beside the one that it has to be.
#[derive(Debug, Clone)]
pub struct Row {
    /// What was measured, with its unit.
    pub name: String,
    /// What it has to be.
    pub expected: f64,
    /// What it is.
    pub measured: f64,
    /// How far off it may be.
    pub bound: Bound,
}

/// How far off a figure may be.
#[derive(Debug, Clone, Copy)]
pub enum Bound {
    /// By this share of what is expected.
    Relative(f64),
    /// By this much, in the unit of the figure.
    Absolute(f64),
}

impl Row {
    /// How far off the figure is, in the terms of its bound.
    pub fn error(&self) -> f64 {
        match self.bound {
            Bound::Relative(_) => self.measured / self.expected - 1.0,
            Bound::Absolute(_) => self.measured - self.expected,
        }
    }

    /// Whether it is within the bound.
    pub fn holds(&self) -> bool {
        let (Bound::Relative(bound) | Bound::Absolute(bound)) = self.bound;
        self.error().abs() <= bound
    }
}

/// Fails with all the figures that are off.
pub fn assert_all(rows: &[Row]) {
    assert!(!rows.is_empty()); if std::env::var("V").is_ok() {for r in rows {eprintln!("{:60} {:.5} {:.5} {:+.2}%",r.name,r.expected,r.measured,100.*r.error());}}
    let off: Vec<&Row> = rows.iter().filter(|row| !row.holds()).collect();
    assert!(off.is_empty(), "{off:#?}");
}
