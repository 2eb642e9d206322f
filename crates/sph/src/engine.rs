//! The solver in `D` dimensions: one step is the method, one call per equation.
//!
//! Momentum and velocity gradient are a work-conjugate pair: with the weights
//! `w_ij = -W'(r_ij)/r_ij V_j` and separations `X_ij = X_j - X_i` of the
//! reference configuration (renewed every few per cent of strain),
//! ```text
//! F_dot_i = sum_j w_ij (v_j - v_i) (x) X_ij B_i,    B_i = (sum_j w_ij X_ij (x) X_ij)^-1
//! f_i     = V_i sum_j w_ij (P_i B_i + P_j B_j) X_ij
//! ```
//! so that internal power is `sum_i V_i P_i : F_dot_i` exactly, linear fields
//! are differentiated exactly, and momentum and angular momentum are kept to
//! rounding. What the affine fit does not see (hourglass motion,
//! `d_ij = v_j - v_i - F_dot_i X_ij`) is damped by the potential
//! `1/2 sum_i eta_i V_i sum_j w_ij |d_ij|^2`; because `F_dot_i` is the
//! least-squares fit with the same weights, its force needs no second sweep and
//! keeps both momenta. `docs/theory.md` derives all of it.

use crate::contact::surface_point::LatticeCell;
use crate::contact::tool_holder::ToolHolder;
use crate::contact::{ToolContact, reduced};
use crate::error::{Diverged, SetupError};
use crate::heat::tool::in_tool;
use crate::material::equation_of_state::Elasticity;
use crate::material::history::{History, Memory};
use crate::material::point::MaterialPoint;
use crate::material::thermoelasticity;
use crate::operators::neighbours::{CHUNK, Cells, NeighbourList, Smoothing};
use crate::output::account::{Account, Tally};
use crate::particles::motion::Motion;
use crate::particles::supports::{FREE, Hold};
use crate::particles::window::{self, Rest, Window};
use crate::setup::{CuttingFrame, HeatSource, Setup, Tool};
use crate::stage::Stage;
use crate::tensor::{Matrix, Vector, dot, identity, plus_scaled, zero};
use rayon::prelude::*;
use sphcut_physics::TemperatureTable;
use sphcut_physics::effects::{HeatShare, heat_share, with_effects};
use sphcut_physics::flow_stress::FlowStressModel;
use sphcut_tool_heat::HeatedTool;

/// A slower motion in m/s is none. In front of a wave velocities fall without end, and numbers below 1e-308, as their
/// squares are from 1e-154 on, take a processor a hundred times as long as others.
const STILL: f64 = 1e-100;

/// Constants of one material.
#[derive(Debug)]
pub(crate) struct MaterialData {
    pub(crate) density: f64,
    pub(crate) elasticity: Elasticity,
    pub(crate) specific_heat: f64,
    pub(crate) conductivity: f64,
    /// E(T) over E at room temperature; `None` for a constant, as with the others.
    pub(crate) stiffness_table: Option<TemperatureTable>,
    pub(crate) heat_table: Option<TemperatureTable>,
    pub(crate) conductivity_table: Option<TemperatureTable>,
    pub(crate) law: Box<dyn FlowStressModel>,
    /// beta / (rho_0 cp), 0 without plastic heating; `heat_share` takes its place.
    pub(crate) constant_heating: f64,
    /// beta where an effect makes it depend on strain and rate.
    pub(crate) heat_share: Option<Box<dyn HeatShare>>,
    pub(crate) memory: Memory,
    pub(crate) hourglass: f64,
    /// kappa G in Pa.
    pub(crate) hourglass_stiffness: f64,
    pub(crate) linear_viscosity: f64,
    pub(crate) quadratic_viscosity: f64,
    pub(crate) wave_speed: f64,
}

/// The discrete operators of one particle in the reference configuration.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame<const D: usize> {
    /// B.
    pub(crate) correction: Matrix<D>,
    /// c = sum_j w_ij X_ij.
    pub(crate) moment: Vector<D>,
    /// q = B c.
    pub(crate) lean: Vector<D>,
    /// s = sum_j w_ij in 1/m^2.
    pub(crate) weight: f64,
    /// V / V_0 of the reference.
    pub(crate) volume_ratio: f64,
}

