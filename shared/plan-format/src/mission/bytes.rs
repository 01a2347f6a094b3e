//! Records of fixed size in a table of bytes.

use core::marker::PhantomData;

/// A value with a fixed number of bytes.
pub trait Record: Sized + 'static {
    /// How many bytes it takes.
    const SIZE: usize;

    /// Reads it; `None` where a tag is unknown.
    fn decode(reader: &mut Reader<'_>) -> Option<Self>;

    /// Writes it.
    #[cfg(feature = "std")]
    fn encode(&self, writer: &mut Writer);
}

/// Takes little-endian numbers from the front of some bytes.
#[derive(Clone, Copy, Debug)]
pub struct Reader<'a>(pub(crate) &'a [u8]);

impl Reader<'_> {
    #[inline]
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*first)
    }

    #[inline]
    pub(crate) fn u8(&mut self) -> Option<u8> {
        self.take::<1>().map(|[byte]| byte)
    }

    #[inline]
    pub(crate) fn u16(&mut self) -> Option<u16> {
        self.take().map(u16::from_le_bytes)
    }

    /// `u16::MAX` stands for none.
    pub(crate) fn optional_u16(&mut self) -> Option<Option<u16>> {
        self.u16().map(|number| (number != u16::MAX).then_some(number))
    }

    #[inline]
    pub(crate) fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    #[inline]
    pub(crate) fn u64(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    #[inline]
    pub(crate) fn f32(&mut self) -> Option<f32> {
        self.take().map(f32::from_le_bytes)
    }
}

/// Appends little-endian numbers.
#[cfg(feature = "std")]
#[derive(Debug, Default)]
pub struct Writer(pub(crate) Vec<u8>);

#[cfg(feature = "std")]
impl Writer {
    fn put(&mut self, bytes: &[u8]) -> &mut Self {
        self.0.extend_from_slice(bytes);
        self
    }

    pub(crate) fn u8(&mut self, number: u8) -> &mut Self {
        self.put(&[number])
    }

    pub(crate) fn u16(&mut self, number: u16) -> &mut Self {
        self.put(&number.to_le_bytes())
    }

    pub(crate) fn optional_u16(&mut self, number: Option<u16>) -> &mut Self {
        self.u16(number.unwrap_or(u16::MAX))
    }

    pub(crate) fn u32(&mut self, number: u32) -> &mut Self {
        self.put(&number.to_le_bytes())
    }

    pub(crate) fn u64(&mut self, number: u64) -> &mut Self {
        self.put(&number.to_le_bytes())
    }

    pub(crate) fn f32(&mut self, number: f32) -> &mut Self {
        self.put(&number.to_le_bytes())
    }
}

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

    /// Whether there is no record.
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A record; `None` past the end.
    #[inline]
    pub fn get(&self, index: usize) -> Option<T> {
        let from = index.checked_mul(T::SIZE)?;
        T::decode(&mut Reader(self.bytes.get(from..)?.get(..T::SIZE)?))
    }

    /// The records in order, from `first`, at most `count`.
    pub fn range(self, first: u16, count: u8) -> impl Iterator<Item = T> + use<'a, T> {
        let bytes = self.bytes.get(usize::from(first) * T::SIZE..).unwrap_or(&[]);
        Table::<T>::new(bytes).iter().take(count.into())
    }

    /// All records in order.
    pub fn iter(self) -> impl Iterator<Item = T> + use<'a, T> {
        let records = self.bytes.chunks_exact(T::SIZE);
        records.map_while(|bytes| T::decode(&mut Reader(bytes)))
    }

    /// Whether the bytes are whole records and each of them can be read.
    pub(crate) fn is_sound(&self) -> bool {
        self.bytes.len().is_multiple_of(T::SIZE) && self.iter().count() == self.len()
    }
}
