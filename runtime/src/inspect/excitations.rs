//! Excitations over time from a NumPy array: `.npy` as `numpy.save` writes it, doubles in two dimensions.
//!
//! The format is small, and a library for all of it evaluates the header as Python: one of 60 kB comes back in its error message, and
//! a shape whose size overflows is a panic. Here the header is looked at as text.

/// Excitations of every step.
#[derive(Debug, Clone, PartialEq)]
pub struct Excitations {
    values: Vec<f64>,
    rows: usize,
    width: usize,
}

/// Why bytes are no excitations.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum ExcitationsError {
    /// Not the beginning of a `.npy` file.
    #[error("is not a NumPy array: {0}")]
    Format(&'static str),
    /// Numbers of another type.
    #[error("must hold doubles in rows (`<f8`, not in Fortran's order), found {0}")]
    Type(String),
    /// Another number of dimensions or columns.
    #[error("must hold rows of {width} numbers, found the shape ({found})")]
    Shape {
        /// Numbers of a row that are needed.
        width: usize,
        /// The shape in the header.
        found: String,
    },
    /// Fewer bytes than the shape promises.
    #[error("declares {rows} rows, but ends before the last of them")]
    Short {
        /// Rows in the header.
        rows: u64,
    },
    /// A number that is none.
    #[error("row {row}, column {column} (from 0) is {value}, which is not a finite number")]
    NotFinite {
        /// Its row.
        row: usize,
        /// Its column.
        column: usize,
        /// NaN or an infinity.
        value: f64,
    },
}

impl Excitations {
    /// From the bytes of a `.npy` file with `width` numbers in each row.
    ///
    /// # Errors
    /// Bytes that are no such array, that end too soon, or hold numbers that are not finite.
    pub fn from_npy(bytes: &[u8], width: usize) -> Result<Self, ExcitationsError> {
        Self::read(bytes, width, f64::is_finite)
    }

    /// The same where numbers may be missing, which are NaN.
    ///
    /// # Errors
    /// As there.
    pub fn with_gaps_from_npy(bytes: &[u8], width: usize) -> Result<Self, ExcitationsError> {
        Self::read(bytes, width, |value| !value.is_infinite())
    }

    fn read(bytes: &[u8], width: usize, may_be: fn(f64) -> bool) -> Result<Self, ExcitationsError> {
        let (header, data) = parts(bytes)?;
        let header = std::str::from_utf8(header).map_err(|_| ExcitationsError::Format("its header is not text"))?;
        let big_endian = match (value_of(header, "descr"), value_of(header, "fortran_order")) {
            (Some(kind), Some(order)) if order.starts_with("False") && is(kind, "<f8") => false,
            (Some(kind), Some(order)) if order.starts_with("False") && is(kind, ">f8") => true,
            (Some(_), Some(_)) => return Err(ExcitationsError::Type(shortened(header))),
            _ => return Err(ExcitationsError::Format("its header has no type or no order")),
        };
        let shape = value_of(header, "shape").and_then(|value| value.strip_prefix('(')?.split_once(')'));
        let (shape, _) = shape.ok_or(ExcitationsError::Format("its header has no shape"))?;
        let rows = rows(shape, width).ok_or_else(|| ExcitationsError::Shape { width, found: shortened(shape) })?;
        let short = ExcitationsError::Short { rows };
        let size = |rows: usize| rows.checked_mul(width)?.checked_mul(8);
        let there = usize::try_from(rows).ok().and_then(|rows| Some((rows, data.get(..size(rows)?)?)));
        let (rows, data) = there.ok_or(short)?;
        let (numbers, _) = data.as_chunks::<8>();
        let number = |bytes: &[u8; 8]| if big_endian { f64::from_be_bytes(*bytes) } else { f64::from_le_bytes(*bytes) };
        let values: Vec<f64> = numbers.iter().map(number).collect();
        match values.iter().position(|value| !may_be(*value)) {
            Some(at) => Err(ExcitationsError::NotFinite { row: at / width, column: at % width, value: values[at] }),
            None => Ok(Self { values, rows, width }),
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The excitations of step `row < rows`, one per muscle.
    pub fn row(&self, row: usize) -> &[f64] {
        &self.values[row * self.width..(row + 1) * self.width]
    }
}

/// Header and data.
fn parts(bytes: &[u8]) -> Result<(&[u8], &[u8]), ExcitationsError> {
    const CUT: ExcitationsError = ExcitationsError::Format("it ends within its header");
    let rest = bytes.strip_prefix(b"\x93NUMPY").ok_or(ExcitationsError::Format("it has no NumPy signature"))?;
    let (version, rest) = rest.split_first_chunk::<2>().ok_or(CUT)?;
    let (length, rest) = match version[0] {
        1 => rest.split_first_chunk::<2>().map(|(length, rest)| (usize::from(u16::from_le_bytes(*length)), rest)).ok_or(CUT)?,
        2 | 3 => {
            let (length, rest) = rest.split_first_chunk::<4>().ok_or(CUT)?;
            (usize::try_from(u32::from_le_bytes(*length)).map_err(|_| CUT)?, rest)
        }
        _ => return Err(ExcitationsError::Format("its version is not 1, 2 or 3")),
    };
    rest.split_at_checked(length).ok_or(CUT)
}

/// What stands behind a key of the header, up to its end.
fn value_of<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let (_, behind) = header.split_once(&format!("'{key}'")).or_else(|| header.split_once(&format!("\"{key}\"")))?;
    Some(behind.trim_start().strip_prefix(':')?.trim_start())
}

/// Whether a value is this text in quotes.
fn is(value: &str, text: &str) -> bool {
    ["'", "\""].iter().any(|quote| {
        value.strip_prefix(quote).and_then(|rest| rest.strip_prefix(text)).is_some_and(|rest| rest.starts_with(quote))
    })
}

/// The number of rows of a shape of two dimensions, the second of which is `width`.
fn rows(shape: &str, width: usize) -> Option<u64> {
    let mut sizes = shape.trim().trim_end_matches(',').split(',').map(|size| size.trim().parse::<u64>().ok());
    let (rows, columns) = (sizes.next()??, sizes.next()??);
    (columns == width as u64 && sizes.next().is_none()).then_some(rows)
}

/// What an error repeats of a file.
fn shortened(text: &str) -> String {
    text.trim().chars().filter(|sign| !sign.is_control()).take(100).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file with this header and these numbers, in the byte order of `<f8`.
    fn file(version: u8, header: &str, numbers: &[f64]) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY".to_vec();
        bytes.extend([version, 0]);
        match version {
            1 => bytes.extend(u16::try_from(header.len()).unwrap().to_le_bytes()),
            _ => bytes.extend(u32::try_from(header.len()).unwrap().to_le_bytes()),
        }
        bytes.extend(header.as_bytes());
        bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        bytes
    }

