//! `.c3d`: places of markers and analog channels, such as electromyograms, of a motion capture.
//!
//! The format is described by "The C3D File Format User Guide" (Motion Lab Systems). A file is made of blocks of 512 bytes: a header,
//! parameters in groups, and for each frame the places of all markers and some samples of all channels, as numbers of the kind that one of three
//! families of processors wrote.

use super::{MOST_NUMBERS, Recording, RecordingError};
use RecordingError::{Damaged, Missing};

const BLOCK: usize = 512;
/// The second byte of every file.
const MARK: u8 = 0x50;

/// Reads a row for each sample of the channels, or for each frame where there are none: `frame`, `time` (s), `NAME.x`, `NAME.y`, `NAME.z`
/// for each marker in the unit of the file, and a column for each channel. Markers have places in the first row of their frame; the other
/// cells, and those of markers that were not seen, are empty.
///
/// The crate `c3dio` was tried: it panics on damaged files, and takes as much memory as a header claims.
pub(super) fn read(bytes: &[u8]) -> Result<Recording, RecordingError> {
    let (numbers, layout) = open(bytes)?;
    layout.rows(&numbers)
}

/// Some analog channels of a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Analog {
    /// Samples per second.
    pub rate: f64,
    /// How many channels the file has.
    pub all: usize,
    /// Number (from 0), name and samples of each channel that was asked for.
    pub channels: Vec<(usize, String, Vec<f64>)>,
}

/// Reads those analog channels whose number (from 0) and name are wanted, and none of the markers.
pub(super) fn analog(bytes: &[u8], wanted: impl Fn(usize, &str) -> bool) -> Result<Analog, RecordingError> {
    let (numbers, layout) = open(bytes)?;
    layout.analog(&numbers, wanted)
}

fn open(bytes: &[u8]) -> Result<(Numbers<'_>, Layout), RecordingError> {
    let [parameters, MARK, ..] = *bytes else { return Err(Missing("mark of a C3D file in its second byte")) };
    let start = usize::from(parameters).checked_sub(1).ok_or(Damaged("the place of its parameters"))? * BLOCK;
    let numbers = Numbers { bytes, order: Order::of(bytes.get(start + 3).copied())? };
    let parameters = Parameters::read(&numbers, start + 4)?;
    let layout = Layout::of(&numbers, &parameters)?;
    Ok((numbers, layout))
}

/// How a family of processors writes numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    Intel,
    Dec,
    Mips,
}

impl Order {
    fn of(code: Option<u8>) -> Result<Self, RecordingError> {
        match code {
            Some(84) => Ok(Self::Intel),
            Some(85) => Ok(Self::Dec),
            Some(86) => Ok(Self::Mips),
            _ => Err(Damaged("the kind of its processor")),
        }
    }

    fn word(self, bytes: [u8; 2]) -> u16 {
        match self {
            Self::Intel | Self::Dec => u16::from_le_bytes(bytes),
            Self::Mips => u16::from_be_bytes(bytes),
        }
    }

    fn float(self, bytes: [u8; 4]) -> f64 {
        let [a, b, c, d] = bytes;
        f64::from(match self {
            Self::Intel => f32::from_le_bytes(bytes),
            // Words in the other order, and an exponent that is larger by two; zero has the exponent 0.
            Self::Dec if b & 0x7F == 0 && a & 0x80 == 0 => 0.0,
            Self::Dec => f32::from_le_bytes([c, d, a, b]) / 4.0,
            Self::Mips => f32::from_be_bytes(bytes),
        })
    }
}

/// The numbers of a file.
struct Numbers<'a> {
    bytes: &'a [u8],
    order: Order,
}

impl<'a> Numbers<'a> {
    fn slice(&self, at: usize, count: usize) -> Result<&'a [u8], RecordingError> {
        let end = at.checked_add(count);
        end.and_then(|end| self.bytes.get(at..end)).ok_or(Damaged("its length: it ends too early"))
    }

    fn array<const N: usize>(&self, at: usize) -> Result<[u8; N], RecordingError> {
        self.slice(at, N)?.try_into().map_err(|_| Damaged("its length"))
    }

    fn byte(&self, at: usize) -> Result<u8, RecordingError> {
        self.array(at).map(|[byte]| byte)
    }

    fn word(&self, at: usize) -> Result<u16, RecordingError> {
        Ok(self.order.word(self.array(at)?))
    }
}