/// Values of the numerical options, read once.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Numerics {
    pub(crate) courant: f64,
    pub(crate) refresh_strain: f64,
    pub(crate) yield_fraction: f64,
    pub(crate) mass_scaling: f64,
    pub(crate) density_diffusion: f64,
    pub(crate) residual_density_diffusion: f64,
    pub(crate) bonding_distance: f64,
    pub(crate) support_stretch: f64,
    /// In particle spacings.
    pub(crate) core_distance: f64,
}

/// The particles and all that moves them.
#[derive(Debug)]
pub(crate) struct Engine<const D: usize> {
    // Per particle, in storage order.
    pub(crate) id: Vec<u64>,
    pub(crate) body: Vec<u32>,
    pub(crate) material: Vec<u8>,
    pub(crate) hold: Vec<u8>,
    pub(crate) position: Vec<Vector<D>>,
    /// Position in the undeformed state.
    pub(crate) origin: Vec<Vector<D>>,
    pub(crate) motion: Vec<Motion<D>>,
    /// Shape H of each support, see `support_shape.rs`; empty while supports are round.
    pub(crate) shape: Vec<Matrix<D>>,
    /// Volume in the undeformed state in m^3 (m^2).
    pub(crate) volume: Vec<f64>,
    pub(crate) point: Vec<MaterialPoint<D>>,
    /// What effects with memory know of each particle; empty without such effects.
    pub(crate) history: Vec<History<D>>,
    /// Total force except the reaction of supports.
    pub(crate) force: Vec<Vector<D>>,
    pub(crate) frame: Vec<Frame<D>>,
    /// What a neighbour needs to know of a particle in the force sweep ([`crate::operators::sweeps`]).
    pub(crate) exchange: Vec<f64>,
    pub(crate) reference_volume: Vec<f64>,
    pub(crate) list: NeighbourList,
    /// Room for renewals, kept from one to the next: the cells, marks and new places of the particles.
    pub(crate) cells: Cells<D>,
    pub(crate) marks: Vec<bool>,
    pub(crate) new_place: Vec<u32>,
    pub(crate) tallies: Vec<Tally>,
    /// Pairs that may touch without belonging together.
    pub(crate) strangers: Vec<(u32, u32)>,
    /// Neighbours that may come too close before the next renewal.
    pub(crate) crowded: Vec<(u32, u32)>,
    /// Penalty stiffness between strangers in N/m (N/m^2 in 2D).
    pub(crate) stranger_stiffness: f64,
    /// Whether different bodies are one continuum.
    pub(crate) bonded: bool,
    // The whole.
    /// Directions of cut, feed and edge as rows, where they are not the axes: what triggers a renewal is
    /// measured along them, so that a rotated scenario renews at the same times.
    pub(crate) tilted_axes: Option<Matrix<D>>,
    pub(crate) materials: Vec<MaterialData>,
    pub(crate) holds: Vec<Hold<D>>,
    /// What comes and goes while the tool moves on; `None`: everything is followed from start to end.
    pub(crate) window: Option<Window<D>>,
    pub(crate) tool: Option<ToolContact<D>>,
    /// Cells of the lattice, by body.
    pub(crate) cells_of_bodies: Vec<LatticeCell<D>>,
    /// Heat in the tool, where it is asked for.
    pub(crate) tool_heat: Option<HeatedTool>,
    pub(crate) heat_sources: Vec<HeatSource>,
    pub(crate) account: Account,
    pub(crate) time: f64,
    pub(crate) step: u64,
    pub(crate) time_step: f64,
    pub(crate) refresh_time: f64,
    /// Strain and displacements since the last refresh.
    pub(crate) since_refresh: Tally,
    /// Time since the last conduction step in s.
    pub(crate) conduction_pending: f64,
    /// S of the particles ([`crate::operators::laplacian`]); empty until a conduction step needs it.
    pub(crate) conduction_tensor: Vec<Matrix<D>>,
    /// Length of a conduction step in s.
    pub(crate) conduction_interval: f64,
    pub(crate) mechanics: bool,
    pub(crate) numerics: Numerics,
    pub(crate) smoothing: Smoothing,
    /// Largest distance of neighbours in m.
    pub(crate) support_reach: f64,
    pub(crate) spacing: f64,
    pub(crate) contact_stiffness: f64,
    /// Largest p-wave modulus of the materials in Pa.
    pub(crate) stiffest: f64,
    pub(crate) friction_heat_share: f64,
    pub(crate) friction_heats: bool,
    pub(crate) conducts: bool,
    /// Largest sum_j w_ij in 1/m^2.
    pub(crate) largest_weight: f64,
    /// Upper limit of a time step without mechanics in s.
    pub(crate) longest_step: f64,
    /// Largest sum_j |w_ij B_i X_ij| at the start: unit of the time step; 0 until known.
    pub(crate) lattice_gradient: f64,
}

