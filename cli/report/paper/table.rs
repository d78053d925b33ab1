//! A table of the paper, and how it is written as LaTeX, Markdown and comma-separated values.

use super::super::page::{END_FITTED, FITTED, escaped, quoted, row};
use core::fmt::Write;
use msk::evaluate::report::{Table, in_markdown};
use msk_text::{in_one_line, numbers::fixed};

/// What a table has where nothing was evaluated.
pub const NOTHING: &str = "--";

/// A table. Texts are plain, with arrows and powers as characters; each format writes them in its own way.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PaperTable {
    /// What it shows.
    pub caption: String,
    /// Alignment of its columns, as LaTeX has it.
    pub columns: String,
    /// Rows of heads, whose columns add up to those of the table.
    pub head: Vec<Vec<Head>>,
    /// Groups of rows, with a rule between them.
    pub groups: Vec<Group>,
}

/// A head above one or more columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Head {
    pub text: String,
    pub columns: usize,
}

/// Rows that belong together.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Group {
    /// Stands once, before all of them; none in a table whose rows have no groups.
    pub name: Option<String>,
    /// Cells of each row, without the name.
    pub rows: Vec<Vec<Cell>>,
}

/// A cell.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cell {
    pub text: String,
    /// Whether it is the best of those that it is compared with.
    pub best: bool,
    /// A remark, such as of how many tasks a mean is.
    pub remark: String,
}

/// A head above one column.
pub fn head(text: impl Into<String>) -> Head {
    Head { text: text.into(), columns: 1 }
}

/// A cell without remark.
pub fn cell(text: impl Into<String>) -> Cell {
    Cell { text: text.into(), ..Cell::default() }
}

/// A number with so many decimals, or nothing.
pub fn number(value: Option<f64>, decimals: usize) -> Cell {
    cell(value.map_or(NOTHING.to_owned(), |value| fixed(value, decimals)))
}

/// All tables as LaTeX; empty if there are none.
pub fn latex(tables: &[PaperTable]) -> String {
    const PACKAGES: &str = "% Needs the packages booktabs, multirow and adjustbox.\n\n";
    let text: String = tables.iter().map(PaperTable::latex).collect();
    if text.is_empty() { text } else { format!("{PACKAGES}{text}") }
}

/// All tables as Markdown, each below its caption.
pub fn markdown(tables: &[PaperTable]) -> String {
    let text = |table: &PaperTable| format!("{}\n\n{}", in_markdown(&table.caption), table.markdown());
    tables.iter().map(text).collect::<Vec<_>>().join("\n")
}

/// All tables one below the other, each row with the caption of its table first.
pub fn csv(tables: &[PaperTable]) -> String {
    let line = |caption: &str, cells: &[String]| {
        [caption].into_iter().chain(cells.iter().map(String::as_str)).map(quoted).collect::<Vec<_>>().join(",") + "\n"
    };
    let text = |table: &PaperTable| -> String {
        let rows = table.rows().map(|row| row.iter().map(|cell| cell.text.clone()).collect());
        [table.heads()].into_iter().chain(rows).map(|cells: Vec<String>| line(&table.caption, &cells)).collect()
    };
    tables.iter().map(text).collect()
}

impl PaperTable {
    /// The same table with every text in one line.
    pub fn in_lines(mut self) -> Self {
        let heads = self.head.iter_mut().flatten().map(|head| &mut head.text);
        let groups = self.groups.iter_mut().flat_map(|group| {
            let cells = group.rows.iter_mut().flatten().flat_map(|cell| [&mut cell.text, &mut cell.remark]);
            group.name.iter_mut().chain(cells)
        });
        heads.chain(groups).chain([&mut self.caption]).for_each(|text| *text = in_one_line(text));
        self
    }

