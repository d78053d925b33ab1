//! A report as HTML, Markdown, CSV and LaTeX.

use super::{Grid, Section};
use askama::Template;
use core::fmt::Write;
use msk::evaluate::report::{Table, in_markdown};

/// The page, as `page.html` lays it out.
#[derive(Template)]
#[template(path = "page.html", config = "cli/report/askama.toml")]
struct Page<'a> {
    title: &'a str,
    sections: &'a [Section],
}

/// One page without links to anything outside.
pub fn html(title: &str, sections: &[Section]) -> String {
    // The template has no part that fails, and writing to a string cannot fail.
    Page { title, sections }.render().unwrap_or_default()
}

/// The tables as Markdown.
pub fn markdown(title: &str, sections: &[Section]) -> String {
    let mut text = format!("# {}\n", in_markdown(title));
    for (section, grid) in tables(sections) {
        let mut table = Table::new(&grid.head.iter().map(String::as_str).collect::<Vec<_>>());
        grid.rows.iter().for_each(|row| table.row(row.clone()));
        let [title, words] = [&section.title, &section.words].map(|text| in_markdown(text));
        // Writing to a string cannot fail.
        let _ = write!(text, "\n## {title}\n\n{words}\n\n{}", table.markdown());
    }
    text
}

/// The tables one below the other, each row with the title of its table first.
pub fn csv(sections: &[Section]) -> String {
    let mut text = String::new();
    for (section, grid) in tables(sections) {
        for row in [&grid.head].into_iter().chain(&grid.rows) {
            let cells: Vec<String> = [&section.title].into_iter().chain(row).map(|cell| quoted(cell)).collect();
            text.push_str(&cells.join(","));
            text.push('\n');
        }
    }
    text
}

/// A cell of comma-separated values, in quotes where it needs them. A text that a spreadsheet would compute as a formula, which may
/// start programs and send what stands in other cells, has an apostrophe before it; numbers stay numbers.
pub fn quoted(cell: &str) -> String {
    let is_number = cell.parse::<f64>().is_ok() || cell.chars().all(|letter| letter == '-');
    let cell = if cell.starts_with(['=', '+', '-', '@']) && !is_number { format!("'{cell}") } else { cell.to_owned() };
    if cell.contains([',', '"', '\n', '\r']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell }
}

/// The tables as LaTeX, with the rules of `booktabs`.
pub fn latex(sections: &[Section]) -> String {
    const PACKAGES: &str = "% Needs the packages booktabs and adjustbox.\n\n";
    let mut text = String::new();
    for (section, grid) in tables(sections) {
        let line = |cells: &[String]| row(&cells.iter().map(|cell| escaped(cell)).collect::<Vec<_>>());
        let columns = "r".repeat(grid.head.len().saturating_sub(1));
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "\\begin{{table}}\n\\centering\n\\caption{{{}. {}}}\n{FITTED}\\begin{{tabular}}{{l{columns}}}\n\\toprule\n{} \\\\\n\\midrule\n",
            escaped(&section.title),
            escaped(&section.words),
            line(&grid.head)
        );
        grid.rows.iter().for_each(|row| text.extend([line(row).as_str(), " \\\\\n"]));
        let _ = write!(text, "\\bottomrule\n\\end{{tabular}}\n{END_FITTED}\\end{{table}}\n\n");
    }
    if text.is_empty() { text } else { format!("{PACKAGES}{text}") }
}

fn tables(sections: &[Section]) -> impl Iterator<Item = (&Section, &Grid)> {
    let filled = |section: &'_ Section| section.table.as_ref().is_some_and(|grid| !grid.rows.is_empty());
    sections.iter().filter(move |section| filled(section)).filter_map(|section| Some((section, section.table.as_ref()?)))
}

/// What makes a table smaller that is wider than the lines of a text, and its end.
pub const FITTED: &str = "\\begin{adjustbox}{max width=\\linewidth}\n";
pub const END_FITTED: &str = "\\end{adjustbox}\n";

/// A row of a table. What stands first in it is no argument of the command that ends the row before.
pub fn row(cells: &[String]) -> String {
    let row = cells.join(" & ");
    if row.trim_start().starts_with(['[', '*']) { format!("{{}}{row}") } else { row }
}

/// Text with the characters escaped that LaTeX takes for commands.
pub fn escaped(text: &str) -> String {
    let mut out = String::new();
    for sign in text.chars() {
        match sign {
            '\\' => out.push_str("\\textbackslash{}"),
            '^' => out.push_str("\\textasciicircum{}"),
            '~' => out.push_str("\\textasciitilde{}"),
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => out.extend(['\\', sign]),
            sign => out.push(sign),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sections() -> Vec<Section> {
        let grid =
            Grid { head: vec!["task".into(), "a, b".into()], rows: vec![vec!["open_door".into(), "94 % <x> | \"y\"".into()]] };
        vec![
            Section { title: "A & B".into(), words: "Words.".into(), table: Some(grid), figures: vec!["<svg></svg>".into()] },
            Section { title: "Empty".into(), table: Some(Grid::default()), ..Section::default() },
        ]
    }

    #[test]
    fn every_format_escapes_what_it_must() {
        let sections = sections();
        let page = html("T < U", &sections);
        assert!(page.contains("T &#60; U") && page.contains("&#60;x&#62;") && page.contains("<svg></svg>"), "{page}");
        assert!(!page.contains("http://") && !page.contains("https://"), "{page}");
        assert_eq!(csv(&sections), "A & B,task,\"a, b\"\nA & B,open_door,\"94 % <x> | \"\"y\"\"\"\n");
        let latex = latex(&sections);
        assert!(latex.contains("open\\_door & 94 \\% <x>") && latex.contains("A \\& B. Words."), "{latex}");
        let markdown = markdown("T", &sections);
        assert!(markdown.contains("## A & B") && markdown.contains("\\<x> \\| ") && !markdown.contains("Empty"), "{markdown}");
    }
}
