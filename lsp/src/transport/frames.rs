//! Framing: bodies of messages cut out of a stream of bytes. A frame is `Content-Length: N`, an empty line and N bytes.
//!
//! The stream comes from another program and may hold anything: memory stays bounded, every frame that cannot be read is an
//! error, and reading goes on at the next header. A header line cannot stand within a JSON body, because line ends in strings are
//! escaped, so that a search for the next `Content-Length` finds the next frame.

use std::io::{self, BufRead, ErrorKind, Read};

/// Longest body that is read, bytes.
pub(super) const LONGEST_BODY: usize = 16 << 20;

/// Longest header line, bytes.
const LONGEST_HEADER: usize = 1024;

/// The only header that matters.
const CONTENT_LENGTH: &str = "content-length";

/// Why a frame cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(super) enum FrameError {
    /// A line that is no header.
    #[error("expected a header `Content-Length: N`, found `{0}`; everything before the next header is skipped")]
    Header(String),
    /// Headers without a length.
    #[error("the headers have no `Content-Length`; everything before the next header is skipped")]
    NoLength,
    /// A length that is no number or is too large.
    #[error(
        "expected a Content-Length of at most {LONGEST_BODY} bytes, found `{0}`; everything before the next header is skipped"
    )]
    Length(String),
    /// The stream ends within a frame.
    #[error("the input ends within a message: {found} of {expected} bytes")]
    Truncated {
        /// Bytes of the body that the header announces.
        expected: usize,
        /// Bytes that came.
        found: usize,
    },
}

/// Where in the stream the reader stands.
enum Position {
    /// Before a header line.
    Header,
    /// After the name of a `Content-Length` header, whose value this is.
    Length(String),
    /// Somewhere: the next header is searched.
    Lost(Search),
}

/// The frames of a stream.
pub(super) struct Frames<R> {
    input: R,
    position: Position,
}

impl<R: BufRead> Frames<R> {
    pub(super) fn new(input: R) -> Self {
        Self { input, position: Position::Header }
    }

    /// The next body, or why a frame cannot be read; `None` at the end of the stream.
    ///
    /// # Errors
    /// The stream itself fails.
    pub(super) fn next(&mut self) -> io::Result<Option<Result<Vec<u8>, FrameError>>> {
        let mut length = None;
        loop {
            let value = match std::mem::replace(&mut self.position, Position::Header) {
                Position::Length(value) => Some(value),
                Position::Lost(search) => match self.search(search)? {
                    Some(value) => Some(value),
                    None => return Ok(None),
                },
                Position::Header => match self.header()? {
                    Line::End => return Ok(length.map(|expected| Err(FrameError::Truncated { expected, found: 0 }))),
                    Line::Empty => break,
                    Line::Garbage(line) => return Ok(Some(Err(self.lose(&line)))),
                    Line::Length(value) => Some(value),
                    Line::Other => None,
                },
            };
            let Some(value) = value else { continue };
            match value.parse::<usize>() {
                Ok(bytes) if bytes <= LONGEST_BODY => length = Some(bytes),
                _ => {
                    self.position = Position::Lost(Search::default());
                    return Ok(Some(Err(FrameError::Length(value))));
                }
            }
        }
        let Some(expected) = length else {
            self.position = Position::Lost(Search::default());
            return Ok(Some(Err(FrameError::NoLength)));
        };
        let mut body = Vec::new();
        let found = self.input.by_ref().take(expected as u64).read_to_end(&mut body)?;
        Ok(Some(if found < expected { Err(FrameError::Truncated { expected, found }) } else { Ok(body) }))
    }

