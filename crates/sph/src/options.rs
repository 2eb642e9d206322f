//! Numerical and contact options as parameter tables: the scenario's
//! `[numerics]` and `[contact]` keys, their ranges, defaults and reasons.

use sphcut_physics::{Parameter, Quantity, Range};

const fn number(
    key: &'static str,
    symbol: &'static str,
    range: Range,
    default: f64,
    meaning: &'static str,
    source: &'static str,
) -> Parameter {
    Parameter {
        key,
        symbol,
        quantity: Quantity::Dimensionless,
        range,
        default: Some(default),
        meaning,
        source,
    }
}

/// Options of the discretisation and of the time step.
pub const NUMERICS: &[Parameter] = &[
    number(
        "smoothing_ratio",
        "h_s/dx",
        Range::closed(1.1, 2.5),
        1.5,
        "smoothing length over particle spacing; the kernel's support is two smoothing lengths",
        "1.5 gives 28 neighbours in 2D, as in the peer codes",
    ),
    number(
        "courant",
        "CFL",
        Range::above(0.0, 1.0),
        0.3,
        "time step in terms of the time a p-wave takes over one smoothing length",
        "halving it must not change mean forces; docs/numerics.md",
    ),
    number(
        "mass_scaling",
        "s",
        Range::closed(1.0, 1e4),
        1.0,
        "factor on the inertia (not on the heat capacity); the time step grows with its root",
        "1 is the unscaled problem",
    ),
    number(
        "refresh_strain",
        "eps_r",
        Range::closed(0.0, 0.5),
        0.1,
        "strain since the last reference update (neighbours and kernel gradients) that triggers the \
         next; 0 updates every step",
        "docs/numerics.md",
    ),
    number(
        "hourglass_coefficient",
        "chi_e",
        Range::closed(0.0, 2.0),
        0.05,
        "damping of non-affine motion of elastic material, in terms of rho c h_s",
        "docs/numerics.md",
    ),
    number(
        "hourglass_stiffness",
        "kappa_h",
        Range::closed(0.0, 2.0),
        0.5,
        "stiffness against non-affine displacement, in terms of the shear modulus; plastic flow \
         makes it forget",
        "docs/numerics.md",
    ),
    number(
        "hourglass_yield_fraction",
        "chi_p",
        Range::closed(0.0, 10.0),
        0.15,
        "upper limit of that damping in flowing material, in terms of sigma_y / (3 eps_p_dot)",
        "docs/numerics.md",
    ),
    number(
        "density_diffusion",
        "delta",
        Range::closed(0.0, 10.0),
        1.0,
        "diffusion of the checkerboard of the volume ratio in flowing material, in terms of h_s^2 eps_p_dot",
        "docs/numerics.md",
    ),
    number(
        "residual_density_diffusion",
        "delta_r",
        Range::closed(0.0, 10.0),
        4.0,
        "diffusion of the checkerboard that plastic flow leaves behind, in terms of h_s and the way of \
         the tool past the particle",
        "docs/numerics.md",
    ),
    number(
        "bonding_distance",
        "R_b",
        Range::closed(4.0, 1e9),
        20.0,
        "undeformed distance in particle spacings up to which two particles of a body belong together wherever they \
         meet; farther ones do once flow has made them neighbours without a gap, and a chip that curls onto the workpiece touches \
         it without welding",
        "docs/numerics.md",
    ),
    number(
        "support_stretch",
        "a",
        Range::closed(1.0, 3.0),
        1.0,
        "how far the support of a particle stretches along with the material: above 1 for bodies \
         that are drawn out (impact, forming), 1 in a shear zone, where neighbours have to change, and for material \
         without shear strength, which keeps no shape",
        "docs/numerics.md",
    ),
    number(
        "core_distance",
        "r_c/dx",
        Range::closed(0.0, 0.6),
        0.35,
        "distance in particle spacings below which neighbours repel each other, so that they do not \
         collapse into pairs; 0 for none",
        "docs/numerics.md",
    ),
    number(
        "shifting_distance",
        "r_s/dx",
        Range::closed(0.0, 1.0),
        0.0,
        "distance in particle spacings below which neighbours in material that has flowed far are moved apart at \
         each reference update (particle shifting); 0 for none",
        "docs/numerics.md",
    ),
    number(
        "linear_viscosity",
        "alpha_v",
        Range::closed(0.0, 4.0),
        0.0,
        "linear bulk viscosity in terms of rho c h_s",
        "docs/numerics.md",
    ),
    number(
        "quadratic_viscosity",
        "beta_v",
        Range::closed(0.0, 8.0),
        0.0,
        "quadratic bulk viscosity in terms of rho h_s^2, in compression only",
        "docs/numerics.md",
    ),
];

/// Options of the contact between particles and tool.
pub const CONTACT: &[Parameter] = &[
    number(
        "stiffness",
        "kappa",
        Range::above(0.0, 100.0),
        1.0,
        "penalty stiffness in terms of the p-wave modulus of the workpiece",
        "doubling or halving it must not change mean forces; docs/numerics.md",
    ),
    number(
        "start_gap",
        "g_0",
        Range::closed(0.0, 100.0),
        0.6,
        "distance of the tool from the workpiece at the start in particle spacings",
        "0.6 makes first contact gentle without a ramp",
    ),
];
