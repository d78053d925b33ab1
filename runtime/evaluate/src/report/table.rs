//! Tables as text: for pages, and for screens.

use core::fmt::Write;

/// Rows of cells below a head. The first column and the one that is called `ended by` hold words and are aligned to the left,
/// the others hold numbers and are aligned to the right.
pub struct Table {
    rows: Vec<Row>,
}

enum Row {
    Cells(Vec<String>),
    /// A name, and a remark across all other columns.
    Remark(String, String),
}

impl Table {
    /// A table with this head.
    pub fn new(head: &[&str]) -> Self {
        Self { rows: vec![Row::Cells(head.iter().map(|&title| title.into()).collect())] }
    }

    /// A row with as many cells as the head.
    pub fn row(&mut self, cells: Vec<String>) {
        self.rows.push(Row::Cells(cells));
    }

    /// A row without numbers.
    pub fn remark(&mut self, name: String, remark: String) {
        self.rows.push(Row::Remark(name, remark));
    }

    /// As Markdown, which a terminal shows well and a page renders.
    pub fn markdown(&self) -> String {
        let columns = self.head().len();
        let widths = self.widths(true);
        let mut text = String::new();
        for (index, row) in self.rows.iter().enumerate() {
            let cells = match row {
                Row::Cells(cells) => cells.clone(),
                // The remark stands in the last column.
                Row::Remark(name, remark) => {
                    let mut cells = vec![String::new(); columns];
                    cells[columns - 1].clone_from(remark);
                    cells[0].clone_from(name);
                    cells
                }
            };
            for (column, cell) in cells.iter().enumerate() {
                text.push_str("| ");
                text.push_str(&self.aligned(column, cell, widths[column]));
                text.push(' ');
            }
            text.push_str("|\n");
            if index == 0 {
                for (column, &width) in widths.iter().enumerate() {
                    let rule = "-".repeat(width);
                    text.push_str(&if self.is_left(column) { format!("|:{rule}-") } else { format!("|-{rule}:") });
                }
                text.push_str("|\n");
            }
        }
        text
    }

    /// Without rules, each row cut to `width` characters: for a screen.
    pub fn plain(&self, width: usize) -> String {
        let widths = self.widths(false);
        let mut text = String::new();
        for row in &self.rows {
            let line = match row {
                Row::Cells(cells) => {
                    let cells = cells.iter().enumerate().map(|(column, cell)| self.aligned(column, cell, widths[column]));
                    cells.collect::<Vec<_>>().join("  ")
                }
                Row::Remark(name, remark) => format!("{}  {remark}", self.aligned(0, name, widths[0])),
            };
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{}", cut(line.trim_end(), width));
        }
        text
    }

    fn head(&self) -> &[String] {
        match self.rows.first() {
            Some(Row::Cells(head)) => head,
            _ => &[],
        }
    }

    fn is_left(&self, column: usize) -> bool {
        column == 0 || self.head().get(column).is_some_and(|title| title == "ended by")
    }

    fn aligned(&self, column: usize, cell: &str, width: usize) -> String {
        if self.is_left(column) { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
    }

    /// The widest cell of each column, where remarks stand in the last one or in none.
    fn widths(&self, remarks: bool) -> Vec<usize> {
        let columns = self.head().len();
        let count = |text: &String| text.chars().count();
        let width = |column: usize| {
            let cells = self.rows.iter().map(|row| match row {
                Row::Cells(cells) => cells.get(column).map_or(0, count),
                Row::Remark(name, _) if column == 0 => count(name),
                Row::Remark(_, remark) if remarks && column + 1 == columns => count(remark),
                Row::Remark(..) => 0,
            });
            cells.max().unwrap_or(0)
        };
        (0..columns).map(width).collect()
    }
}

/// At most `width` characters; what is left out is three dots.
pub(super) fn cut(line: &str, width: usize) -> String {
    if line.chars().count() <= width {
        return line.to_owned();
    }
    line.chars().take(width.saturating_sub(3)).chain("...".chars()).collect()
}