    /// A head for each column, those above each other in one.
    fn heads(&self) -> Vec<String> {
        let mut heads: Vec<String> = Vec::new();
        for row in &self.head {
            let texts: Vec<&str> = row.iter().flat_map(|head| std::iter::repeat_n(head.text.as_str(), head.columns)).collect();
            heads.resize(heads.len().max(texts.len()), String::new());
            for (head, text) in heads.iter_mut().zip(texts).filter(|(_, text)| !text.is_empty()) {
                let space = if head.is_empty() { "" } else { " " };
                head.push_str(&format!("{space}{text}"));
            }
        }
        heads
    }

    /// All rows with the names of their groups.
    fn rows(&self) -> impl Iterator<Item = Vec<Cell>> {
        let rows = |group: &Group| {
            let name = group.name.clone().map(cell);
            group.rows.iter().map(move |row| name.iter().chain(row).cloned().collect()).collect::<Vec<_>>()
        };
        self.groups.iter().flat_map(rows)
    }

    fn markdown(&self) -> String {
        let mut table = Table::new(&self.heads().iter().map(String::as_str).collect::<Vec<_>>());
        let cell = |cell: &Cell| {
            let Cell { text, best, remark } = cell;
            let remark = if remark.is_empty() { String::new() } else { format!(" ({remark})") };
            if *best { format!("**{text}**{remark}") } else { format!("{text}{remark}") }
        };
        self.rows().for_each(|row| table.row(row.iter().map(cell).collect()));
        table.markdown()
    }

    fn latex(&self) -> String {
        let mut text = format!(
            "\\begin{{table*}}\n\\centering\n\\setlength{{\\tabcolsep}}{{2pt}}\n\\caption{{{}}}\n{FITTED}\\begin{{tabular}}{{{}}}\n\\toprule\n",
            in_latex(&self.caption),
            self.columns
        );
        self.head.iter().for_each(|row| text.push_str(&heads_in_latex(row)));
        for group in &self.groups {
            text.push_str("\\midrule\n");
            for (place, row) in group.rows.iter().enumerate() {
                let name = group.name.as_ref().map(|name| match (place, group.rows.len()) {
                    (0, 1) => in_latex(name),
                    (0, count) => format!("\\multirow{{{count}}}{{*}}{{{}}}", in_latex(name)),
                    _ => String::new(),
                });
                let cells: Vec<String> = name.into_iter().chain(row.iter().map(Cell::latex)).collect();
                // Writing to a string cannot fail.
                let _ = writeln!(text, "{}", line(&cells));
            }
        }
        let _ = write!(text, "\\bottomrule\n\\end{{tabular}}\n{END_FITTED}\\end{{table*}}\n\n");
        text
    }
}

/// A row of heads, with rules below those that stand above several columns.
fn heads_in_latex(row: &[Head]) -> String {
    let text = |head: &Head| match head.columns {
        1 => in_latex(&head.text),
        columns => format!("\\multicolumn{{{columns}}}{{c}}{{{}}}", in_latex(&head.text)),
    };
    let (mut rules, mut from) = (Vec::new(), 1);
    for head in row {
        let to = from + head.columns - 1;
        if to > from {
            rules.push(format!("\\cmidrule(lr){{{from}-{to}}}"));
        }
        from = to + 1;
    }
    let rules = if rules.is_empty() { String::new() } else { format!("{}\n", rules.join(" ")) };
    format!("{}\n{rules}", line(&row.iter().map(text).collect::<Vec<_>>()))
}

/// A line of cells.
fn line(cells: &[String]) -> String {
    format!("{} \\\\", row(cells)).replace("  ", " ").trim_start().to_owned()
}

impl Cell {
    fn latex(&self) -> String {
        let text = in_latex(&self.text);
        let text = if self.best { format!("\\textbf{{{text}}}") } else { text };
        if self.remark.is_empty() { text } else { format!("{text}\\textsuperscript{{{}}}", in_latex(&self.remark)) }
    }
}

