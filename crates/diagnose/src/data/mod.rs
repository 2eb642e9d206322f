//! Recordings: channels, rows, and what they say of their own noise.

pub(crate) mod mistakes;
pub(crate) mod noise;
pub(crate) mod recordings;
