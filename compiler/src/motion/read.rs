//! From a text of comma-separated values to a [`Motion`], with every error at its place.

use super::{Column, Motion, RootPart, Table, Target};
use crate::diagnostics::{Checked, Code, Diagnostic, Failures, FileId, Reported, Span, codes, nearest};
use crate::numbers::{distinguished, for_people};
use crate::quantity::dimension::Dimension;
use crate::quantity::unit;

/// Headers of a motion.
const WORDS: [&str; 5] = ["name", "source", "cycle", "duration", "advances"];

/// How far the first and the last row of a cycle may differ, rad or m: tables are written with a few decimals.
const CLOSING: f64 = 1e-4;

/// How far the last time may differ from the duration, as a fraction of it.
const TIMING: f64 = 1e-6;

/// Largest number of a table, in whatever unit: beyond it curves through the rows would lose all digits, or overflow.
const LARGEST: f64 = 1e6;

/// Rows that a cycle needs, and another motion.
const FEWEST: [usize; 2] = [4, 2];

/// Reads a table. `file` is where diagnostics point.
///
/// Lines that begin with `#` are the head: `# name: walk`, `# source: ...` (as often as there are sources), `# cycle: yes`,
/// `# duration: 1.1 s`, `# advances: root.x, root.height`; such a line without a colon is a remark. Then come the headings,
/// `time [s]` or `phase` and the columns with their units, and the rows.
///
/// # Errors
/// Every error of the text.
pub fn read(file: FileId, text: &str) -> Result<Motion, Vec<Diagnostic>> {
    let mut diagnostics = Vec::new();
    read_into(file, text, &mut diagnostics).map_err(|_| diagnostics)
}

/// Reads a table; its errors go to `diagnostics`.
pub(crate) fn read_into(file: FileId, text: &str, diagnostics: &mut Vec<Diagnostic>) -> Checked<Motion> {
    let mut reader = Reader { file, diagnostics: Vec::new() };
    let motion = reader.motion(text);
    let broken = Reported::among(&reader.diagnostics);
    diagnostics.append(&mut reader.diagnostics);
    motion.and_then(|motion| broken.map_or(Ok(motion), Err))
}

/// A part of the text, trimmed, with the byte at which it begins.
#[derive(Clone, Copy)]
struct Part<'a> {
    text: &'a str,
    start: usize,
}

impl<'a> Part<'a> {
    fn new(text: &'a str, start: usize) -> Self {
        let trimmed = text.trim_start();
        Self { text: trimmed.trim_end(), start: start + text.len() - trimmed.len() }
    }

    fn span(self) -> Span {
        Span::new(self.start, self.start + self.text.len())
    }

    fn cut(self, at: char) -> Option<(Part<'a>, Part<'a>)> {
        let (left, right) = self.text.split_once(at)?;
        Some((Part::new(left, self.start), Part::new(right, self.start + left.len() + at.len_utf8())))
    }

    /// The parts between commas.
    fn cells(self) -> Vec<Part<'a>> {
        let mut start = self.start;
        let cell = |text: &'a str| {
            let part = Part::new(text, start);
            start += text.len() + 1;
            part
        };
        self.text.split(',').map(cell).collect()
    }
}

/// The headers of a motion, as read.
#[derive(Default)]
struct Head<'a> {
    name: Option<Part<'a>>,
    sources: Vec<&'a str>,
    cycle: Option<bool>,
    duration: Option<(f64, Span)>,
    advances: Vec<Part<'a>>,
}

/// How the rows are placed in time.
#[derive(Clone, Copy, PartialEq)]
enum Clock {
    /// SI value of one unit of the first column.
    Time(f64),
    /// Fractions of the duration.
    Phase,
}

struct Reader {
    file: FileId,
    diagnostics: Vec<Diagnostic>,
}

impl Reader {
    fn error(&mut self, code: &'static Code, span: Span, message: impl Into<String>) -> &mut Diagnostic {
        self.diagnostics.push(Diagnostic::new(code, self.file, span, message));
        let last = self.diagnostics.len() - 1;
        &mut self.diagnostics[last]
    }

