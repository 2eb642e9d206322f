//! Energy, momentum and heat: does everything add up, and how much of it is numerical?

use sphcut_record::{Facts, Samples};
use sphcut_sph::{CHANNELS, ChannelId};

/// What a term of the energy balance stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TermKind {
    /// Stored or dissipated by the material or by friction.
    Physical,
    /// Put in or taken out by the discretisation.
    Numerical,
    /// What nobody accounts for.
    Closure,
}

/// The terms into which the work goes, in the order in which charts stack them.
pub const ENERGY_TERMS: &[(ChannelId, TermKind, &str)] = &[
    (ChannelId::PlasticWork, TermKind::Physical, "Plastic dissipation"),
    (ChannelId::FrictionWork, TermKind::Physical, "Friction"),
    (ChannelId::ElasticEnergy, TermKind::Physical, "Elastic energy"),
    (ChannelId::KineticEnergy, TermKind::Physical, "Kinetic energy"),
    (ChannelId::RetiredEnergy, TermKind::Physical, "Left the moving window"),
    (
        ChannelId::ThermoelasticWork,
        TermKind::Physical,
        "Released by a falling modulus, or turned into heat by thermal pressure",
    ),
    (ChannelId::HourglassWork, TermKind::Numerical, "Hourglass control"),
    (ChannelId::ViscosityWork, TermKind::Numerical, "Bulk viscosity"),
    (ChannelId::DensityDiffusionWork, TermKind::Numerical, "Density diffusion"),
    (ChannelId::ArtificialStressWork, TermKind::Numerical, "Artificial stress"),
    (ChannelId::UpdateResidue, TermKind::Numerical, "Residue of the stress update"),
    (ChannelId::ContactEnergy, TermKind::Numerical, "Contact penalty"),
    (ChannelId::EnergyError, TermKind::Closure, "Not accounted for"),
];

/// One term of the energy balance at the end of the run.
#[derive(Debug, Clone, PartialEq)]
pub struct EnergyTerm {
    /// The channel.
    pub channel: ChannelId,
    /// What it stands for.
    pub kind: TermKind,
    /// Name for people.
    pub title: &'static str,
    /// J, per metre of width in a plane run.
    pub energy: f64,
    /// Over the energy supplied; 0 where none was.
    pub share: f64,
}

impl EnergyTerm {
    /// Identifier of the channel.
    #[must_use]
    pub fn name(&self) -> &'static str {
        CHANNELS[self.channel as usize].name
    }
}

/// The energy balance at the end of the run.
#[derive(Debug, Clone, PartialEq)]
pub struct EnergyBalance {
    /// Work of the tool in J, per metre of width in a plane run.
    pub tool_work: f64,
    /// Work of the tool per metre of width of cut in J/m.
    pub tool_work_per_width: f64,
    /// Work of the tool and of moving supports, by absolute value: what shares refer to. In a run
    /// without either, the sum of the physical terms.
    pub supplied: f64,
    /// Every term.
    pub terms: Vec<EnergyTerm>,
    /// |not accounted for| / supplied.
    pub closure: f64,
    /// Gross numerical share: sum of |numerical term| / supplied. Absolute values, so that a
    /// negative term cannot hide a positive one.
    pub numerical_dissipation: f64,
    /// Kinetic energy over supplied, the largest value of the later half of the run.
    pub kinetic_share: f64,
}

/// Books of one run; `None` without samples.
pub(crate) fn energy(samples: &Samples, facts: &Facts) -> Option<EnergyBalance> {
    let last = samples.last()?;
    let terms: Vec<(usize, f64)> =
        ENERGY_TERMS.iter().enumerate().map(|(k, term)| (k, last.get(term.0))).collect();
    let physical: f64 = terms
        .iter()
        .filter(|(k, _)| ENERGY_TERMS[*k].1 == TermKind::Physical)
        .map(|(_, energy)| energy.abs())
        .sum();
    let tool_work = last.get(ChannelId::ToolWork);
    let work = tool_work.abs() + last.get(ChannelId::SupportWork).abs();
    let supplied = if work > 0.0 { work } else { physical };
    let share = |energy: f64| if supplied > 0.0 { energy / supplied } else { 0.0 };
    let terms: Vec<EnergyTerm> = terms
        .into_iter()
        .map(|(k, energy)| {
            let (channel, kind, title) = ENERGY_TERMS[k];
            EnergyTerm { channel, kind, title, energy, share: share(energy) }
        })
        .collect();
    let gross = |kind: TermKind| {
        terms.iter().filter(|term| term.kind == kind).map(|term| term.share.abs()).sum()
    };
    Some(EnergyBalance {
        tool_work,
        tool_work_per_width: tool_work * facts.force_factor() / facts.width_of_cut,
        supplied,
        closure: gross(TermKind::Closure),
        numerical_dissipation: gross(TermKind::Numerical),
        kinetic_share: kinetic_share(samples),
        terms,
    })
}

