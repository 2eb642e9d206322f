//! The cut, orthogonal or turning: [workpiece], [tool], [process], [passes], [boundaries].

pub(crate) mod grading;
pub(crate) mod inertia;
pub(crate) mod passes;
pub(crate) mod window;
use crate::cut::passes::{PassPlan, Passes};
use crate::material::Shelf;
use crate::material::tested::{LeastShear, Tested};
use crate::process::{CuttingProcess, ProcessKind};
use crate::shared::{self, Resolution, refuse_keys, require};
use crate::tool::{ToolShape, ToolVolume};
use crate::{sections, warnings};
use glam::DVec3;
use sphcut_geometry::silhouette::Silhouette;
use sphcut_geometry::tool_section::shift_to_gap;
use sphcut_geometry::tool_surface::ToolSurface;
use sphcut_input::findings::Findings;
use sphcut_input::problem::Mistake;
use sphcut_input::reader;
use sphcut_input::record::Record;
use sphcut_physics::Quantity;
use sphcut_sph::setup::{
    Body, Grading, Grooves, Material, Setup, Support, Tool, Vector, VelocityChange, VelocityField,
};
use sphcut_tool_heat::ToolHeat;

/// `[workpiece]`.
#[derive(Debug)]
pub(crate) struct WorkpieceBlock {
    pub(crate) material: Material,
    pub(crate) tested: Tested,
    pub(crate) length: f64,
    pub(crate) height: f64,
    /// Along z; zero in the plane.
    pub(crate) width: f64,
    pub(crate) temperature: f64,
}

/// A side of the workpiece.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Hold {
    Fixed,
    Sliding,
    Free,
}

/// A held side: its name, how it is held, at what temperature.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HeldSide {
    name: &'static str,
    normal: Axis,
    end: End,
    hold: Hold,
    temperature: Option<f64>,
}

/// The direction across a side, as an index of components.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Axis {
    X = 0,
    Y = 1,
    Z = 2,
}

/// At which end of its axis a side is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    Low,
    High,
}

impl HeldSide {
    /// Whether anything is prescribed.
    fn acts(self) -> bool {
        self.hold != Hold::Free || self.temperature.is_some()
    }
}

/// The end of a cut.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CutEnd {
    pub(crate) travel: f64,
    pub(crate) sampling_travel: f64,
}

/// Everything read, before it is put together.
pub(crate) struct CutScenario {
    pub(crate) process: CuttingProcess,
    pub(crate) workpiece: WorkpieceBlock,
    pub(crate) tool: ToolShape,
    pub(crate) resolution: Resolution,
    pub(crate) end: CutEnd,
    passes: Passes,
    section: Section,
    sides: Vec<HeldSide>,
    layers: f64,
}

/// What the later passes take off, or the only one.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Section {
    uncut_chip_thickness: f64,
    width_of_cut: f64,
    /// Smallest and largest z of the first groove, from the lowest point of the tool.
    groove: [f64; 2],
}

/// `[workpiece]`.
pub(crate) fn workpiece(
    findings: &mut Findings,
    root: &Record<'_>,
    shelf: &mut Shelf<'_>,
    dimension: usize,
) -> Option<WorkpieceBlock> {
    let record =
        reader::read(findings, &root.source, root.table("workpiece")?, &sections::workpiece(), 2);
    let material = shelf.material(findings, &record);
    let width = if dimension == 2 {
        let help = "the width of a plane cut is `width_of_cut` of [process]";
        refuse_keys(findings, &record, ["width"], "belongs to turning, this is a plane cut", help);
        Some(0.0)
    } else {
        require(findings, &record, &["width"]);
        record.number("width")
    };
    let known = material?;
    Some(WorkpieceBlock {
        material: known.material,
        tested: known.tested,
        length: record.number("length")?,
        height: record.number("height")?,
        width: width?,
        temperature: record.number("temperature")?,
    })
}

