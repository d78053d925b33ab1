//! Indentation, aligned columns, aligned comments.

use super::columns::{Group, Marks};
use super::lines::Line;
use super::spacing;
use crate::syntax::scanner::Token;
use crate::work::visit;
use std::collections::BTreeMap;

/// A line cut at its columns.
struct Cells {
    /// Aligned with the lines of the same key.
    key: (Group, usize),
    /// (number of the column, its text, whether it is aligned at its point)
    cells: Vec<(usize, String, bool)>,
}

/// Width of a column: before the point, and from it on.
#[derive(Default, Clone, Copy)]
struct Width {
    whole: usize,
    fraction: usize,
}

type Widths = BTreeMap<((Group, usize), usize), Width>;

/// Writes all lines.
pub(super) fn lay_out(text: &str, lines: &[Line], marks: &Marks) -> String {
    let cells = cut(text, lines, marks);
    let widths = widths(&cells);
    let bodies: Vec<String> = lines
        .iter()
        .zip(&cells)
        .map(|(line, cells)| match cells {
            Some(cells) => aligned(cells, &widths),
            None => spacing::joined(text, marks, &line.tokens),
        })
        .collect();
    write(text, lines, &bodies)
}

/// Cuts the lines that have columns. Neighbours of one sort share a run; what stands between ends it.
fn cut(text: &str, lines: &[Line], marks: &Marks) -> Vec<Option<Cells>> {
    let mut run = 0;
    let mut previous = None;
    lines
        .iter()
        .map(|line| {
            let cells = columns(text, line, marks);
            let group = cells.as_ref().map(|cells| (cells.key.0, line.level));
            if !line.tokens.is_empty() || line.is_blank() {
                run += usize::from(group != previous);
                previous = group;
            }
            let run = match group {
                Some((Group::Run(_), _)) => run,
                _ => 0,
            };
            cells.map(|cells| Cells { key: (cells.key.0, run), ..cells })
        })
        .collect()
}

fn columns(text: &str, line: &Line, marks: &Marks) -> Option<Cells> {
    let mut starts: Vec<(usize, usize, bool)> = Vec::new();
    let mut group: Option<Group> = None;
    for (index, token) in line.tokens.iter().enumerate() {
        let before = index.checked_sub(1).map(|before| &line.tokens[before]);
        let mark = matches!(&text[token.start..token.end], "=" | "{" | "when");
        let behind = before.filter(|_| mark).and_then(|before| marks.column_after(before.start));
        // Only the first statement of a line is aligned.
        if &text[token.start..token.end] == ";" {
            break;
        }
        let Some(column) = marks.column(token.start).or(behind) else { continue };
        if group.is_some_and(|group| group != column.group) || starts.last().is_some_and(|last| last.1 >= column.number) {
            continue;
        }
        group = Some(column.group);
        starts.push((index, column.number, column.decimal));
    }
    let group = group?;
    // Several on a line are a list, not a table.
    let begins = |token: &&Token| marks.column(token.start).is_some_and(|column| column.group == group && column.number == 0);
    if line.tokens.iter().filter(begins).count() > 1 {
        return None;
    }
    match starts.first() {
        // The word before the value of a setting is a column of its own.
        Some((1, 1, _)) => starts.insert(0, (0, 0, false)),
        Some((0, ..)) => {}
        _ => return None,
    }
    let ends = starts.iter().skip(1).map(|start| start.0).chain([line.tokens.len()]);
    let cells = starts.iter().zip(ends);
    let cells = cells.map(|(start, end)| (start.1, spacing::joined(text, marks, &line.tokens[start.0..end]), start.2));
    Some(Cells { key: (group, 0), cells: cells.collect() })
}

/// Text before the point, and from it on.
fn halves(cell: &str, decimal: bool) -> (usize, usize) {
    let length = cell.chars().count();
    if decimal {
        let whole = cell.find(['.', 'e', 'E']).unwrap_or(length);
        (whole, length - whole)
    } else {
        (0, length)
    }
}

fn widths(lines: &[Option<Cells>]) -> Widths {
    let mut widths = Widths::new();
    for line in lines.iter().flatten() {
        // The last cell of a line needs no room beside it.
        for (number, cell, decimal) in line.cells.iter().rev().skip(1) {
            let width = widths.entry((line.key, *number)).or_default();
            let (whole, fraction) = halves(cell, *decimal);
            width.whole = width.whole.max(whole);
            width.fraction = width.fraction.max(fraction);
        }
    }
    widths
}

fn aligned(line: &Cells, widths: &Widths) -> String {
    let mut out = String::new();
    let last = line.cells.last().map_or(0, |cell| cell.0);
    for (&(_, number), width) in widths.range((line.key, 0)..(line.key, last)) {
        let cell = line.cells.iter().find(|cell| cell.0 == number);
        let (whole, fraction) = cell.map_or((0, 0), |cell| halves(&cell.1, cell.2));
        // A column that only some lines have takes its room in all.
        out.extend(std::iter::repeat_n(' ', width.whole - whole.min(width.whole)));
        out.push_str(cell.map_or("", |cell| &cell.1));
        out.extend(std::iter::repeat_n(' ', width.fraction - fraction.min(width.fraction) + 1));
    }
    out.push_str(line.cells.last().map_or("", |cell| &cell.1));
    out
}

/// Puts lines together: indentation, one empty line at most, comments of neighbouring lines in one column.
fn write(text: &str, lines: &[Line], bodies: &[String]) -> String {
    let comment_columns = comment_columns(lines, bodies);
    let mut out = String::new();
    let mut blank = false;
    let mut opened = true;
    for (index, line) in lines.iter().enumerate() {
        if line.is_blank() {
            blank = true;
            continue;
        }
        let closes = bodies[index].starts_with('}');
        if blank && !opened && !closes {
            out.push('\n');
        }
        let indent = 4 * line.level;
        let body = bodies[index].trim_end();
        out.extend(std::iter::repeat_n(' ', indent));
        out.push_str(body);
        if let Some(comment) = line.comment {
            if !body.is_empty() {
                let width = comment_columns[index] - body.chars().count() - indent;
                out.extend(std::iter::repeat_n(' ', width));
            }
            out.push_str(comment.of(text).trim_end());
        }
        out.push('\n');
        blank = false;
        opened = body.ends_with('{');
    }
    out
}

/// Where the comment behind each line begins: two blanks behind the longest of its neighbours that have one. Neighbours are lines
/// of one level without an empty line or a comment line between them.
fn comment_columns(lines: &[Line], bodies: &[String]) -> Vec<usize> {
    let mut columns = Vec::with_capacity(lines.len());
    let is_beside = |a: &Line, b: &Line| !a.tokens.is_empty() && !b.tokens.is_empty() && a.level == b.level;
    for neighbours in lines.chunk_by(is_beside) {
        visit(neighbours.len());
        let first = columns.len();
        let commented = neighbours.iter().zip(&bodies[first..]).filter(|(line, _)| line.comment.is_some());
        let widths = commented.map(|(line, body)| 4 * line.level + body.trim_end().chars().count());
        let column = widths.max().unwrap_or(0) + 2;
        columns.resize(first + neighbours.len(), column);
    }
    columns
}

#[cfg(test)]
mod tests {
    use crate::diagnostics::FileId;
    use crate::format::format;
    use crate::work::assert_linear;

    #[test]
    fn commented_lines_are_visited_once() {
        let text = |lines: usize| format!("task t {{\n{}}}\n", "    let a = 1 // x\n".repeat(lines));
        assert_linear(500, |lines| format(FileId::default(), &text(lines)).unwrap());
    }
}