fn kinetic_share(samples: &Samples) -> f64 {
    let kinetic = samples.channel(ChannelId::KineticEnergy);
    let tool = samples.channel(ChannelId::ToolWork);
    let support = samples.channel(ChannelId::SupportWork);
    (samples.len() / 2..samples.len())
        .map(|k| (kinetic[k], tool[k].abs() + support[k].abs()))
        .filter(|(_, supplied)| *supplied > 0.0)
        .map(|(kinetic, supplied)| kinetic / supplied)
        .fold(0.0, f64::max)
}

/// The momentum balance along one direction over a window: impulse of the contact plus impulse
/// of the supports against the change of momentum. N s, per metre of width in a plane run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MomentumBalance {
    /// Of the tool on the workpiece.
    pub contact_impulse: f64,
    /// Of the supports on the workpiece.
    pub reaction_impulse: f64,
    /// Momentum at the end minus at the start.
    pub momentum_change: f64,
}

impl MomentumBalance {
    /// contact + reaction - change.
    #[must_use]
    pub fn residual(&self) -> f64 {
        self.contact_impulse + self.reaction_impulse - self.momentum_change
    }
}

/// Momentum along the cutting and the feed direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MomentumBalances {
    /// Along the cutting direction.
    pub cutting: MomentumBalance,
    /// Into the machined surface.
    pub feed: MomentumBalance,
    /// Impulse of the tool on the workpiece across both, in space; reaction and momentum along it are not recorded.
    pub passive_impulse: f64,
}

impl MomentumBalances {
    /// Magnitude of the residual over the magnitude of the contact impulse; `None` without one. A plate that presses across both
    /// directions has impulses along them that cancel: they are no measure of what may be left of them.
    #[must_use]
    pub fn closure(&self) -> Option<f64> {
        let impulse = self.cutting.contact_impulse.hypot(self.feed.contact_impulse);
        let impulse = impulse.hypot(self.passive_impulse);
        let residual = self.cutting.residual().hypot(self.feed.residual());
        (impulse > 0.0).then(|| residual / impulse)
    }
}

/// The balances over the samples from `first` on; `None` for fewer than two samples.
/// The first sample gives the momentum at the start and is not part of the impulses.
pub(crate) fn momentum(samples: &Samples, first: usize) -> Option<MomentumBalances> {
    if samples.len() < first.saturating_add(2) {
        return None;
    }
    let time = samples.channel(ChannelId::Time);
    let impulse = |id: ChannelId| {
        let force = samples.channel(id);
        (first + 1..samples.len()).map(|k| force[k] * (time[k] - time[k - 1])).sum()
    };
    let change = |id: ChannelId| {
        let momentum = samples.channel(id);
        momentum[samples.len() - 1] - momentum[first]
    };
    Some(MomentumBalances {
        cutting: MomentumBalance {
            contact_impulse: impulse(ChannelId::CuttingForce),
            reaction_impulse: impulse(ChannelId::ReactionCutting),
            momentum_change: change(ChannelId::MomentumCutting),
        },
        feed: MomentumBalance {
            contact_impulse: impulse(ChannelId::FeedForce),
            reaction_impulse: impulse(ChannelId::ReactionFeed),
            momentum_change: change(ChannelId::MomentumFeed),
        },
        passive_impulse: impulse(ChannelId::PassiveForce),
    })
}

/// Heat at the end of the run in J, per metre of width in a plane run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeatBalance {
    /// Supplied by plastic work, friction and boundaries.
    pub supplied: f64,
    /// Found in the particles above their initial state.
    pub content: f64,
    /// Share of the heat of friction that heats the workpiece at once; `None` where friction heats nothing.
    pub friction_share: Option<f64>,
    /// That of the tool, where it conducts heat.
    pub tool: Option<ToolHeatBalance>,
}