/// `[boundaries]`: the held sides and the number of rows that belong to them.
pub(crate) fn boundaries(
    findings: &mut Findings,
    root: &Record<'_>,
    dimension: usize,
) -> Option<(Vec<HeldSide>, f64)> {
    shared::optional_section(findings, root, &sections::boundaries(), 2, |findings, record| {
        let hold = |key: &str| {
            Some(match record.text(key)? {
                "fixed" => Hold::Fixed,
                "sliding" => Hold::Sliding,
                _ => Hold::Free,
            })
        };
        let temperature = |key: &str| record.number(key);
        let mut sides = vec![
            HeldSide {
                name: "bottom",
                normal: Axis::Y,
                end: End::Low,
                hold: hold("bottom")?,
                temperature: temperature("bottom_temperature"),
            },
            HeldSide {
                name: "back",
                normal: Axis::X,
                end: End::High,
                hold: hold("back")?,
                temperature: temperature("back_temperature"),
            },
        ];
        if dimension == 2 {
            let help = "remove it: a plane cut has no sides across its width";
            refuse_keys(findings, record, ["sides"], "belongs to turning", help);
        } else {
            let hold = if record.is_written("sides") { hold("sides")? } else { Hold::Sliding };
            for (name, end) in [("side", End::Low), ("feed side", End::High)] {
                sides.push(HeldSide { name, normal: Axis::Z, end, hold, temperature: None });
            }
        }
        // At most 20 rows: exact.
        let layers = record.count("layers")? as f64;
        Some((sides, layers))
    })
}

impl CuttingProcess {
    /// Passes whose grooves are there from the start.
    pub(crate) fn earlier_passes(&self) -> u32 {
        match self.kind {
            ProcessKind::Orthogonal { .. } => 0,
            ProcessKind::Turning { earlier_passes, .. } => earlier_passes,
        }
    }

    /// What decides on the motion of the tool.
    pub(crate) fn plan(&self, travel: f64) -> PassPlan {
        let step = match self.kind {
            ProcessKind::Orthogonal { .. } => [0.0, -self.depth, 0.0],
            ProcessKind::Turning { feed, .. } => [0.0, 0.0, feed],
        };
        PassPlan { travel, cutting_speed: self.cutting_speed, depth: self.depth, step }
    }
}

impl Section {
    /// Of an orthogonal cut what is written; in turning from the shadow of the tool: h is the largest
    /// distance of the groove of a later pass from what the one before has left (of the only pass from
    /// the uncut surface), and b makes b h the section of the cut, a_p f (that of the groove).
    fn of(process: &CuttingProcess, body: &ToolVolume, several: bool) -> Self {
        let depth = process.depth;
        match (process.kind, body) {
            (ProcessKind::Orthogonal { width_of_cut }, _) => {
                Self { uncut_chip_thickness: depth, width_of_cut, groove: [0.0; 2] }
            }
            (ProcessKind::Turning { feed, .. }, ToolVolume::Solid(surface)) => {
                let shadow =
                    Silhouette::of(surface).expect("its lowest point is below the surface");
                let groove = shadow.extent();
                let (thickness, area) = if several {
                    (shadow.distance_when_moved(feed), depth * feed)
                } else {
                    (depth, shadow.section())
                };
                let width_of_cut = area / thickness;
                Self { uncut_chip_thickness: thickness, width_of_cut, groove }
            }
            (ProcessKind::Turning { .. }, ToolVolume::Section(_)) => {
                unreachable!("the tool of turning is a solid")
            }
        }
    }
}

impl CutScenario {
    pub(crate) fn new(
        process: CuttingProcess,
        workpiece: WorkpieceBlock,
        tool: ToolShape,
        resolution: Resolution,
        end: CutEnd,
        passes: Passes,
        (sides, layers): (Vec<HeldSide>, f64),
    ) -> Self {
        let several = passes.count + process.earlier_passes() > 1;
        let section = Section::of(&process, &tool.body, several);
        Self { process, workpiece, tool, resolution, end, passes, section, sides, layers }
    }

    /// Notes what follows from the tool's shape.
    pub(crate) fn tell(&self, findings: &mut Findings) {
        if let ProcessKind::Turning { .. } = self.process.kind {
            let mut derived =
                |key, value| findings.derived("process", key, Quantity::Length, value);
            derived("uncut_chip_thickness", self.section.uncut_chip_thickness);
            derived("width_of_cut", self.section.width_of_cut);
        }
    }

    /// Depth of the last pass below the uncut surface.
    pub(crate) fn deepest(&self) -> f64 {
        let further = f64::from(self.passes.count - 1);
        self.process.depth - further * self.process.plan(self.end.travel).step[1]
    }

    /// From the first groove's side to that of the last one.
    fn grooves(&self) -> f64 {
        let [low, high] = self.section.groove;
        let further = self.passes.count - 1 + self.process.earlier_passes();
        high - low + f64::from(further) * self.process.plan(self.end.travel).step[2]
    }