    fn failed(&mut self, code: &'static Code, span: Span, message: impl Into<String>, help: Option<&str>) -> Reported {
        let mut diagnostic = Diagnostic::new(code, self.file, span, message);
        diagnostic.help.extend(help.map(str::to_owned));
        diagnostic.report(&mut self.diagnostics)
    }

    fn motion(&mut self, text: &str) -> Checked<Motion> {
        let mut head = Head::default();
        let mut headings: Option<Part<'_>> = None;
        let mut rows: Vec<Part<'_>> = Vec::new();
        let mut start = 0;
        for line in text.split_inclusive('\n') {
            let part = Part::new(line, start);
            start += line.len();
            match (part.text.strip_prefix('#'), headings) {
                _ if part.text.is_empty() => {}
                (Some(line), None) => self.head_line(Part::new(line, part.start + 1), &mut head),
                (Some(_), Some(_)) => {}
                (None, None) => headings = Some(part),
                (None, Some(_)) => rows.push(part),
            }
        }
        let end = Span::at(text.len());
        let Some(headings) = headings else {
            let help = "after the lines that begin with `#` come the column names, `phase, hip_flexion_r [deg]`, and the rows";
            return Err(self.failed(codes::composition::MOTION_TABLE, end, "there is no table here", Some(help)));
        };
        let (clock, mut columns) = self.headings(headings)?;
        for wanted in &head.advances {
            self.advances(*wanted, &mut columns);
        }
        let table = self.rows(&rows, columns.len() + 1, clock);
        let (name, cycle) = self.complete(&head, headings.span())?;
        let (mut times, values) = table?;
        if rows.len() < FEWEST[usize::from(!cycle)] {
            let (kind, fewest) = if cycle { ("a cycle", "four") } else { ("a motion", "two") };
            let message = format!("{kind} has at least {fewest} rows, found {}", rows.len());
            return Err(self.failed(codes::composition::MOTION_TABLE, headings.span(), message, None));
        }
        let duration = self.timing(&head, clock, &mut times, &rows, headings.span())?;
        // Columns of the text in SI units, one list for each.
        let factor = |column: &Column| unit::find(&column.unit).map_or(1.0, |unit| unit.factor);
        let column = |index: usize| values.iter().map(|row| row[index] * factor(&columns[index])).collect::<Vec<f64>>();
        let lists: Vec<Vec<f64>> = (0..columns.len()).map(column).collect();
        if cycle {
            self.must_close(&columns, &lists, rows.last().map_or(headings.span(), |row| row.span()));
        }
        let source = head.sources.join("\n");
        Ok(Table { name, source, cycle, duration, columns, times, values: lists }.into())
    }

