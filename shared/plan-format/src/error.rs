//! Why a blob is refused.

use crate::mission::MissionError;

/// Why a blob is refused. The doc comment is the message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlobError {
    /// no plans here: the region is empty or erased
    Absent,
    /// shorter than a header, or than the header says
    Truncated,
    /// not a blob of plans
    Magic,
    /// from another version of the format
    Version {
        /// The version that the header names.
        found: u16,
    },
    /// from another build of the same version: its directory has another shape
    Schema,
    /// the header contradicts itself
    Header,
    /// larger than the format allows
    TooLarge,
    /// the checksum does not match: bytes were damaged
    Checksum,
    /// bytes follow the end of the blob
    TrailingBytes,
    /// the directory cannot be read
    Directory,
    /// the grid is out of its limits
    Grid,
    /// the geodetic origin is out of its limits
    Origin,
    /// a parameter is out of its range
    Parameters,
    /// the table of plans is out of its limits
    Plans,
    /// the table of layers is out of its limits
    Layers,
    /// a name is malformed or used twice
    Name,
    /// a goal is off the map
    Goal,
    /// the cells of a layer are malformed
    Cells,
    /// the mission is malformed
    Mission {
        /// Why.
        error: MissionError,
    },
    /// checking it would take longer than its size allows: its tables lie on one another
    Work,
}

impl BlobError {
    /// A number for logs and reason codes, from 1; never reused for another meaning.
    pub const fn code(self) -> u8 {
        match self {
            Self::Absent => 1,
            Self::Truncated => 2,
            Self::Magic => 3,
            Self::Version { .. } => 4,
            Self::Schema => 5,
            Self::Header => 6,
            Self::TooLarge => 7,
            Self::Checksum => 8,
            Self::TrailingBytes => 9,
            Self::Directory => 10,
            Self::Grid => 11,
            Self::Origin => 12,
            Self::Parameters => 13,
            Self::Plans => 14,
            Self::Layers => 15,
            Self::Name => 16,
            Self::Goal => 17,
            Self::Cells => 18,
            Self::Mission { .. } => 19,
            Self::Work => 20,
        }
    }

    const fn message(self) -> &'static str {
        match self {
            Self::Absent => "no plans here: the region is empty or erased",
            Self::Truncated => "shorter than a header, or than the header says",
            Self::Magic => "not a blob of plans",
            Self::Version { .. } => "from another version of the format",
            Self::Schema => {
                "from another build of the same version: its directory has another shape"
            }
            Self::Header => "the header contradicts itself",
            Self::TooLarge => "larger than the format allows",
            Self::Checksum => "the checksum does not match: bytes were damaged",
            Self::TrailingBytes => "bytes follow the end of the blob",
            Self::Directory => "the directory cannot be read",
            Self::Grid => "the grid is out of its limits",
            Self::Origin => "the geodetic origin is out of its limits",
            Self::Parameters => "a parameter is out of its range",
            Self::Plans => "the table of plans is out of its limits",
            Self::Layers => "the table of layers is out of its limits",
            Self::Name => "a name is malformed or used twice",
            Self::Goal => "a goal is off the map",
            Self::Cells => "the cells of a layer are malformed",
            Self::Mission { .. } => "the mission is malformed",
            Self::Work => {
                "checking it would take longer than its size allows: its tables lie on one another"
            }
        }
    }
}

impl core::fmt::Display for BlobError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(self.message())?;
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