/// Plain text as LaTeX, with what stands for arrows, powers and products as mathematics.
fn in_latex(text: &str) -> String {
    const MATHEMATICS: [(char, &str); 7] = [
        ('\u{2191}', "$\\uparrow$"),
        ('\u{2193}', "$\\downarrow$"),
        ('\u{d7}', "$\\times$"),
        ('\u{b2}', "$^2$"),
        ('\u{2076}', "$^6$"),
        ('\u{2077}', "$^7$"),
        ('>', "$>$"),
    ];
    escaped(text)
        .chars()
        .map(|letter| match MATHEMATICS.iter().find(|(known, _)| *known == letter) {
            Some((_, mathematics)) => (*mathematics).to_owned(),
            None => letter.to_string(),
        })
        .collect()
}

/// Marks the cells with the largest number, where there are several numbers and the largest is more than nothing.
pub fn mark_largest(cells: &mut [Cell], numbers: &[Option<f64>]) {
    let several = numbers.iter().flatten().count() > 0 && numbers.len() > 1;
    let largest = numbers.iter().flatten().copied().fold(0.0, |largest, number| if number > largest { number } else { largest });
    for (cell, number) in cells.iter_mut().zip(numbers) {
        cell.best = several && number.is_some_and(|number| number > 0.0 && number >= largest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> PaperTable {
        let rows = |numbers: [&str; 2]| {
            numbers.map(|text| vec![cell(text), Cell { text: "1".into(), best: true, remark: "3/6".into() }]).to_vec()
        };
        PaperTable {
            caption: "A & B \u{2191}".into(),
            columns: "lcc".into(),
            head: vec![
                vec![head(""), Head { text: "SR (%)".into(), columns: 2 }],
                vec![head("Task"), head("a|b"), head("rad\u{b2}/s\u{2076}")],
            ],
            groups: vec![
                Group { name: Some("open_door".into()), rows: rows(["x", "y"]) },
                Group { name: Some("walk, run".into()), rows: rows(["z", "--"])[..1].to_vec() },
            ],
        }
    }

    #[test]
    fn every_format_has_all_heads_and_cells() {
        let all = [table()];
        assert_eq!(
            csv(&all),
            "A & B \u{2191},Task,SR (%) a|b,SR (%) rad\u{b2}/s\u{2076}\nA & B \u{2191},open_door,x,1\nA & B \u{2191},open_door,y,1\n\
             A & B \u{2191},\"walk, run\",z,1\n"
        );
        let latex = latex(&all);
        for line in [
            "\\caption{A \\& B $\\uparrow$}",
            "& \\multicolumn{2}{c}{SR (\\%)} \\\\",
            "\\cmidrule(lr){2-3}",
            "Task & a|b & rad$^2$/s$^6$ \\\\",
            "\\multirow{2}{*}{open\\_door} & x & \\textbf{1}\\textsuperscript{3/6} \\\\",
            "& y & \\textbf{1}\\textsuperscript{3/6} \\\\",
            "walk, run & z & \\textbf{1}\\textsuperscript{3/6} \\\\",
        ] {
            assert!(latex.lines().any(|found| found == line), "no `{line}` in\n{latex}");
        }
        assert_eq!(latex.matches("\\midrule").count(), 2);
        let markdown = markdown(&all);
        assert!(markdown.contains("| open_door |           y | **1** (3/6) |") || markdown.contains("**1** (3/6)"), "{markdown}");
        assert_eq!(super::latex(&[]), "");
    }

    #[test]
    fn the_largest_of_several_is_marked() {
        let marked = |numbers: &[Option<f64>]| {
            let mut cells = vec![cell("x"); numbers.len()];
            mark_largest(&mut cells, numbers);
            cells.iter().map(|cell| cell.best).collect::<Vec<_>>()
        };
        assert_eq!(marked(&[Some(1.0), None, Some(2.0), Some(2.0)]), [false, false, true, true]);
        assert_eq!(marked(&[Some(1.0)]), [false]);
        assert_eq!(marked(&[Some(0.0), Some(0.0)]), [false, false]);
    }
}
