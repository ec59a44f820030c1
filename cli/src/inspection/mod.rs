//! What a camera does to its pixels, from its pixels alone.

pub(crate) mod grey;
pub(crate) mod robust;
pub(crate) mod stillness;
pub(crate) mod levels;
pub(crate) mod noise;
pub(crate) mod offsets;
pub(crate) mod blocks;
pub(crate) mod edge_profile;
mod row_changes;
mod pulses;
pub(crate) mod bands;
pub(crate) mod measurement;
pub(crate) mod findings;
