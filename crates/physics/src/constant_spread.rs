//! How far constants of one material lie apart: standard deviations of their logarithms, by their keys.

/// From batch to batch.
pub const BATCH_SCATTER: [(&str, f64); 6] = [
    ("initial_yield", 0.08),
    ("hardening_modulus", 0.08),
    ("hardening_exponent", 0.10),
    ("rate_coefficient", 0.25),
    ("softening_exponent", 0.12),
    ("friction_coefficient", 0.15),
];

/// Between published sets: those of Ti6Al4V and AISI 1045 in the library, rounded up; that of mu covers 0.13 to 0.95 about 0.35.
pub const PUBLISHED_SPREAD: [(&str, f64); 6] = [
    ("initial_yield", 0.25),
    ("hardening_modulus", 0.4),
    ("hardening_exponent", 0.4),
    ("rate_coefficient", 0.6),
    ("softening_exponent", 0.3),
    ("friction_coefficient", 0.5),
];
