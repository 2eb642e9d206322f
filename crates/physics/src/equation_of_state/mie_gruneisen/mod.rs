//! The Mie-Gruneisen equation of state of a metal with a linear shock Hugoniot.

use super::series::{Excess, LARGEST};
use super::{EquationOfStateEntry, ReferenceState};
use crate::{Parameter, Quantity, Range, Values};

/// ```text
/// p = p_H(x) + Gamma_0 [E - E_H(x)],   x = 1 - V/V_0
/// U_s = c_0 + s u_p:   p_H = K x/(1 - s x)^2,   E_H = p_H x/2,   K = rho_0 c_0^2
/// ```
/// with energies per undeformed volume (Gamma/V is constant: Gamma = Gamma_0 V/V_0). With a
/// constant heat capacity c_v the energy is that of the isentrope through the undeformed state
/// (V_0, T_0) and the heat above it, and the pressure is a function of volume and temperature:
/// ```text
/// E = E_S(x) + rho_0 c_v (T - T_S(x)),   p = p_S(x) + a (T - T_S(x))
/// T_S = T_0 exp(Gamma_0 x),   a = Gamma_0 rho_0 c_v,   p_S = dE_S/dx = p_H - Gamma_0 (E_H - E_S)
/// ```
/// `E_H - E_S` is a power series (`series.rs`), to rounding. Nothing beyond x and T has to be
/// known of a particle.
///
/// **Heat.** Without supply of heat `dT = Gamma_0 T dx` (`dT/dt = -Gamma T tr D`), so T follows
/// `exp(Gamma_0 x)` exactly; heating at constant volume raises the pressure by `a dT`, at constant
/// pressure it expands the body by `alpha_v dT`, `alpha_v = a/K_T`, `K_T = K - a Gamma_0 T_0`. The
/// heat capacity that tables give is that at constant pressure: `c_v = c_p/(1 + Gamma_0^2 T_0 c_p/c_0^2)`,
/// from `c_p - c_v = alpha_v^2 K_T T/rho_0`, which is 2 to 4 % in metals.
///
/// **Consistency.** `dE/dV = T dp/dT - p` at constant temperature holds with a linear p(T), whatever
/// the heat capacity is as a function of T: with a table c(T) the coefficient a keeps the c_v of T_0,
/// and Gamma = a V/(V_0 rho_0 c) falls as c rises.
///
/// **Tension** (x < 0): s is taken as 0, so p_S = K x, with the same modulus and without a jump of the
/// slope at x = 0; the Hugoniot says nothing there.
///
/// Limits: one phase (iron transforms at 13 GPa); one Gamma_0; the bulk modulus of the isentrope does
/// not fall with temperature; compressions beyond `s x = 0.6` are refused (the run ends).
#[derive(Debug, Clone, PartialEq)]
pub struct MieGruneisen {
    /// K = rho_0 c_0^2 in Pa, of the isentrope.
    bulk_modulus: f64,
    slope: f64,
    gruneisen: f64,
    /// T_0 in K.
    temperature: f64,
    /// rho_0 c_v in J/(m^3 K).
    heat_capacity: f64,
    /// c_v/c_p at T_0.
    heat_ratio: f64,
    excess: Excess,
}

impl MieGruneisen {
    /// From values of [`ENTRY`]'s parameters and the rest of the material.
    #[must_use]
    pub fn new(values: &Values, reference: &ReferenceState) -> Self {
        let speed = values.get("bulk_sound_speed");
        let (slope, gruneisen) = (values.get("shock_slope"), values.get("gruneisen_parameter"));
        let temperature = values.get("stress_free_temperature");
        let heat = reference.specific_heat;
        let heat_ratio = 1.0 / (1.0 + (gruneisen / speed).powi(2) * temperature * heat);
        Self {
            bulk_modulus: reference.density * speed * speed,
            slope,
            gruneisen,
            temperature,
            heat_capacity: reference.density * heat * heat_ratio,
            heat_ratio,
            excess: Excess::new(slope, gruneisen),
        }
    }

    /// K in Pa.
    #[must_use]
    pub fn bulk_modulus(&self) -> f64 {
        self.bulk_modulus
    }

