use super::*;

/// Written by `tests/oracle/recordings.py` with mat-io and with SciPy.
const TABLES: &[u8] = include_bytes!("../gait120/processed.mat");
const STRUCTURES: &[u8] = include_bytes!("../gait120/converted.mat");

#[test]
fn structures_and_tables_of_other_programs_are_read() {
    for bytes in [TABLES, STRUCTURES] {
        let file = MatFile::read(bytes).unwrap();
        assert_eq!(file.names().collect::<Vec<_>>(), ["LevelWalking"]);
        let movement = file.get("LevelWalking").unwrap();
        assert_eq!(movement.field("AvailableTrialIdx").unwrap().numbers(), Some(&[1.0, 3.0][..]));
        assert_eq!(movement.field("nTrials").unwrap().numbers(), Some(&[3.0][..]));
        let cycle = movement.field("Trial01").and_then(|trial| trial.field("Step02")?.field("EMGs_interpolated")).unwrap();
        let columns = file.columns(cycle).unwrap();
        assert_eq!(columns.iter().map(|(name, _)| *name).collect::<Vec<_>>(), ["VastusLateralis", "GastrocnemuisMedialis"]);
        assert!(columns[0].1.len() == 101 && columns[0].1[50] == 2.5 && columns[1].1[25] == 1.5, "{columns:?}");
        assert!(file.columns(movement).is_err());
    }
}

/// An element with its tag.
fn element(ty: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = [ty.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
    bytes.extend_from_slice(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

/// A variable of that class and those dimensions, and what comes after its name.
fn variable(class: u8, dimensions: [i32; 2], name: &str, rest: &[Vec<u8>]) -> Vec<u8> {
    let dimensions: Vec<u8> = dimensions.into_iter().flat_map(i32::to_le_bytes).collect();
    let head = [element(6, &[class, 0, 0, 0, 0, 0, 0, 0]), element(5, &dimensions), element(1, name.as_bytes())];
    element(MATRIX, &[head.concat(), rest.concat()].concat())
}

fn file(variables: &[Vec<u8>]) -> Vec<u8> {
    let mut header = b"MATLAB 5.0 MAT-file".to_vec();
    header.resize(124, b' ');
    [header, vec![0, 1, b'I', b'M'], variables.concat()].concat()
}

#[test]
fn numbers_of_every_type_texts_and_short_elements_are_read() {
    let words: Vec<u8> = [-2_i16, 300].into_iter().flat_map(i16::to_le_bytes).collect();
    let wide: Vec<u8> = "Löß".encode_utf16().flat_map(u16::to_le_bytes).collect();
    // Four bytes or less stand in the place of the length.
    let short = [[9, 0, 2, 0], [7, 8, 0, 0]].concat();
    let short_bytes = [&[2, 0, 2, 0][..], &short[4..]].concat();
    let bytes = file(&[
        variable(6, [1, 2], "words", &[element(3, &words)]),
        variable(9, [1, 2], "short", &[short_bytes]),
        variable(6, [1, 1], "float", &[element(7, &1.5_f32.to_le_bytes())]),
        variable(4, [1, 3], "text", &[element(17, &wide)]),
        variable(1, [1, 2], "cells", &[variable(4, [1, 1], "", &[element(16, b"a")]), element(MATRIX, &[])]),
        variable(5, [1, 1], "sparse", &[]),
    ]);
    let file = MatFile::read(&bytes).unwrap();
    let get = |name: &str| file.get(name).unwrap().clone();
    assert_eq!(get("words"), Value::Numbers(vec![-2.0, 300.0]));
    assert_eq!(get("short"), Value::Numbers(vec![7.0, 8.0]));
    assert_eq!(get("float"), Value::Numbers(vec![1.5]));
    assert_eq!(get("text"), Value::Text("Löß".into()));
    assert_eq!(get("cells"), Value::Cells(vec![Value::Text("a".into()), Value::Numbers(vec![])]));
    assert_eq!(get("sparse"), Value::Other);
}

#[test]
fn other_formats_and_too_deep_values_are_refused() {
    let message = |bytes: &[u8]| MatFile::read(bytes).unwrap_err().to_string();
    assert_eq!(message(b"percent,Soleus"), "has no mark of a MAT file of level 5, little-endian, in its header");
    assert!(message(b"MATLAB 7.3 MAT-file").contains("HDF5"));
    let mut cell = variable(6, [0, 0], "", &[]);
    for _ in 0..DEEPEST + 1 {
        cell = variable(1, [1, 1], "deep", &[cell]);
    }
    assert_eq!(message(&file(&[cell])), "is damaged: its depth: values are nested too deeply");
    let large = variable(1, [i32::MAX, 1], "large", &[]);
    assert_eq!(message(&file(&[large])), "has more numbers than are read");
}

#[test]
fn damaged_files_are_refused_and_never_more() {
    for bytes in [TABLES, STRUCTURES] {
        for length in 0..bytes.len() {
            let _ = MatFile::read(&bytes[..length]);
        }
    }
    // Inside of the deflated variables, where every byte means something.
    let inflated: Vec<Vec<u8>> =
        Elements(&TABLES[HEADER..]).map(|part| inflate(part.unwrap().data, &mut MOST_BYTES.clone()).unwrap()).collect();
    let whole = file(&inflated);
    for place in HEADER..whole.len() {
        for value in [0, 1, 0x7F, 0xFF] {
            let mut bytes = whole.clone();
            bytes[place] = value;
            if let Ok(read) = MatFile::read(&bytes) {
                let trial = read
                    .get("LevelWalking")
                    .and_then(|movement| movement.field("Trial01")?.field("Step01")?.field("EMGs_interpolated"));
                let _ = trial.map(|cycle| read.columns(cycle).map(|columns| columns.len()));
            }
        }
    }
}
