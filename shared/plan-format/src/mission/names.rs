//! Names of records.

use crate::record::record;

record! {
    /// A name in the mission's name table.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct Name {
        /// Where it starts, bytes.
        pub offset: u16,
        /// How long it is, bytes.
        pub length: u8,
    }
}
