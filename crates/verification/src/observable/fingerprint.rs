//! Whether two runs end in the same bits.

use super::Observable;
use sphcut_sph::Snapshot;

/// 52 bits of a hash of the final state, as a whole number.
pub(super) const FINGERPRINT: Observable = Observable {
    name: "fingerprint",
    unit: "",
    meaning: "hash of all bits of position, velocity, stress, strain and temperature at the end",
    arguments: &[],
    // A double holds every whole number of 52 bits exactly.
    evaluate: |evidence, _| Ok((hash(evidence.last()?) >> 12) as f64),
};

/// Fowler-Noll-Vo 1a over the bits of the state.
fn hash(snapshot: &Snapshot) -> u64 {
    let vectors = snapshot.position.iter().chain(&snapshot.velocity).flatten();
    let tensors = snapshot.stress.iter().flatten();
    let scalars = snapshot.plastic_strain.iter().chain(&snapshot.temperature);
    vectors
        .chain(tensors)
        .chain(scalars)
        .flat_map(|value| value.to_bits().to_le_bytes())
        .fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_bit_changes_the_hash() {
        let at = |x: f64| Snapshot { position: vec![[x, 0.0, 0.0]], ..Snapshot::default() };
        assert_eq!(hash(&at(1.0)), hash(&at(1.0)));
        assert_ne!(hash(&at(1.0)), hash(&at(1.0 + f64::EPSILON)));
        assert_ne!(hash(&at(0.0)), hash(&at(-0.0)));
    }
}
