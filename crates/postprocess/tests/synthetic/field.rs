//! The particles of a cut drawn by hand.

use super::{AMBIENT, INTERFACE_TEMPERATURE, SyntheticCut, uniform};
use sphcut_sph::Snapshot;
use sphcut_sph::setup::Vector;

/// Workpiece, chip and loose particles around the tool of `empty`, in the order of the identifiers.
pub(super) fn drawn(cut: &SyntheticCut, travel: f64, empty: Snapshot) -> Snapshot {
    let mut field = Field { cut, travel, snapshot: empty };
    field.fill_workpiece();
    field.fill_chip();
    field.scatter_loose_particles();
    let mut snapshot = field.snapshot;
    sort(&mut snapshot);
    turn(&mut snapshot, cut.orientation);
    snapshot
}

/// Identifiers of chip and loose particles follow those of the workpiece, far enough apart.
const CHIP: u64 = 1 << 32;
const LOOSE: u64 = 1 << 33;

impl SyntheticCut {
    /// Thickness of the chip `along` the rake face: teeth with two even flanks, valleys at whole multiples
    /// of the pitch.
    fn local_thickness(&self, along: f64) -> f64 {
        if self.tooth_pitch <= 0.0 {
            return f64::INFINITY;
        }
        self.chip_thickness
            - self.tooth_height * (2.0 * (along / self.tooth_pitch).rem_euclid(1.0) - 1.0).abs()
    }
}

/// A snapshot in the making.
struct Field<'a> {
    cut: &'a SyntheticCut,
    travel: f64,
    snapshot: Snapshot,
}

/// State of one particle.
#[derive(Clone, Copy)]
struct State {
    velocity: [f64; 2],
    temperature: f64,
    plastic_strain: f64,
    von_mises_stress: f64,
    contact_force: [f64; 2],
    /// Along the cutting direction; half of it across.
    residual_stress: f64,
    friction_use: f64,
    shear_friction_factor: f64,
    contact_area: f64,
    /// Of the machined surface, or what will be it.
    is_surface: bool,
}

