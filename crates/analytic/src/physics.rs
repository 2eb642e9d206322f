//! Which physics: the closures and relations that can be chosen.

/// The relations that make up a cutting physics.
///
/// [`Physics::LIBRARY`] is what hypotheses are written in. The two opponents replace relations by others that the
/// library does not contain; the effects keep their names and parameters there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Physics {
    /// What fixes the shear angle.
    pub closure: Closure,
    /// The angle between the resultant force and the shear plane.
    pub shear_angle: ShearAngle,
    /// Partition of heat.
    pub heat: HeatPartition,
    /// Force on the rounded edge.
    pub ploughing: Ploughing,
    /// How friction falls with the sliding speed, where the effect is on.
    pub friction_speed: FrictionSpeed,
    /// By how much its relations are off.
    pub errors: RelationErrors,
}

/// By how much relations of a cutting physics are off. Each changes several quantities at once: a shear angle that is wrong makes forces,
/// temperatures, chip and contact wrong together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelationErrors {
    /// Added to theta of [`ShearAngle`], in rad.
    pub resultant_angle: f64,
    /// Logarithm of a factor of the contact length.
    pub contact_length: f64,
    /// Logarithm of a factor of the forces on the rounded edge.
    pub edge_force: f64,
}

impl RelationErrors {
    /// None.
    pub const NONE: Self = Self { resultant_angle: 0.0, contact_length: 0.0, edge_force: 0.0 };
}

impl Physics {
    /// Equilibrium of the shear zone, Zorev's contact, Boothroyd's temperatures, an edge pressed as hard as the chip flows.
    pub const LIBRARY: Self = Self {
        closure: Closure::ZOREV,
        shear_angle: ShearAngle::Equilibrium,
        heat: HeatPartition::Boothroyd,
        ploughing: Ploughing::FlowStress,
        friction_speed: FrictionSpeed::Power,
        errors: RelationErrors::NONE,
    };
    /// Oxley's own closure in place of a coefficient of friction.
    pub const OXLEY: Self = Self { closure: Closure::OXLEY, ..Self::LIBRARY };
    /// The library with other heat and other friction: closed solutions for moving heat sources, a coefficient that falls
    /// exponentially with the sliding speed.
    pub const OPPONENT_HEAT: Self = Self {
        heat: HeatPartition::MovingSource,
        friction_speed: FrictionSpeed::Exponential,
        ..Self::LIBRARY
    };
    /// All of it replaced: least energy in place of equilibrium, moving heat sources, pressure that falls in
    /// proportion to the distance, exponential friction, an edge that indents a cold solid.
    pub const OPPONENT_ALL: Self = Self {
        closure: Closure::Zorev { pressure_exponent: 1.0, layer: 0.08 },
        shear_angle: ShearAngle::LeastEnergy,
        heat: HeatPartition::MovingSource,
        ploughing: Ploughing::Hardness,
        friction_speed: FrictionSpeed::Exponential,
        errors: RelationErrors::NONE,
    };
}

/// What fixes the shear angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Closure {
    /// Oxley: the shear stress on the rake face, taken as constant, is the shear flow stress of the chip there.
    Oxley {
        /// C_O.
        rate_constant: RateConstant,
        /// delta.
        layer: SecondaryLayer,
    },
    /// Zorev: `tau = min(mu p, m_s k)` under a pressure `p = p_0 (1 - x/l)^xi`.
    Zorev {
        /// xi.
        pressure_exponent: f64,
        /// delta, thickness of the secondary zone over that of the chip.
        layer: f64,
    },
}

impl Closure {
    /// xi = 2 (a contact twice as long as under constant pressure) and delta = 0.05, of the order of what Oxley's closure finds for steel.
    pub const ZOREV: Self = Self::Zorev { pressure_exponent: 2.0, layer: 0.05 };
    /// C_O and delta as Oxley finds them.
    pub const OXLEY: Self = Self::Oxley {
        rate_constant: RateConstant::NormalStress,
        layer: SecondaryLayer::LeastForce,
    };
}

/// C_O of Oxley's closure: strain rate on the shear plane over speed along it by its length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RateConstant {
    /// That of [`crate::OrthogonalCut::rate_constant`].
    Given,
    /// The one with which the normal stress at the edge is the same from the contact and from the shear plane.
    NormalStress,
}

/// delta of Oxley's closure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SecondaryLayer {
    /// This value.
    Given(f64),
    /// The one with the least cutting force.
    LeastForce,
}

/// The angle theta between the resultant force and the shear plane, as a function of the shear angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShearAngle {
    /// `tan theta = 1 + 2 (pi/4 - phi) - C_O n` (Oxley 1989): equilibrium along the parallel-sided zone.
    Equilibrium,
    /// `theta = pi/2 - phi`: Merchant's angle of least energy, `phi = pi/4 - (lambda - alpha)/2`.
    LeastEnergy,
    /// `theta = pi/4`: Lee and Shaffer's slip-line field, `phi = pi/4 - (lambda - alpha)`.
    SlipLine,
}

/// Partition of the heat of the shear plane and of friction. The tool takes heat only where the effect says so, a steady corner
/// as Loewen and Shaw (1954) have it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeatPartition {
    /// Fits of Boothroyd (1963) as used by Oxley (1989).
    Boothroyd,
    /// Closed solutions: Weiner (1955) for the shear plane, Jaeger (1942) for the chip.
    MovingSource,
}

/// The pressure on the rounded edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ploughing {
    /// (2 + pi) k with the shear flow stress k of the hot shear plane, up to the separation at 45 degrees.
    FlowStress,
    /// The indentation hardness of the cold solid, whatever the speed, up to 60 degrees.
    Hardness,
}

/// How the effect of sliding speed lowers mu.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrictionSpeed {
    /// `max(1, v/v_0)^-q`: the law of the catalogue.
    Power,
    /// `exp(-q max(0, v - v_0)/v_e)`, v_e = 1 m/s: with the same slope `-q` per e-fold of speed at 1 m/s.
    Exponential,
}
