//! From a text of comma-separated values to a [`Motion`], with every error at its place.

use super::curve::Curve;
use super::{Column, Motion, RootPart, Target};
use crate::check::dimension::Dimension;
use crate::check::unit;
use crate::diagnostics::{Code, Diagnostic, FileId, Span, codes, nearest};

/// What the head of a motion may say.
const WORDS: [&str; 5] = ["name", "source", "cycle", "duration", "advances"];

/// How far the first and the last row of a cycle may differ, rad or m: tables are written with a few decimals.
const CLOSING: f64 = 1e-4;

/// How far the last time may differ from the duration, as a fraction of it.
const TIMING: f64 = 1e-6;

/// Rows that a cycle needs, and another motion.
const FEWEST: [usize; 2] = [4, 2];

impl Motion {
    /// Reads a table. `file` is where diagnostics point.
    ///
    /// Lines that begin with `#` are the head: `# name: walk`, `# source: ...` (as often as there are sources), `# cycle: yes`,
    /// `# duration: 1.1 s`, `# advances: root.x, root.height`; such a line without a colon is a remark. Then come the headings,
    /// `time [s]` or `phase` and the columns with their units, and the rows.
    ///
    /// # Errors
    /// Every error of the text.
    pub fn read(file: FileId, text: &str) -> Result<Self, Vec<Diagnostic>> {
        let mut reader = Reader { file, diagnostics: Vec::new() };
        let motion = reader.motion(text);
        match motion {
            Some(motion) if reader.diagnostics.is_empty() => Ok(motion),
            _ => Err(reader.diagnostics),
        }
    }
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

/// What the head says.
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

    fn motion(&mut self, text: &str) -> Option<Motion> {
        let mut head = Head::default();
        let mut headings: Option<Part<'_>> = None;
        let mut rows: Vec<Part<'_>> = Vec::new();
        let mut start = 0;
        for line in text.split_inclusive('\n') {
            let part = Part::new(line, start);
            start += line.len();
            match (part.text.strip_prefix('#'), headings) {
                _ if part.text.is_empty() => {}
                (Some(said), None) => self.head_line(Part::new(said, part.start + 1), &mut head),
                (Some(_), Some(_)) => {}
                (None, None) => headings = Some(part),
                (None, Some(_)) => rows.push(part),
            }
        }
        let end = Span::at(text.len());
        let Some(headings) = headings else {
            self.error(codes::composition::MOTION_TABLE, end, "there is no table here")
                .help
                .push("after the lines that begin with `#` come headings, `phase, hip_flexion_r [deg]`, and the rows".to_owned());
            return None;
        };
        let (clock, mut columns) = self.headings(headings)?;
        for wanted in &head.advances {
            self.advances(*wanted, &mut columns);
        }
        let table = self.rows(&rows, columns.len() + 1, clock);
        let (name, cycle) = self.complete(&head, headings.span())?;
        let (mut times, values) = table?;
        let duration = self.timing(&head, clock, &mut times, &rows, headings.span())?;
        if rows.len() < FEWEST[usize::from(!cycle)] {
            let (kind, fewest) = if cycle { ("a cycle", "four") } else { ("a motion", "two") };
            let message = format!("{kind} has at least {fewest} rows, this one has {}", rows.len());
            self.error(codes::composition::MOTION_TABLE, headings.span(), message);
            return None;
        }
        // Columns of the text in SI units, one list for each.
        let factor = |column: &Column| unit::find(&column.unit).map_or(1.0, |unit| unit.factor);
        let column = |index: usize| values.iter().map(|row| row[index] * factor(&columns[index])).collect::<Vec<f64>>();
        let lists: Vec<Vec<f64>> = (0..columns.len()).map(column).collect();
        if cycle {
            self.must_close(&columns, &lists, rows.last()?.span());
        }
        let curves = lists.iter().map(|values| Curve::through(&times, values, cycle)).collect();
        let source = head.sources.join("\n");
        Some(Motion { name, source, cycle, duration, columns, times, curves, digest: String::new() }.identified())
    }