/// A parameter: its elements by their kind.
struct Parameter<'a> {
    group: i8,
    name: String,
    /// -1: letters; 1, 2, 4: bytes of a number.
    kind: i8,
    /// Lengths, the fastest first.
    lengths: Vec<usize>,
    data: &'a [u8],
    order: Order,
}

/// All parameters, with the names of their groups.
struct Parameters<'a> {
    groups: Vec<(i8, String)>,
    all: Vec<Parameter<'a>>,
}

impl<'a> Parameters<'a> {
    fn read(numbers: &Numbers<'a>, start: usize) -> Result<Self, RecordingError> {
        let mut found = Self { groups: Vec::new(), all: Vec::new() };
        let mut at = start;
        loop {
            // A locked entry has a negative length.
            let length = usize::from((numbers.byte(at)? as i8).unsigned_abs());
            let group = numbers.byte(at + 1)? as i8;
            if length == 0 || group == 0 {
                return Ok(found);
            }
            let name = letters(numbers.slice(at + 2, length)?).to_ascii_uppercase();
            let link = at + 2 + length;
            let next = usize::from(numbers.word(link)?);
            if group < 0 {
                found.groups.push((group, name));
            } else {
                let kind = numbers.byte(link + 2)? as i8;
                let count = usize::from(numbers.byte(link + 3)?);
                let lengths: Vec<usize> = numbers.slice(link + 4, count)?.iter().map(|length| usize::from(*length)).collect();
                let size = lengths.iter().try_fold(usize::from(kind.unsigned_abs()), |size, length| size.checked_mul(*length));
                let data = numbers.slice(link + 4 + count, size.ok_or(Damaged("the lengths of a parameter"))?)?;
                found.all.push(Parameter { group, name, kind, lengths, data, order: numbers.order });
            }
            // The last entry has no next one; what points at itself would never end.
            match next {
                0 => return Ok(found),
                1 => return Err(Damaged("the chain of its parameters")),
                next => at = link + next,
            }
        }
    }

    fn get(&self, group: &str, name: &str) -> Option<&Parameter<'a>> {
        let id = self.groups.iter().find(|(_, known)| known == group)?.0.checked_neg()?;
        self.all.iter().find(|parameter| parameter.group == id && parameter.name == name)
    }

    /// The first number of a parameter.
    fn number(&self, group: &str, name: &str) -> Option<f64> {
        self.get(group, name)?.numbers().next()
    }

    /// The first number as a count, which is written as a word without sign.
    fn count(&self, group: &str, name: &str) -> Option<usize> {
        let number = self.number(group, name)?;
        Some(if number < 0.0 { (number + 65536.0) as usize } else { number as usize })
    }

    /// The texts of a parameter and of those that continue it: LABELS, LABELS2, and so on.
    fn texts(&self, group: &str, name: &str) -> Vec<String> {
        let names = std::iter::once(name.to_owned()).chain((2..=255).map(|number| format!("{name}{number}")));
        names.map_while(|name| self.get(group, &name)).flat_map(Parameter::texts).collect()
    }
}

impl Parameter<'_> {
    fn numbers(&self) -> impl Iterator<Item = f64> + '_ {
        let width = usize::from(self.kind.unsigned_abs()).max(1);
        self.data.chunks_exact(width).filter_map(|bytes| match (self.kind, bytes) {
            (1, [byte]) => Some(f64::from(*byte)),
            (2, [a, b]) => Some(f64::from(self.order.word([*a, *b]) as i16)),
            (4, [a, b, c, d]) => Some(self.order.float([*a, *b, *c, *d])),
            _ => None,
        })
    }

    fn texts(&self) -> Vec<String> {
        let width = self.lengths.first().copied().unwrap_or(0);
        if self.kind == -1 && width > 0 { self.data.chunks_exact(width).map(letters).collect() } else { Vec::new() }
    }
}

/// Letters without the blanks that fill them up.
fn letters(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).trim_end_matches(['\0', ' ']).trim().to_owned()
}