    /// Where the lowest point of the tool begins along z: the grooves lie in the middle.
    fn tip(&self) -> f64 {
        let earlier = f64::from(self.process.earlier_passes());
        let feed = self.process.plan(self.end.travel).step[2];
        self.first_tip() + earlier * feed
    }

    /// The same of the first of the earlier passes.
    fn first_tip(&self) -> f64 {
        0.5 * (self.workpiece.width - self.grooves()) - self.section.groove[0]
    }

    /// What earlier passes have left.
    fn earlier_grooves(&self) -> Option<Grooves> {
        let ToolVolume::Solid(surface) = &self.tool.body else { return None };
        let feed = self.process.plan(self.end.travel).step[2];
        let shifts: Vec<f64> = (0..self.process.earlier_passes())
            .map(|pass| self.first_tip() + f64::from(pass) * feed)
            .collect();
        let shadow = Silhouette::of(surface).filter(|_| !shifts.is_empty())?;
        Some(Grooves { line: shadow.left_by(&shifts) })
    }

    /// What cannot be built, however well each value looks alone.
    pub(crate) fn check(&self, findings: &mut Findings, root: &Record<'_>) {
        let spacing = self.resolution.particle_spacing;
        let grading = self.resolution.discretisation.grading;
        let coarsest = grading.map_or(1.0, |grading| grading.coarsest());
        let turning = matches!(self.process.kind, ProcessKind::Turning { .. });
        let layers = if turning { self.workpiece.width / spacing } else { 1.0 };
        let height = self.graded_height(2 + i32::from(turning));
        let particles = self.workpiece.length / spacing * (height / spacing);
        shared::check_particle_count(findings, root, particles * layers);
        let thickness = self.section.uncut_chip_thickness;
        let held = self.layers * spacing * coarsest;
        let mut room = vec![
            (
                "height",
                self.workpiece.height,
                self.deepest() + held,
                "the uncut chip thickness and the held rows",
            ),
            (
                "length",
                self.workpiece.length,
                self.end.travel + held,
                "the travel and the held rows",
            ),
        ];
        if turning {
            room[0].3 = "the depth of cut and the held rows";
            let needed = self.grooves() + 2.0 * held;
            room.push(("width", self.workpiece.width, needed, "the grooves and the held rows"));
        } else if self.passes.count > 1 {
            room[0].3 = "the passes and the held rows";
        }
        for (key, value, needed, what) in room {
            if value <= needed {
                self.no_room(findings, root, ("workpiece", key), value, needed, what);
            }
        }
        if spacing > thickness {
            let mistake = Mistake::Contradiction {
                message: "the particle spacing is larger than the uncut chip thickness".to_owned(),
                help: if turning {
                    format!("that is {} um here", sphcut_input::units::significant(thickness * 1e6))
                } else {
                    "a chip needs at least 5 particles across it: preset = \"draft\"".to_owned()
                },
            };
            let span = root.table("resolution").map_or(root.heading.clone(), |table| table.1);
            findings.problem(&root.source, span, mistake);
        }
    }

    /// By how much held sides are deeper than they would be with the spacing of the chip alone: a graded workpiece is held over
    /// rows of its coarsest spacing. A window ends as much farther ahead: the room between edge and held end counts
    /// (docs/numerics.md, *How high the workpiece has to be*).
    pub(crate) fn deeper_hold(&self) -> f64 {
        let discretisation = &self.resolution.discretisation;
        let deeper = discretisation
            .grading
            .map_or(0.0, |grading| grading.coarsest() - discretisation.chip_size());
        self.layers * self.resolution.particle_spacing * deeper
    }

    /// Height of the workpiece that would have as many particles at the finest spacing, where a grading has coarser ones.
    fn graded_height(&self, axes: i32) -> f64 {
        let height = self.workpiece.height;
        let Some(Grading { band, below, above }) = self.resolution.discretisation.grading else {
            return height;
        };
        // The levels between count as their coarsest does: an estimate.
        let part =
            |thickness: f64, level: u8| thickness.max(0.0) / f64::from(1_u32 << level).powi(axes);
        let [low, high] = band;
        let fine = high.min(0.0) - low.max(-height);
        fine + part(low + height, below) + part(-high, above)
    }

