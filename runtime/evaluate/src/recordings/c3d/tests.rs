use super::*;

/// Written by `tests/oracle/recordings.py` with ezc3d.
const EXAMPLE: &[u8] = include_bytes!("../example.c3d");

/// What that program has put in.
fn place(marker: usize, frame: usize) -> [f64; 3] {
    let [marker, frame] = [marker, frame].map(|number| number as f64);
    [100.0 * marker + frame, 0.5 * frame - marker, 1000.0 - 2.0 * frame]
}

fn sample(channel: usize, sample: usize) -> f64 {
    0.25 * sample as f64 - channel as f64
}

#[test]
fn markers_and_channels_of_another_program_are_read() {
    let found = read(EXAMPLE).unwrap();
    assert_eq!(found.names[..5], ["frame", "time", "HEEL.x", "HEEL.y", "HEEL.z"]);
    assert_eq!(found.names[8..], ["Soleus", "Tib. ant.", "Gastroc"]);
    assert_eq!(found.rows(), 5 * 4);
    for frame in 0..5 {
        for marker in 0..2 {
            for axis in 0..3 {
                let column = &found.columns[2 + 3 * marker + axis][4 * frame..4 * frame + 4];
                // The second marker was not seen in the fourth frame.
                match (marker, frame) {
                    (1, 3) => assert!(column[0].is_nan()),
                    _ => assert!((column[0] - place(marker, frame)[axis]).abs() < 1e-4, "{marker} {frame} {column:?}"),
                }
                assert!(column[1..].iter().all(|value| value.is_nan()));
            }
        }
    }
    for channel in 0..3 {
        for row in 0..20 {
            let value = found.columns[8 + channel][row];
            assert!((value - sample(channel, row)).abs() < 1e-5, "{channel} {row}: {value}");
        }
    }
    let time = found.column("time").unwrap();
    assert!((time[5] - time[0] - 5.0 / 400.0).abs() < 1e-12 && (time[19] - time[0] - 19.0 / 400.0).abs() < 1e-12);
}

/// A file of one marker and one channel with two samples per frame, two frames, in whole numbers or not.
fn file(order: Order, whole: bool) -> Vec<u8> {
    let word = |value: i32| match order {
        Order::Mips => (value as u16).to_be_bytes(),
        _ => (value as u16).to_le_bytes(),
    };
    let float = |value: f32| match order {
        Order::Intel => value.to_le_bytes(),
        Order::Mips => value.to_be_bytes(),
        Order::Dec => {
            let [a, b, c, d] = (4.0 * value).to_le_bytes();
            [c, d, a, b]
        }
    };
    let scale = if whole { 0.5 } else { -0.5 };
    let mut header = vec![2, MARK];
    [1, 2, 1, 2, 0].into_iter().for_each(|value| header.extend(word(value)));
    header.extend(float(scale));
    [3, 2].into_iter().for_each(|value| header.extend(word(value)));
    header.extend(float(50.0));
    header.resize(BLOCK, 0);
    let code = [(Order::Intel, 84), (Order::Dec, 85), (Order::Mips, 86)].into_iter().find(|(known, _)| *known == order);
    let mut parameters = vec![1, MARK, 1, code.unwrap().1];
    let mut entry = |id: i8, name: &str, body: &[u8]| {
        parameters.extend([name.len() as u8, id as u8]);
        parameters.extend(name.as_bytes());
        parameters.extend(word(body.len() as i32 + 2));
        parameters.extend(body);
    };
    entry(-1, "POINT", &[0]);
    entry(-2, "ANALOG", &[0]);
    entry(1, "LABELS", &[&[0xFF, 2, 4, 1][..], b"HEEL", &[0]].concat());
    entry(2, "LABELS", &[&[0xFF, 2, 3, 1][..], b"EMG", &[0]].concat());
    entry(2, "SCALE", &[&[4, 1, 1][..], &float(0.25), &[0]].concat());
    entry(2, "OFFSET", &[&[2, 1, 1][..], &word(-8), &[0]].concat());
    entry(2, "GEN_SCALE", &[&[4, 0][..], &float(2.0), &[0]].concat());
    parameters.resize(BLOCK, 0);
    let frames = [[10, -20, 30, 0, 4, -12], [1, 2, 3, -1, 0, 32767]];
    let data = frames.iter().flatten().flat_map(|value| match whole {
        true => word(*value).to_vec(),
        false => float(*value as f32).to_vec(),
    });
    [header, parameters, data.collect()].concat()
}

