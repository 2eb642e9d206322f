//! What the engine tells: channels, snapshots, and its complete state.

use crate::contact::{Touch, extended, reduced};
use crate::engine::Engine;
use crate::error::SetupError;
use crate::material::history::History;
use crate::material::point::MaterialPoint;
use crate::operators::neighbours::Cells;
use crate::output::account::Account;
use crate::output::observation::{CHANNELS, ChannelId, CheckpointState, Sample, Snapshot};
use crate::particles::motion::Motion;
use crate::particles::window::{Rest, Retired};
use crate::setup::{Setup, Vector as Vector3};
use crate::tensor::{Matrix, Vector, dot};
use sphcut_geometry::tool_surface::ToolSurface;
use sphcut_tool_heat::HeatedTool;

impl<const D: usize> Engine<D> {
    /// Kinetic energy with the inertia as scaled.
    pub(crate) fn kinetic_energy(&self) -> f64 {
        (0..self.motion.len())
            .map(|i| {
                0.5 * self.inertia(i) * dot(self.motion[i].velocity(), self.motion[i].velocity())
            })
            .sum()
    }

    /// Stored elastic energy.
    pub(crate) fn elastic_energy(&self) -> f64 {
        (0..self.point.len())
            .map(|i| {
                let data = &self.materials[self.material[i] as usize];
                self.volume[i] * self.point[i].elastic_energy(&data.elasticity)
            })
            .sum()
    }

    /// Thermal energy above 0 K, less what an equation of state counts as stored energy.
    pub(crate) fn heat_content(&self) -> f64 {
        self.heat_of(0..self.point.len())
    }

    /// [`Engine::heat_content`] of some particles.
    pub(crate) fn heat_of(&self, particles: std::ops::Range<usize>) -> f64 {
        particles
            .map(|i| {
                let data = &self.materials[self.material[i] as usize];
                let point = &self.point[i];
                let heat = match &data.heat_table {
                    None => self.mass(i) * data.specific_heat * point.temperature,
                    Some(table) => self.mass(i) * table.integral(point.temperature),
                };
                heat - self.volume[i] * data.isentrope_heat(point.volume_ratio)
            })
            .sum()
    }

