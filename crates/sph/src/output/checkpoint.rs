//! The complete state, and the engine that goes on from it.

use crate::contact::surface_point::Neighbourhood;
use crate::contact::touch::Touch;
use crate::engine::Engine;
use crate::error::SetupError;
use crate::ledger::Ledger;
use crate::material::history::History;
use crate::material::point::MaterialPoint;
use crate::operators::reference::Bonding;
use crate::output::observation::CheckpointState;
use crate::particles::motion::Motion;
use crate::particles::window::Window;
use crate::setup::Setup;
use crate::tensor::Vector;
use sphcut_tool_heat::HeatedTool;

impl<const D: usize> Engine<D> {
    /// Everything that [`Engine::restore`] needs.
    pub(crate) fn checkpoint(&self) -> CheckpointState {
        let mut state = CheckpointState::default();
        let mut real = |name: &str, values: Vec<f64>| state.reals.push((name.to_owned(), values));
        real("position", flat(&self.particles.position));
        real("origin", flat(&self.particles.origin));
        real(
            "velocity",
            self.particles.motion.iter().flat_map(|motion| *motion.velocity()).collect(),
        );
        real(
            "reference",
            self.particles.motion.iter().flat_map(|motion| *motion.reference()).collect(),
        );
        real("force", flat(&self.particles.force));
        if !self.particles.shape.is_empty() {
            real(
                "support_shape",
                self.particles.shape.iter().flatten().flatten().copied().collect(),
            );
        }
        real("volume", self.particles.volume.clone());
        real(
            "reference_volume_ratio",
            self.reference.frame.iter().map(|f| f.volume_ratio).collect(),
        );
        real("point", written(&self.particles.point, MaterialPoint::numbers));
        if !self.particles.history.is_empty() {
            real("history", written(&self.particles.history, History::numbers));
        }
        real("account", self.ledger.to_array().to_vec());
        real(
            "clock",
            vec![
                self.clock.time,
                self.clock.time_step,
                self.reference.time,
                self.conduction.pending,
                self.conduction.interval,
                self.reference.lattice_gradient,
                self.reference.since.strain,
                self.reference.reach,
            ],
        );
        real("displacements", [self.reference.since.low, self.reference.since.high].concat());
        let touches: &[Touch<D>] = self.tool.as_ref().map_or(&[], |tool| &tool.touches);
        real(
            "touches",
            touches
                .iter()
                .flat_map(|t| [t.normal_force, t.friction_force, t.lever].concat())
                .collect(),
        );
        if let Some(tool) = self.tool.as_ref().filter(|tool| tool.holder.size() > 0) {
            real("tool_holder", tool.holder.to_vec());
        }
        for (name, values) in self.tool_heat.iter().flat_map(HeatedTool::checkpoint) {
            real(name, values);
        }
        let window = self.window.as_ref().map(Window::state);
        if let Some((retired, _)) = &window {
            real("window", retired.clone());
        }
        real("friction_use", touches.iter().map(|t| t.friction_use).collect());
        let surface =
            touches.iter().flat_map(|t| [t.area, t.pressure, t.shear_friction_factor]).collect();
        real("contact_surface", surface);
        let mut integer =
            |name: &str, values: Vec<u64>| state.integers.push((name.to_owned(), values));
        integer("id", self.particles.id.clone());
        integer("body", self.particles.body.iter().map(|&b| u64::from(b)).collect());
        integer("material", self.particles.material.iter().map(|&m| u64::from(m)).collect());
        integer("hold", self.particles.hold.iter().map(|&h| u64::from(h)).collect());
        integer("touched", touches.iter().map(|t| u64::from(t.particle)).collect());
        if let Some((_, waiting)) = window {
            integer("waiting", vec![waiting]);
        }
        let bonds = self.reference.bonds.iter().flat_map(|&(a, b)| [a, b]);
        integer("bonds", bonds.collect());
        integer("step", vec![self.clock.step]);
        state
    }