/// A file of analog channels alone, of as many samples each, one per frame, as numbers with a point.
pub(in super::super) fn analog_file(rate: f32, channels: &[(&str, Vec<f64>)]) -> Vec<u8> {
    let count = channels.len() as u16;
    let frames = channels[0].1.len() as u16;
    let mut header = vec![2, MARK];
    [0, count, 1, frames, 0].into_iter().for_each(|value: u16| header.extend(value.to_le_bytes()));
    header.extend((-1.0_f32).to_le_bytes());
    [3, 1].into_iter().for_each(|value: u16| header.extend(value.to_le_bytes()));
    header.extend(rate.to_le_bytes());
    header.resize(BLOCK, 0);
    let mut parameters = vec![1, MARK, 1, 84];
    let mut entry = |id: i8, name: &str, body: &[u8]| {
        parameters.extend([name.len() as u8, id as u8]);
        parameters.extend(name.as_bytes());
        parameters.extend((body.len() as u16 + 2).to_le_bytes());
        parameters.extend(body);
    };
    let labels: Vec<u8> = channels.iter().flat_map(|(name, _)| format!("{name:16}").into_bytes()).collect();
    entry(-2, "ANALOG", &[0]);
    entry(2, "LABELS", &[&[0xFF, 2, 16, count as u8][..], &labels, &[0]].concat());
    parameters.resize(BLOCK, 0);
    let sample = |frame: usize| channels.iter().flat_map(move |(_, values)| (values[frame] as f32).to_le_bytes());
    [header, parameters, (0..frames.into()).flat_map(sample).collect()].concat()
}

#[test]
fn channels_are_read_without_the_markers() {
    let found = analog(EXAMPLE, |place, name| place == 2 || name == "Soleus").unwrap();
    assert_eq!((found.rate, found.all, found.channels.len()), (400.0, 3, 2));
    let whole = read(EXAMPLE).unwrap();
    for (place, name, values) in found.channels {
        assert_eq!(Some(values.as_slice()), whole.column(&name), "{place}");
    }
    assert_eq!(
        analog(&file(Order::Mips, true), |_, _| true).unwrap().channels[0].2,
        read(&file(Order::Mips, true)).unwrap().columns[5]
    );
}

#[test]
fn numbers_of_all_processors_are_read() {
    for order in [Order::Intel, Order::Dec, Order::Mips] {
        for whole in [true, false] {
            let found = read(&file(order, whole)).unwrap();
            assert_eq!(found.names, ["frame", "time", "HEEL.x", "HEEL.y", "HEEL.z", "EMG"], "{order:?} {whole}");
            let scale = if whole { 0.5 } else { 1.0 };
            let at = |column: usize| found.columns[column][0];
            assert_eq!([at(2), at(3), at(4)], [10.0 * scale, -20.0 * scale, 30.0 * scale]);
            assert!(found.columns[2][2].is_nan());
            assert_eq!(found.columns[5], [4.0, -12.0, 0.0, 32767.0].map(|raw| (raw + 8.0) * 0.5));
            assert_eq!(found.columns[1], [0.0, 0.01, 0.02, 0.03]);
        }
    }
}

#[test]
fn damaged_files_are_refused_and_never_more() {
    let message = |bytes: &[u8]| read(bytes).unwrap_err().to_string();
    assert_eq!(message(b""), "has no mark of a C3D file in its second byte");
    assert_eq!(message(&[0, MARK]), "is damaged: the place of its parameters");
    let whole = file(Order::Intel, true);
    assert_eq!(message(&whole[..whole.len() - 1]), "is damaged: its length: it ends too early");
    for bytes in [&whole, &EXAMPLE.to_vec()] {
        for length in 0..bytes.len() {
            let _ = read(&bytes[..length]);
        }
        for place in 0..bytes.len() {
            for value in [0, 1, 0x7F, 0x80, 0xFF] {
                let mut bytes = bytes.clone();
                bytes[place] = value;
                let _ = read(&bytes);
            }
        }
    }
    // More frames than there are, and more than anybody has.
    let mut long = whole.clone();
    long[8..10].copy_from_slice(&u16::MAX.to_le_bytes());
    assert_eq!(message(&long), "is damaged: its length: it ends too early");
}
