//! How the particles are dealt out to threads.

/// Particles handled by one task; fixed, so that sums over tasks have one order.
pub(crate) const CHUNK: usize = 64;
/// Chunks that a thread takes at a time. Chunks differ in cost (plastic flow, free surfaces), and left
/// to itself rayon hands out quarters of a sweep: one of two threads then waits for the other.
pub(crate) const TURN: usize = 2;
