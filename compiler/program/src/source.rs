//! Places in texts: what is known of a task may point to where it was written, for those who have the texts.

/// A file among those of one compilation. The default is the first.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FileId(u32);

impl FileId {
    /// The file of that number, from 0.
    pub fn new(number: usize) -> Self {
        Self(u32::try_from(number).unwrap_or(u32::MAX))
    }

    /// Its number, from 0.
    pub fn number(self) -> usize {
        self.0 as usize
    }
}

/// Bytes `start..end` of a file.
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    /// First byte.
    pub start: u32,
    /// Byte after the last.
    pub end: u32,
}

/// `12..34`: trees are full of spans.
impl std::fmt::Debug for Span {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{}..{}", self.start, self.end)
    }
}

impl Span {
    /// Bytes `start..end`. Files are at most 256 kB, so that offsets fit.
    pub fn new(start: usize, end: usize) -> Self {
        let offset = |byte: usize| u32::try_from(byte).unwrap_or(u32::MAX);
        Self { start: offset(start), end: offset(end.max(start)) }
    }

    /// The empty span before `byte`.
    pub fn at(byte: usize) -> Self {
        Self::new(byte, byte)
    }

    /// From the start of `self` to the end of `other`.
    pub fn to(self, other: Span) -> Self {
        Self { start: self.start.min(other.start), end: self.end.max(other.end) }
    }

    /// As a range of indices.
    pub fn range(self) -> std::ops::Range<usize> {
        self.start as usize..self.end as usize
    }

    /// The text it covers; empty if `text` is shorter, or if the ends are not between characters.
    pub fn of(self, text: &str) -> &str {
        text.get(self.range()).unwrap_or("")
    }
}

/// Where the parts of a task stand in the texts, for diagnostics that need its model.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Places {
    /// The word `init`.
    pub init: (FileId, Span),
    /// The condition of success.
    pub success: (FileId, Span),
    /// The conditions of the reasons that end an episode as a failure, in order.
    pub terminations: Vec<(FileId, Span)>,
    /// The conditions of the reasons that end an episode without being failures, in order.
    pub finishes: Vec<(FileId, Span)>,
    /// The formulas of the terms, in order.
    pub terms: Vec<(FileId, Span)>,
    /// Every `allow` of the task, and whether it covers what the compiler warns of.
    pub allowances: Vec<Allowance>,
}

/// An `allow` of a task.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Allowance {
    /// The code of the lint that is allowed: `W0511`.
    pub code: &'static str,
    /// Where the statement stands.
    pub place: (FileId, Span),
    /// What it covers.
    pub scope: Scope,
    /// Whether it has covered a warning.
    pub fulfilled: bool,
}

/// What an `allow` covers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Scope {
    /// All of the task.
    Task,
    /// A line of a list; none where no line follows.
    Line(Option<(FileId, Span)>),
}

impl Scope {
    /// Whether it covers what is found at a place.
    pub fn covers(&self, file: FileId, span: Span) -> bool {
        match self {
            Self::Task => true,
            Self::Line(line) => line.is_some_and(|(own, line)| own == file && line.start <= span.start && span.end <= line.end),
        }
    }
}