    /// a = Gamma_0 rho_0 c_v in Pa/K: how the pressure rises with temperature at constant volume.
    #[must_use]
    pub fn thermal_pressure_slope(&self) -> f64 {
        self.gruneisen * self.heat_capacity
    }

    /// alpha_v = a/(K - a Gamma_0 T_0) in 1/K, volumetric, of the undeformed state.
    #[must_use]
    pub fn thermal_expansion(&self) -> f64 {
        let slope = self.thermal_pressure_slope();
        slope / (self.bulk_modulus - slope * self.gruneisen * self.temperature)
    }

    /// c_v over c_p at T_0.
    #[must_use]
    pub fn heat_ratio(&self) -> f64 {
        self.heat_ratio
    }

    /// c_v in J/(kg K) for a heat capacity c_p at a temperature, `c_p - a alpha_v T/rho_0`; at
    /// least half of c_p, so that no table can make it vanish.
    #[must_use]
    pub fn at_constant_volume(&self, specific_heat: f64, temperature: f64, density: f64) -> f64 {
        let difference =
            self.thermal_pressure_slope() * self.thermal_expansion() * temperature / density;
        (specific_heat - difference).max(0.5 * specific_heat)
    }

    /// T_0 in K.
    #[must_use]
    pub fn stress_free_temperature(&self) -> f64 {
        self.temperature
    }

    /// Smallest V/V_0 that the law knows.
    #[must_use]
    pub fn least_volume_ratio(&self) -> f64 {
        1.0 - self.largest_compression()
    }

    fn largest_compression(&self) -> f64 {
        if self.slope > 0.0 { (LARGEST / self.slope).min(0.8) } else { 0.8 }
    }

    /// x within what the law knows: beyond it the run ends, and until then numbers stay finite.
    #[inline]
    fn compression(&self, volume_ratio: f64) -> f64 {
        (1.0 - volume_ratio).min(self.largest_compression())
    }

    /// p_H in Pa.
    #[must_use]
    #[inline]
    pub fn hugoniot_pressure(&self, volume_ratio: f64) -> f64 {
        let compression = self.compression(volume_ratio);
        let slope = if compression > 0.0 { self.slope } else { 0.0 };
        self.bulk_modulus * compression / (1.0 - slope * compression).powi(2)
    }

    /// E_H - E_S in J/m^3.
    #[inline]
    fn excess_energy(&self, compression: f64) -> f64 {
        if compression > 0.0 { self.bulk_modulus * self.excess.value(compression) } else { 0.0 }
    }

    /// E_S in J/m^3: the energy that compression along the isentrope stores.
    #[must_use]
    #[inline]
    pub fn isentrope_energy(&self, volume_ratio: f64) -> f64 {
        let compression = self.compression(volume_ratio);
        0.5 * self.hugoniot_pressure(volume_ratio) * compression - self.excess_energy(compression)
    }

    /// p_S in Pa.
    #[must_use]
    #[inline]
    pub fn isentrope_pressure(&self, volume_ratio: f64) -> f64 {
        let compression = self.compression(volume_ratio);
        self.hugoniot_pressure(volume_ratio) - self.gruneisen * self.excess_energy(compression)
    }

    /// T_S in K.
    #[must_use]
    #[inline]
    pub fn isentrope_temperature(&self, volume_ratio: f64) -> f64 {
        self.temperature * (self.gruneisen * self.compression(volume_ratio)).exp()
    }

    /// p in Pa.
    #[must_use]
    #[inline]
    pub fn pressure(&self, volume_ratio: f64, temperature: f64) -> f64 {
        let above = temperature - self.isentrope_temperature(volume_ratio);
        self.isentrope_pressure(volume_ratio) + self.thermal_pressure_slope() * above
    }

    /// E - E(V_0, T_0) in J/m^3 with a constant heat capacity.
    #[must_use]
    pub fn energy(&self, volume_ratio: f64, temperature: f64) -> f64 {
        let above = temperature - self.isentrope_temperature(volume_ratio);
        self.isentrope_energy(volume_ratio) + self.heat_capacity * above
    }

    /// rho_0 c_v (T_S - T_0) in J/m^3: the heat content that belongs to the stored energy E_S.
    #[must_use]
    #[inline]
    pub fn isentrope_heat(&self, volume_ratio: f64) -> f64 {
        self.heat_capacity * (self.isentrope_temperature(volume_ratio) - self.temperature)
    }