    fn momentum(&self) -> Vector3 {
        let mut sum = self.retired().momentum;
        for i in 0..self.motion.len() {
            for k in 0..D {
                sum[k] += self.inertia(i) * self.motion[i].velocity()[k];
            }
        }
        sum
    }

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
        self.account.interval_start = self.time;
        self.account.tool_impulse = [0.0; 3];
        self.account.reaction_impulse = [0.0; 3];
        Sample { values }
    }

    fn sample_motion(&self, setup: &Setup, set: &mut impl FnMut(ChannelId, f64)) {
        let along = |a: &Vector3, b: &Vector3| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let interval = self.time - self.account.interval_start;
        let rate = if interval > 0.0 { 1.0 / interval } else { 0.0 };
        let force = self.account.tool_impulse.map(|impulse| impulse * rate);
        let reaction = self.account.reaction_impulse.map(|impulse| impulse * rate);
        let momentum = self.momentum();
        let frame = &setup.frame;
        let travel = self
            .tool
            .as_ref()
            .map_or(0.0, |tool| along(&tool.displacement(self.time), &frame.cutting));
        set(ChannelId::Time, self.time);
        set(ChannelId::Travel, travel);
        if let Some(tool) = self.tool.as_ref().filter(|tool| tool.holder.acts()) {
            let off = tool.holder.displacement(self.time);
            set(ChannelId::ToolOffsetCutting, along(&off, &frame.cutting));
            set(ChannelId::ToolOffsetFeed, along(&off, &frame.feed));
        }
        set(ChannelId::CuttingForce, along(&force, &frame.cutting));
        set(ChannelId::FeedForce, along(&force, &frame.feed));
        set(ChannelId::PassiveForce, along(&force, &frame.passive));
        set(ChannelId::ReactionCutting, along(&reaction, &frame.cutting));
        set(ChannelId::ReactionFeed, along(&reaction, &frame.feed));
        set(ChannelId::MomentumCutting, along(&momentum, &frame.cutting));
        set(ChannelId::MomentumFeed, along(&momentum, &frame.feed));
        set(ChannelId::TimeStep, self.time_step);
    }

    fn sample_energies(&self, set: &mut impl FnMut(ChannelId, f64)) {
        let account = &self.account;
        let (kinetic, elastic) = (self.kinetic_energy(), self.elastic_energy());
        let contact = account.contact + self.stranger_energy();
        let crowding = self.crowding_energy();
        let numerical = account.hourglass
            + account.viscosity
            + account.density_diffusion
            + crowding
            + account.residue
            + contact;
        let supplied = account.initial_energy + account.tool_work + account.support_work;
        let found = kinetic
            + elastic
            + account.plastic
            + account.friction
            + account.thermoelastic
            + self.retired().energy
            + numerical;
        set(ChannelId::ToolWork, account.tool_work);
        set(ChannelId::SupportWork, account.support_work);
        set(ChannelId::KineticEnergy, kinetic);
        set(ChannelId::ElasticEnergy, elastic);
        set(ChannelId::PlasticWork, account.plastic);
        set(ChannelId::FrictionWork, account.friction);
        set(ChannelId::ContactEnergy, contact);
        set(ChannelId::HourglassWork, account.hourglass);
        set(ChannelId::ViscosityWork, account.viscosity);
        set(ChannelId::DensityDiffusionWork, account.density_diffusion);
        set(ChannelId::ArtificialStressWork, crowding);
        set(ChannelId::UpdateResidue, account.residue);
        set(ChannelId::ThermoelasticWork, account.thermoelastic);
        set(ChannelId::RetiredEnergy, self.retired().energy);
        set(ChannelId::EnergyError, supplied - found);
        let heat = self.heat_content() + self.retired().heat;
        set(ChannelId::HeatContent, heat - account.initial_heat);
        set(ChannelId::HeatSupplied, account.heat_supplied);
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
            self.point
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
        let count = self.point.len();
        let fewest = (0..count).map(|i| self.list.count(i)).min().unwrap_or(0);
        set(ChannelId::Particles, count as f64);
        set(ChannelId::MeanNeighbours, self.list.pairs() as f64 / count as f64);
        set(ChannelId::MinNeighbours, f64::from(fewest));
        if let Some(tool) = &self.tool {
            let touches = &tool.touches;
            let (mut force, mut heat) = (0.0, 0.0);
            for touch in touches {
                let size = touch.pressure * touch.area;
                force += size;
                heat += size * self.point[touch.particle as usize].temperature;
            }
            set(ChannelId::ContactCount, touches.len() as f64);
            set(ChannelId::ContactLength, touches.iter().map(|touch| touch.area).sum());
            set(ChannelId::InterfaceTemperature, if force > 0.0 { heat / force } else { 0.0 });
        }
    }

    /// The particles now, by identifier.
    pub(crate) fn snapshot(&self, setup: &Setup) -> Snapshot {
        let count = self.id.len();
        // With a moving window the start shows what waits, too: it is where everything comes from.
        let waiting = self.window.iter().filter(|_| self.step == 0).flat_map(|w| &w.reserve);
        let mut order: Vec<(u64, Shown<'_, D>)> = waiting
            .map(|rest| (rest.id, Shown::Waiting(rest)))
            .chain((0..count).map(|i| (self.id[i], Shown::Followed(i))))
            .collect();
        order.sort_by_key(|(id, _)| *id);
        let feed = reduced(&setup.frame.feed);
        let mut contact = vec![[0.0; 3]; count];
        let mut friction_use = vec![0.0; count];
        let mut shear_friction = vec![0.0; count];
        let mut area = vec![0.0; count];
        for touch in self.tool.iter().flat_map(|tool| &tool.touches) {
            let particle = touch.particle as usize;
            contact[particle] = extended(&std::array::from_fn::<f64, D, _>(|k| {
                touch.normal_force[k] + touch.friction_force[k]
            }));
            friction_use[particle] = touch.friction_use;
            shear_friction[particle] = touch.shear_friction_factor;
            area[particle] = touch.area;
        }
        let mut snapshot = Snapshot {
            time: self.time,
            step: self.step,
            dimension: D,
            particle_spacing: self.spacing,
            tool: self.tool_outline(setup),
            ..Snapshot::default()
        };
        if let Some(heat) = &self.tool_heat {
            let shift = self.tool.as_ref().map_or([0.0; 3], |tool| tool.displacement(self.time));
            (snapshot.tool_nodes, snapshot.tool_elements, snapshot.tool_temperature) =
                heat.picture(shift);
        }
        for (_, shown) in order {
            let i = match shown {
                Shown::Followed(i) => i,
                Shown::Waiting(rest) => {
                    self.show_waiting(rest, &feed, &mut snapshot);
                    continue;
                }
            };
            let (point, data) = (&self.point[i], &self.materials[self.material[i] as usize]);
            let pressure =
                point.pressure(&data.elasticity) + point.viscous_pressure / point.volume_ratio;
            snapshot.id.push(self.id[i]);
            snapshot.body.push(self.body[i]);
            snapshot.position.push(extended(&self.position[i]));
            snapshot.velocity.push(extended(self.motion[i].velocity()));
            snapshot.stress.push(cauchy(&point.deviator, point.volume_ratio, pressure));
            let square = MaterialPoint::<D>::deviator_square(&point.deviator);
            snapshot.von_mises_stress.push((1.5 * square).sqrt() / point.volume_ratio);
            snapshot.pressure.push(pressure);
            snapshot.density.push(data.density / point.volume_ratio);
            snapshot.plastic_strain.push(point.plastic_strain);
            snapshot.plastic_strain_rate.push(point.plastic_strain_rate);
            snapshot.temperature.push(point.temperature);
            snapshot.contact_force.push(contact[i]);
            snapshot.friction_use.push(friction_use[i]);
            snapshot.shear_friction_factor.push(shear_friction[i]);
            snapshot.contact_area.push(area[i]);
            snapshot.half_thickness.push(self.half_thickness(i, &feed));
            snapshot.neighbours.push(self.list.count(i));
        }
        snapshot
    }

    /// Adds a particle that the moving window has not reached.
    fn show_waiting(&self, rest: &Rest<D>, feed: &Vector<D>, snapshot: &mut Snapshot) {
        let data = &self.materials[rest.material as usize];
        let point = MaterialPoint::<D>::at_rest(rest.temperature);
        snapshot.id.push(rest.id);
        snapshot.body.push(rest.body);
        snapshot.position.push(extended(&rest.position));
        snapshot.velocity.push(extended(&rest.velocity));
        snapshot.stress.push([0.0; 6]);
        snapshot.von_mises_stress.push(0.0);
        snapshot.pressure.push(0.0);
        snapshot.density.push(data.density / point.volume_ratio);
        snapshot.plastic_strain.push(0.0);
        snapshot.plastic_strain_rate.push(0.0);
        snapshot.temperature.push(rest.temperature);
        snapshot.contact_force.push([0.0; 3]);
        snapshot.friction_use.push(0.0);
        snapshot.shear_friction_factor.push(0.0);
        snapshot.contact_area.push(0.0);
        let cell = &self.cells_of_bodies[rest.body as usize];
        snapshot.half_thickness.push(cell.half_thickness(feed));
        snapshot.neighbours.push(0);
    }

    fn tool_outline(&self, setup: &Setup) -> Vec<Vector3> {
        let Some(tool) = &setup.tool else { return Vec::new() };
        let shift = self.tool.as_ref().map_or([0.0; 3], |tool| tool.displacement(self.time));
        let moved = |x: &Vector3| [x[0] + shift[0], x[1] + shift[1], x[2] + shift[2]];
        match &tool.surface {
            ToolSurface::Polygon(corners) => {
                corners.iter().map(|c| moved(&[c[0], c[1], 0.0])).collect()
            }
            ToolSurface::Triangles { vertices, triangles } => {
                triangles.iter().flatten().map(|&vertex| moved(&vertices[vertex])).collect()
            }
            ToolSurface::HalfSpace { .. } => Vec::new(),
        }
    }

    /// Everything that [`Engine::restore`] needs.
    pub(crate) fn checkpoint(&self) -> CheckpointState {
        let mut state = CheckpointState::default();
        let mut real = |name: &str, values: Vec<f64>| state.reals.push((name.to_owned(), values));
        real("position", flat(&self.position));
        real("origin", flat(&self.origin));
        real("velocity", self.motion.iter().flat_map(|motion| *motion.velocity()).collect());
        real("reference", self.motion.iter().flat_map(|motion| *motion.reference()).collect());
        real("force", flat(&self.force));
        if !self.shape.is_empty() {
            real("support_shape", self.shape.iter().flatten().flatten().copied().collect());
        }
        real("volume", self.volume.clone());
        real("reference_volume_ratio", self.frame.iter().map(|f| f.volume_ratio).collect());
        real("point", self.point.iter().flat_map(point_to_vec).collect());
        if !self.history.is_empty() {
            real("history", self.history.iter().copied().flat_map(History::to_vec).collect());
        }
        real("account", self.account.to_array().to_vec());
        real(
            "clock",
            vec![
                self.time,
                self.time_step,
                self.refresh_time,
                self.conduction_pending,
                self.conduction_interval,
                self.lattice_gradient,
                self.since_refresh.strain,
                self.support_reach,
            ],
        );
        real("displacements", [self.since_refresh.low, self.since_refresh.high].concat());
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
        let window = self.window_state();
        if let Some((books, _)) = &window {
            real("window", books.clone());
        }
        real("friction_use", touches.iter().map(|t| t.friction_use).collect());
        let surface =
            touches.iter().flat_map(|t| [t.area, t.pressure, t.shear_friction_factor]).collect();
        real("contact_surface", surface);
        let mut integer =
            |name: &str, values: Vec<u64>| state.integers.push((name.to_owned(), values));
        integer("id", self.id.clone());
        integer("body", self.body.iter().map(|&b| u64::from(b)).collect());
        integer("material", self.material.iter().map(|&m| u64::from(m)).collect());
        integer("hold", self.hold.iter().map(|&h| u64::from(h)).collect());
        integer("touched", touches.iter().map(|t| u64::from(t.particle)).collect());
        if let Some((_, waiting)) = window {
            integer("waiting", waiting);
        }
        integer("step", vec![self.step]);
        state
    }

    /// The engine of `setup` in the state stored.
    pub(crate) fn restore(setup: &Setup, state: &CheckpointState) -> Result<Self, SetupError> {
        let fresh = Self::new(setup)?;
        let mut engine = fresh;
        let mut count = engine.id.len();
        if engine.window.is_some() {
            let waiting = state.integer("waiting").ok_or_else(|| missing("waiting"))?;
            let waiting = waiting.first().ok_or_else(|| missing("waiting"))?;
            engine
                .restore_window(state.real("window").ok_or_else(|| missing("window"))?, *waiting)?;
            count = state.integer("id").ok_or_else(|| missing("id"))?.len();
        }
        let reader = Reader { state, count };
        engine.position = reader.vectors("position")?;
        engine.size_arrays();
        engine.origin = reader.vectors("origin")?;
        let velocities = reader.vectors("velocity")?;
        let references = reader.vectors("reference")?;
        engine.motion = velocities
            .into_iter()
            .zip(references)
            .map(|(velocity, reference)| Motion::new(reference, velocity))
            .collect();
        engine.force = reader.vectors("force")?;
        if !engine.shape.is_empty() {
            let rows = reader.reals("support_shape", count * D * D)?.chunks_exact(D * D);
            engine.shape = rows
                .map(|m| std::array::from_fn(|r| std::array::from_fn(|c| m[r * D + c])))
                .collect();
        }
        engine.volume = reader.reals("volume", count)?.to_vec();
        let ratios = reader.reals("reference_volume_ratio", count)?;
        for (frame, ratio) in engine.frame.iter_mut().zip(ratios) {
            frame.volume_ratio = *ratio;
        }
        let width = point_to_vec(&engine.point[0]).len();
        let points = reader.reals("point", count * width)?;
        engine.point = points.chunks_exact(width).map(point_from_slice).collect();
        if !engine.history.is_empty() {
            let width = engine.history[0].to_vec().len();
            let histories = reader.reals("history", count * width)?;
            engine.history = histories.chunks_exact(width).map(History::from_slice).collect();
        }
        let account = reader.reals("account", 20)?;
        engine.account = Account::from_array(account.try_into().expect("length was checked"));
        engine.id = reader.integers("id")?.to_vec();
        engine.body = narrow(reader.integers("body")?)?;
        engine.material = narrow(reader.integers("material")?)?;
        engine.hold = narrow(reader.integers("hold")?)?;
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
        self.time = clock[0];
        self.refresh_time = clock[2];
        self.lattice_gradient = clock[5];
        self.support_reach = clock[7];
        let holder = self.tool.as_ref().map_or(0, |tool| tool.holder.size());
        let held = if holder > 0 { reader.reals("tool_holder", holder)? } else { &[] };
        if let Some(tool) = &mut self.tool {
            tool.holder.set_reference(held);
        }
        let reference: Vec<Vector<D>> =
            self.motion.iter().map(|motion| *motion.reference()).collect();
        let mut cells = Cells::default();
        // The particles are stored in cell order already: their order stays.
        cells.lay(&reference, self.support_reach);
        self.rebuild(&cells, &reference);
        if let Some(tool) = &mut self.tool {
            tool.holder.set(held);
        }
        self.time_step = clock[1];
        self.conduction_pending = clock[3];
        self.conduction_interval = clock[4];
        self.since_refresh.strain = clock[6];
        self.since_refresh.low.copy_from_slice(&displacements[..3]);
        self.since_refresh.high.copy_from_slice(&displacements[3..]);
        self.step = *reader
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
        self.lay_surface_points();
        Ok(())
    }
}