impl Field<'_> {
    fn fill_workpiece(&mut self) {
        let cut = self.cut;
        let spacing = cut.particle_spacing;
        let (columns, rows) =
            ((cut.length / spacing).round() as usize, (cut.height / spacing).round() as usize);
        let tip = [self.travel, -cut.uncut_chip_thickness];
        let slope = cut.shear_angle().tan();
        for column in 0..columns {
            for row in 0..rows {
                let x = (column as f64 + 0.5) * spacing;
                let y = -(row as f64 + 0.5) * spacing;
                let ahead = x - tip[0] > (y - tip[1]) / slope;
                if y > tip[1] && !ahead {
                    continue;
                }
                let offset = [x - tip[0], y - tip[1]];
                let id = (column * rows + row) as u64;
                self.push(id, [x, y + self.rise(offset)], self.workpiece_state(offset));
            }
        }
    }

    /// The springback at a place relative to the tool's tip: full down to the depth of one uncut
    /// chip thickness, none from two on.
    fn rise(&self, offset: [f64; 2]) -> f64 {
        let cut = self.cut;
        let share = (2.0 + offset[1] / cut.uncut_chip_thickness).clamp(0.0, 1.0);
        let recovered = 1.0 - (offset[0].min(0.0) / cut.recovery_length).exp();
        cut.springback * share * recovered
    }

    fn workpiece_state(&self, offset: [f64; 2]) -> State {
        let cut = self.cut;
        let distance = offset[0].hypot(offset[1]);
        let near = (-distance / (0.8 * cut.uncut_chip_thickness)).exp();
        let burnished = if offset[0] < 0.0 {
            (offset[1] / (0.15 * cut.uncut_chip_thickness)).exp()
        } else {
            0.0
        };
        let residual = if offset[0] < 0.0 {
            cut.residual_stress * (offset[1] / cut.residual_depth).exp()
        } else {
            0.0
        };
        // The first row under the land touches it.
        let spacing = cut.particle_spacing;
        let touches =
            (0.0..spacing).contains(&offset[0]) && offset[1] < 0.0 && offset[1] > -spacing;
        State {
            velocity: [0.2 * cut.cutting_speed * near, 0.1 * cut.cutting_speed * near],
            temperature: AMBIENT + 450.0 * near + 200.0 * burnished,
            plastic_strain: 0.8 * near * near + 1.2 * burnished,
            von_mises_stress: 9e8 * near + 2e8 * burnished,
            contact_force: [0.0, if touches { -cut.flank_force } else { 0.0 }],
            residual_stress: residual,
            friction_use: 0.0,
            shear_friction_factor: 0.0,
            contact_area: if touches && cut.flank_force != 0.0 { spacing } else { 0.0 },
            is_surface: offset[1] < 0.0 && offset[1] > -spacing,
        }
    }

    fn fill_chip(&mut self) {
        let cut = self.cut;
        let spacing = cut.particle_spacing;
        let tilt = (cut.shear_angle() - cut.rake_angle).tan();
        let length = self.travel * cut.uncut_chip_thickness / cut.chip_thickness;
        let (across, along_row) = (spacing * cut.chip_stretch, spacing / cut.chip_stretch);
        let layers = (cut.chip_thickness / across).round() as usize;
        let count = (length / along_row).round() as usize;
        for k in 0..count {
            let since = (k as f64 + 0.5) * along_row;
            let place = |layer: usize| {
                let from_rake = (layer as f64 + 0.5) * across;
                (from_rake * tilt + since, from_rake)
            };
            let inside: Vec<usize> = (0..layers)
                .filter(|&layer| {
                    let (along, from_rake) = place(layer);
                    from_rake < cut.local_thickness(along)
                })
                .collect();
            for &layer in &inside {
                let (along, from_rake) = place(layer);
                let deepest = (cut.uncut_chip_thickness / spacing).round() as u64 - 1;
                let id = if Some(&layer) == inside.last() {
                    self.column(since)
                } else if layer == 0 {
                    self.column(since) + deepest
                } else {
                    CHIP + (k * layers + layer) as u64
                };
                self.push(id, self.chip_point(along, from_rake), self.chip_state(along, from_rake));
            }
        }
    }

    /// Identifier of the uppermost particle of the column that now lies `since` above the shear plane,
    /// measured along the chip: the tool has travelled h_ch / h times that since.
    fn column(&self, since: f64) -> u64 {
        let cut = self.cut;
        let rows = (cut.height / cut.particle_spacing).round() as u64;
        let ahead = cut.uncut_chip_thickness / cut.shear_angle().tan();
        let place = self.travel + ahead - since * cut.chip_thickness / cut.uncut_chip_thickness;
        (place / cut.particle_spacing).max(0.0) as u64 * rows
    }

    /// The point `along` the rake face from the tip and `from_rake` away from it.
    fn chip_point(&self, along: f64, from_rake: f64) -> [f64; 2] {
        let (sine, cosine) = self.cut.rake_angle.sin_cos();
        [
            self.travel - sine * along + cosine * from_rake,
            -self.cut.uncut_chip_thickness + cosine * along + sine * from_rake,
        ]
    }

    fn chip_state(&self, along: f64, from_rake: f64) -> State {
        let cut = self.cut;
        let (sine, cosine) = cut.rake_angle.sin_cos();
        let speed = cut.cutting_speed * cut.uncut_chip_thickness / cut.chip_thickness;
        let in_contact = along < cut.contact_length && from_rake < 0.75 * cut.particle_spacing;
        let depth = (from_rake - 0.5 * cut.particle_spacing) / (0.15 * cut.chip_thickness);
        let layer = (-depth.max(0.0)).exp();
        let hot = INTERFACE_TEMPERATURE - 620.0;
        let normal_force = if in_contact { 5e3 } else { 0.0 };
        let sticks = along < cut.sticking_length;
        // Friction of the tool on the chip, down the rake face.
        let friction = if sticks { 0.2 } else { 0.4 } * normal_force;
        let warming = 1.0 + (cut.contact_warming - 1.0) * along / cut.contact_length;
        State {
            velocity: [cut.cutting_speed - sine * speed, cosine * speed],
            temperature: if in_contact {
                AMBIENT + (INTERFACE_TEMPERATURE - AMBIENT) * warming
            } else {
                620.0 + 0.9 * hot * layer
            },
            plastic_strain: 1.6 + 3.0 * layer,
            von_mises_stress: 7.5e8 * (-along / 0.4e-3).exp() + 1e8,
            contact_force: [
                cosine * normal_force + sine * friction,
                sine * normal_force - cosine * friction,
            ],
            residual_stress: 0.0,
            // The first half of the sticking part does not slip, in the second the chip shears inside.
            friction_use: match (in_contact, 2.0 * along < cut.sticking_length) {
                (false, _) => 0.0,
                (true, true) => 0.5,
                (true, false) => 1.0,
            },
            shear_friction_factor: match (in_contact, sticks) {
                (false, _) => 0.0,
                (true, true) => 1.0,
                (true, false) => 0.4,
            },
            contact_area: if in_contact { cut.particle_spacing } else { 0.0 },
            is_surface: false,
        }
    }

    /// Single particles above the workpiece, far from each other.
    fn scatter_loose_particles(&mut self) {
        for k in 0..self.cut.loose_particles {
            let x = 0.1e-3 + 0.21e-3 * k as f64;
            let y = 0.25e-3 + 0.05e-3 * (k % 5) as f64;
            let state = State {
                velocity: [1.0, 2.0],
                temperature: 1500.0,
                plastic_strain: 9.0,
                von_mises_stress: 0.0,
                contact_force: [0.0; 2],
                residual_stress: 0.0,
                friction_use: 0.0,
                shear_friction_factor: 0.0,
                contact_area: 0.0,
                is_surface: false,
            };
            self.push(LOOSE + k as u64, [x, y], state);
        }
    }

    /// Plastic strain rate at a place: a Gaussian across the shear plane, which ends at the edge and
    /// at the uncut surface.
    fn shear_rate(&self, point: [f64; 2]) -> f64 {
        let cut = self.cut;
        let offset = [point[0] - self.travel, point[1] + cut.uncut_chip_thickness];
        let (sine, cosine) = cut.shear_angle().sin_cos();
        let along = offset[0] * cosine + offset[1] * sine;
        if along < 0.0 || along * sine > cut.uncut_chip_thickness {
            return 0.0;
        }
        let away = (offset[0] * sine - offset[1] * cosine) / (0.5 * cut.shear_width);
        cut.shear_rate * (-std::f64::consts::LN_2 * away * away).exp()
    }

    fn push(&mut self, k: u64, point: [f64; 2], state: State) {
        let shear_rate = self.shear_rate(point);
        let snapshot = &mut self.snapshot;
        let shift = |salt: u64| {
            self.cut.disorder * self.cut.particle_spacing * (uniform(2 * k + salt) - 0.5)
        };
        snapshot.id.push(k);
        snapshot.body.push(0);
        snapshot.position.push([point[0] + shift(0), point[1] + shift(1), 0.0]);
        snapshot.velocity.push([state.velocity[0], state.velocity[1], 0.0]);
        let residual = state.residual_stress;
        snapshot.stress.push([residual, 0.0, 0.5 * residual, 0.0, 0.0, 0.0]);
        snapshot.von_mises_stress.push(state.von_mises_stress);
        snapshot.pressure.push(0.5 * state.von_mises_stress);
        snapshot.density.push(7850.0);
        snapshot.plastic_strain.push(state.plastic_strain);
        snapshot.plastic_strain_rate.push(shear_rate);
        snapshot.temperature.push(state.temperature);
        snapshot.contact_force.push([state.contact_force[0], state.contact_force[1], 0.0]);
        snapshot.friction_use.push(state.friction_use);
        snapshot.shear_friction_factor.push(state.shear_friction_factor);
        snapshot.contact_area.push(state.contact_area);
        snapshot.relative_spacing.push(1.0);
        // The material of what has touched the tool reaches its surface, wherever the centre lies.
        let half = 0.5 * self.cut.particle_spacing;
        snapshot.half_thickness.push(if state.is_surface { half - shift(1) } else { half });
        snapshot.neighbours.push(28);
    }
}

