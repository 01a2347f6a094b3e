//! Why a blob is refused.

use crate::mission::MissionError;

/// Why a blob is refused. `Display` gives the message; the variants' docs say what to do about it.
///
/// From [`BlobError::Directory`] on, the checksum was right: the writer made a mistake, or the blob
/// is hostile. Compile the plans again with an unmodified compiler of the firmware's version.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlobError {
    /// The first eight bytes are all zeros or all ones. Write a blob to the region.
    Absent,
    /// A file was cut off, or a write to flash did not finish. Write the blob again.
    Truncated,
    /// The bytes are something else, for example a map. Compile the map, or check the address.
    Magic,
    /// Compiler and firmware are of different releases. Compile the plans with the firmware's
    /// release.
    Version {
        /// The version in the header.
        found: u16,
    },
    /// The directory changed without a new version, as between development builds. Build compiler
    /// and firmware from the same sources.
    Schema,
    /// The lengths in the header contradict each other: it is damaged. Write the blob again.
    Header,
    /// The header claims more than [`MAX_BLOB_BYTES`](crate::limits::MAX_BLOB_BYTES). Write the
    /// blob again; if it is this large, compile with a coarser resolution or fewer layers.
    TooLarge,
    /// Bits changed in storage or in transfer. Write the blob again.
    Checksum,
    /// A file is longer than its blob, which only [`Blob::parse_exact`](crate::Blob::parse_exact)
    /// refuses. Use [`Blob::parse`](crate::Blob::parse) for a region of flash.
    TrailingBytes,
    /// The directory is not a postcard message of its type, or bytes follow it.
    Directory,
    /// See [`Grid::is_valid`](crate::Grid::is_valid).
    Grid,
    /// See [`Origin::is_valid`](crate::Origin::is_valid).
    Origin,
    /// See [`Parameters::check`](crate::Parameters::check). The parallel plan to follow must exist.
    Parameters,
    /// Too many plans, a plan without layers or with too many, or layers out of order.
    Plans,
    /// Too many layers, or layers that belong to no plan.
    Layers,
    /// A name is not UTF-8, [`is_name`](crate::is_name) refuses it, or two plans of the blob or two
    /// layers of a plan share it.
    Name,
    /// The goal of a plan is outside the grid.
    Goal,
    /// A plane, the roots or the counts of a layer break the rules of `FORMAT.md`.
    Cells,
    /// The mission breaks a rule.
    Mission {
        /// The rule.
        error: MissionError,
    },
    /// The tables of the cells overlap, so that checking them exceeds
    /// [`MAX_CHECKS_PER_WORD`](crate::limits::MAX_CHECKS_PER_WORD).
    Work,
}

impl BlobError {
    /// Number and message of each error.
    const fn row(self) -> (u8, &'static str) {
        match self {
            Self::Absent => (1, "no plans here: the region is empty or erased"),
            Self::Truncated => (2, "shorter than the header, or than the length in the header"),
            Self::Magic => (3, "not a plan blob"),
            Self::Version { .. } => (4, "from another version of the format"),
            Self::Schema => {
                (5, "from another build of the same version: its directory has a different type")
            }
            Self::Header => (6, "the header contradicts itself"),
            Self::TooLarge => (7, "larger than the format allows"),
            Self::Checksum => (8, "the checksum does not match: bytes were damaged"),
            Self::TrailingBytes => (9, "bytes follow the end of the blob"),
            Self::Directory => (10, "the directory cannot be read"),
            Self::Grid => (11, "the cell grid exceeds its limits"),
            Self::Origin => (12, "the geodetic origin exceeds its limits"),
            Self::Parameters => (13, "a parameter is out of its range"),
            Self::Plans => (14, "the table of plans exceeds its limits"),
            Self::Layers => (15, "the table of layers exceeds its limits"),
            Self::Name => (16, "a name is malformed or used twice"),
            Self::Goal => (17, "a goal is off the map"),
            Self::Cells => (18, "the cells of a layer are malformed"),
            Self::Mission { .. } => (19, "the mission is malformed"),
            Self::Work => {
                (20, "checking it would take longer than its size allows: its tables overlap")
            }
        }
    }

    /// A number for logs and reason codes, from 1; never reused for another meaning.
    pub const fn code(self) -> u8 {
        self.row().0
    }
}

impl core::fmt::Display for BlobError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(self.row().1)?;
        if let Self::Version { found } = self {
            write!(f, " ({found}; this build reads {})", crate::seal::FORMAT_VERSION)?;
        }
        if let Self::Mission { error } = self {
            write!(f, ": {error}")?;
        }
        Ok(())
    }
}

impl core::error::Error for BlobError {}

#[cfg(all(feature = "defmt", target_os = "none"))]
impl defmt::Format for BlobError {
    fn format(&self, f: defmt::Formatter<'_>) {
        let (code, text) = self.row();
        match self {
            Self::Version { found } => {
                defmt::write!(f, "code {=u8}, {=str} ({=u16})", code, text, found)
            }
            Self::Mission { error } => {
                defmt::write!(f, "code {=u8}, {=str}: {}", code, text, error)
            }
            _ => defmt::write!(f, "code {=u8}, {=str}", code, text),
        }
    }
}
