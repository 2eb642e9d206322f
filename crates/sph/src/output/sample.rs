//! The columns of the record at the end of a sampling interval.

use crate::engine::Engine;
use crate::material::point::MaterialPoint;
use crate::output::observation::{CHANNELS, ChannelId, Sample};
use crate::particles::window::Retired;
use crate::setup::Setup;
use glam::DVec3;

fn along(a: DVec3, direction: [f64; 3]) -> f64 {
    a.dot(direction.into())
}

impl<const D: usize> Engine<D> {
    /// What has left the moving window.
    fn retired(&self) -> Retired {
        self.window.as_ref().map_or(Retired::default(), |window| window.retired)
    }

    /// Closes the sampling interval that ends now.
    pub(crate) fn sample(&mut self, setup: &Setup) -> Sample {
        let mut values = vec![0.0; CHANNELS.len()];
        let mut set = |id: ChannelId, value: f64| values[id as usize] = value;
        self.sample_motion(setup, &mut set);
        self.sample_energies(&mut set);
        self.sample_extremes(&mut set);
        self.ledger.begin_interval(self.clock.time);
        Sample { values }
    }

    fn sample_motion(&self, setup: &Setup, set: &mut impl FnMut(ChannelId, f64)) {
        let interval = self.clock.time - self.ledger.interval_start;
        let rate = if interval > 0.0 { 1.0 / interval } else { 0.0 };
        let force = self.ledger.tool_impulse.map(|impulse| impulse * rate);
        let reaction = self.ledger.reaction_impulse.map(|impulse| impulse * rate);
        let mut momentum = self.retired().momentum;
        self.particles.add_momentum(&mut momentum);
        let frame = &setup.frame;
        let travel = self
            .tool
            .as_ref()
            .map_or(0.0, |tool| along(tool.displacement(self.clock.time), frame.cutting));
        set(ChannelId::Time, self.clock.time);
        set(ChannelId::Travel, travel);
        if let Some(tool) = self.tool.as_ref().filter(|tool| tool.holder.acts()) {
            let off = tool.holder.displacement(self.clock.time);
            set(ChannelId::ToolOffsetCutting, along(off, frame.cutting));
            set(ChannelId::ToolOffsetFeed, along(off, frame.feed));
        }
        set(ChannelId::CuttingForce, along(force.into(), frame.cutting));
        set(ChannelId::FeedForce, along(force.into(), frame.feed));
        set(ChannelId::PassiveForce, along(force.into(), frame.passive));
        set(ChannelId::ReactionCutting, along(reaction.into(), frame.cutting));
        set(ChannelId::ReactionFeed, along(reaction.into(), frame.feed));
        set(ChannelId::MomentumCutting, along(momentum.into(), frame.cutting));
        set(ChannelId::MomentumFeed, along(momentum.into(), frame.feed));
        set(ChannelId::TimeStep, self.clock.time_step);
    }

    fn sample_energies(&self, set: &mut impl FnMut(ChannelId, f64)) {
        let ledger = &self.ledger;
        let (kinetic, elastic) = (self.particles.kinetic_energy(), self.particles.elastic_energy());
        let sizes = self.reference.sizes.as_slice();
        let contact = ledger.contact + self.self_contact.energy(&self.particles.position, sizes);
        let pairing = self.pairing.energy(&self.particles.position, sizes);
        let numerical = ledger.hourglass
            + ledger.viscosity
            + ledger.density_diffusion
            + pairing
            + ledger.residue
            + contact;
        let supplied = ledger.initial_energy + ledger.tool_work + ledger.support_work;
        let found = kinetic
            + elastic
            + ledger.plastic
            + ledger.friction
            + ledger.thermoelastic
            + self.retired().energy
            + numerical;
        set(ChannelId::ToolWork, ledger.tool_work);
        set(ChannelId::SupportWork, ledger.support_work);
        set(ChannelId::KineticEnergy, kinetic);
        set(ChannelId::ElasticEnergy, elastic);
        set(ChannelId::PlasticWork, ledger.plastic);
        set(ChannelId::FrictionWork, ledger.friction);
        set(ChannelId::ContactEnergy, contact);
        set(ChannelId::HourglassWork, ledger.hourglass);
        set(ChannelId::ViscosityWork, ledger.viscosity);
        set(ChannelId::DensityDiffusionWork, ledger.density_diffusion);
        set(ChannelId::ArtificialStressWork, pairing);
        set(ChannelId::UpdateResidue, ledger.residue);
        set(ChannelId::ThermoelasticWork, ledger.thermoelastic);
        set(ChannelId::RetiredEnergy, self.retired().energy);
        set(ChannelId::EnergyError, supplied - found);
        let heat = self.particles.heat_content() + self.retired().heat;
        set(ChannelId::HeatContent, heat - ledger.initial_heat);
        set(ChannelId::HeatSupplied, ledger.heat_supplied);
        set(ChannelId::NumericalHeat, ledger.numerical_heat);
        if let Some(heat) = &self.tool_heat {
            set(ChannelId::HeatIntoTool, heat.ledger.contact);
            set(ChannelId::ToolFrictionHeat, heat.ledger.friction);
            set(ChannelId::ToolBoundaryHeat, heat.ledger.boundary);
            set(ChannelId::ToolHeatContent, heat.content());
            set(ChannelId::ToolMaxTemperature, heat.hottest());
            set(ChannelId::ToolOuterRise, heat.outer_rise());
        }
    }

    fn sample_extremes(&self, set: &mut impl FnMut(ChannelId, f64)) {
        let over = |value: &dyn Fn(&MaterialPoint<D>) -> f64| {
            self.particles
                .point
                .iter()
                .map(value)
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)))
        };
        let temperature = over(&|point| point.temperature);
        let plastic_strain = over(&|point| point.plastic_strain);
        let volume_ratio = over(&|point| point.volume_ratio);
        set(ChannelId::MaxTemperature, temperature.1);
        set(ChannelId::MinTemperature, temperature.0);
        set(ChannelId::MaxPlasticStrain, plastic_strain.1);
        set(ChannelId::MinDensityRatio, 1.0 / volume_ratio.1);
        set(ChannelId::MaxDensityRatio, 1.0 / volume_ratio.0);
        let count = self.particles.point.len();
        let fewest = (0..count).map(|i| self.reference.list.count(i)).min().unwrap_or(0);
        set(ChannelId::Particles, count as f64);
        set(ChannelId::MeanNeighbours, self.reference.list.pairs() as f64 / count as f64);
        set(ChannelId::MinNeighbours, f64::from(fewest));
        if let Some(tool) = &self.tool {
            let touches = &tool.touches;
            let (mut force, mut heat) = (0.0, 0.0);
            for touch in touches {
                let size = touch.pressure * touch.area;
                force += size;
                heat += size * self.particles.point[touch.particle as usize].temperature;
            }
            set(ChannelId::ContactCount, touches.len() as f64);
            set(ChannelId::ContactLength, touches.iter().map(|touch| touch.area).sum());
            set(ChannelId::InterfaceTemperature, if force > 0.0 { heat / force } else { 0.0 });
        }
    }
}