/// Where the numbers of all frames stand, and what they mean.
struct Layout {
    /// The first byte of the data.
    start: usize,
    /// Number of the first frame.
    first: usize,
    frames: usize,
    markers: Vec<String>,
    channels: Vec<Channel>,
    /// Samples of each channel in a frame.
    samples: usize,
    /// Frames per second.
    rate: f64,
    /// Unit of places that are whole numbers; `None` where they are not.
    scale: Option<f64>,
    /// Whether whole numbers of channels have no sign.
    unsigned: bool,
}

/// An analog channel: its value is (number - offset) times the scale.
struct Channel {
    name: String,
    offset: f64,
    scale: f64,
}

impl Layout {
    fn of(numbers: &Numbers<'_>, parameters: &Parameters<'_>) -> Result<Self, RecordingError> {
        // Words of the header are counted from 1.
        let word = |number: usize| numbers.word(2 * (number - 1)).map(usize::from);
        let float = |number: usize| numbers.array(2 * (number - 1)).map(|bytes| numbers.order.float(bytes));
        let start = word(9)?.checked_sub(1).ok_or(Damaged("the place of its data"))? * BLOCK;
        let (first, last) = (word(4)?, word(5)?);
        // Two words, the lower first, where there are more frames than one word counts.
        let long = |name: &str| {
            let words: Vec<f64> = parameters.get("TRIAL", name)?.numbers().collect();
            let [low, high] = *words.get(..2)? else { return None };
            Some((low.rem_euclid(65536.0) + 65536.0 * high.rem_euclid(65536.0)) as usize)
        };
        let (first, last) = match (long("ACTUAL_START_FIELD"), long("ACTUAL_END_FIELD")) {
            (Some(first), Some(last)) => (first, last),
            _ => (first, last),
        };
        let frames = (last + 1).checked_sub(first).ok_or(Damaged("the numbers of its frames"))?;
        let scale = parameters.number("POINT", "SCALE").map_or_else(|| float(7), Ok)?;
        let rate = parameters.number("POINT", "RATE").map_or_else(|| float(11), Ok)?;
        if !(rate.is_finite() && rate > 0.0) {
            return Err(Damaged("the rate of its frames"));
        }
        let used = |group: &str, otherwise: usize| parameters.count(group, "USED").unwrap_or(otherwise);
        let samples = word(10)?;
        let names = |group: &str, count: usize, unnamed: &str| -> Vec<String> {
            let known = parameters.texts(group, "LABELS");
            let name = |place: usize| known.get(place).filter(|name| !name.is_empty()).cloned();
            (0..count).map(|place| name(place).unwrap_or_else(|| format!("{unnamed}{}", place + 1))).collect()
        };
        let channels = used("ANALOG", word(3)?.checked_div(samples).unwrap_or(0));
        let unsigned = parameters.texts("ANALOG", "FORMAT").first().is_some_and(|format| format == "UNSIGNED");
        let listed = |name: &str| parameters.get("ANALOG", name).map_or_else(Vec::new, |found| found.numbers().collect());
        let (scales, offsets) = (listed("SCALE"), listed("OFFSET"));
        let general = parameters.number("ANALOG", "GEN_SCALE").unwrap_or(1.0);
        let channel = |(place, name): (usize, String)| {
            let offset = offsets.get(place).copied().unwrap_or(0.0);
            let offset = if unsigned { f64::from(offset as i16 as u16) } else { offset };
            Channel { name, offset, scale: general * scales.get(place).copied().unwrap_or(1.0) }
        };
        Ok(Self {
            start,
            first,
            frames,
            markers: names("POINT", used("POINT", word(2)?), "marker"),
            channels: names("ANALOG", channels, "channel").into_iter().enumerate().map(channel).collect(),
            samples: if channels == 0 { 1 } else { samples.max(1) },
            rate,
            scale: (scale > 0.0).then_some(scale),
            unsigned,
        })
    }

    /// Bytes of a number.
    fn width(&self) -> usize {
        if self.scale.is_some() { 2 } else { 4 }
    }