/// What a snapshot shows.
enum Shown<'a, const D: usize> {
    /// The particle at this place of the arrays.
    Followed(usize),
    /// One that the moving window has not reached.
    Waiting(&'a Rest<D>),
}

/// Cauchy stress xx, yy, zz, xy, yz, xz; in the plane zz closes the deviator's trace.
fn cauchy<const D: usize>(deviator: &Matrix<D>, volume_ratio: f64, pressure: f64) -> [f64; 6] {
    let at = |row: usize, column: usize| {
        if row < D && column < D { deviator[row][column] / volume_ratio } else { 0.0 }
    };
    let out = if D == 2 { -at(0, 0) - at(1, 1) } else { at(2, 2) };
    [at(0, 0) - pressure, at(1, 1) - pressure, out - pressure, at(0, 1), at(1, 2), at(0, 2)]
}

fn flat<const D: usize>(vectors: &[Vector<D>]) -> Vec<f64> {
    vectors.iter().flatten().copied().collect()
}

fn point_to_vec<const D: usize>(point: &MaterialPoint<D>) -> Vec<f64> {
    let mut values: Vec<f64> = point.deviator.iter().flatten().copied().collect();
    values.extend(point.deformation.iter().flatten());
    values.extend([
        point.volume_ratio,
        point.plastic_strain,
        point.plastic_strain_rate,
        point.temperature,
        point.flow_stress,
        point.viscous_pressure,
    ]);
    values.extend(point.offset);
    values.extend([point.stiffness, point.half_thickness]);
    values
}

fn point_from_slice<const D: usize>(values: &[f64]) -> MaterialPoint<D> {
    let square = D * D;
    let matrix = |from: usize| -> Matrix<D> {
        std::array::from_fn(|row| std::array::from_fn(|column| values[from + row * D + column]))
    };
    let rest = &values[2 * square..];
    MaterialPoint {
        deviator: matrix(0),
        deformation: matrix(square),
        volume_ratio: rest[0],
        plastic_strain: rest[1],
        plastic_strain_rate: rest[2],
        temperature: rest[3],
        flow_stress: rest[4],
        viscous_pressure: rest[5],
        offset: std::array::from_fn(|k| rest[6 + k]),
        stiffness: rest[6 + D],
        half_thickness: rest[7 + D],
        limit_temperature: f64::NAN,
    }
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