    /// The engine of `setup` in the state stored.
    pub(crate) fn restore(setup: &Setup, state: &CheckpointState) -> Result<Self, SetupError> {
        let mut engine = Self::new(setup)?;
        let mut count = engine.particles.id.len();
        if let Some(window) = &mut engine.window {
            let waiting = state.integer("waiting").ok_or_else(|| missing("waiting"))?;
            let waiting = waiting.first().ok_or_else(|| missing("waiting"))?;
            window.restore(state.real("window").ok_or_else(|| missing("window"))?, *waiting)?;
            count = state.integer("id").ok_or_else(|| missing("id"))?.len();
        }
        let reader = Reader { state, count };
        engine.particles.position = reader.vectors("position")?;
        engine.resize();
        engine.particles.origin = reader.vectors("origin")?;
        let velocities = reader.vectors("velocity")?;
        let references = reader.vectors("reference")?;
        engine.particles.motion = velocities
            .into_iter()
            .zip(references)
            .map(|(velocity, reference)| Motion::new(reference, velocity))
            .collect();
        engine.particles.force = reader.vectors("force")?;
        if !engine.particles.shape.is_empty() {
            let rows = reader.reals("support_shape", count * D * D)?.chunks_exact(D * D);
            engine.particles.shape = rows
                .map(|m| std::array::from_fn(|r| std::array::from_fn(|c| m[r * D + c])))
                .collect();
        }
        engine.particles.volume = reader.reals("volume", count)?.to_vec();
        let ratios = reader.reals("reference_volume_ratio", count)?;
        for (frame, ratio) in engine.reference.frame.iter_mut().zip(ratios) {
            frame.volume_ratio = *ratio;
        }
        reader.fill("point", &mut engine.particles.point, MaterialPoint::numbers)?;
        if !engine.particles.history.is_empty() {
            reader.fill("history", &mut engine.particles.history, History::numbers)?;
        }
        let account = reader.reals("account", 21)?;
        engine.ledger = Ledger::from_array(account.try_into().expect("length was checked"));
        engine.particles.id = reader.integers("id")?.to_vec();
        engine.particles.body = narrow(reader.integers("body")?)?;
        engine.particles.material = narrow(reader.integers("material")?)?;
        engine.particles.hold = narrow(reader.integers("hold")?)?;
        let bonds = state.integer("bonds").ok_or_else(|| missing("bonds"))?;
        engine.reference.bonds = bonds.chunks_exact(2).map(|bond| (bond[0], bond[1])).collect();
        engine.restore_clock(&reader)?;
        engine.restore_touches(&reader)?;
        if let Some(heat) = &mut engine.tool_heat {
            heat.restore(|name| state.real(name), count).map_err(|name| {
                SetupError::Checkpoint {
                    reason: format!("`{name}` is missing or does not fit the tool"),
                }
            })?;
        }
        Ok(engine)
    }

    fn restore_clock(&mut self, reader: &Reader) -> Result<(), SetupError> {
        let clock = reader.reals("clock", 8)?;
        let displacements = reader.reals("displacements", 6)?;
        self.clock.time = clock[0];
        self.reference.time = clock[2];
        self.reference.lattice_gradient = clock[5];
        self.reference.reach = clock[7];
        let holder = self.tool.as_ref().map_or(0, |tool| tool.holder.size());
        let held = if holder > 0 { reader.reals("tool_holder", holder)? } else { &[] };
        if let Some(tool) = &mut self.tool {
            tool.holder.set_reference(held);
        }
        let Self { particles, reference, numerics, .. } = self;
        let there = particles.motion.iter().map(|motion| *motion.reference()).collect();
        let here = std::mem::replace(&mut particles.position, there);
        // The particles are stored in cell order already: their order stays.
        reference.lay_cells(&particles.position, numerics);
        self.rebuild(Bonding::Kept);
        self.particles.position = here;
        if let Some(tool) = &mut self.tool {
            tool.holder.set(held);
        }
        self.clock.time_step = clock[1];
        self.conduction.pending = clock[3];
        self.conduction.interval = clock[4];
        self.reference.since.strain = clock[6];
        self.reference.since.low.copy_from_slice(&displacements[..3]);
        self.reference.since.high.copy_from_slice(&displacements[3..]);
        self.clock.step = *reader
            .state
            .integer("step")
            .and_then(|steps| steps.first())
            .ok_or_else(|| missing("step"))?;
        Ok(())
    }

