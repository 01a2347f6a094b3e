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
    /// Every error's number and text, once.
    const fn row(self) -> (u8, &'static str) {
        match self {
            Self::Absent => (1, "no plans here: the region is empty or erased"),
            Self::Truncated => (2, "shorter than a header, or than the header says"),
            Self::Magic => (3, "not a blob of plans"),
            Self::Version { .. } => (4, "from another version of the format"),
            Self::Schema => {
                (5, "from another build of the same version: its directory has another shape")
            }
            Self::Header => (6, "the header contradicts itself"),
            Self::TooLarge => (7, "larger than the format allows"),
            Self::Checksum => (8, "the checksum does not match: bytes were damaged"),
            Self::TrailingBytes => (9, "bytes follow the end of the blob"),
            Self::Directory => (10, "the directory cannot be read"),
            Self::Grid => (11, "the grid is out of its limits"),
            Self::Origin => (12, "the geodetic origin is out of its limits"),
            Self::Parameters => (13, "a parameter is out of its range"),
            Self::Plans => (14, "the table of plans is out of its limits"),
            Self::Layers => (15, "the table of layers is out of its limits"),
            Self::Name => (16, "a name is malformed or used twice"),
            Self::Goal => (17, "a goal is off the map"),
            Self::Cells => (18, "the cells of a layer are malformed"),
            Self::Mission { .. } => (19, "the mission is malformed"),
            Self::Work => (
                20,
                "checking it would take longer than its size allows: its tables lie on one another",
            ),
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