    fn no_room(
        &self,
        findings: &mut Findings,
        root: &Record<'_>,
        (section, key): (&str, &str),
        value: f64,
        needed: f64,
        what: &str,
    ) {
        let millimetres = |length: f64| sphcut_input::units::significant(length * 1e3);
        let mistake = Mistake::Contradiction {
            message: format!(
                "{key} = {} mm leaves no room for {what}: {} mm",
                millimetres(value),
                millimetres(needed)
            ),
            help: format!("enlarge `{key}` of [{section}], or reduce the others"),
        };
        let table = root.table(section);
        let span = table
            .and_then(|(table, _)| Some(table.get(key)?.span()))
            .unwrap_or_else(|| root.heading.clone());
        findings.problem(&root.source, span, mistake);
    }

    /// The setup of the solver, apart from options that all scenarios share.
    pub(crate) fn fill(&self, setup: &mut Setup) {
        let placement = self.process.placement;
        let motion = self.passes.motion(&self.process.plan(self.end.travel));
        setup.materials = vec![self.workpiece.material.clone()];
        let (low, high) = self.corners();
        setup.bodies = vec![Body {
            name: "workpiece".to_owned(),
            material: 0,
            shape: placement.block(low, high),
            velocity: VelocityField::Uniform([0.0; 3]),
            temperature: self.workpiece.temperature,
        }];
        setup.grooves = self.earlier_grooves();
        setup.discretisation.parting_height = Some(-self.process.depth);
        setup.supports = self.supports();
        setup.machine = self.tool.machine;
        setup.frame = match self.process.kind {
            ProcessKind::Orthogonal { .. } => placement.frame(),
            ProcessKind::Turning { .. } => placement.turning_frame(),
        };
        let velocity_changes = motion.velocity_changes.iter().map(|change| VelocityChange {
            time: change.time,
            velocity: placement.vector(change.velocity),
        });
        setup.tool = Some(Tool {
            velocity_changes: velocity_changes.collect(),
            ..self.placed_tool(setup.contact.get("start_gap"))
        });
        setup.passes = motion.passes;
        setup.width_of_cut = self.section.width_of_cut;
        setup.uncut_chip_thickness = Some(self.section.uncut_chip_thickness);
        setup.sampling_interval = self.end.sampling_travel / self.process.cutting_speed;
    }

    /// Of the workpiece.
    fn corners(&self) -> (Vector, Vector) {
        let WorkpieceBlock { length, height, width, .. } = self.workpiece;
        ([0.0, -height, 0.0], [length, 0.0, width])
    }

    /// The held sides. A particle belongs to the last support that contains it, so where held sides
    /// meet comes after them and holds what any of them holds.
    fn supports(&self) -> Vec<Support> {
        let held: Vec<HeldSide> = self.sides.iter().copied().filter(|side| side.acts()).collect();
        let mut meetings: Vec<Vec<HeldSide>> = vec![Vec::new()];
        for side in held {
            let with: Vec<Vec<HeldSide>> = meetings
                .iter()
                .filter(|sides| sides.iter().all(|other| other.normal != side.normal))
                .map(|sides| sides.iter().copied().chain([side]).collect())
                .collect();
            meetings.extend(with);
        }
        // Stable: sides in their order, then edges, then corners.
        meetings.sort_by_key(Vec::len);
        meetings[1..].iter().map(|sides| self.support(sides)).collect()
    }

    /// Where all of `sides` are, with everything that they prescribe.
    fn support(&self, sides: &[HeldSide]) -> Support {
        let grading = self.resolution.discretisation.grading;
        let coarsest = grading.map_or(1.0, |grading| grading.coarsest());
        let depth = self.layers * self.resolution.particle_spacing * coarsest;
        let (mut min, mut max) = self.corners();
        let mut velocity = [None; 3];
        for side in sides {
            let axis = side.normal as usize;
            match side.end {
                End::Low => max[axis] = depth + min[axis],
                End::High => min[axis] = max[axis] - depth,
            }
            match side.hold {
                Hold::Fixed => velocity = [Some(0.0); 3],
                Hold::Sliding => velocity[axis] = Some(0.0),
                Hold::Free => {}
            }
        }
        let name = if let [side] = sides { side.name } else { "corner" };
        Support {
            name: name.to_owned(),
            region: self.process.placement.block(min, max),
            velocity,
            temperature: sides.iter().find_map(|side| side.temperature),
        }
    }

