//! Records of fixed size, each declared by the list of its fields, and tables of them.
//!
//! Numbers are little-endian and unaligned, and fields are stored in the order of their
//! declaration, so a table is read in place by index.

use core::marker::PhantomData;

/// A value with a fixed number of bytes.
pub trait Record: Sized + 'static {
    /// Number of bytes.
    const SIZE: usize;

    /// Reads it; `None` if a tag is unknown. If `STRICT`, also `None` if [`Record::encode`] would
    /// write other bytes for the value: a number exceeds its type, or unused bytes are not 0. Only
    /// the check of a whole table is strict; the tick relies on that check.
    fn decode<const STRICT: bool>(reader: &mut Reader<'_>) -> Option<Self>;

    /// Appends its bytes.
    #[cfg(feature = "std")]
    fn encode(&self, bytes: &mut Vec<u8>);
}

/// Takes bytes from the front of a slice.
#[derive(Clone, Copy, Debug)]
pub struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    #[inline]
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*first)
    }
}

macro_rules! numbers {
    ($($number:ty)*) => {$(
        impl Record for $number {
            const SIZE: usize = size_of::<Self>();

            #[inline]
            fn decode<const STRICT: bool>(reader: &mut Reader<'_>) -> Option<Self> {
                reader.take().map(Self::from_le_bytes)
            }

            #[cfg(feature = "std")]
            fn encode(&self, bytes: &mut Vec<u8>) {
                bytes.extend_from_slice(&self.to_le_bytes());
            }
        }
    )*};
}

numbers! { u8 u16 u32 u64 f32 f64 }

/// One byte: 0 or 1. Other values count as 1 unless reading is strict.
impl Record for bool {
    const SIZE: usize = 1;

    #[inline]
    fn decode<const STRICT: bool>(reader: &mut Reader<'_>) -> Option<Self> {
        let byte = u8::decode::<STRICT>(reader)?;
        (!STRICT || byte <= 1).then_some(byte != 0)
    }

    #[cfg(feature = "std")]
    fn encode(&self, bytes: &mut Vec<u8>) {
        u8::from(*self).encode(bytes);
    }
}

/// An index; `u16::MAX` stands for `None`.
impl Record for Option<u16> {
    const SIZE: usize = 2;

    #[inline]
    fn decode<const STRICT: bool>(reader: &mut Reader<'_>) -> Option<Self> {
        let number = u16::decode::<STRICT>(reader)?;
        Some((number != u16::MAX).then_some(number))
    }

    #[cfg(feature = "std")]
    fn encode(&self, bytes: &mut Vec<u8>) {
        self.unwrap_or(u16::MAX).encode(bytes);
    }
}

/// X, then y.
impl Record for [f64; 2] {
    const SIZE: usize = 16;

    #[inline]
    fn decode<const STRICT: bool>(reader: &mut Reader<'_>) -> Option<Self> {
        Some([f64::decode::<STRICT>(reader)?, f64::decode::<STRICT>(reader)?])
    }

    #[cfg(feature = "std")]
    fn encode(&self, bytes: &mut Vec<u8>) {
        let [x, y] = self;
        x.encode(bytes);
        y.encode(bytes);
    }
}

