//! Messages in the wire format of Protocol Buffers, as far as files of other programs need it: they are written and never read here.

/// A message that is being written, field by field.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Message {
    bytes: Vec<u8>,
}

impl Message {
    /// The bytes.
    pub fn bytes(self) -> Vec<u8> {
        self.bytes
    }

    /// A whole number, an enumeration or a truth value.
    #[must_use]
    pub fn integer(mut self, field: u32, value: u64) -> Self {
        self.tag(field, 0);
        self.varint(value);
        self
    }

    /// A number of double precision.
    #[must_use]
    pub fn double(mut self, field: u32, value: f64) -> Self {
        self.tag(field, 1);
        self.bytes.extend(value.to_le_bytes());
        self
    }

    /// A number of single precision.
    #[must_use]
    pub fn float(mut self, field: u32, value: f32) -> Self {
        self.tag(field, 5);
        self.bytes.extend(value.to_le_bytes());
        self
    }

    /// A string or bytes.
    #[must_use]
    pub fn data(mut self, field: u32, value: impl AsRef<[u8]>) -> Self {
        self.tag(field, 2);
        self.varint(value.as_ref().len() as u64);
        self.bytes.extend_from_slice(value.as_ref());
        self
    }

    /// A message within this one.
    #[must_use]
    pub fn message(self, field: u32, value: Self) -> Self {
        self.data(field, value.bytes)
    }

    fn tag(&mut self, field: u32, kind: u32) {
        self.varint(u64::from(field << 3 | kind));
    }

    /// Seven bits per byte, the lowest first; the eighth says that another one follows.
    fn varint(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.bytes.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.bytes.push(value as u8);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_have_the_bytes_of_the_documented_examples() {
        // https://protobuf.dev/programming-guides/encoding: a = 150, b = "testing", and a message of the first in field 3.
        let first = Message::default().integer(1, 150);
        assert_eq!(first.clone().bytes(), [0x08, 0x96, 0x01]);
        assert_eq!(Message::default().data(2, "testing").bytes(), *b"\x12\x07testing");
        assert_eq!(Message::default().message(3, first).bytes(), [0x1a, 0x03, 0x08, 0x96, 0x01]);
        assert_eq!(Message::default().float(2, 1.0).bytes(), [0x15, 0, 0, 0x80, 0x3f]);
        assert_eq!(Message::default().double(1, 1.0).bytes(), [0x09, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f]);
    }
}