impl MaterialData {
    /// Density with scaled inertia, (K + 4G/3) / c^2, in kg/m^3.
    pub(crate) fn inertial_density(&self) -> f64 {
        let moduli = self.elasticity.moduli.scaled(self.stiffest());
        (moduli.bulk + 4.0 / 3.0 * moduli.shear) / (self.wave_speed * self.wave_speed)
    }

    /// beta at a state, or 0 without plastic heating.
    #[inline]
    pub(crate) fn heating_share<const D: usize>(&self, point: &MaterialPoint<D>) -> f64 {
        self.heating(point) * self.density * self.specific_heat
    }

    /// beta / (rho_0 cp) at a state, with cp at room temperature.
    #[inline]
    pub(crate) fn heating<const D: usize>(&self, point: &MaterialPoint<D>) -> f64 {
        match &self.heat_share {
            None => self.constant_heating,
            Some(law) => {
                let share = law.share(point.plastic_strain, point.plastic_strain_rate);
                share / (self.density * self.specific_heat)
            }
        }
    }
}

impl<const D: usize> Engine<D> {
    /// Fills the bodies and prepares the first step.
    pub(crate) fn new(setup: &Setup) -> Result<Self, SetupError> {
        let mut engine = Self::without_particles(setup)?;
        let seeds = crate::particles::lattice::fill(setup)?.into_iter().enumerate();
        let all: Vec<Rest<D>> = seeds.map(|(id, seed)| engine.rest(setup, id, &seed)).collect();
        if setup.window.is_some() {
            engine.holds = window::with_resting(engine.holds);
            engine.window = Window::of(setup, all, engine.support_reach);
            engine.move_window();
        } else {
            all.iter().for_each(|rest| engine.follow(rest));
            engine.size_arrays();
        }
        if let Some(tool) = &engine.tool {
            tool.check_start(&engine)?;
        }
        engine.refresh();
        engine.account.initial_energy = engine.kinetic_energy() + engine.elastic_energy();
        engine.account.initial_heat = engine.heat_content();
        engine.sweep_gradients(0.0);
        engine.sweep_forces();
        engine.push_strangers_apart();
        engine.push_crowded_apart();
        engine.touch_tool();
        Ok(engine)
    }