/// Declares a struct that is a [`Record`]; size, reader and writer follow from its fields.
macro_rules! record {
    (
        $(#[$meta:meta])*
        $vis:vis struct $name:ident {
            $($(#[$field_meta:meta])* $field_vis:vis $field:ident: $kind:ty,)*
        }
    ) => {
        $(#[$meta])*
        $vis struct $name {
            $($(#[$field_meta])* $field_vis $field: $kind,)*
        }

        impl $crate::record::Record for $name {
            const SIZE: usize = 0 $(+ <$kind as $crate::record::Record>::SIZE)*;

            #[inline]
            fn decode<const STRICT: bool>(
                reader: &mut $crate::record::Reader<'_>,
            ) -> Option<Self> {
                use $crate::record::Record;
                Some(Self { $($field: <$kind as Record>::decode::<STRICT>(reader)?,)* })
            }

            #[cfg(feature = "std")]
            fn encode(&self, bytes: &mut Vec<u8>) {
                $($crate::record::Record::encode(&self.$field, bytes);)*
            }
        }
    };
}

/// Makes an enum without fields a [`Record`] of one byte.
macro_rules! tags {
    ($name:ident { $($variant:ident = $tag:literal,)* }) => {
        impl $crate::record::Record for $name {
            const SIZE: usize = 1;

            #[inline]
            fn decode<const STRICT: bool>(
                reader: &mut $crate::record::Reader<'_>,
            ) -> Option<Self> {
                match <u8 as $crate::record::Record>::decode::<STRICT>(reader)? {
                    $($tag => Some(Self::$variant),)*
                    _ => None,
                }
            }

            #[cfg(feature = "std")]
            fn encode(&self, bytes: &mut Vec<u8>) {
                let tag: u8 = match self {
                    $(Self::$variant => $tag,)*
                };
                $crate::record::Record::encode(&tag, bytes);
            }
        }
    };
}

/// Makes an enum with fields a [`Record`]. Its variants share the bytes of one record; the enum's
/// `of_bytes` and `to_bytes` convert.
macro_rules! payload {
    ($name:ident in $bytes:ident) => {
        impl $crate::record::Record for $name {
            const SIZE: usize = <$bytes as $crate::record::Record>::SIZE;

            #[inline]
            fn decode<const STRICT: bool>(reader: &mut $crate::record::Reader<'_>) -> Option<Self> {
                let bytes = <$bytes as $crate::record::Record>::decode::<STRICT>(reader)?;
                let payload = Self::of_bytes(bytes)?;
                (!STRICT || payload.to_bytes() == bytes).then_some(payload)
            }

            #[cfg(feature = "std")]
            fn encode(&self, bytes: &mut Vec<u8>) {
                $crate::record::Record::encode(&self.to_bytes(), bytes);
            }
        }
    };
}

pub(crate) use {payload, record, tags};

/// Records of one kind, read in place by index.
#[derive(Debug)]
pub struct Table<'a, T> {
    bytes: &'a [u8],
    kind: PhantomData<T>,
}

impl<T> Clone for Table<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Table<'_, T> {}

impl<'a, T: Record> Table<'a, T> {
    pub(crate) const fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, kind: PhantomData }
    }

    /// Number of records.
    pub const fn len(&self) -> usize {
        self.bytes.len() / T::SIZE
    }

    /// Whether the table has no records.
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A record; `None` past the end.
    #[inline]
    pub fn get(&self, index: usize) -> Option<T> {
        let from = index.checked_mul(T::SIZE)?;
        T::decode::<false>(&mut Reader(self.bytes.get(from..)?.get(..T::SIZE)?))
    }

    /// At most `count` records from `first` on, in order.
    pub fn range(self, first: u16, count: u8) -> impl Iterator<Item = T> + use<'a, T> {
        let bytes = self.bytes.get(usize::from(first) * T::SIZE..).unwrap_or(&[]);
        Table::<T>::new(bytes).iter().take(count.into())
    }

    /// All records in order.
    pub fn iter(self) -> impl Iterator<Item = T> + use<'a, T> {
        let records = self.bytes.chunks_exact(T::SIZE);
        records.map_while(|bytes| T::decode::<false>(&mut Reader(bytes)))
    }

    /// Whether the bytes are whole records, each as [`Record::encode`] writes it.
    pub(crate) fn is_sound(&self) -> bool {
        let mut records = self.bytes.chunks_exact(T::SIZE);
        records.all(|bytes| T::decode::<true>(&mut Reader(bytes)).is_some()) && self.is_whole()
    }

    /// Whether the bytes are a whole number of records.
    pub(crate) fn is_whole(&self) -> bool {
        self.bytes.len().is_multiple_of(T::SIZE)
    }
}
