//! The ledger of a run: energies, impulses and extremes.

/// Cumulative energies in J (J/m in 2D) and impulses of the current interval in N s (N s/m).
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Ledger {
    pub(crate) tool_work: f64,
    pub(crate) support_work: f64,
    pub(crate) plastic: f64,
    pub(crate) friction: f64,
    pub(crate) contact: f64,
    pub(crate) hourglass: f64,
    pub(crate) viscosity: f64,
    pub(crate) density_diffusion: f64,
    pub(crate) residue: f64,
    pub(crate) thermoelastic: f64,
    pub(crate) heat_supplied: f64,
    /// What of it hourglass damping and bulk viscosity gave.
    pub(crate) numerical_heat: f64,
    pub(crate) initial_energy: f64,
    pub(crate) initial_heat: f64,
    pub(crate) interval_start: f64,
    pub(crate) tool_impulse: [f64; 3],
    pub(crate) reaction_impulse: [f64; 3],
}

impl Ledger {
    /// Adds what a step took.
    pub(crate) fn add(&mut self, tally: &Tally) {
        self.plastic += tally.plastic;
        self.viscosity += tally.viscosity;
        self.residue += tally.residue;
        self.thermoelastic += tally.thermoelastic;
        self.hourglass += tally.hourglass;
        self.heat_supplied += tally.heat;
        self.numerical_heat += tally.numerical_heat;
    }

    /// Begins the next interval at `time`.
    pub(crate) fn begin_interval(&mut self, time: f64) {
        self.interval_start = time;
        self.tool_impulse = [0.0; 3];
        self.reaction_impulse = [0.0; 3];
    }

    /// All numbers in the order of a checkpoint.
    fn numbers(&mut self) -> [&mut f64; 21] {
        let [tool_x, tool_y, tool_z] = &mut self.tool_impulse;
        let [reaction_x, reaction_y, reaction_z] = &mut self.reaction_impulse;
        [
            &mut self.tool_work,
            &mut self.support_work,
            &mut self.plastic,
            &mut self.friction,
            &mut self.contact,
            &mut self.hourglass,
            &mut self.viscosity,
            &mut self.density_diffusion,
            &mut self.residue,
            &mut self.heat_supplied,
            &mut self.initial_energy,
            &mut self.initial_heat,
            &mut self.interval_start,
            tool_x,
            tool_y,
            tool_z,
            reaction_x,
            reaction_y,
            reaction_z,
            &mut self.thermoelastic,
            &mut self.numerical_heat,
        ]
    }

    /// The ledger as numbers, for the checkpoint.
    pub(crate) fn to_array(&self) -> [f64; 21] {
        self.clone().numbers().map(|number| *number)
    }

    /// The inverse of [`Ledger::to_array`].
    pub(crate) fn from_array(values: &[f64; 21]) -> Self {
        let mut ledger = Self::default();
        std::iter::zip(ledger.numbers(), values).for_each(|(number, value)| *number = *value);
        ledger
    }
}

/// What one chunk of particles reports of one step; summed in the order of the chunks.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Tally {
    pub(crate) plastic: f64,
    pub(crate) viscosity: f64,
    pub(crate) residue: f64,
    pub(crate) hourglass: f64,
    /// Stored energy released because a modulus fell with temperature.
    pub(crate) thermoelastic: f64,
    /// Heat made.
    pub(crate) heat: f64,
    /// What of it hourglass damping and bulk viscosity gave.
    pub(crate) numerical_heat: f64,
    /// Stored energy released by the density diffusion.
    pub(crate) diffused: f64,
    /// Largest component of the strain since the last refresh.
    pub(crate) strain: f64,
    /// Bounds of the displacements since the last refresh.
    pub(crate) low: [f64; 3],
    /// See `low`.
    pub(crate) high: [f64; 3],
    /// First particle of the chunk whose numbers blew up.
    pub(crate) failure: Option<ParticleFailure>,
}

impl Tally {
    /// This report and the next.
    pub(crate) fn with(mut self, next: &Self) -> Self {
        self.plastic += next.plastic;
        self.viscosity += next.viscosity;
        self.residue += next.residue;
        self.thermoelastic += next.thermoelastic;
        self.hourglass += next.hourglass;
        self.heat += next.heat;
        self.numerical_heat += next.numerical_heat;
        self.strain = self.strain.max(next.strain);
        self.spread(&next.low);
        self.spread(&next.high);
        self.failure = self.failure.or(next.failure);
        self
    }

    /// Widens the bounds of the displacements.
    #[inline]
    pub(crate) fn spread(&mut self, displacement: &[f64; 3]) {
        for k in 0..3 {
            self.low[k] = self.low[k].min(displacement[k]);
            self.high[k] = self.high[k].max(displacement[k]);
        }
    }
}

/// A number out of bounds.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ParticleFailure {
    pub(crate) index: usize,
    pub(crate) quantity: &'static str,
    pub(crate) value: f64,
}
