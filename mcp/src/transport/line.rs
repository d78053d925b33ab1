//! Lines of bounded length.

use super::request_id::RequestIdScanner;
use serde_json::Value;
use std::io;
use tokio::io::{AsyncBufRead, AsyncBufReadExt};

/// A line of the input, without its end.
#[derive(Debug, PartialEq)]
pub enum Line {
    /// The whole line.
    Whole(Vec<u8>),
    /// The line was longer than the limit and has been dropped; the id of the request in it, if one can be found.
    TooLong(Option<Value>),
}

/// Reads lines of at most `limit` bytes; of a longer one only the id of its request is kept.
pub struct LineReader<R> {
    input: R,
    limit: usize,
}

impl<R: AsyncBufRead + Unpin> LineReader<R> {
    /// Reads `input`.
    pub fn new(input: R, limit: usize) -> Self {
        Self { input, limit }
    }

    /// The next line; `None` when the input has ended. The last line needs no line end.
    ///
    /// # Errors
    /// The input cannot be read.
    pub async fn next(&mut self) -> io::Result<Option<Line>> {
        let mut line = Vec::new();
        let mut dropped: Option<RequestIdScanner> = None;
        loop {
            let available = self.input.fill_buf().await?;
            if available.is_empty() {
                return Ok(finish(line, dropped).filter(|line| *line != Line::Whole(Vec::new())));
            }
            let end = available.iter().position(|byte| *byte == b'\n');
            let part = &available[..end.unwrap_or(available.len())];
            match &mut dropped {
                Some(scanner) => scanner.read(part),
                None if line.len() + part.len() > self.limit => {
                    let mut scanner = RequestIdScanner::default();
                    scanner.read(&line);
                    scanner.read(part);
                    line = Vec::new();
                    dropped = Some(scanner);
                }
                None => line.extend_from_slice(part),
            }
            let consumed = end.map_or(available.len(), |end| end + 1);
            self.input.consume(consumed);
            if end.is_some() {
                return Ok(finish(line, dropped));
            }
        }
    }
}

fn finish(mut line: Vec<u8>, dropped: Option<RequestIdScanner>) -> Option<Line> {
    if let Some(scanner) = dropped {
        return Some(Line::TooLong(scanner.id()));
    }
    if line.last() == Some(&b'\r') {
        line.pop();
    }
    Some(Line::Whole(line))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use serde_json::json;

    #[tokio::test]
    async fn lines_are_bounded_and_what_follows_a_long_one_is_read() {
        let text = "one\r\n\nexactly8\n{\"id\": 7}x\n{\"id\": 7, \"a\": 1}\ntwo";
        // A small buffer, so that lines arrive in pieces.
        let input = tokio::io::BufReader::with_capacity(3, text.as_bytes());
        let mut reader = LineReader::new(input, 8);
        let mut lines = Vec::new();
        while let Some(line) = reader.next().await.unwrap() {
            lines.push(line);
        }
        let whole = |text: &str| Line::Whole(text.as_bytes().to_vec());
        let expected =
            [whole("one"), whole(""), whole("exactly8"), Line::TooLong(None), Line::TooLong(Some(json!(7))), whole("two")];
        assert_eq!(lines, expected);
    }
}