    fn head_line<'a>(&mut self, said: Part<'a>, head: &mut Head<'a>) {
        let Some((word, value)) = said.cut(':').filter(|(word, _)| !word.text.contains(char::is_whitespace)) else { return };
        match word.text {
            "name" if head.name.is_none() => head.name = Some(value),
            "source" => head.sources.push(value.text),
            "cycle" if head.cycle.is_none() => match value.text {
                "yes" => head.cycle = Some(true),
                "no" => head.cycle = Some(false),
                _ => {
                    self.error(codes::composition::MOTION_TABLE, value.span(), "a motion is a cycle or is none: `yes` or `no`");
                }
            },
            "duration" if head.duration.is_none() => head.duration = self.duration(value),
            "advances" if head.advances.is_empty() => head.advances = value.cells(),
            known if WORDS.contains(&known) => {
                let message = format!("`{known}` is said twice");
                self.error(codes::composition::MOTION_TABLE, word.span(), message);
            }
            other => {
                let near = nearest(other, WORDS);
                let message = format!("the head of a motion says nothing called `{other}`");
                let diagnostic = self.error(codes::composition::MOTION_TABLE, word.span(), message);
                diagnostic.help.extend(near.first().map(|near| format!("did you mean `{near}`?")));
                diagnostic.help.push(format!("it says {}; a remark has no colon after its first word", WORDS.join(", ")));
            }
        }
    }

    fn duration(&mut self, value: Part<'_>) -> Option<(f64, Span)> {
        let parsed = value.text.split_once(' ').and_then(|(number, unit)| {
            let unit = unit::find(unit.trim()).filter(|unit| unit.dimension == Dimension::TIME)?;
            number.parse::<f64>().ok().map(|number| number * unit.factor)
        });
        let good = parsed.filter(|duration| duration.is_finite() && *duration > 0.0);
        if good.is_none() {
            let found = value.text.to_owned();
            let diagnostic = self.error(codes::composition::MOTION_TABLE, value.span(), "a duration is a positive time");
            (diagnostic.expected, diagnostic.found) = (Some("a time with its unit: `1.1 s`".to_owned()), Some(found));
        }
        good.map(|duration| (duration, value.span()))
    }

    /// How time is counted, and the columns.
    fn headings(&mut self, line: Part<'_>) -> Option<(Clock, Vec<Column>)> {
        let cells = line.cells();
        let (first, others) = cells.split_first()?;
        let (name, unit) = named(*first);
        let clock = match (name.text, unit.map(|unit| unit.text)) {
            ("phase", None) => Some(Clock::Phase),
            ("time", Some(unit)) => unit::find(unit).filter(|u| u.dimension == Dimension::TIME).map(|u| Clock::Time(u.factor)),
            _ => None,
        };
        if clock.is_none() {
            let found = first.text.to_owned();
            let diagnostic =
                self.error(codes::composition::MOTION_COLUMN, first.span(), "the first column says when each row is");
            (diagnostic.expected, diagnostic.found) = (Some("`time [s]`, or `phase` from 0 to 1".to_owned()), Some(found));
        }
        let mut columns: Vec<Column> = Vec::new();
        for cell in others {
            let Some(column) = self.column(*cell) else { continue };
            if let Some(known) = columns.iter().find(|known| known.target == column.target) {
                let (message, first) = (format!("there are two columns `{}`", column.target.name()), known.span);
                let file = self.file;
                let diagnostic = self.error(codes::composition::MOTION_COLUMN, cell.span(), message);
                diagnostic.labels.push(crate::diagnostics::Label { file, span: first, text: "the first".to_owned() });
                continue;
            }
            columns.push(column);
        }
        if others.is_empty() {
            self.error(codes::composition::MOTION_COLUMN, line.span(), "the table moves nothing: it has no column but the first");
        }
        let whole = columns.len() == others.len() && !columns.is_empty();
        clock.filter(|_| whole).map(|clock| (clock, columns))
    }

    fn column(&mut self, cell: Part<'_>) -> Option<Column> {
        let (name, written) = named(cell);
        let root = name.text.starts_with("root.");
        let part = RootPart::ALL.into_iter().find(|part| part.heading() == name.text);
        let target = match (name.text, part) {
            ("", _) => {
                self.error(codes::composition::MOTION_COLUMN, cell.span(), "a column without a name");
                return None;
            }
            (_, Some(part)) => Target::Root(part),
            (_, None) if root => {
                let message = format!("the root has no `{}`", name.text);
                let parts = RootPart::ALL.map(RootPart::heading);
                let near = nearest(name.text, parts);
                let diagnostic = self.error(codes::composition::MOTION_COLUMN, name.span(), message);
                diagnostic.help.extend(near.first().map(|near| format!("did you mean `{near}`?")));
                diagnostic.help.push(format!("it has {}", parts.join(", ")));
                return None;
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
            let message = format!("`{}` needs a unit that fits", name.text);
            let expected = match wanted {
                Some(Dimension::LENGTH) => format!("a length: `{} [m]`", name.text),
                Some(_) => format!("an angle: `{} [deg]`", name.text),
                None => format!("an angle or, along a slide, a length: `{} [deg]`", name.text),
            };
            let found = found.to_owned();
            let diagnostic = self.error(codes::composition::MOTION_COLUMN, span, message);
            (diagnostic.expected, diagnostic.found) = (Some(expected), Some(found));
            return None;
        };
        Some(Column { target, unit: unit.name.to_owned(), dimension: unit.dimension, advances: false, span: name.span() })
    }

    /// Marks a column that goes on from turn to turn.
    fn advances(&mut self, wanted: Part<'_>, columns: &mut [Column]) {
        match columns.iter_mut().find(|column| column.target.name() == wanted.text && can_advance(&column.target)) {
            Some(column) => column.advances = true,
            None => {
                let message = format!("`{}` is no column that can go on from turn to turn", wanted.text);
                self.error(codes::composition::MOTION_CYCLE, wanted.span(), message)
                    .help
                    .push("root.x, root.y and root.height can; joints and turns of the root come back".to_owned());
            }
        }
    }

    /// Times as written, and the numbers of each row.
    fn rows(&mut self, rows: &[Part<'_>], width: usize, clock: Clock) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
        let (mut times, mut values) = (Vec::new(), Vec::new());
        let errors = self.diagnostics.len();
        for row in rows {
            let cells = row.cells();
            if cells.len() != width {
                let (expected, found) = (format!("{width} numbers"), format!("{}", cells.len()));
                let diagnostic = self.error(codes::composition::MOTION_TABLE, row.span(), "a row has a number for every heading");
                (diagnostic.expected, diagnostic.found) = (Some(expected), Some(found));
                continue;
            }
            let mut numbers = cells.iter().map(|cell| self.number(*cell)).collect::<Vec<_>>().into_iter();
            let Some(Some(time)) = numbers.next() else { continue };
            if times.last().is_some_and(|last| *last >= time) {
                let word = if clock == Clock::Phase { "phases" } else { "times" };
                self.error(codes::composition::MOTION_TABLE, cells[0].span(), format!("{word} increase from row to row"));
            } else if times.is_empty() && time != 0.0 {
                self.error(codes::composition::MOTION_TABLE, cells[0].span(), "the first row stands at 0");
            }
            times.push(time);
            values.extend(numbers.collect::<Option<Vec<f64>>>());
        }
        (self.diagnostics.len() == errors).then_some((times, values))
    }

    fn number(&mut self, cell: Part<'_>) -> Option<f64> {
        let number = cell.text.parse::<f64>().ok().filter(|number| number.is_finite());
        if number.is_none() {
            let message = format!("`{}` is no number", cell.text);
            self.error(codes::composition::MOTION_TABLE, cell.span(), message);
        }
        number
    }

    /// What every head says: a name and whether it is a cycle.
    fn complete(&mut self, head: &Head<'_>, place: Span) -> Option<(String, bool)> {
        let missing = [("name", head.name.is_none()), ("source", head.sources.is_empty()), ("cycle", head.cycle.is_none())];
        for (word, _) in missing.iter().filter(|(_, missing)| *missing) {
            let example = match *word {
                "name" => "# name: walk",
                "source" => "# source: where the figures come from",
                _ => "# cycle: yes",
            };
            self.error(codes::composition::MOTION_TABLE, place, format!("the motion does not say its `{word}`"))
                .help
                .push(format!("write `{example}` above the headings"));
        }
        Some((head.name?.text.to_owned(), head.cycle?))
    }

    /// The duration; `times` become seconds.
    fn timing(&mut self, head: &Head<'_>, clock: Clock, times: &mut [f64], rows: &[Part<'_>], headings: Span) -> Option<f64> {
        let last_row = rows.last().map_or(headings, |row| row.cells().first().map_or(headings, |cell| cell.span()));
        let last = *times.last()?;
        let (factor, duration) = match (clock, head.duration) {
            (Clock::Phase, None) => {
                self.error(codes::composition::MOTION_TABLE, headings, "a table over phases must say its `duration`")
                    .help
                    .push("write `# duration: 1.1 s` above the headings".to_owned());
                return None;
            }
            (Clock::Phase, Some((duration, _))) if last == 1.0 => (duration, duration),
            (Clock::Phase, Some(_)) => {
                self.error(codes::composition::MOTION_TABLE, last_row, "the last row stands at phase 1");
                return None;
            }
            (Clock::Time(factor), None) => (factor, last * factor),
            (Clock::Time(factor), Some((duration, span))) => {
                if (last * factor - duration).abs() > TIMING * duration {
                    let found = format!("{} s", last * factor);
                    let expected = format!("{duration} s");
                    let file = self.file;
                    let diagnostic =
                        self.error(codes::composition::MOTION_TABLE, last_row, "the last row does not stand at the duration");
                    (diagnostic.expected, diagnostic.found) = (Some(expected), Some(found));
                    diagnostic.labels.push(crate::diagnostics::Label { file, span, text: "the duration".to_owned() });
                    return None;
                }
                (factor, duration)
            }
        };
        times.iter_mut().for_each(|time| *time *= factor);
        // The table ends where the motion does, to the bit.
        *times.last_mut()? = duration;
        Some(duration)
    }

    /// A cycle ends as it began, but for what goes on.
    fn must_close(&mut self, columns: &[Column], lists: &[Vec<f64>], last_row: Span) {
        for (column, values) in columns.iter().zip(lists).filter(|(column, _)| !column.advances) {
            let (Some(first), Some(last)) = (values.first(), values.last()) else { continue };
            if (first - last).abs() > CLOSING {
                let name = column.target.name();
                let factor = unit::find(&column.unit).map_or(1.0, |unit| unit.factor);
                let shown = |value: f64| format!("{} {}", (value / factor * 1e6).round() / 1e6, column.unit);
                let (expected, found, file, span) = (shown(*first), shown(*last), self.file, column.span);
                let message = format!("the cycle does not close: `{name}` ends elsewhere than it begins");
                let diagnostic = self.error(codes::composition::MOTION_CYCLE, last_row, message);
                (diagnostic.expected, diagnostic.found) = (Some(expected), Some(found));
                diagnostic.labels.push(crate::diagnostics::Label { file, span, text: "this column".to_owned() });
                let mut help = "the last row is the first of the next turn".to_owned();
                if can_advance(&column.target) {
                    help += &format!("; what goes on is said: `# advances: {name}`");
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
