//! Tables of the reader.
