//! A heading with rows below it.

use std::fmt;

/// Values stand in a column after names of this length; longer names push theirs to the right.
const WIDEST: usize = 40;

/// A heading with rows of a name and a value below it.
#[derive(Debug)]
pub(crate) struct Table {
    heading: String,
    rows: Vec<[String; 2]>,
}

impl Table {
    pub(crate) fn new(heading: &str) -> Self {
        Self {
            heading: heading.to_owned(),
            rows: Vec::new(),
        }
    }

    pub(crate) fn row(&mut self, name: &str, value: impl fmt::Display) {
        self.rows.push([name.to_owned(), value.to_string()]);
    }
}

impl fmt::Display for Table {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self.rows.iter().map(|[name, _]| name.len()).max();
        let width = width.unwrap_or(0).min(WIDEST);
        write!(formatter, "{}", self.heading)?;
        for [name, value] in &self.rows {
            write!(formatter, "\n  {name:width$}  {value}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_any_length_have_rows() {
        let mut table = Table::new("heading");
        table.row("a", 1);
        table.row(&"b".repeat(70_000), 2);
        let text = table.to_string();
        assert!(text.starts_with("heading\n  a  ") && text.ends_with("bb  2"));
    }
}
