//! NumPy archives (`.npz`): named arrays in a ZIP file, as `numpy.load` reads them.
//!
//! The same arrays have the same bytes whenever they are written: entries bear no time. Entries are deflated.

use npyz::{AutoSerialize, WriterBuilder};
use std::io::{self, Cursor, Read, Seek, Write};
pub use zip::result::ZipError;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter, write::SimpleFileOptions};

/// Size from which on an entry needs the 64-bit extension of ZIP, bytes; deflated noise is larger than it was, by less than 16 MiB.
const LARGE: u64 = u32::MAX as u64 - (16 << 20);

/// An archive that is being written.
pub struct NpzWriter<W: Write + Seek> {
    archive: ZipWriter<W>,
}

impl<W: Write + Seek> NpzWriter<W> {
    /// An archive without entries.
    pub fn new(out: W) -> Self {
        Self { archive: ZipWriter::new(out) }
    }

    /// Adds an array of that shape, the last index fastest.
    ///
    /// # Errors
    /// A name that the archive has already, another number of values than the shape has, or a refusal of the operating system.
    pub fn array<T: AutoSerialize + Copy>(&mut self, name: &str, values: &[T], shape: &[usize]) -> io::Result<()> {
        let shape: Vec<u64> = shape.iter().map(|length| *length as u64).collect();
        self.begin(&format!("{name}.npy"), size_of_val(values) as u64)?;
        let options = npyz::WriteOptions::new().default_dtype().shape(&shape);
        let mut writer = options.writer(&mut self.archive).begin_nd()?;
        writer.extend(values.iter().copied())?;
        writer.finish()
    }

    /// Adds a file that is no array, such as a description of the columns.
    ///
    /// # Errors
    /// A name that the archive has already, or a refusal of the operating system.
    pub fn file(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        self.begin(name, bytes.len() as u64)?;
        self.archive.write_all(bytes)
    }

    /// Completes the archive.
    ///
    /// # Errors
    /// A refusal of the operating system.
    pub fn finish(self) -> io::Result<W> {
        let mut out = self.archive.finish()?;
        out.flush()?;
        Ok(out)
    }

    fn begin(&mut self, name: &str, size: u64) -> io::Result<()> {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(DateTime::default())
            .large_file(size >= LARGE);
        Ok(self.archive.start_file(name, options)?)
    }
}

/// The entries of an archive in memory.
pub struct NpzReader<'a> {
    archive: ZipArchive<Cursor<&'a [u8]>>,
}

impl<'a> NpzReader<'a> {
    /// Reads the list of entries.
    ///
    /// # Errors
    /// Bytes that are no ZIP file.
    pub fn new(bytes: &'a [u8]) -> Result<Self, ZipError> {
        Ok(Self { archive: ZipArchive::new(Cursor::new(bytes))? })
    }

    /// The bytes of an entry, at most the first `limit`: `NAME.npy` is the array `NAME`.
    ///
    /// # Errors
    /// No such entry, or a damaged one.
    pub fn entry(&mut self, name: &str, limit: u64) -> Result<Vec<u8>, ZipError> {
        let mut bytes = Vec::new();
        self.archive.by_name(name)?.take(limit).read_to_end(&mut bytes)?;
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use npyz::NpyFile;

    fn archive() -> Vec<u8> {
        let mut archive = NpzWriter::new(Cursor::new(Vec::new()));
        archive.array("a", &[1.5, 2.5, 3.5, 4.5, 5.5, 6.5], &[2, 3]).unwrap();
        archive.array("flags", &[true, false], &[2]).unwrap();
        archive.array("none", &[0.0_f32; 0], &[0, 4]).unwrap();
        archive.file("words.json", b"{}").unwrap();
        archive.finish().unwrap().into_inner()
    }

    #[test]
    fn arrays_read_back_and_have_the_same_bytes_every_time() {
        let bytes = archive();
        assert_eq!(archive(), bytes);
        let mut archive = NpzReader::new(&bytes).unwrap();
        let a = archive.entry("a.npy", 1 << 20).unwrap();
        let a = NpyFile::new(&a[..]).unwrap();
        assert_eq!(a.shape(), [2, 3]);
        assert_eq!(a.into_vec::<f64>().unwrap(), [1.5, 2.5, 3.5, 4.5, 5.5, 6.5]);
        let flags = archive.entry("flags.npy", 1 << 20).unwrap();
        assert_eq!(NpyFile::new(&flags[..]).unwrap().into_vec::<bool>().unwrap(), [true, false]);
        let none = archive.entry("none.npy", 1 << 20).unwrap();
        assert_eq!(NpyFile::new(&none[..]).unwrap().shape(), [0, 4]);
        assert_eq!(archive.entry("words.json", 1 << 20).unwrap(), b"{}");
        assert_eq!(archive.entry("words.json", 1).unwrap(), b"{", "no more than the limit is read");
        assert!(archive.entry("b.npy", 1 << 20).is_err());
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let mut archive = NpzWriter::new(Cursor::new(Vec::new()));
        assert!(archive.array("short", &[1.0], &[2]).is_err());
        let mut archive = NpzWriter::new(Cursor::new(Vec::new()));
        archive.array("a", &[1.0], &[1]).unwrap();
        assert!(archive.array("a", &[1.0], &[1]).is_err(), "two arrays of one name");
        assert!(NpzReader::new(b"PK no archive").is_err());
    }
}
