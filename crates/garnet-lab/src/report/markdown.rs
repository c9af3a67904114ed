//! Tables of Markdown.

use std::fmt::Write as _;

/// A table with a head; the first column holds names, the others hold numbers.
pub(super) struct Grid {
    rows: Vec<Vec<String>>,
}

impl Grid {
    pub(super) fn new(head: &[&str]) -> Self {
        Self {
            rows: vec![head.iter().map(|&text| text.to_owned()).collect()],
        }
    }

    pub(super) fn push(&mut self, row: Vec<String>) {
        self.rows.push(row);
    }

    /// The text, its columns as wide as their widest field.
    pub(super) fn text(&self) -> String {
        let columns = self.rows[0].len();
        let widths: Vec<usize> = (0..columns)
            .map(|column| {
                let fields = self.rows.iter().map(|row| row[column].chars().count());
                fields.max().unwrap_or(0).max(3)
            })
            .collect();
        let mut text = String::new();
        for (number, row) in self.rows.iter().enumerate() {
            text.push('|');
            for (column, (field, &width)) in row.iter().zip(&widths).enumerate() {
                let written = if column == 0 {
                    write!(text, " {field:<width$} |")
                } else {
                    write!(text, " {field:>width$} |")
                };
                written.expect("a string takes all");
            }
            text.push('\n');
            if number == 0 {
                text.push('|');
                for (column, &width) in widths.iter().enumerate() {
                    let dashes = "-".repeat(width + 1);
                    let end = if column == 0 { '-' } else { ':' };
                    write!(text, "{dashes}{end}|").expect("a string takes all");
                }
                text.push('\n');
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_as_wide_as_their_fields() {
        let mut grid = Grid::new(&["bench", "ms"]);
        grid.push(vec!["drape".to_owned(), "12.34".to_owned()]);
        assert_eq!(
            grid.text(),
            "| bench |    ms |\n|-------|------:|\n| drape | 12.34 |\n"
        );
    }
}
