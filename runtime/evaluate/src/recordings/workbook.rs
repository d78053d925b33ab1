//! Sheets of `.xlsx` workbooks, as rows of texts.
//!
//! A workbook is a ZIP archive of XML files (ECMA-376, part 1, chapter 18): `xl/workbook.xml` names its sheets, their relations name the
//! files that they are in, and cells refer to texts in `xl/sharedStrings.xml`. Formulas come as the values that were kept with them.

use super::{RecordingError, RecordingError::Damaged};
use roxmltree::{Document, Node};
use std::io::{Cursor, Read};
use zip::ZipArchive;

/// Most bytes of a file of the archive.
const MOST_BYTES: u64 = 64 << 20;
/// Most columns of a sheet.
const MOST_COLUMNS: usize = 1 << 14;

/// The rows of the sheet of that name; empty cells are empty texts.
pub(super) fn sheet(bytes: &[u8], name: &str) -> Result<Vec<Vec<String>>, RecordingError> {
    let mut archive =
        ZipArchive::new(Cursor::new(bytes)).map_err(|_| RecordingError::Missing("ZIP archive, which a workbook is"))?;
    let workbook = part(&mut archive, "xl/workbook.xml")?.ok_or(Damaged("a workbook without a list of sheets"))?;
    let relations = part(&mut archive, "xl/_rels/workbook.xml.rels")?.ok_or(Damaged("a workbook without relations"))?;
    let texts = part(&mut archive, "xl/sharedStrings.xml")?;
    let target = target(&parse(&workbook)?, &parse(&relations)?, name)?;
    let sheet = part(&mut archive, &target)?.ok_or(Damaged("a workbook: the file of a sheet is missing"))?;
    let texts = texts.map_or(Ok(Vec::new()), |texts| Ok::<_, RecordingError>(shared(&parse(&texts)?)))?;
    rows(&parse(&sheet)?, &texts)
}

/// A file of the archive as text; `None` if there is none of that name.
fn part(archive: &mut ZipArchive<Cursor<&[u8]>>, name: &str) -> Result<Option<String>, RecordingError> {
    let Ok(file) = archive.by_name(name) else { return Ok(None) };
    let mut text = String::new();
    let read = file.take(MOST_BYTES + 1).read_to_string(&mut text);
    read.map_err(|_| Damaged("a workbook: a file of it cannot be unpacked"))?;
    if text.len() as u64 > MOST_BYTES { Err(RecordingError::Large) } else { Ok(Some(text)) }
}

fn parse(text: &str) -> Result<Document<'_>, RecordingError> {
    Document::parse(text).map_err(|_| Damaged("a workbook: a file of it is no XML"))
}

/// Elements of that name at any depth.
fn elements<'a>(document: &'a Document<'a>, name: &'static str) -> impl Iterator<Item = Node<'a, 'a>> {
    document.descendants().filter(move |node| node.tag_name().name() == name)
}

/// The file of the archive with the sheet of that name.
fn target(workbook: &Document<'_>, relations: &Document<'_>, name: &str) -> Result<String, RecordingError> {
    let Some(sheet) = elements(workbook, "sheet").find(|sheet| sheet.attribute("name") == Some(name)) else {
        let known: Vec<&str> = elements(workbook, "sheet").filter_map(|sheet| sheet.attribute("name")).collect();
        return Err(RecordingError::Sheet(name.to_owned(), known.join(", ")));
    };
    let id = sheet.attributes().find(|attribute| attribute.name() == "id").map(|attribute| attribute.value());
    let relation = elements(relations, "Relationship").find(|relation| id.is_some() && relation.attribute("Id") == id);
    let target =
        relation.and_then(|relation| relation.attribute("Target")).ok_or(Damaged("a workbook: a sheet without a file"))?;
    Ok(target.strip_prefix('/').map_or_else(|| format!("xl/{target}"), str::to_owned))
}

/// All letters within an element, which may be set in several styles; those of phonetic hints are left out.
fn letters(node: Node<'_, '_>) -> String {
    let texts = node.descendants().filter(|part| part.has_tag_name((part.tag_name().namespace().unwrap_or_default(), "t")));
    let shown = texts.filter(|text| !text.ancestors().any(|above| above.tag_name().name() == "rPh"));
    shown.filter_map(|text| text.text()).collect()
}

fn shared(document: &Document<'_>) -> Vec<String> {
    elements(document, "si").map(letters).collect()
}

fn rows(document: &Document<'_>, texts: &[String]) -> Result<Vec<Vec<String>>, RecordingError> {
    let row = |row: Node<'_, '_>| {
        let mut cells: Vec<String> = Vec::new();
        for cell in row.children().filter(|cell| cell.tag_name().name() == "c") {
            let place = cell.attribute("r").map_or(Some(cells.len()), column).filter(|place| *place < MOST_COLUMNS);
            let place = place.ok_or(Damaged("a workbook: the name of a cell"))?;
            cells.resize(cells.len().max(place + 1), String::new());
            cells[place] = value(cell, texts)?;
        }
        Ok(cells)
    };
    elements(document, "row").map(row).collect()
}

/// The column of a cell such as `AB12`, from 0.
fn column(name: &str) -> Option<usize> {
    let letters: Vec<u8> = name.bytes().take_while(u8::is_ascii_uppercase).collect();
    if letters.len() > 3 {
        return None;
    }
    letters.iter().fold(0, |number, letter| 26 * number + usize::from(letter - b'A') + 1).checked_sub(1)
}

fn value(cell: Node<'_, '_>, texts: &[String]) -> Result<String, RecordingError> {
    let value = cell.children().find(|part| part.tag_name().name() == "v").and_then(|value| value.text()).unwrap_or_default();
    match cell.attribute("t") {
        Some("s") => {
            let text = value.trim().parse::<usize>().ok().and_then(|place| texts.get(place));
            text.cloned().ok_or(Damaged("a workbook: a cell refers to a text that is missing"))
        }
        Some("inlineStr") => Ok(letters(cell)),
        _ => Ok(value.trim().to_owned()),
    }
}