/// Heat of the tool since the start in J, per metre of width in a plane run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToolHeatBalance {
    /// Passed from the workpiece through the contact.
    pub contact: f64,
    /// Its share of the heat of friction.
    pub friction: f64,
    /// Through its outer boundary, negative where it leaves.
    pub boundary: f64,
    /// Found in the tool above its initial state.
    pub content: f64,
    /// Highest temperature of the tool over the run in K.
    pub max_temperature: f64,
    /// Highest less first temperature of the hottest place of the tool in K.
    pub rise: f64,
    /// Largest change of temperature over the run where the tool is cut off in K.
    pub outer_rise: f64,
    /// Factors from these heats to those of the width of cut in J, and to J per metre of it.
    pub factors: [f64; 2],
}

/// A tool that still holds more than this of the heat that entered it is warming up.
const WARMING_UP: f64 = 0.5;

impl ToolHeatBalance {
    /// Whether it is still warming up: most of the heat that entered is in it and has not passed on.
    #[must_use]
    pub fn is_warming_up(&self) -> bool {
        self.content > WARMING_UP * (self.contact + self.friction).max(0.0)
    }

    /// What the place where the tool is cut off has to do with the result: heat that passed there over the heat that
    /// entered, or its change of temperature over the highest rise, whichever is more.
    #[must_use]
    pub fn cut_off_share(&self) -> f64 {
        let over = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
        let heat = over(self.boundary.abs(), self.contact.abs() + self.friction.abs());
        heat.max(over(self.outer_rise, self.rise))
    }

    /// |content - what entered| over the sum of the absolute values of what passed; `None` where
    /// nothing did.
    #[must_use]
    pub fn closure(&self) -> Option<f64> {
        let passed = self.contact.abs() + self.friction.abs() + self.boundary.abs();
        let entered = self.contact + self.friction + self.boundary;
        (passed > 0.0).then(|| (self.content - entered).abs() / passed)
    }
}

impl HeatBalance {
    /// |content - supplied| / |supplied|; `None` where none was supplied.
    #[must_use]
    pub fn closure(&self) -> Option<f64> {
        (self.supplied != 0.0).then(|| ((self.content - self.supplied) / self.supplied).abs())
    }
}

pub(crate) fn heat(samples: &Samples, facts: &Facts) -> Option<HeatBalance> {
    let last = samples.last()?;
    Some(HeatBalance {
        supplied: last.get(ChannelId::HeatSupplied),
        content: last.get(ChannelId::HeatContent),
        friction_share: None,
        tool: tool_heat(samples, facts),
    })
}