    fn restore_touches(&mut self, reader: &Reader) -> Result<(), SetupError> {
        let Some(tool) = &mut self.tool else { return Ok(()) };
        let touched = reader.state.integer("touched").ok_or_else(|| missing("touched"))?;
        let forces = reader.reals("touches", touched.len() * 3 * D)?;
        let uses = reader.reals("friction_use", touched.len())?;
        let surface = reader.reals("contact_surface", touched.len() * 3)?;
        tool.touches = touched
            .iter()
            .zip(forces.chunks_exact(3 * D))
            .zip(uses.iter().zip(surface.chunks_exact(3)))
            .map(|((&particle, force), (&friction_use, surface))| {
                let particle =
                    u32::try_from(particle).ok().filter(|p| (*p as usize) < reader.count);
                Ok(Touch {
                    particle: particle.ok_or_else(|| missing("touched"))?,
                    normal_force: std::array::from_fn(|k| force[k]),
                    friction_force: std::array::from_fn(|k| force[D + k]),
                    lever: std::array::from_fn(|k| force[2 * D + k]),
                    friction_use,
                    area: surface[0],
                    pressure: surface[1],
                    shear_friction_factor: surface[2],
                })
            })
            .collect::<Result<_, SetupError>>()?;
        tool.lay_points(&Neighbourhood { particles: &self.particles, reference: &self.reference });
        Ok(())
    }
}

fn flat<const D: usize>(vectors: &[Vector<D>]) -> Vec<f64> {
    vectors.iter().flatten().copied().collect()
}

/// The numbers of all of a kind, one after the other.
fn written<T: Copy>(all: &[T], numbers: fn(&mut T) -> Vec<&mut f64>) -> Vec<f64> {
    let copies = all.iter().copied();
    copies
        .flat_map(|mut one| numbers(&mut one).into_iter().map(|x| *x).collect::<Vec<_>>())
        .collect()
}

fn missing(name: &str) -> SetupError {
    SetupError::Checkpoint { reason: format!("`{name}` is missing or damaged") }
}

fn narrow<T: TryFrom<u64>>(values: &[u64]) -> Result<Vec<T>, SetupError> {
    values.iter().map(|&v| T::try_from(v).map_err(|_| missing("an index"))).collect()
}

/// Reads arrays of the expected length.
struct Reader<'a> {
    state: &'a CheckpointState,
    count: usize,
}

impl Reader<'_> {
    fn reals(&self, name: &str, length: usize) -> Result<&[f64], SetupError> {
        let values = self.state.real(name).ok_or_else(|| missing(name))?;
        if values.len() == length {
            return Ok(values);
        }
        Err(SetupError::Checkpoint {
            reason: format!("`{name}` has {} numbers instead of {length}", values.len()),
        })
    }

    /// Takes the numbers of [`written`].
    fn fill<T: Copy>(
        &self,
        name: &str,
        all: &mut Vec<T>,
        numbers: fn(&mut T) -> Vec<&mut f64>,
    ) -> Result<(), SetupError> {
        all.resize(self.count, all[0]);
        let width = numbers(&mut all[0]).len();
        let values = self.reals(name, self.count * width)?;
        for (one, values) in all.iter_mut().zip(values.chunks_exact(width)) {
            std::iter::zip(numbers(one), values).for_each(|(number, value)| *number = *value);
        }
        Ok(())
    }

    fn integers(&self, name: &str) -> Result<&[u64], SetupError> {
        let values = self.state.integer(name).ok_or_else(|| missing(name))?;
        if values.len() == self.count {
            return Ok(values);
        }
        Err(SetupError::Checkpoint {
            reason: format!("`{name}` has {} numbers instead of {}", values.len(), self.count),
        })
    }

    fn vectors<const D: usize>(&self, name: &str) -> Result<Vec<Vector<D>>, SetupError> {
        let values = self.reals(name, self.count * D)?;
        Ok(values.chunks_exact(D).map(|chunk| std::array::from_fn(|k| chunk[k])).collect())
    }
}