    /// The bytes of each frame, first those of its markers, then those of its samples.
    fn frames<'a>(&self, numbers: &Numbers<'a>) -> Result<impl Iterator<Item = (&'a [u8], &'a [u8])>, RecordingError> {
        let of_markers = 4 * self.width() * self.markers.len();
        let of_frame = of_markers + self.width() * self.samples * self.channels.len();
        let data = numbers.slice(self.start, self.frames.saturating_mul(of_frame))?;
        Ok(data.chunks_exact(of_frame.max(1)).map(move |frame| frame.split_at(of_markers)))
    }

    fn number(&self, order: Order, bytes: &[u8], unsigned: bool) -> f64 {
        match *bytes {
            [a, b] if unsigned => f64::from(order.word([a, b])),
            [a, b] => f64::from(order.word([a, b]) as i16),
            [a, b, c, d] => order.float([a, b, c, d]),
            _ => f64::NAN,
        }
    }

    /// The value of a sample of a channel.
    fn sample(&self, order: Order, bytes: &[u8], channel: usize) -> f64 {
        let Channel { offset, scale, .. } = self.channels[channel];
        (self.number(order, bytes, self.unsigned) - offset) * scale
    }

    fn analog(&self, numbers: &Numbers<'_>, wanted: impl Fn(usize, &str) -> bool) -> Result<Analog, RecordingError> {
        let channels = self.channels.iter().enumerate().filter(|(place, channel)| wanted(*place, &channel.name));
        let mut channels: Vec<_> = channels.map(|(place, channel)| (place, channel.name.clone(), Vec::new())).collect();
        if self.frames.saturating_mul(self.samples).saturating_mul(channels.len()) > MOST_NUMBERS {
            return Err(RecordingError::Large);
        }
        for (_, samples) in self.frames(numbers)? {
            for sample in samples.chunks_exact((self.width() * self.channels.len()).max(1)) {
                for (place, _, values) in &mut channels {
                    let start = *place * self.width();
                    values.push(self.sample(numbers.order, &sample[start..start + self.width()], *place));
                }
            }
        }
        Ok(Analog { rate: self.rate * self.samples as f64, all: self.channels.len(), channels })
    }

    fn rows(&self, numbers: &Numbers<'_>) -> Result<Recording, RecordingError> {
        let places = self.markers.iter().flat_map(|marker| ["x", "y", "z"].map(|axis| format!("{marker}.{axis}")));
        let names = ["frame", "time"].map(String::from).into_iter().chain(places);
        let names: Vec<String> = names.chain(self.channels.iter().map(|channel| channel.name.clone())).collect();
        if self.frames.saturating_mul(self.samples).saturating_mul(names.len()) > MOST_NUMBERS {
            return Err(RecordingError::Large);
        }
        let frames = self.frames(numbers)?;
        let rows = self.frames * self.samples;
        let mut columns = vec![vec![f64::NAN; rows]; names.len()];
        let frame = |row: usize| (self.first + row / self.samples) as f64;
        let time = |row: usize| (frame(row) - 1.0 + (row % self.samples) as f64 / self.samples as f64) / self.rate;
        columns[0] = (0..rows).map(frame).collect();
        columns[1] = (0..rows).map(time).collect();
        let width = self.width();
        for (frame, (places, samples)) in frames.enumerate() {
            for (marker, place) in places.chunks_exact(4 * width).enumerate() {
                let part = |part: usize| self.number(numbers.order, &place[part * width..(part + 1) * width], false);
                let [x, y, z, residual] = [0, 1, 2, 3].map(part);
                if residual >= 0.0 {
                    for (axis, value) in [x, y, z].into_iter().enumerate() {
                        columns[2 + 3 * marker + axis][frame * self.samples] = value * self.scale.unwrap_or(1.0);
                    }
                }
            }
            let first = 2 + 3 * self.markers.len();
            for (place, bytes) in samples.chunks_exact(width).enumerate() {
                let (sample, channel) = (place / self.channels.len(), place % self.channels.len());
                columns[first + channel][frame * self.samples + sample] = self.sample(numbers.order, bytes, channel);
            }
        }
        Ok(Recording { degrees: false, names, columns })
    }
}

#[cfg(test)]
pub(super) mod tests;