/// The books of a tool that conducts heat: its temperature is above 0 K.
fn tool_heat(samples: &Samples, facts: &Facts) -> Option<ToolHeatBalance> {
    let last = samples.last()?;
    let hottest = samples.channel(ChannelId::ToolMaxTemperature).iter().copied();
    let max_temperature = hottest.fold(0.0, f64::max);
    let first = samples.channel(ChannelId::ToolMaxTemperature).first().copied().unwrap_or(0.0);
    let outer = samples.channel(ChannelId::ToolOuterRise).iter().copied();
    (max_temperature > 0.0).then(|| ToolHeatBalance {
        contact: last.get(ChannelId::HeatIntoTool),
        friction: last.get(ChannelId::ToolFrictionHeat),
        boundary: last.get(ChannelId::ToolBoundaryHeat),
        content: last.get(ChannelId::ToolHeatContent),
        max_temperature,
        rise: max_temperature - first,
        outer_rise: outer.fold(0.0, f64::max),
        factors: [facts.force_factor(), facts.force_factor() / facts.width_of_cut],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::SyntheticCut;
    use sphcut_sph::Sample;

    fn facts() -> Facts {
        Facts::of(&sphcut_sph::Setup::empty(sphcut_sph::setup::Dimension::Two, 1e-5, 1.0))
    }

    fn record(rows: &[Sample]) -> Samples {
        let mut samples = Samples::default();
        rows.iter().for_each(|row| samples.push(row));
        samples
    }

    #[test]
    fn shares_are_gross_and_a_negative_term_hides_nothing() {
        let mut rows = SyntheticCut::default().samples(100, 10e-6, &[]);
        let last = rows.last_mut().unwrap();
        let work = last.get(ChannelId::ToolWork);
        last.values[ChannelId::ArtificialStressWork as usize] = -0.04 * work;
        last.values[ChannelId::EnergyError as usize] = -0.002 * work;
        let energy = energy(&record(&rows), &facts()).unwrap();
        // 0.05 + 0.005 + 0.012 + 0.002 of the drawing, and 0.04.
        assert!((energy.numerical_dissipation - 0.109).abs() < 1e-12, "{energy:?}");
        assert!((energy.closure - 0.002).abs() < 1e-12);
        assert!((energy.kinetic_share - 0.01).abs() < 1e-12);
    }

    #[test]
    fn a_free_flight_refers_to_its_own_energy() {
        let mut row = Sample { values: vec![0.0; CHANNELS.len()] };
        row.values[ChannelId::KineticEnergy as usize] = 8.0;
        row.values[ChannelId::ElasticEnergy as usize] = 2.0;
        row.values[ChannelId::HourglassWork as usize] = 0.1;
        let energy = energy(&record(&[row]), &facts()).unwrap();
        assert_eq!(energy.supplied, 10.0);
        assert!((energy.numerical_dissipation - 0.01).abs() < 1e-15);
    }

    #[test]
    fn heat_of_a_tool_closes_by_hand() {
        let mut row = Sample { values: vec![0.0; CHANNELS.len()] };
        let facts = SyntheticCut::default().run(1e-4, 1).facts;
        assert_eq!(heat(&record(&[row.clone()]), &facts).unwrap().tool, None);
        for (id, value) in [
            (ChannelId::HeatIntoTool, 5.0),
            (ChannelId::ToolFrictionHeat, 2.0),
            (ChannelId::ToolBoundaryHeat, -1.0),
            (ChannelId::ToolHeatContent, 5.92),
            (ChannelId::ToolMaxTemperature, 700.0),
            (ChannelId::ToolOuterRise, 50.0),
        ] {
            row.values[id as usize] = value;
        }
        let hotter = row.clone();
        row.values[ChannelId::ToolMaxTemperature as usize] = 300.0;
        let cold = row.clone();
        row.values[ChannelId::ToolMaxTemperature as usize] = 650.0;
        let rows = [cold, hotter, row];
        let tool = heat(&record(&rows), &facts).unwrap().tool.unwrap();
        assert_eq!(tool.max_temperature, 700.0);
        // Entered: 5 + 2 - 1 = 6, found 5.92, passed in all 8.
        assert!((tool.closure().unwrap() - 0.01).abs() < 1e-12);
        // 1 of 7 through the outer sides; they warm by 50 of 400 K, which is less.
        assert_eq!(tool.cut_off_share(), 1.0 / 7.0);
        assert_eq!(ToolHeatBalance { boundary: 0.0, ..tool }.cut_off_share(), 0.125);
        // Of the 7 that entered 5.92 are still in it.
        assert!(tool.is_warming_up());
        assert!(!ToolHeatBalance { content: 3.4, ..tool }.is_warming_up());
        // In the plane the heats are per metre, in space those of the width of cut.
        assert_eq!(tool.factors, [facts.width_of_cut, 1.0]);
        let space = Facts { dimension: 3, ..facts };
        let tool = heat(&record(&rows), &space).unwrap().tool.unwrap();
        assert_eq!(tool.factors, [1.0, 1.0 / space.width_of_cut]);
    }

    #[test]
    fn momentum_closes_by_hand() {
        let closed = |passive: f64| {
            let row = |time: f64, force: f64, reaction: f64, momentum: f64| {
                let mut row = Sample { values: vec![0.0; CHANNELS.len()] };
                row.values[ChannelId::Time as usize] = time;
                row.values[ChannelId::CuttingForce as usize] = force;
                row.values[ChannelId::PassiveForce as usize] = passive;
                row.values[ChannelId::ReactionCutting as usize] = reaction;
                row.values[ChannelId::MomentumCutting as usize] = momentum;
                row
            };
            let samples = record(&[
                row(1.0, 9.0, 9.0, 0.5),
                row(2.0, 10.0, -7.0, 3.5),
                row(4.0, 10.0, -9.0, 5.4),
            ]);
            assert_eq!(momentum(&samples, 2), None);
            momentum(&samples, 0).unwrap()
        };
        let balance = closed(0.0);
        // Contact 10 * 1 + 10 * 2, supports -7 * 1 - 9 * 2, change 5.4 - 0.5.
        assert_eq!(balance.cutting.contact_impulse, 30.0);
        assert_eq!(balance.cutting.reaction_impulse, -25.0);
        assert!((balance.cutting.residual() - 0.1).abs() < 1e-12);
        assert!((balance.closure().unwrap() - 0.1 / 30.0).abs() < 1e-12);
        // 3, 4, 5: impulses 30 along the cut and 40 across it.
        assert!((closed(40.0 / 3.0).closure().unwrap() - 0.1 / 50.0).abs() < 1e-12);
    }
}
