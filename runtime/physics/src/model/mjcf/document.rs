//! Model files as a tree of elements: XML parsed, includes spliced in, every element with its file and line.

use super::error::{ModelError, Place};
use super::lenient;
use super::values::shortened;
use crate::model::ModelFiles;
use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

/// Elements may nest this deep (MuJoCo's own parser stops at a similar depth).
const DEEPEST: usize = 256;
/// One file may hold this many bytes.
const LONGEST_FILE: u64 = 64 << 20;
/// All files of a model together may hold this many elements.
const MOST_ELEMENTS: usize = 1_000_000;
/// A model may be spread over this many files.
const MOST_FILES: usize = 1_000;

/// An element with its attributes as written.
#[derive(Debug, Clone)]
pub(super) struct Element {
    pub tag: String,
    pub attributes: Vec<(String, String)>,
    pub children: Vec<Element>,
    pub place: Place,
}

impl Element {
    /// An element without attributes or children.
    pub fn empty(tag: &str, place: Place) -> Self {
        Self { tag: tag.to_owned(), attributes: Vec::new(), children: Vec::new(), place }
    }

    /// How many elements this is, with all in it.
    pub fn size(&self) -> usize {
        1 + self.children.iter().map(Self::size).sum::<usize>()
    }
}

/// A model's elements, and where its files are.
#[derive(Debug)]
pub(super) struct Document<'a> {
    pub root: Element,
    /// `None` for text without a file.
    pub origin: Option<Origin<'a>>,
}

/// Where the files of a model are.
#[derive(Debug, Clone)]
pub(super) struct Origin<'a> {
    files: &'a dyn ModelFiles,
    /// The folder that names of files are relative to.
    pub folder: PathBuf,
}

impl Origin<'_> {
    /// The bytes of a file of bounded size, if there is one.
    fn find(&self, path: &Path) -> Result<Option<Vec<u8>>, ModelError> {
        let read = self.files.read(path, LONGEST_FILE);
        read.map_err(|reason| ModelError::Read { path: path.to_path_buf(), reason })
    }

    /// The bytes of a file of bounded size.
    pub fn read(&self, path: &Path) -> Result<Vec<u8>, ModelError> {
        let missing = || ModelError::Read { path: path.to_path_buf(), reason: "there is no such file".to_owned() };
        self.find(path)?.ok_or_else(missing)
    }
}

/// Reads a model file with its includes.
pub(super) fn read_file<'a>(path: &Path, files: &'a dyn ModelFiles) -> Result<Document<'a>, ModelError> {
    let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
    let origin = Origin { files, folder };
    let bytes = origin.read(path)?;
    let mut reader = Reader { origin: Some(origin), seen: BTreeSet::new(), elements: 0 };
    let root = reader.file(path, bytes, 0)?;
    Ok(Document { root, origin: reader.origin })
}

/// Reads a model from text that includes nothing.
pub(super) fn read_text(text: &str) -> Result<Document<'static>, ModelError> {
    let mut reader = Reader { origin: None, seen: BTreeSet::new(), elements: 0 };
    let root = reader.text(text, Path::new(""), 0)?;
    Ok(Document { root, origin: None })
}

/// A path without `.` and, where that is possible, without `..`, by which a file is known again.
fn identity(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir if matches!(plain.components().next_back(), Some(Component::Normal(_))) => {
                plain.pop();
            }
            other => plain.push(other),
        }
    }
    plain
}

/// Carries what must be bounded or unique over all files of one model.
struct Reader<'a> {
    origin: Option<Origin<'a>>,
    seen: BTreeSet<PathBuf>,
    elements: usize,
}