    fn without_particles(setup: &Setup) -> Result<Self, SetupError> {
        let numerics = Numerics {
            courant: setup.numerics.get("courant"),
            refresh_strain: setup.numerics.get("refresh_strain"),
            yield_fraction: setup.numerics.get("hourglass_yield_fraction"),
            mass_scaling: setup.numerics.get("mass_scaling"),
            density_diffusion: setup.numerics.get("density_diffusion"),
            residual_density_diffusion: setup.numerics.get("residual_density_diffusion"),
            bonding_distance: setup.numerics.get("bonding_distance"),
            support_stretch: setup.numerics.get("support_stretch"),
            core_distance: setup.numerics.get("core_distance"),
        };
        let length = setup.numerics.get("smoothing_ratio") * setup.particle_spacing;
        let materials = material_data(setup, length);
        let stiffest = setup
            .materials
            .iter()
            .map(|m| m.moduli.bulk + 4.0 / 3.0 * m.moduli.shear)
            .fold(0.0, f64::max);
        let contact_stiffness = setup.contact.get("stiffness");
        let tool = setup
            .tool
            .as_ref()
            .map(|tool| ToolContact::new(tool, setup.particle_spacing, stiffest, contact_stiffness))
            .transpose()?
            .map(|tool| tool.held_by(ToolHolder::of(setup)));
        let tool_heat = match (&setup.tool, &tool) {
            (Some(Tool { surface, heat: Some(heat), .. }), Some(tool)) => {
                Some(HeatedTool::new(surface, heat, &tool.path_speeds(), setup.particle_spacing)?)
            }
            _ => None,
        };
        Ok(Self {
            id: Vec::new(),
            body: Vec::new(),
            material: Vec::new(),
            hold: Vec::new(),
            position: Vec::new(),
            origin: Vec::new(),
            motion: Vec::new(),
            shape: Vec::new(),
            volume: Vec::new(),
            point: Vec::new(),
            history: Vec::new(),
            force: Vec::new(),
            frame: Vec::new(),
            exchange: Vec::new(),
            reference_volume: Vec::new(),
            list: NeighbourList::default(),
            cells: Cells::default(),
            marks: Vec::new(),
            new_place: Vec::new(),
            tallies: Vec::new(),
            strangers: Vec::new(),
            crowded: Vec::new(),
            stranger_stiffness: contact_stiffness
                * stiffest
                * setup.particle_spacing.powi(D as i32 - 2),
            bonded: setup.bonded.is_on(),
            tilted_axes: tilted_axes(&setup.frame),
            materials,
            holds: Hold::all(setup),
            window: None,
            tool,
            cells_of_bodies: LatticeCell::all(setup),
            tool_heat,
            heat_sources: setup.heat_sources.clone(),
            account: Account::default(),
            time: 0.0,
            step: 0,
            time_step: 0.0,
            refresh_time: 0.0,
            since_refresh: Tally::default(),
            conduction_pending: 0.0,
            conduction_tensor: Vec::new(),
            conduction_interval: f64::INFINITY,
            mechanics: setup.mechanics.is_on(),
            numerics,
            smoothing: Smoothing { kernel: setup.discretisation.kernel, length },
            support_reach: 2.0 * length,
            spacing: setup.particle_spacing,
            contact_stiffness,
            stiffest,
            friction_heat_share: setup.heat.values.get("friction_heat_share"),
            friction_heats: setup.heat.friction_heating.is_on(),
            conducts: setup.heat.conduction.is_on(),
            longest_step: setup.sampling_interval,
            largest_weight: 0.0,
            lattice_gradient: 0.0,
        })
    }

    /// Gives every particle its place in all arrays; new places are those of the undeformed state.
    pub(crate) fn size_arrays(&mut self) {
        let count = self.position.len();
        let frame = Frame {
            correction: zero(),
            moment: [0.0; D],
            lean: [0.0; D],
            weight: 0.0,
            volume_ratio: 1.0,
        };
        if self.numerics.support_stretch > 1.0 {
            self.shape.resize(count, identity());
        }
        if self.materials.iter().any(|data| data.memory.is_needed()) {
            self.history.resize(count, History::default());
        }
        self.force.resize(count, [0.0; D]);
        self.frame.resize(count, frame);
        self.exchange.resize(count * crate::operators::sweeps::exchange_width::<D>(), 0.0);
        self.reference_volume.resize(count, 0.0);
        self.tallies.resize(count.div_ceil(CHUNK), Tally::default());
    }

    /// One step, kick-drift-kick; tells `passed` which stage has just ended.
    pub(crate) fn advance(&mut self, passed: &mut dyn FnMut(Stage)) -> Result<(), Diverged> {
        let dt = self.time_step;
        self.step += 1;
        if !self.mechanics {
            self.time += dt;
            self.rest_on_tool(dt);
            self.conduct_when_due(dt);
            self.heat_tool_when_due(dt);
            passed(Stage::Diffusion);
            return Ok(());
        }
        if let Some(tool) = &mut self.tool {
            tool.begin_step(self.time, dt);
        }
        self.kick_and_drift(0.5 * dt, dt);
        self.book_contact(0.5 * dt);
        passed(Stage::Motion);
        self.sweep_gradients(dt);
        self.close_tallies()?;
        passed(Stage::Gradients);
        self.sweep_forces();
        passed(Stage::Forces);
        self.push_strangers_apart();
        self.push_crowded_apart();
        self.touch_tool();
        self.book_contact(0.5 * dt);
        if let Some(tool) = &mut self.tool {
            tool.end_step(dt);
        }
        passed(Stage::Contact);
        self.kick_and_drift(0.5 * dt, 0.0);
        passed(Stage::Motion);
        self.diffuse_density_when_due(dt);
        self.renew_strain_gradients_when_due();
        self.conduct_when_due(dt);
        self.heat_tool_when_due(dt);
        passed(Stage::Diffusion);
        if self.refresh_is_due() {
            self.move_window();
            self.refresh();
            self.sweep_gradients(0.0);
            self.sweep_forces();
            self.push_strangers_apart();
            self.push_crowded_apart();
            self.lay_surface_points();
            self.add_contact_forces();
            passed(Stage::Renewal);
        }
        Ok(())
    }