    fn header(shape: &str) -> String {
        format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({shape}), }}   \n")
    }

    #[test]
    fn rows_are_read_as_numpy_writes_them() {
        let numbers = [0.0, 0.25, 0.5, 0.75, 1.0, -0.5];
        for version in [1, 2, 3] {
            let read = Excitations::from_npy(&file(version, &header("3, 2"), &numbers), 2).unwrap();
            assert_eq!(read.rows(), 3);
            assert_eq!([read.row(0), read.row(1), read.row(2)].concat(), numbers);
        }
        let mut turned = file(1, &header("1, 1").replace('<', ">"), &[]);
        turned.extend(2.5_f64.to_be_bytes());
        assert_eq!(Excitations::from_npy(&turned, 1).unwrap().row(0), [2.5]);
        assert_eq!(Excitations::from_npy(&file(1, &header("0, 4"), &[]), 4).unwrap().rows(), 0);
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let error_of = |bytes: &[u8]| Excitations::from_npy(bytes, 2).unwrap_err().to_string();
        let with = |header: &str, numbers: &[f64]| error_of(&file(1, header, numbers));
        assert_eq!(error_of(b"PK\x03\x04"), "is not a NumPy array: it has no NumPy signature");
        assert_eq!(error_of(&file(1, &header("1, 2"), &[])[..20]), "is not a NumPy array: it ends within its header");
        assert_eq!(error_of(&file(7, "", &[])), "is not a NumPy array: its version is not 1, 2 or 3");
        assert_eq!(with("{}", &[]), "is not a NumPy array: its header has no type or no order");
        for shape in ["2", "2,", "2, 3", "2, 2, 2", "-1, 2", "x, 2", ""] {
            assert!(with(&header(shape), &[0.0; 8]).contains("must hold rows of 2 numbers"), "{shape}");
        }
        assert!(with(&header("1, 2").replace("<f8", "<f4"), &[0.0; 2]).contains("must hold doubles"));
        assert!(with(&header("1, 2").replace("False", "True"), &[0.0; 2]).contains("must hold doubles"));
        assert_eq!(with(&header("2, 2"), &[0.0; 3]), "declares 2 rows, but ends before the last of them");
        assert_eq!(with(&header("1, 2"), &[0.0, f64::NAN]), "row 0, column 1 (from 0) is NaN, which is not a finite number");
    }

    #[test]
    fn a_header_that_would_exhaust_a_reader_is_refused() {
        let error_of = |bytes: &[u8]| Excitations::from_npy(bytes, 2).unwrap_err();
        // Rows beyond what any file holds: the product overflows 64 bits.
        assert!(matches!(error_of(&file(1, &header("18446744073709551615, 2"), &[])), ExcitationsError::Short { .. }));
        assert!(matches!(error_of(&file(1, &header("99999999999999999999, 2"), &[])), ExcitationsError::Shape { .. }));
        // A value nested without end, a length of the header beyond the file.
        let nested = format!("{{'descr': {}", "(".repeat(60_000));
        assert!(matches!(error_of(&file(1, &nested, &[])), ExcitationsError::Format(_)));
        assert!(matches!(error_of(b"\x93NUMPY\x02\0\xff\xff\xff\xff{"), ExcitationsError::Format(_)));
    }
}
