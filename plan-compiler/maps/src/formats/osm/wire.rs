//! Reads protocol buffers field by field, without copying or allocating.
//!
//! Source: Google's "Encoding" page on protocol buffers. Every loop ends with its bytes.

/// The bytes are not a protocol buffer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Damaged;

/// The value of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Value<'a> {
    Number(u64),
    Bytes(&'a [u8]),
}

impl<'a> Value<'a> {
    pub(super) fn number(self) -> Result<u64, Damaged> {
        match self {
            Self::Number(number) => Ok(number),
            Self::Bytes(_) => Err(Damaged),
        }
    }

    pub(super) fn bytes(self) -> Result<&'a [u8], Damaged> {
        match self {
            Self::Bytes(bytes) => Ok(bytes),
            Self::Number(_) => Err(Damaged),
        }
    }

    /// The value as packed numbers.
    pub(super) fn packed(self) -> Result<Packed<'a>, Damaged> {
        Ok(Packed { bytes: self.bytes()? })
    }
}

/// Iterates over the fields of a message: number and value.
pub(super) struct Fields<'a> {
    bytes: &'a [u8],
}

pub(super) fn fields(bytes: &[u8]) -> Fields<'_> {
    Fields { bytes }
}

impl<'a> Fields<'a> {
    fn field(&mut self) -> Result<(u64, Value<'a>), Damaged> {
        let key = varint(&mut self.bytes)?;
        let value = match key & 7 {
            0 => Value::Number(varint(&mut self.bytes)?),
            1 => Value::Bytes(self.take(8)?),
            2 => {
                let length = varint(&mut self.bytes)?;
                Value::Bytes(self.take(usize::try_from(length).map_err(|_| Damaged)?)?)
            }
            5 => Value::Bytes(self.take(4)?),
            _ => return Err(Damaged),
        };
        Ok((key >> 3, value))
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8], Damaged> {
        let (taken, rest) = self.bytes.split_at_checked(count).ok_or(Damaged)?;
        self.bytes = rest;
        Ok(taken)
    }
}

impl<'a> Iterator for Fields<'a> {
    type Item = Result<(u64, Value<'a>), Damaged>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.bytes.is_empty() {
            return None;
        }
        let field = self.field();
        if field.is_err() {
            self.bytes = &[];
        }
        Some(field)
    }
}

/// Packed numbers.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Packed<'a> {
    bytes: &'a [u8],
}

impl<'a> Packed<'a> {
    /// Decodes signed numbers, each stored as the difference from the previous one.
    pub(super) fn deltas(self) -> impl Iterator<Item = Result<i64, Damaged>> + 'a {
        let mut sum = 0i64;
        self.map(move |number| {
            sum = sum.wrapping_add(zigzag(number?));
            Ok(sum)
        })
    }
}

impl Iterator for Packed<'_> {
    type Item = Result<u64, Damaged>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.bytes.is_empty() {
            return None;
        }
        let number = varint(&mut self.bytes);
        if number.is_err() {
            self.bytes = &[];
        }
        Some(number)
    }
}

pub(super) fn zigzag(number: u64) -> i64 {
    (number >> 1) as i64 ^ -((number & 1) as i64)
}

fn varint(bytes: &mut &[u8]) -> Result<u64, Damaged> {
    let mut number = 0;
    for shift in (0..70).step_by(7) {
        let (&byte, rest) = bytes.split_first().ok_or(Damaged)?;
        *bytes = rest;
        // Only one bit of the tenth byte fits; the rest is dropped, as other decoders do.
        number |= u64::from(byte & 0x7f) << shift.min(63);
        if byte & 0x80 == 0 {
            return Ok(number);
        }
    }
    Err(Damaged)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_read_or_damaged() {
        let check = |bytes: &[u8], expected: &[Result<(u64, Value<'_>), Damaged>]| {
            assert_eq!(fields(bytes).collect::<Vec<_>>(), expected, "{bytes:x?}");
        };
        check(&[8, 150, 1], &[Ok((1, Value::Number(150)))]);
        check(
            &[0x12, 2, 7, 8, 0x18, 1],
            &[Ok((2, Value::Bytes(&[7, 8]))), Ok((3, Value::Number(1)))],
        );
        check(&[0x12, 3, 7, 8], &[Err(Damaged)]);
        check(&[8], &[Err(Damaged)]);
        check(&[0x0b], &[Err(Damaged)]);
        check(&[8, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 1], &[Err(Damaged)]);
    }

    #[test]
    fn differences_are_summed() {
        let deltas = |bytes: &[u8]| -> Result<Vec<i64>, Damaged> {
            Value::Bytes(bytes).packed().unwrap().deltas().collect()
        };
        assert_eq!(deltas(&[2, 2, 1]), Ok(vec![1, 2, 1]));
        assert_eq!(deltas(&[2, 0x80]), Err(Damaged));
        assert_eq!(zigzag(u64::MAX), i64::MIN);
    }
}