    fn head_line<'a>(&mut self, line: Part<'a>, head: &mut Head<'a>) {
        let Some((word, value)) = line.cut(':').filter(|(word, _)| !word.text.contains(char::is_whitespace)) else { return };
        match word.text {
            "name" if head.name.is_none() => head.name = Some(value),
            "source" => head.sources.push(value.text),
            "cycle" if head.cycle.is_none() => match value.text {
                "yes" => head.cycle = Some(true),
                "no" => head.cycle = Some(false),
                _ => {
                    self.error(codes::composition::MOTION_TABLE, value.span(), "a motion is cyclic or not: `yes` or `no`");
                }
            },
            "duration" if head.duration.is_none() => head.duration = self.duration(value),
            "advances" if head.advances.is_empty() => head.advances = value.cells(),
            known if WORDS.contains(&known) => {
                let message = format!("`{known}` is given twice");
                self.error(codes::composition::MOTION_TABLE, word.span(), message);
            }
            other => {
                let near = nearest(other, WORDS);
                let message = format!("unknown header `{other}` of a motion");
                let diagnostic = self.error(codes::composition::MOTION_TABLE, word.span(), message);
                diagnostic.help.extend(near.first().map(|near| format!("did you mean `{near}`?")));
                diagnostic
                    .help
                    .push(format!("known headers are {}; a comment has no colon after its first word", WORDS.join(", ")));
            }
        }
    }

    fn duration(&mut self, value: Part<'_>) -> Option<(f64, Span)> {
        let parsed = value.text.split_once(' ').and_then(|(number, unit)| {
            let unit = unit::find(unit.trim()).filter(|unit| unit.dimension == Dimension::TIME)?;
            number.parse::<f64>().ok().map(|number| number * unit.factor)
        });
        let good = parsed.filter(|duration| *duration > 0.0 && *duration <= LARGEST);
        if good.is_none() {
            let found = value.text.to_owned();
            let diagnostic = self.error(codes::composition::MOTION_TABLE, value.span(), "a duration is a positive time");
            (diagnostic.expected, diagnostic.found) = (Some("a time with its unit: `1.1 s`".to_owned()), Some(found));
        }
        good.map(|duration| (duration, value.span()))
    }

    /// How time is counted, and the columns.
    fn headings(&mut self, line: Part<'_>) -> Checked<(Clock, Vec<Column>)> {
        let cells = line.cells();
        // A line has a cell before its first comma.
        let (first, others) = (cells[0], &cells[1..]);
        let mut failures = Failures::default();
        let (name, unit) = named(first);
        let clock = match (name.text, unit.map(|unit| unit.text)) {
            ("phase", None) => Some(Clock::Phase),
            ("time", Some(unit)) => unit::find(unit).filter(|u| u.dimension == Dimension::TIME).map(|u| Clock::Time(u.factor)),
            _ => None,
        };
        if clock.is_none() {
            let message = "the first column is the time or phase of each row";
            let diagnostic = Diagnostic::new(codes::composition::MOTION_COLUMN, self.file, first.span(), message)
                .expected("`time [s]`, or `phase` from 0 to 1")
                .found(first.text);
            failures.add(diagnostic.report(&mut self.diagnostics));
        }
        let mut columns: Vec<Column> = Vec::new();
        for cell in others {
            let Some(column) = failures.catch(self.column(*cell)) else { continue };
            if let Some(known) = columns.iter().find(|known| known.target == column.target) {
                let message = format!("the column `{}` is declared twice", column.target.name());
                let diagnostic = Diagnostic::new(codes::composition::MOTION_COLUMN, self.file, cell.span(), message);
                let diagnostic = diagnostic.label(self.file, known.span, "the first");
                failures.add(diagnostic.report(&mut self.diagnostics));
                continue;
            }
            columns.push(column);
        }
        if others.is_empty() {
            let message = "the table has no column but the first";
            failures.add(self.failed(codes::composition::MOTION_COLUMN, line.span(), message, None));
        }
        // Without a clock there is a failure.
        failures.or((clock.unwrap_or(Clock::Phase), columns))
    }

    fn column(&mut self, cell: Part<'_>) -> Checked<Column> {
        let (name, written) = named(cell);
        let root = name.text.starts_with("root.");
        let part = RootPart::ALL.into_iter().find(|part| part.heading() == name.text);
        let target = match (name.text, part) {
            ("", _) => {
                return Err(self.failed(codes::composition::MOTION_COLUMN, cell.span(), "a column without a name", None));
            }
            (_, Some(part)) => Target::Root(part),
            (_, None) if root => {
                let message = format!("the root has no `{}`", name.text);
                let parts = RootPart::ALL.map(RootPart::heading);
                let near = nearest(name.text, parts);
                let mut diagnostic = Diagnostic::new(codes::composition::MOTION_COLUMN, self.file, name.span(), message);
                diagnostic.help.extend(near.first().map(|near| format!("did you mean `{near}`?")));
                let diagnostic = diagnostic.help(format!("it has {}", parts.join(", ")));
                return Err(diagnostic.report(&mut self.diagnostics));
            }
            _ => Target::Joint(name.text.to_owned()),
        };
        let wanted = part.map(RootPart::dimension);
        let unit = written.and_then(|unit| unit::find(unit.text));
        let fits = |dimension: Dimension| match wanted {
            Some(wanted) => dimension == wanted,
            None => dimension == Dimension::ANGLE || dimension == Dimension::LENGTH,
        };
        let Some(unit) = unit.filter(|unit| fits(unit.dimension)) else {
            let (span, found) = written.map_or((cell.span(), "no unit"), |unit| (unit.span(), unit.text));
            let message = format!("`{}` needs a matching unit", name.text);
            let expected = match wanted {
                Some(Dimension::LENGTH) => format!("a length: `{} [m]`", name.text),
                Some(_) => format!("an angle: `{} [deg]`", name.text),
                None => format!("an angle or, for a slide, a length: `{} [deg]`", name.text),
            };
            let diagnostic = Diagnostic::new(codes::composition::MOTION_COLUMN, self.file, span, message);
            return Err(diagnostic.expected(expected).found(found).report(&mut self.diagnostics));
        };
        Ok(Column { target, unit: unit.name.to_owned(), dimension: unit.dimension, advances: false, span: name.span() })
    }

    /// Marks a column that goes on from turn to turn.
    fn advances(&mut self, wanted: Part<'_>, columns: &mut [Column]) {
        match columns.iter_mut().find(|column| column.target.name() == wanted.text && can_advance(&column.target)) {
            Some(column) => column.advances = true,
            None => {
                let message = format!("`{}` is not a column that can advance from cycle to cycle", wanted.text);
                self.error(codes::composition::MOTION_CYCLE, wanted.span(), message)
                    .help
                    .push("root.x, root.y and root.height can; joints and angles of the root are periodic".to_owned());
            }
        }
    }

    /// Times as written, and the numbers of each row.
    fn rows(&mut self, rows: &[Part<'_>], width: usize, clock: Clock) -> Checked<(Vec<f64>, Vec<Vec<f64>>)> {
        let (mut times, mut values) = (Vec::new(), Vec::new());
        let mut failures = Failures::default();
        for row in rows {
            let cells = row.cells();
            if cells.len() != width {
                let message = "a row has one number per column";
                let diagnostic = Diagnostic::new(codes::composition::MOTION_TABLE, self.file, row.span(), message)
                    .expected(format!("{width} numbers"))
                    .found(cells.len().to_string());
                failures.add(diagnostic.report(&mut self.diagnostics));
                continue;
            }
            let mut numbers = Vec::with_capacity(width);
            for cell in &cells {
                numbers.extend(failures.catch(self.number(*cell)));
            }
            if numbers.len() < width {
                continue;
            }
            let time = numbers.remove(0);
            if times.last().is_some_and(|last| *last >= time) {
                let word = if clock == Clock::Phase { "phases" } else { "times" };
                let message = format!("{word} increase from row to row");
                failures.add(self.failed(codes::composition::MOTION_TABLE, cells[0].span(), message, None));
            } else if times.is_empty() && time != 0.0 {
                let message = "the first row is at 0";
                failures.add(self.failed(codes::composition::MOTION_TABLE, cells[0].span(), message, None));
            }
            times.push(time);
            values.push(numbers);
        }
        failures.or((times, values))
    }

    fn number(&mut self, cell: Part<'_>) -> Checked<f64> {
        let message = match cell.text.parse::<f64>() {
            Ok(number) if number.abs() <= LARGEST => return Ok(number),
            Ok(number) if number.is_finite() => {
                format!("`{}` is too large: the largest number of a motion is {}", cell.text, for_people(LARGEST))
            }
            _ => format!("`{}` is not a number", cell.text),
        };
        Err(self.failed(codes::composition::MOTION_TABLE, cell.span(), message, None))
    }

    /// What every head gives: a name and whether it is a cycle.
    fn complete(&mut self, head: &Head<'_>, place: Span) -> Checked<(String, bool)> {
        let mut failures = Failures::default();
        let missing = [("name", head.name.is_none()), ("source", head.sources.is_empty()), ("cycle", head.cycle.is_none())];
        for (word, _) in missing.iter().filter(|(_, missing)| *missing) {
            let example = match *word {
                "name" => "# name: walk",
                "source" => "# source: where the values come from",
                _ => "# cycle: yes",
            };
            let (message, help) =
                (format!("the motion does not declare its `{word}`"), format!("write `{example}` above the column names"));
            failures.add(self.failed(codes::composition::MOTION_TABLE, place, message, Some(&help)));
        }
        // What is missing is a failure.
        failures.or((head.name.map_or("", |name| name.text).to_owned(), head.cycle.unwrap_or_default()))
    }

    /// The duration; `times` become seconds.
    fn timing(&mut self, head: &Head<'_>, clock: Clock, times: &mut [f64], rows: &[Part<'_>], headings: Span) -> Checked<f64> {
        let last_row = rows.last().map_or(headings, |row| row.cells().first().map_or(headings, |cell| cell.span()));
        // A table without rows is refused before.
        let last = times.last().copied().unwrap_or(0.0);
        let (factor, duration) = match (clock, head.duration) {
            (Clock::Phase, None) => {
                let (message, help) =
                    ("a table over phases must declare its `duration`", "write `# duration: 1.1 s` above the column names");
                return Err(self.failed(codes::composition::MOTION_TABLE, headings, message, Some(help)));
            }
            (Clock::Phase, Some((duration, _))) if last == 1.0 => (duration, duration),
            (Clock::Phase, Some(_)) => {
                return Err(self.failed(codes::composition::MOTION_TABLE, last_row, "the last row must be at phase 1", None));
            }
            (Clock::Time(factor), None) => (factor, last * factor),
            (Clock::Time(factor), Some((duration, span))) => {
                if (last * factor - duration).abs() > TIMING * duration {
                    let message = "the last row must be at the duration";
                    let diagnostic = Diagnostic::new(codes::composition::MOTION_TABLE, self.file, last_row, message)
                        .expected(format!("{} s", for_people(duration)))
                        .found(format!("{} s", for_people(last * factor)))
                        .label(self.file, span, "the duration");
                    return Err(diagnostic.report(&mut self.diagnostics));
                }
                (factor, duration)
            }
        };
        times.iter_mut().for_each(|time| *time *= factor);
        // The table ends where the motion does, to the bit.
        if let Some(last) = times.last_mut() {
            *last = duration;
        }
        Ok(duration)
    }

    /// A cycle ends as it began, but for what goes on.
    fn must_close(&mut self, columns: &[Column], lists: &[Vec<f64>], last_row: Span) {
        for (column, values) in columns.iter().zip(lists).filter(|(column, _)| !column.advances) {
            let (Some(first), Some(last)) = (values.first(), values.last()) else { continue };
            if (first - last).abs() > CLOSING {
                let name = column.target.name();
                let factor = unit::find(&column.unit).map_or(1.0, |unit| unit.factor);
                let tidy = |value: f64| (value / factor * 1e6).round() / 1e6;
                let shown = distinguished(&[tidy(*first), tidy(*last)]).map(|value| format!("{value} {}", column.unit));
                let ([expected, found], file, span) = (shown, self.file, column.span);
                let message = format!("the cycle does not close: first and last value of `{name}` differ");
                let diagnostic = self.error(codes::composition::MOTION_CYCLE, last_row, message);
                (diagnostic.expected, diagnostic.found) = (Some(expected), Some(found));
                diagnostic.labels.push(crate::diagnostics::Label { file, span, text: "this column".to_owned() });
                let mut help = "the last row is the first row of the next cycle".to_owned();
                if can_advance(&column.target) {
                    help += &format!("; declare columns that advance: `# advances: {name}`");
                }
                diagnostic.help.push(help);
            }
        }
    }
}

/// Whether a column may go on from turn to turn: places may, what turns comes back.
fn can_advance(target: &Target) -> bool {
    matches!(target, Target::Root(RootPart::X | RootPart::Y | RootPart::Height))
}

/// `name [unit]` taken apart.
fn named(cell: Part<'_>) -> (Part<'_>, Option<Part<'_>>) {
    match cell.cut('[') {
        Some((name, rest)) if rest.text.ends_with(']') => (name, Some(Part::new(&rest.text[..rest.text.len() - 1], rest.start))),
        _ => (cell, None),
    }
}