    /// Memory of the arrays in bytes.
    pub(crate) fn memory(&self) -> usize {
        let each = size_of::<u64>()
            + size_of::<u32>()
            + 2
            + 5 * size_of::<Vector<D>>()
            + 2 * size_of::<f64>()
            + size_of::<MaterialPoint<D>>()
            + size_of::<Frame<D>>()
            + size_of::<f64>() * crate::operators::sweeps::exchange_width::<D>();
        let tool = self.tool_heat.as_ref().map_or(0, HeatedTool::memory);
        tool + self.id.len() * each
            + self.shape.len() * size_of::<Matrix<D>>()
            + self.history.len() * size_of::<History<D>>()
            + self.list.memory()
            + self.cells.memory()
            + self.conduction_tensor.capacity() * size_of::<Matrix<D>>()
            + self.marks.capacity()
            + self.new_place.capacity() * size_of::<u32>()
    }

    /// Inertia of a particle in kg (kg/m).
    pub(crate) fn inertia(&self, i: usize) -> f64 {
        self.numerics.mass_scaling * self.mass(i)
    }

    /// Mass of a particle in kg (kg/m).
    pub(crate) fn mass(&self, i: usize) -> f64 {
        self.materials[self.material[i] as usize].density * self.volume[i]
    }

    /// v += a dt, then x += v `drift` and the clock; supports prescribe their components of the
    /// velocity and book their reaction.
    fn kick_and_drift(&mut self, kick: f64, drift: f64) {
        let (materials, scaling, holds) =
            (&self.materials, self.numerics.mass_scaling, &self.holds);
        self.motion
            .par_chunks_mut(CHUNK)
            .zip(self.position.par_chunks_mut(CHUNK))
            .zip(self.force.par_chunks(CHUNK))
            .zip(self.material.par_chunks(CHUNK))
            .zip(self.hold.par_chunks(CHUNK))
            .zip(self.volume.par_chunks(CHUNK))
            .for_each(|(((((motion, position), force), material), hold), volume)| {
                for (k, motion) in motion.iter_mut().enumerate() {
                    let inertia = scaling * materials[material[k] as usize].density * volume[k];
                    let mut velocity = plus_scaled(motion.velocity(), kick / inertia, &force[k])
                        .map(|speed| if speed.abs() < STILL { 0.0 } else { speed });
                    if hold[k] != FREE {
                        velocity = holds[hold[k] as usize].constrained(&velocity);
                    }
                    motion.set_velocity(velocity);
                    if drift > 0.0 {
                        position[k] = plus_scaled(&position[k], drift, &velocity);
                    }
                }
            });
        self.time += drift;
        for i in 0..self.hold.len() {
            if self.hold[i] == FREE {
                continue;
            }
            let reaction = self.holds[self.hold[i] as usize].reaction(&self.force[i]);
            self.account.support_work += kick * dot(&reaction, self.motion[i].velocity());
            for k in 0..D {
                self.account.reaction_impulse[k] += kick * reaction[k];
            }
        }
    }

    /// Contact forces at the present positions for the coming step, added to the internal ones.
    fn touch_tool(&mut self) {
        let Some(mut tool) = self.tool.take() else { return };
        tool.evaluate(self.time, self.time_step, self);
        for (particle, half_thickness) in tool.half_thicknesses() {
            self.point[particle].half_thickness = half_thickness;
        }
        self.tool = Some(tool);
        self.add_contact_forces();
    }

