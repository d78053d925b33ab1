//! Tables as text: for pages, and for screens.

use core::fmt::Write;
use msk_text::in_one_line;

/// Rows of cells below a head. The first column and the one that is called `ended by` hold words and are aligned to the left,
/// the others hold numbers and are aligned to the right. Cells are plain text, whatever they hold: they stay cells.
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
        Self { rows: vec![Row::Cells(head.iter().map(|title| in_one_line(title)).collect())] }
    }

    /// A row with as many cells as the head.
    pub fn row(&mut self, cells: Vec<String>) {
        self.rows.push(Row::Cells(cells.iter().map(|cell| in_one_line(cell)).collect()));
    }

    /// A row without numbers.
    pub fn remark(&mut self, name: String, remark: String) {
        self.rows.push(Row::Remark(in_one_line(&name), in_one_line(&remark)));
    }

    /// As Markdown, which a terminal shows well and a page renders.
    pub fn markdown(&self) -> String {
        let columns = self.head().len();
        let cells = |row: &Row| -> Vec<String> {
            match row {
                Row::Cells(cells) => cells.iter().map(|cell| in_markdown(cell)).collect(),
                // The remark stands in the last column.
                Row::Remark(name, remark) => {
                    let mut cells = vec![String::new(); columns];
                    cells[columns - 1] = in_markdown(remark);
                    cells[0] = in_markdown(name);
                    cells
                }
            }
        };
        let rows: Vec<Vec<String>> = self.rows.iter().map(cells).collect();
        let width = |column: usize| rows.iter().filter_map(|cells| cells.get(column)).map(count).max().unwrap_or(0);
        let widths: Vec<usize> = (0..columns).map(width).collect();
        let mut text = String::new();
        for (index, cells) in rows.iter().enumerate() {
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
        let widths = self.widths();
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

    /// The widest cell of each column; remarks stand in none.
    fn widths(&self) -> Vec<usize> {
        let width = |column: usize| {
            let cells = self.rows.iter().map(|row| match row {
                Row::Cells(cells) => cells.get(column).map_or(0, count),
                Row::Remark(name, _) if column == 0 => count(name),
                Row::Remark(..) => 0,
            });
            cells.max().unwrap_or(0)
        };
        (0..self.head().len()).map(width).collect()
    }
}

fn count(text: impl AsRef<str>) -> usize {
    text.as_ref().chars().count()
}

/// A text in Markdown that is shown as it is: `|` separates no cells, and neither elements of HTML nor links and pictures, which a reader
/// of the page would load, come of it.
pub fn in_markdown(text: &str) -> String {
    in_one_line(text).replace('\\', "\\\\").replace('|', "\\|").replace('<', "\\<").replace("](", "]\\(")
}

/// A text in Markdown between backticks, which end where the text does.
pub fn as_code(text: &str) -> String {
    format!("`{}`", in_one_line(text).replace('`', "'"))
}

/// At most `width` characters; what is left out is three dots.
pub(super) fn cut(line: &str, width: usize) -> String {
    if line.chars().count() <= width {
        return line.to_owned();
    }
    line.chars().take(width.saturating_sub(3)).chain("...".chars()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOSTILE: &str = "a|b\\|c\n| d |\u{1b}[2J <img src=x> ![x](http://x) `y`";

    #[test]
    fn a_hostile_cell_stays_a_cell() {
        let mut table = Table::new(&["task|", "n"]);
        table.row(vec![HOSTILE.into(), "1".into()]);
        table.remark("short".into(), HOSTILE.into());
        let markdown = table.markdown();
        assert_eq!(markdown.lines().count(), 4, "{markdown}");
        let cells = |line: &str| line.replace(r"\\", "").replace(r"\|", "").matches('|').count() - 1;
        assert!(markdown.lines().all(|line| cells(line) == 2), "{markdown}");
        assert!(
            markdown.lines().all(|line| line.chars().count() == markdown.lines().next().unwrap().chars().count()),
            "{markdown}"
        );
        assert!(markdown.contains(r"\\u001b[2J \<img src=x> ![x]\(http://x) `y`"), "{markdown}");
        assert_eq!(table.plain(200).lines().count(), 3);
        assert_eq!(as_code("a`b\n"), r"`a'b\n`");
    }
}