    fn header(&mut self) -> io::Result<Line> {
        let mut line = Vec::new();
        self.input.by_ref().take(LONGEST_HEADER as u64).read_until(b'\n', &mut line)?;
        let Some(content) = line.strip_suffix(b"\n") else {
            return Ok(if line.is_empty() { Line::End } else { Line::Garbage(line) });
        };
        let content = content.strip_suffix(b"\r").unwrap_or(content);
        if content.is_empty() {
            return Ok(Line::Empty);
        }
        let header = std::str::from_utf8(content).ok().and_then(|content| content.split_once(':'));
        let is_name = |name: &str| !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'-');
        Ok(match header.filter(|(name, _)| is_name(name)) {
            Some((name, value)) if name.eq_ignore_ascii_case(CONTENT_LENGTH) => Line::Length(shown(value.trim().as_bytes())),
            Some(_) => Line::Other,
            None => Line::Garbage(line),
        })
    }

    /// Gives up a frame at a line that is no header; a header may follow within the line.
    fn lose(&mut self, line: &[u8]) -> FrameError {
        let mut search = Search::default();
        self.position = match line.iter().find_map(|byte| search.pass(*byte)) {
            Some(value) => Position::Length(value),
            None => Position::Lost(search),
        };
        FrameError::Header(shown(line))
    }

    /// Skips everything before the value of the next `Content-Length`.
    fn search(&mut self, mut search: Search) -> io::Result<Option<String>> {
        loop {
            let bytes = match self.input.fill_buf() {
                Ok([]) => return Ok(None),
                Ok(bytes) => bytes,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => return Err(error),
            };
            let found = bytes.iter().enumerate().find_map(|(index, byte)| Some((index + 1, search.pass(*byte)?)));
            let (passed, value) = found.map_or((bytes.len(), None), |(passed, value)| (passed, Some(value)));
            self.input.consume(passed);
            if value.is_some() {
                return Ok(value);
            }
        }
    }
}

/// A line before a body.
enum Line {
    /// The end of the stream.
    End,
    /// What separates headers from their body.
    Empty,
    /// `Content-Length`, with its value.
    Length(String),
    /// Another header.
    Other,
    /// No header, as read.
    Garbage(Vec<u8>),
}

/// A search for a line `Content-Length: VALUE` in bytes that come one after the other. Memory is bounded.
#[derive(Default)]
struct Search {
    /// Bytes of the name and its colon that were passed.
    matched: usize,
    value: Vec<u8>,
}

impl Search {
    /// Passes a byte; gives the value once its line ends.
    fn pass(&mut self, byte: u8) -> Option<String> {
        let name = CONTENT_LENGTH.as_bytes();
        if self.matched <= name.len() {
            let expected = name.get(self.matched).copied().unwrap_or(b':');
            // No beginning of the name occurs again within it, so a search that fails begins anew.
            self.matched = if byte.eq_ignore_ascii_case(&expected) {
                self.matched + 1
            } else {
                usize::from(byte.eq_ignore_ascii_case(&name[0]))
            };
            return None;
        }
        match byte {
            b'\n' => return Some(shown(std::mem::take(self).value.trim_ascii())),
            b'"' => *self = Self::default(),
            _ if self.value.len() >= LONGEST_HEADER => *self = Self::default(),
            _ => self.value.push(byte),
        }
        None
    }
}