    fn placed_tool(&self, start_gap: f64) -> Tool {
        let gap = start_gap * self.resolution.particle_spacing;
        let placement = self.process.placement;
        let (surface, heat) = match &self.tool.body {
            ToolVolume::Section(polygon) => {
                let shift =
                    shift_to_gap(polygon, self.workpiece.length, self.workpiece.height, gap);
                let local: Vec<[f64; 2]> =
                    polygon.iter().map(|point| [point[0] + shift, point[1]]).collect();
                let heat = self.tool.heat.as_ref();
                let side = |side: usize| placement.side(side, polygon.len());
                let heat = heat.map(|heat| self.placed_heat(heat, [shift, 0.0, 0.0], side));
                (ToolSurface::Polygon(placement.polygon(&local)), heat)
            }
            ToolVolume::Solid((vertices, triangles)) => {
                let shift = -foremost((vertices, triangles), gap) - gap;
                let tip = self.tip();
                let way = DVec3::new(shift, 0.0, tip);
                let local = vertices.iter().map(|vertex| vertex + way).collect();
                let (vertices, triangles) = placement.surface(&(local, triangles.clone()));
                let heat = self.tool.heat.as_ref();
                let heat = heat.map(|heat| self.placed_heat(heat, [shift, 0.0, tip], |side| side));
                let vertices = vertices.iter().map(DVec3::to_array).collect();
                (ToolSurface::Triangles { vertices, triangles }, heat)
            }
        };
        Tool {
            surface,
            velocity: placement.vector([self.process.cutting_speed, 0.0, 0.0]),
            edge_radius: self.tool.edge_radius,
            friction: self.tool.friction.0,
            velocity_changes: Vec::new(),
            friction_values: self.tool.friction.1.clone(),
            heat,
        }
    }

    /// Moved and placed like the tool; `side` tells where each of its sides is then.
    fn placed_heat(
        &self,
        heat: &ToolHeat,
        shift: Vector,
        side: impl Fn(usize) -> usize,
    ) -> ToolHeat {
        let centre = std::array::from_fn(|axis| heat.fine_centre[axis] + shift[axis]);
        ToolHeat {
            fine_centre: self.process.placement.vector(centre),
            outer_sides: heat.outer_sides.iter().map(|known| side(*known)).collect(),
            ..heat.clone()
        }
    }

    /// What the user should know before trusting the run, if `heat_share` of the plastic work heats.
    pub(crate) fn warnings(&self, heat_share: f64) -> Vec<String> {
        let side_room = match self.process.kind {
            ProcessKind::Orthogonal { .. } => None,
            ProcessKind::Turning { .. } => Some(0.5 * (self.workpiece.width - self.grooves())),
        };
        let mut told = warnings::cut(&warnings::CutFigures {
            uncut_chip_thickness: self.section.uncut_chip_thickness,
            depth: self.process.depth,
            below: self.workpiece.height - self.deepest(),
            side_room,
            edge_radius: self.tool.edge_radius,
            cutting_speed: self.process.cutting_speed,
            particle_spacing: self.resolution.particle_spacing,
            chip_spacing: self.resolution.particle_spacing
                * self.resolution.discretisation.chip_size(),
            is_graded: self.resolution.discretisation.grading.is_some(),
            travel: self.end.travel,
            length: self.workpiece.length,
            tool_top: self.tool.body.top(),
        });
        told.extend(self.tool.notes.iter().cloned());
        told.extend(self.tool.rake_angle.and_then(|rake_angle| {
            let zone = LeastShear {
                rake_angle,
                cutting_speed: self.process.cutting_speed,
                uncut_chip_thickness: self.section.uncut_chip_thickness,
                initial_temperature: self.workpiece.temperature,
                heat_share,
            };
            self.workpiece.tested.warning(&zone, &self.workpiece.material)
        }));
        told
    }
}

/// Largest x of the part of a surface that can meet a workpiece below y = 0 within `gap`.
fn foremost((vertices, triangles): (&[DVec3], &[[usize; 3]]), gap: f64) -> f64 {
    let sides = triangles.iter().flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]);
    let foremost_of = |ends: [&usize; 2]| {
        let [a, b] = ends.map(|&vertex| vertices[vertex]);
        let at_gap = || a[0] + (gap - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
        match (a[1] <= gap, b[1] <= gap) {
            (true, true) => a[0].max(b[0]),
            (true, false) => a[0].max(at_gap()),
            (false, true) => b[0].max(at_gap()),
            (false, false) => f64::NEG_INFINITY,
        }
    };
    sides.map(foremost_of).fold(f64::NEG_INFINITY, f64::max)
}