impl Reader<'_> {
    fn file(&mut self, path: &Path, bytes: Vec<u8>, depth: usize) -> Result<Element, ModelError> {
        let wrong = |reason: &str| ModelError::File { path: path.to_path_buf(), reason: reason.to_owned() };
        if !self.seen.insert(identity(path)) {
            return Err(wrong("included more than once; a file may be part of a model only once"));
        }
        if self.seen.len() > MOST_FILES {
            return Err(wrong("the model includes more than 1000 files"));
        }
        let text = String::from_utf8(bytes).map_err(|_| wrong("not UTF-8 text"))?;
        self.text(&text, path, depth)
    }

    fn text(&mut self, text: &str, path: &Path, depth: usize) -> Result<Element, ModelError> {
        let file: Arc<Path> = Arc::from(path);
        let mended: String;
        let xml = match parse(text) {
            Ok(xml) => xml,
            Err(error) => {
                // MuJoCo's parser is more lenient than the standard, and published models rely on it.
                mended = lenient::mend(text);
                parse(&mended).map_err(|_| ModelError::Syntax {
                    place: Place { file: file.clone(), line: error.pos().row },
                    reason: error.to_string(),
                })?
            }
        };
        let text = xml.input_text();
        let lines = Lines { file, starts: line_starts(text) };
        let mut spliced = Vec::new();
        self.convert(xml.root_element(), &lines, depth, &mut spliced)?;
        let mut spliced = spliced.into_iter();
        match (spliced.next(), spliced.next()) {
            (Some(root), None) => Ok(root),
            _ => Err(invalid(&lines.place(0), "the top-level element cannot be an include".to_owned())),
        }
    }

    /// Appends the element, or the children of the file that it includes, to `into`.
    fn convert(
        &mut self,
        node: roxmltree::Node<'_, '_>,
        lines: &Lines,
        depth: usize,
        into: &mut Vec<Element>,
    ) -> Result<(), ModelError> {
        let place = lines.place(node.range().start);
        if depth > DEEPEST {
            return Err(invalid(&place, format!("elements nest deeper than {DEEPEST} levels")));
        }
        self.elements += 1;
        if self.elements > MOST_ELEMENTS {
            return Err(invalid(&place, format!("the model has more than {MOST_ELEMENTS} elements")));
        }
        let tag = node.tag_name().name().to_owned();
        if tag == "include" {
            return self.include(node, &place, depth, into);
        }
        let attributes = node.attributes().filter(|attribute| attribute.namespace().is_none());
        let attributes = attributes.map(|attribute| (attribute.name().to_owned(), attribute.value().to_owned())).collect();
        let mut children = Vec::new();
        for child in node.children().filter(roxmltree::Node::is_element) {
            self.convert(child, lines, depth + 1, &mut children)?;
        }
        into.push(Element { tag, attributes, children, place });
        Ok(())
    }

    fn include(
        &mut self,
        node: roxmltree::Node<'_, '_>,
        place: &Place,
        depth: usize,
        into: &mut Vec<Element>,
    ) -> Result<(), ModelError> {
        let name = node.attribute("file").ok_or_else(|| invalid(place, "`include` needs the attribute `file`".to_owned()))?;
        let origin = self.origin.as_ref();
        let origin = origin.ok_or_else(|| invalid(place, "text without a file cannot include files".to_owned()))?;
        // MuJoCo looks in the main file's folder first, then in the including file's.
        let beside = place.file.parent().unwrap_or(Path::new("")).join(name);
        let path = origin.folder.join(name);
        let (path, bytes) = match origin.find(&path)? {
            Some(bytes) => (path, bytes),
            None => {
                let bytes = origin.read(&beside)?;
                (beside, bytes)
            }
        };
        let included = self.file(&path, bytes, depth + 1)?;
        if included.children.is_empty() {
            return Err(invalid(place, format!("the included file `{name}` holds no elements")));
        }
        into.extend(included.children);
        Ok(())
    }
}

fn parse(text: &str) -> Result<roxmltree::Document<'_>, roxmltree::Error> {
    let options = roxmltree::ParsingOptions { nodes_limit: 4 * MOST_ELEMENTS as u32, ..Default::default() };
    roxmltree::Document::parse_with_options(text, options)
}

/// Byte offsets to lines: looked up by bisection, since asking the parser costs a scan of the file for every element.
struct Lines {
    file: Arc<Path>,
    starts: Vec<usize>,
}

impl Lines {
    fn place(&self, offset: usize) -> Place {
        let line = self.starts.partition_point(|start| *start <= offset);
        Place { file: self.file.clone(), line: u32::try_from(line).unwrap_or(u32::MAX) }
    }
}

fn line_starts(text: &str) -> Vec<usize> {
    let breaks = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
    core::iter::once(0).chain(breaks.map(|(offset, _)| offset + 1)).collect()
}

/// A mistake at a place. Whatever of the file the message repeats, it stays readable.
pub(super) fn invalid(place: &Place, message: String) -> ModelError {
    const MOST: usize = 500;
    ModelError::Invalid { place: place.clone(), message: shortened(&message, MOST) }
}