/// The beginning of some bytes as text, for messages.
fn shown(bytes: &[u8]) -> String {
    const LONGEST: usize = 60;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(LONGEST)]);
    let text: String =
        text.trim_end().chars().map(|character| if character.is_control() { '\u{fffd}' } else { character }).collect();
    if bytes.len() > LONGEST { text + "..." } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::io::BufReader;

    fn frame(body: &str) -> String {
        format!("Content-Length: {}\r\n\r\n{body}", body.len())
    }

    type Found = Result<String, FrameError>;

    fn body(text: &str) -> Found {
        Ok(text.to_owned())
    }

    fn error(error: FrameError) -> Found {
        Err(error)
    }

    /// All frames of a stream that arrives in pieces of some bytes.
    fn frames(stream: &[u8], piece: usize) -> Vec<Found> {
        let mut frames = Frames::new(BufReader::with_capacity(piece, stream));
        let next = || frames.next().unwrap().map(|frame| frame.map(|body| String::from_utf8(body).unwrap()));
        std::iter::from_fn(next).collect()
    }

    #[test]
    fn frames_follow_each_other() {
        let stream = frame("{}") + "content-length:3\nContent-Type: x\n\n[1]" + &frame("");
        for piece in [1, 7, 4096] {
            assert_eq!(frames(stream.as_bytes(), piece), [body("{}"), body("[1]"), body("")]);
        }
    }

    #[test]
    fn bad_frames_are_errors_and_the_next_frame_is_read() {
        let length = |text: &str| FrameError::Length(text.to_owned());
        let header = |text: &str| FrameError::Header(text.to_owned());
        let bad = [
            ("Content-Length: 40000000000\r\n\r\n{}", length("40000000000")),
            ("Content-Length: 99999999999999999999999999\r\n\r\n{}", length("99999999999999999999999999")),
            ("Content-Length: -5\r\n\r\n{}", length("-5")),
            ("Content-Length: five\r\n\r\n{}", length("five")),
            ("Content-Length: \r\n\r\n{}", length("")),
            ("Content-Length: 16777217\r\n\r\n{}", length("16777217")),
            ("Content-Type: x\r\n\r\n{}", FrameError::NoLength),
            ("\r\n{}", FrameError::NoLength),
            ("{\"id\":1}", header("{\"id\":1}Content-Length: 2")),
            ("{\"id\":1}\n", header("{\"id\":1}")),
            ("{\"id\":1}\r\n\"Content-Length: 7\\r\\n\"", header("{\"id\":1}")),
            ("C Content-Length\r\n", header("C Content-Length")),
        ];
        for (text, wrong) in bad {
            for piece in [1, 7, 4096] {
                let stream = frame("[0]") + text + &frame("{}");
                assert_eq!(frames(stream.as_bytes(), piece), [body("[0]"), error(wrong.clone()), body("{}")], "{text}");
            }
        }
    }

    #[test]
    fn every_bad_length_is_an_error_of_its_own() {
        let stream = "Content-Length: -1\r\n\r\nab".to_owned() + "Content-Length: -2\r\n\r\nab" + &frame("x");
        let results = frames(stream.as_bytes(), 5);
        assert_eq!(results, [error(FrameError::Length("-1".into())), error(FrameError::Length("-2".into())), body("x")]);
    }

    #[test]
    fn a_stream_that_ends_within_a_frame_is_an_error() {
        assert_eq!(frames(b"Content-Length: 10\r\n\r\nabc", 4), [error(FrameError::Truncated { expected: 10, found: 3 })]);
        assert_eq!(frames(b"Content-Len", 4), [error(FrameError::Header("Content-Len".into()))]);
        assert_eq!(frames(b"Content-Length: 10\r\n", 4), [error(FrameError::Truncated { expected: 10, found: 0 })]);
    }

    #[test]
    fn a_header_without_an_end_takes_no_memory() {
        let mut frames =
            Frames::new(BufReader::new(io::repeat(b'x').take(1 << 22).chain(b"Content-Length: 1\r\n\r\n7".as_slice())));
        assert!(matches!(frames.next(), Ok(Some(Err(FrameError::Header(found)))) if found.len() < 100));
        assert_eq!(frames.next().unwrap(), Some(Ok(b"7".to_vec())));
        let mut endless = Frames::new(BufReader::new(b"Content-Length: ".as_slice().chain(io::repeat(b'1').take(1 << 22))));
        assert!(matches!(endless.next(), Ok(Some(Err(FrameError::Header(_))))));
        assert_eq!(endless.next().unwrap(), None);
    }

    proptest! {
        /// Whatever stands between frames, every frame behind it that follows a header of its own is found.
        #[test]
        fn garbage_never_hides_the_frames_behind_it(garbage in "[^C]{0,200}", piece in 1_usize..40) {
            let stream = garbage + "\n" + &frame("[1]") + &frame("[2]");
            let found = frames(stream.as_bytes(), piece);
            prop_assert_eq!(found[found.len() - 2..].to_vec(), vec![body("[1]"), body("[2]")]);
        }

        #[test]
        fn no_bytes_hang_or_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400), piece in 1_usize..40) {
            let mut frames = Frames::new(BufReader::with_capacity(piece, bytes.as_slice()));
            let mut count = 0;
            while frames.next().unwrap().is_some() {
                count += 1;
                prop_assert!(count <= bytes.len());
            }
        }
    }
}