/// Puts the particles into the order of their identifiers.
fn sort(snapshot: &mut Snapshot) {
    fn ordered<T: Copy>(values: &mut Vec<T>, order: &[usize]) {
        *values = order.iter().map(|&k| values[k]).collect();
    }
    let mut order: Vec<usize> = (0..snapshot.id.len()).collect();
    order.sort_by_key(|&k| snapshot.id[k]);
    ordered(&mut snapshot.id, &order);
    ordered(&mut snapshot.body, &order);
    ordered(&mut snapshot.position, &order);
    ordered(&mut snapshot.velocity, &order);
    ordered(&mut snapshot.stress, &order);
    for values in [
        &mut snapshot.von_mises_stress,
        &mut snapshot.pressure,
        &mut snapshot.density,
        &mut snapshot.plastic_strain,
        &mut snapshot.plastic_strain_rate,
        &mut snapshot.temperature,
        &mut snapshot.friction_use,
        &mut snapshot.shear_friction_factor,
        &mut snapshot.contact_area,
        &mut snapshot.relative_spacing,
        &mut snapshot.half_thickness,
    ] {
        ordered(values, &order);
    }
    ordered(&mut snapshot.contact_force, &order);
    ordered(&mut snapshot.neighbours, &order);
}

/// Turns positions, velocities, forces and the tool about the origin.
fn turn(snapshot: &mut Snapshot, angle: f64) {
    let (sine, cosine) = angle.sin_cos();
    let turn_one = |v: &mut Vector| {
        *v = [cosine * v[0] - sine * v[1], sine * v[0] + cosine * v[1], v[2]];
    };
    for vectors in [
        &mut snapshot.position,
        &mut snapshot.velocity,
        &mut snapshot.contact_force,
        &mut snapshot.tool,
    ] {
        vectors.iter_mut().for_each(turn_one);
    }
    // sigma' = Q sigma Q^T of a stress with xx and zz alone.
    for stress in &mut snapshot.stress {
        let along = stress[0];
        stress[0] = cosine * cosine * along;
        stress[1] = sine * sine * along;
        stress[3] = sine * cosine * along;
    }
}