    /// The heat in J/m^3 that a change of volume from one ratio to another gives a particle at a
    /// temperature, `a int T dx`, with the heat capacity rho_0 c of that temperature.
    #[must_use]
    #[inline]
    pub fn heat_of_compression(
        &self,
        (before, after): (f64, f64),
        temperature: f64,
        heat_capacity: f64,
    ) -> f64 {
        // dT = (a/rho_0 c) T dx: exact for a constant heat capacity.
        let gain = self.thermal_pressure_slope() / heat_capacity * (before - after);
        heat_capacity * temperature * gain.exp_m1()
    }

    /// The temperature behind a shock from the undeformed state: all of `E_H - E_S` is heat.
    #[must_use]
    pub fn hugoniot_temperature(&self, volume_ratio: f64) -> f64 {
        let excess = self.excess_energy(self.compression(volume_ratio));
        self.isentrope_temperature(volume_ratio) + excess / self.heat_capacity
    }

    /// dp/dx at constant entropy in Pa.
    #[must_use]
    pub fn isentropic_slope(&self, volume_ratio: f64, temperature: f64) -> f64 {
        let x = self.compression(volume_ratio);
        let slope = if x > 0.0 { self.slope } else { 0.0 };
        let left = 1.0 - slope * x;
        let hugoniot = self.bulk_modulus * (1.0 + slope * x) / left.powi(3);
        let excess = self.gruneisen * self.excess_energy(x)
            + self.bulk_modulus * slope * x * x / left.powi(3);
        let above = temperature - self.isentrope_temperature(volume_ratio);
        hugoniot - self.gruneisen * excess + self.thermal_pressure_slope() * self.gruneisen * above
    }
}

pub(super) const ENTRY: EquationOfStateEntry = EquationOfStateEntry {
    key: "mie_gruneisen",
    title: "Mie-Gruneisen equation of state with a linear shock Hugoniot",
    equation: "p = p_H + Gamma_0 rho_0 (e - e_H) = p_S(x) + Gamma_0 rho_0 c_v (T - T_0 exp(Gamma_0 x)), \
               p_H = rho_0 c_0^2 x/(1 - s x)^2, x = 1 - V/V_0; heats by -Gamma T tr D",
    source: "Mie, Ann. Phys. 316 (1903) 657-697; Gruneisen, Ann. Phys. 344 (1912) 257-306; Rice, McQueen \
             and Walsh, Solid State Phys. 6 (1958) 1-63",
    validity: "one phase; Gamma/V and c_v constant; tension linear with the same modulus; the bulk modulus is \
               rho_0 c_0^2, the shear modulus that of E and nu; s x up to 0.6",
    parameters: &[
        Parameter {
            key: "bulk_sound_speed",
            symbol: "c_0",
            quantity: Quantity::Speed,
            range: Range::closed(10.0, 3e4),
            default: None,
            meaning: "speed of a weak shock; the bulk modulus is rho_0 c_0^2",
            source: "shock experiments",
        },
        Parameter {
            key: "shock_slope",
            symbol: "s",
            quantity: Quantity::Dimensionless,
            range: Range::closed(0.0, 4.0),
            default: None,
            meaning: "growth of the shock speed with the particle speed, U_s = c_0 + s u_p",
            source: "shock experiments; 1 to 1.6 for metals",
        },
        Parameter {
            key: "gruneisen_parameter",
            symbol: "Gamma_0",
            quantity: Quantity::Dimensionless,
            range: Range::closed(0.0, 5.0),
            default: None,
            meaning: "Gruneisen parameter at the undeformed volume, alpha_v K_T/(rho_0 c_v)",
            source: "shock experiments or thermal expansion; 1 to 2.5 for metals",
        },
        Parameter {
            key: "stress_free_temperature",
            symbol: "T_0",
            quantity: Quantity::Temperature,
            range: Range::closed(1.0, 5000.0),
            default: Some(293.15),
            meaning: "temperature at which the undeformed material is free of stress and has its density",
            source: "room temperature",
        },
    ],
    build: Some(MieGruneisen::new),
};

#[cfg(test)]
mod tests;
