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
    }

    /// Begins the next interval at `time`.
    pub(crate) fn begin_interval(&mut self, time: f64) {
        self.interval_start = time;
        self.tool_impulse = [0.0; 3];
        self.reaction_impulse = [0.0; 3];
    }

    /// All numbers in a fixed order, for the checkpoint.
    pub(crate) fn to_array(&self) -> [f64; 20] {
        [
            self.tool_work,
            self.support_work,
            self.plastic,
            self.friction,
            self.contact,
            self.hourglass,
            self.viscosity,
            self.density_diffusion,
            self.residue,
            self.heat_supplied,
            self.initial_energy,
            self.initial_heat,
            self.interval_start,
            self.tool_impulse[0],
            self.tool_impulse[1],
            self.tool_impulse[2],
            self.reaction_impulse[0],
            self.reaction_impulse[1],
            self.reaction_impulse[2],
            self.thermoelastic,
        ]
    }

    /// The inverse of [`Ledger::to_array`].
    pub(crate) fn from_array(a: &[f64; 20]) -> Self {
        Self {
            tool_work: a[0],
            support_work: a[1],
            plastic: a[2],
            friction: a[3],
            contact: a[4],
            hourglass: a[5],
            viscosity: a[6],
            density_diffusion: a[7],
            residue: a[8],
            heat_supplied: a[9],
            initial_energy: a[10],
            initial_heat: a[11],
            interval_start: a[12],
            tool_impulse: [a[13], a[14], a[15]],
            reaction_impulse: [a[16], a[17], a[18]],
            thermoelastic: a[19],
        }
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
    /// Heat made from plastic work.
    pub(crate) heat: f64,
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