    /// Impulse, tool work and friction of the present contacts over half a step, with the
    /// velocities of the middle of the step; friction heats the particle at once.
    ///
    /// Tool work = work on particles + friction + contact energy, exactly.
    fn book_contact(&mut self, duration: f64) {
        let Some(tool) = &self.tool else { return };
        let tool_velocity: Vector<D> = reduced(&tool.velocity);
        for (place, touch) in tool.touches.iter().enumerate() {
            let i = touch.particle as usize;
            let moving = tool.points.velocity(place, &self.motion);
            let slip = crate::tensor::minus(&tool_velocity, &moving);
            let friction = duration * dot(&touch.friction_force, &slip);
            self.account.friction += friction;
            self.account.contact += duration * dot(&touch.normal_force, &slip);
            for k in 0..D {
                let impulse = duration * (touch.normal_force[k] + touch.friction_force[k]);
                self.account.tool_impulse[k] += impulse;
                self.account.tool_work += impulse * tool_velocity[k];
            }
            let mut rubbed = 0.0;
            if self.friction_heats {
                let data = &self.materials[self.material[i] as usize];
                let heat = self.friction_heat_share * friction;
                self.point[i].temperature =
                    data.heated(self.point[i].temperature, heat, self.volume[i]);
                self.account.heat_supplied += heat;
                rubbed = friction - heat;
            }
            if let Some(heat) = &mut self.tool_heat {
                let place = in_tool(&self.position[i], &tool.displacement(self.time));
                heat.touch_on(touch.area, touch.particle, &place, duration, rubbed);
            }
        }
    }
}

/// The directions of a frame as rows; `None` where they are axes.
fn tilted_axes<const D: usize>(frame: &CuttingFrame) -> Option<Matrix<D>> {
    let directions = [frame.cutting, frame.feed, frame.passive];
    let rows: Matrix<D> = std::array::from_fn(|k| reduced(&directions[k]));
    let is_axis = |row: &Vector<D>| row.iter().all(|x| *x == 0.0 || x.abs() == 1.0);
    (!rows.iter().all(is_axis)).then_some(rows)
}

/// Constants of the materials for a smoothing length.
fn material_data(setup: &Setup, smoothing_length: f64) -> Vec<MaterialData> {
    let option = |key| setup.numerics.get(key);
    let taylor_quinney = setup.heat.values.get("taylor_quinney");
    setup
        .materials
        .iter()
        .map(|material| {
            let elasticity = Elasticity::of(material);
            let (specific_heat, heat_table) = elasticity.heat_capacity(material);
            let stiffness_table = thermoelasticity::stiffness_table(material);
            let stiffest = stiffness_table.as_ref().map_or(1.0, TemperatureTable::max);
            let wave_speed = material
                .moduli
                .scaled(stiffest)
                .p_wave_speed(material.density * option("mass_scaling"));
            let inertial_density = material.density * option("mass_scaling");
            let impedance = inertial_density * wave_speed * smoothing_length;
            let heats = setup.heat.plastic_heating.is_on();
            let constant_heating =
                if heats { taylor_quinney / (material.density * specific_heat) } else { 0.0 };
            MaterialData {
                density: material.density,
                elasticity,
                specific_heat,
                conductivity: material.thermal_conductivity,
                stiffness_table,
                heat_table,
                conductivity_table: thermoelasticity::varying(
                    material.tables.thermal_conductivity.as_ref(),
                ),
                law: with_effects(
                    (material.flow_stress.build)(&material.flow_stress_values),
                    &setup.effects,
                    &setup.effect_context(),
                ),
                constant_heating,
                heat_share: heat_share(&setup.effects).filter(|_| heats),
                memory: Memory::of(setup),
                hourglass: option("hourglass_coefficient") * impedance,
                hourglass_stiffness: option("hourglass_stiffness") * material.moduli.shear,
                linear_viscosity: option("linear_viscosity") * impedance,
                quadratic_viscosity: option("quadratic_viscosity")
                    * inertial_density
                    * smoothing_length
                    * smoothing_length,
                wave_speed,
            }
        })
        .collect()
}
