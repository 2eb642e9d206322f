//! The orthogonal cut: [workpiece], [tool], [process], [boundaries].

use crate::findings::Findings;
use crate::material::Shelf;
use crate::placement::{Handedness, Placement};
use crate::problem::Mistake;
use crate::reader;
use crate::record::Record;
use crate::shared::{self, Resolution};
use crate::tool::ToolShape;
use crate::tool_geometry::shift_to_gap;
use crate::{sections, warnings};
use sphcut_sph::setup::{
    Body, Material, Setup, Support, Tool, ToolHeat, ToolSurface, Vector, VelocityField,
};

/// `[process]`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Process {
    pub(crate) cutting_speed: f64,
    pub(crate) uncut_chip_thickness: f64,
    pub(crate) width_of_cut: f64,
    pub(crate) placement: Placement,
}

/// `[workpiece]`.
#[derive(Debug)]
pub(crate) struct Workpiece {
    pub(crate) material: Material,
    pub(crate) length: f64,
    pub(crate) height: f64,
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
pub(crate) struct Side {
    name: &'static str,
    normal: Axis,
    hold: Hold,
    temperature: Option<f64>,
}

/// The direction across a side, as an index of components.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Axis {
    X = 0,
    Y = 1,
}

impl Side {
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
pub(crate) struct Cut {
    pub(crate) process: Process,
    pub(crate) workpiece: Workpiece,
    pub(crate) tool: ToolShape,
    pub(crate) resolution: Resolution,
    pub(crate) end: CutEnd,
    sides: Vec<Side>,
    layers: f64,
}

/// `[process]`; read first because presets and the tool depend on it.
pub(crate) fn process(findings: &mut Findings, root: &Record<'_>) -> Option<Process> {
    let record =
        reader::read(findings, &root.source, root.table("process")?, &sections::process(), 2);
    let mirrored = record.switch("mirrored");
    Some(Process {
        cutting_speed: record.number("cutting_speed")?,
        uncut_chip_thickness: record.number("uncut_chip_thickness")?,
        width_of_cut: record.number("width_of_cut")?,
        placement: Placement {
            rotation: record.number("orientation")?,
            handedness: if mirrored? { Handedness::Mirrored } else { Handedness::Kept },
        },
    })
}

/// `[workpiece]`.
pub(crate) fn workpiece(
    findings: &mut Findings,
    root: &Record<'_>,
    shelf: &mut Shelf<'_>,
) -> Option<Workpiece> {
    let record =
        reader::read(findings, &root.source, root.table("workpiece")?, &sections::workpiece(), 2);
    let material = shelf.material(findings, &record);
    Some(Workpiece {
        material: material?,
        length: record.number("length")?,
        height: record.number("height")?,
        temperature: record.number("temperature")?,
    })
}

/// `[boundaries]`: the held sides and the number of rows that belong to them.
pub(crate) fn boundaries(findings: &mut Findings, root: &Record<'_>) -> Option<(Vec<Side>, f64)> {
    shared::optional_section(findings, root, &sections::boundaries(), 2, |_, record| {
        let side = |name, normal, temperature| {
            let hold = match record.text(name)? {
                "fixed" => Hold::Fixed,
                "sliding" => Hold::Sliding,
                _ => Hold::Free,
            };
            Some(Side { name, normal, hold, temperature: record.number(temperature) })
        };
        let sides = [
            side("bottom", Axis::Y, "bottom_temperature")?,
            side("back", Axis::X, "back_temperature")?,
        ];
        // At most 20 rows: exact.
        let layers = record.count("layers")? as f64;
        Some((sides.to_vec(), layers))
    })
}

impl Cut {
    pub(crate) fn new(
        process: Process,
        workpiece: Workpiece,
        tool: ToolShape,
        resolution: Resolution,
        end: CutEnd,
        (sides, layers): (Vec<Side>, f64),
    ) -> Self {
        Self { process, workpiece, tool, resolution, end, sides, layers }
    }

