//! A heading with rows below it.

use std::fmt;

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
        let width = width.unwrap_or(0);
        write!(formatter, "{}", self.heading)?;
        for [name, value] in &self.rows {
            write!(formatter, "\n  {name:width$}  {value}")?;
        }
        Ok(())
    }
}
