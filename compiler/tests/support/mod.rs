//! Specifications in Markdown: a text and the diagnostics of the compiler, side by side.
//!
//! A page under `tests/language/` holds snippets in blocks marked `msk`. What follows a snippet in a block marked `text` is what
//! is printed for it, to the letter; a snippet without one is right. A word after `msk` names what the snippet is put into
//! (`msk reward`: the lines of a reward), so that pages show only what they are about; places are counted in the snippet.
//! A block marked `msk file=PATH` is a file that the snippets after it, up to the next heading, may use.
//!
//! `MSK_UPDATE=1 cargo test` rewrites the `text` blocks; read the difference before keeping it.

pub mod compiling;
pub mod reading;

use msk_compiler::diagnostics::{Report, SourceMap, Span, Style};
use std::fmt::Write;
use std::path::Path;

/// Path under which a snippet is compiled.
pub const ENTRY: &str = "example.msk";

/// How a page is read: only parsed, or compiled whole.
pub trait Reading {
    /// The text before and after a snippet of the given kind; `None` if the kind is unknown. Both end with whole lines.
    fn surroundings(&self, kind: &str) -> Option<(String, String)>;

    /// Reads `entry` (to be called [`ENTRY`]) beside `files`, pairs of path and text.
    fn read(&self, entry: &str, files: &[(String, String)]) -> Report;
}

/// Reads every page of a folder of `tests/language/` and fails with all differences at once.
pub fn check_pages(folder: &str, reading: &dyn Reading) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/language").join(folder);
    let mut pages: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    pages.retain(|page| page.extension().is_some_and(|extension| extension == "md"));
    pages.sort();
    assert!(!pages.is_empty(), "no page in {}", folder.display());
    let mut differences = String::new();
    for page in pages {
        let text = std::fs::read_to_string(&page).unwrap();
        let (rewritten, wrong) = check_page(&text, reading);
        if std::env::var_os("MSK_UPDATE").is_some_and(|value| !value.is_empty()) {
            std::fs::write(&page, rewritten).unwrap();
        } else {
            for (line, wrong) in wrong {
                let _ = writeln!(differences, "{}:{line}\n{wrong}", page.display());
            }
        }
    }
    assert!(differences.is_empty(), "\n{differences}\n(MSK_UPDATE=1 rewrites the pages)");
}

/// The page with the right answers, and the snippets (line, what differs) whose answers were wrong.
fn check_page(page: &str, reading: &dyn Reading) -> (String, Vec<(usize, String)>) {
    let (mut rewritten, mut wrong, mut files) = (String::new(), Vec::new(), Vec::new());
    let mut blocks = split(page).into_iter().peekable();
    while let Some(block) = blocks.next() {
        rewritten += &block.source;
        if block.has_heading {
            files.clear();
        }
        let Some(info) = block.info.as_deref().and_then(|info| info.strip_prefix("msk")) else { continue };
        if let Some(path) = info.trim().strip_prefix("file=") {
            files.push((path.to_owned(), block.body));
            continue;
        }
        let answer = answer(&block.body, info.trim(), &files, reading);
        // The answer may follow after an empty line.
        let gap = blocks.next_if(|next| next.info.is_none() && next.source.trim().is_empty());
        let recorded = blocks.next_if(|next| next.info.as_deref() == Some("text"));
        let had_answer = recorded.is_some();
        let expected = recorded.map(|block| block.body).unwrap_or_default();
        if answer != expected {
            wrong.push((block.line, format!("{}-- expected --\n{expected}-- found --\n{answer}", block.body)));
        }
        if !answer.is_empty() {
            rewritten += &format!("```text\n{answer}```\n");
        }
        if let Some(gap) = gap.filter(|_| !had_answer || answer.is_empty()) {
            rewritten += &gap.source;
        }
    }
    (rewritten, wrong)
}

/// What is printed for a snippet, places counted in the snippet itself.
fn answer(snippet: &str, kind: &str, files: &[(String, String)], reading: &dyn Reading) -> String {
    let (before, after) = reading.surroundings(kind).unwrap_or_else(|| panic!("unknown kind of snippet `{kind}`"));
    let report = reading.read(&format!("{before}{snippet}{after}"), files);
    let entry = report.sources.files().find(|file| report.sources.path(*file) == ENTRY);
    let mut sources = SourceMap::default();
    for file in report.sources.files() {
        let text = if Some(file) == entry { snippet } else { report.sources.text(file) };
        sources.add(report.sources.path(file), text);
    }
    let shift = |span: &mut Span| {
        *span = Span::new((span.start as usize).saturating_sub(before.len()), (span.end as usize).saturating_sub(before.len()));
    };
    let mut diagnostics = report.diagnostics;
    for diagnostic in &mut diagnostics {
        diagnostic.labels.iter_mut().filter(|label| Some(label.file) == entry).for_each(|label| shift(&mut label.span));
    }
    let texts: Vec<String> = diagnostics.iter().map(|diagnostic| diagnostic.render(&sources, Style::Plain)).collect();
    texts.join("\n")
}

/// A fenced block, or what stands between two.
struct Block {
    /// Words after the fence; `None` between blocks.
    info: Option<String>,
    /// Without the fences.
    body: String,
    /// With them.
    source: String,
    /// Line of the page on which it begins.
    line: usize,
    /// Whether a heading stands in it.
    has_heading: bool,
}

fn split(page: &str) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut inside = false;
    for (index, line) in page.split_inclusive('\n').enumerate() {
        let fence = line.strip_prefix("```");
        let begins = blocks.is_empty() || (fence.is_some() && !inside) || (!inside && blocks.last().unwrap().info.is_some());
        if begins {
            let info = fence.map(|info| info.trim().to_owned());
            blocks.push(Block { info, body: String::new(), source: String::new(), line: index + 1, has_heading: false });
        }
        let block = blocks.last_mut().unwrap();
        block.source += line;
        match fence {
            Some(_) => inside = !inside,
            None if inside => block.body += line,
            None => block.has_heading |= line.starts_with('#'),
        }
    }
    blocks
}