    /// What cannot be built, however well each value looks alone.
    pub(crate) fn check(&self, findings: &mut Findings, root: &Record<'_>) {
        let spacing = self.resolution.particle_spacing;
        let particles = self.workpiece.length / spacing * (self.workpiece.height / spacing);
        shared::check_particle_count(findings, root, particles);
        let depth = self.process.uncut_chip_thickness;
        let held = self.layers * spacing;
        let room = [
            (
                "workpiece",
                "height",
                self.workpiece.height,
                depth + held,
                "the uncut chip thickness and the held rows",
            ),
            (
                "workpiece",
                "length",
                self.workpiece.length,
                self.end.travel + held,
                "the travel and the held rows",
            ),
        ];
        for (section, key, value, needed, what) in room {
            if value <= needed {
                self.no_room(findings, root, (section, key), value, needed, what);
            }
        }
        if spacing > depth {
            let mistake = Mistake::Contradiction {
                message: "the particle spacing is larger than the uncut chip thickness".to_owned(),
                help: "a chip needs at least 5 particles across it: preset = \"draft\"".to_owned(),
            };
            let span = root.table("resolution").map_or(root.heading.clone(), |table| table.1);
            findings.problem(&root.source, span, mistake);
        }
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
        let millimetres = |length: f64| crate::units::significant(length * 1e3);
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
        setup.materials = vec![self.workpiece.material.clone()];
        setup.bodies = vec![Body {
            name: "workpiece".to_owned(),
            material: 0,
            shape: placement.rectangle([0.0, -self.workpiece.height], [self.workpiece.length, 0.0]),
            velocity: VelocityField::Uniform([0.0; 3]),
            temperature: self.workpiece.temperature,
        }];
        setup.supports = self.supports();
        setup.tool = Some(self.placed_tool(setup.contact.get("start_gap")));
        setup.frame = placement.frame();
        setup.width_of_cut = self.process.width_of_cut;
        setup.uncut_chip_thickness = Some(self.process.uncut_chip_thickness);
        setup.sampling_interval = self.end.sampling_travel / self.process.cutting_speed;
    }

    /// The held sides. A particle belongs to the last support that contains it, so the corner of
    /// two held sides comes last and holds what either of them holds.
    fn supports(&self) -> Vec<Support> {
        let depth = self.layers * self.resolution.particle_spacing;
        let (length, height) = (self.workpiece.length, self.workpiece.height);
        let held: Vec<Side> = self.sides.iter().copied().filter(|side| side.acts()).collect();
        let mut supports: Vec<Support> = held
            .iter()
            .map(|side| match side.normal {
                Axis::X => {
                    self.support(side.name, [length - depth, -height], [length, 0.0], &[*side])
                }
                Axis::Y => {
                    self.support(side.name, [0.0, -height], [length, depth - height], &[*side])
                }
            })
            .collect();
        if held.len() == 2 {
            let (min, max) = ([length - depth, -height], [length, depth - height]);
            supports.push(self.support("corner", min, max, &held));
        }
        supports
    }

    /// The rectangle from `min` to `max` with everything that `sides` prescribe.
    fn support(&self, name: &str, min: [f64; 2], max: [f64; 2], sides: &[Side]) -> Support {
        let mut velocity = [None; 3];
        for side in sides {
            match side.hold {
                Hold::Fixed => velocity = [Some(0.0); 3],
                Hold::Sliding => velocity[side.normal as usize] = Some(0.0),
                Hold::Free => {}
            }
        }
        Support {
            name: name.to_owned(),
            region: self.process.placement.rectangle(min, max),
            velocity,
            temperature: sides.iter().find_map(|side| side.temperature),
        }
    }

    fn placed_tool(&self, start_gap: f64) -> Tool {
        let gap = start_gap * self.resolution.particle_spacing;
        let polygon = &self.tool.polygon;
        let shift = shift_to_gap(polygon, self.workpiece.length, self.workpiece.height, gap);
        let local: Vec<[f64; 2]> =
            polygon.iter().map(|point| [point[0] + shift, point[1]]).collect();
        let speed: Vector = [self.process.cutting_speed, 0.0, 0.0];
        Tool {
            surface: ToolSurface::Polygon(self.process.placement.polygon(&local)),
            velocity: self.process.placement.vector(speed),
            edge_radius: self.tool.edge_radius,
            friction: self.tool.friction.0,
            velocity_changes: Vec::new(),
            friction_values: self.tool.friction.1.clone(),
            heat: self.tool.heat.as_ref().map(|heat| self.placed_heat(heat, shift)),
        }
    }

    fn placed_heat(&self, heat: &ToolHeat, shift: f64) -> ToolHeat {
        let placement = self.process.placement;
        let [x, y] = heat.fine_centre;
        let centre = placement.vector([x + shift, y, 0.0]);
        let count = self.tool.polygon.len();
        ToolHeat {
            fine_centre: [centre[0], centre[1]],
            outer_sides: heat.outer_sides.iter().map(|side| placement.side(*side, count)).collect(),
            ..heat.clone()
        }
    }

    /// What the user should know before trusting the run.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let mut told = warnings::cut(&warnings::CutFigures {
            uncut_chip_thickness: self.process.uncut_chip_thickness,
            edge_radius: self.tool.edge_radius,
            particle_spacing: self.resolution.particle_spacing,
            travel: self.end.travel,
            length: self.workpiece.length,
            height: self.workpiece.height,
            tool_top: self.tool.polygon.iter().map(|point| point[1]).fold(0.0, f64::max),
        });
        told.extend(self.tool.notes.iter().cloned());
        told
    }
}
