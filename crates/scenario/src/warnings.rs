//! What a scenario may do but its author should know.

use sphcut_input::units::significant;
use sphcut_sph::Setup;
use sphcut_sph::setup::{Body, Shape};

/// Fewest particles across a length that is to be resolved.
pub(crate) const RESOLVED: f64 = 5.0;
/// Particles across an edge radius below which it is not seen.
const SEEN: f64 = 2.0;
/// Fastest cut in m/s (1000 m/min) for which the models of a material and of friction are usually known.
const FAST: f64 = 1000.0 / 60.0;
/// Travel in uncut chip thicknesses before a mean force can be steady: the prototype's mean still
/// moved after ten.
const STEADY_TRAVEL: f64 = 10.0;
/// Distance from the back side, in uncut chip thicknesses, below which it changes the forces.
const BACK_ROOM: f64 = 3.0;
/// Below the reference temperature by more K a material has another strength than the law gives it: some per cent. A room has 20 or 25 degC.
const COLDER: f64 = 10.0;
/// Material below the cut in uncut chip thicknesses.
const DEPTH_BELOW: f64 = 2.0;

/// The figures that the warnings of a cut look at, in SI.
pub(crate) struct CutFigures {
    pub(crate) uncut_chip_thickness: f64,
    /// Of the tool below the uncut surface in its first pass.
    pub(crate) depth: f64,
    /// Material below the last pass.
    pub(crate) below: f64,
    /// Turning: material between the grooves and either side.
    pub(crate) side_room: Option<f64>,
    pub(crate) edge_radius: Option<f64>,
    pub(crate) cutting_speed: f64,
    pub(crate) particle_spacing: f64,
    /// Largest spacing in the uncut chip.
    pub(crate) chip_spacing: f64,
    /// Whether the spacing differs from place to place.
    pub(crate) is_graded: bool,
    pub(crate) travel: f64,
    pub(crate) length: f64,
    /// Height of the tool above the uncut surface.
    pub(crate) tool_top: f64,
}

/// Whether `value` is less than `limit` by more than the rounding of decimal numbers.
pub(crate) fn falls_short(value: f64, limit: f64) -> bool {
    value < limit * (1.0 - 1e-9)
}

/// A number of particles, to a hundredth: no more is known of them.
pub(crate) fn rough(particles: f64) -> String {
    significant((particles * 100.0).round() / 100.0)
}

/// One sentence for each thing to know.
pub(crate) fn cut(figures: &CutFigures) -> Vec<String> {
    let depth = figures.uncut_chip_thickness;
    let mut warnings = Vec::new();
    let across = depth / figures.chip_spacing;
    if falls_short(across, RESOLVED) {
        warnings.push(format!(
            "particles across the uncut chip thickness: {}; below {RESOLVED} the chip is not \
             resolved: choose a spacing of at most {} um",
            rough(across),
            significant((depth / RESOLVED * 1e8).floor() / 100.0)
        ));
    }
    warnings.extend(edge_warning(figures));
    if figures.edge_radius.is_some_and(|radius| radius > depth * (1.0 + 1e-9)) {
        warnings.push(
            "the edge radius is larger than the uncut chip thickness: much of the material is pressed below \
             the edge, not cut"
                .to_owned(),
        );
    }
    if figures.cutting_speed > FAST * (1.0 + 1e-9) {
        warnings.push(format!(
            "the cutting speed is {} m/min; above 1000 m/min strain rates are beyond those at which flow \
             stress is measured",
            significant(figures.cutting_speed * 60.0)
        ));
    }
    if falls_short(figures.travel, STEADY_TRAVEL * depth) {
        warnings.push(format!(
            "the travel is {} uncut chip thicknesses: mean forces are rarely steady before {STEADY_TRAVEL}",
            significant(figures.travel / depth)
        ));
    }
    let room = figures.length - figures.travel;
    if falls_short(room, BACK_ROOM * figures.depth) {
        warnings.push(format!(
            "the tool ends {} mm before the back side, nearer than {BACK_ROOM} uncut chip \
             thicknesses: the held side changes the forces",
            significant(room * 1e3)
        ));
    }
    if falls_short(figures.below, DEPTH_BELOW * figures.depth) {
        warnings.push(format!(
            "only {} mm of material below the cut, less than {DEPTH_BELOW} uncut chip \
             thicknesses: the held bottom changes the forces",
            significant(figures.below * 1e3)
        ));
    }
    if let Some(beside) =
        figures.side_room.filter(|room| falls_short(*room, DEPTH_BELOW * figures.depth))
    {
        warnings.push(format!(
            "only {} mm of material beside the grooves, less than {DEPTH_BELOW} depths of cut: the \
             held sides change the forces",
            significant(beside * 1e3)
        ));
    }
    // Chips are thicker and so shorter than the layer they come from: the travel bounds them.
    if falls_short(figures.tool_top, figures.travel) {
        warnings.push(format!(
            "the tool reaches {} mm above the uncut surface, the chip may become {} mm long: it may \
             climb over the tool",
            significant(figures.tool_top * 1e3),
            significant(figures.travel * 1e3)
        ));
    }
    warnings
}

/// Bodies too thin for their spacing.
pub(crate) fn bodies(bodies: &[Body], particle_spacing: f64, dimension: usize) -> Vec<String> {
    let thin = bodies.iter().filter_map(|body| {
        let across = thickness(&body.shape, dimension) / particle_spacing;
        (falls_short(across, RESOLVED)).then(|| {
            format!(
                "particles across `{}` where it is thinnest: {}; below {RESOLVED} it is not resolved",
                body.name,
                significant(across)
            )
        })
    });
    thin.collect()
}

/// Smallest extent of a shape.
pub(crate) fn thickness(shape: &Shape, dimension: usize) -> f64 {
    match shape {
        Shape::Box { min, max, .. } => {
            (0..dimension).map(|axis| max[axis] - min[axis]).fold(f64::INFINITY, f64::min)
        }
        Shape::Cylinder { radius, inner_radius, length, .. } => {
            let radial = if *inner_radius > 0.0 { radius - inner_radius } else { 2.0 * radius };
            if dimension == 3 { radial.min(*length) } else { radial }
        }
    }
}

/// Materials that start outside the temperatures of their law.
pub(crate) fn temperatures(setup: &Setup) -> Vec<String> {
    let mut warnings = Vec::new();
    for body in &setup.bodies {
        let material = &setup.materials[body.material];
        let of = |key: &str| {
            let mut values = material.flow_stress_values.iter();
            values.find(|value| value.0.key == key).map(|value| value.1)
        };
        let start = body.temperature;
        if let Some(reference) = of("reference_temperature").filter(|limit| start < *limit - COLDER)
        {
            warnings.push(format!(
                "`{}` starts at {} K, below the reference temperature of its flow stress ({} K): it \
                 has the strength of that temperature",
                body.name,
                significant(start),
                significant(reference)
            ));
        }
        if let Some(melting) = of("melting_temperature").filter(|limit| start >= *limit) {
            warnings.push(format!(
                "`{}` starts at {} K, above its melting temperature ({} K): it has no strength",
                body.name,
                significant(start),
                significant(melting)
            ));
        }
    }
    warnings
}

fn edge_warning(figures: &CutFigures) -> Option<String> {
    let radius = figures.edge_radius?;
    let across = radius / figures.particle_spacing;
    if radius == 0.0 {
        return Some("the edge is sharp: its ploughing force is left out".to_owned());
    }
    (falls_short(across, RESOLVED)).then(|| {
        let means = if falls_short(across, SEEN) {
            format!(
                "below {SEEN} the tool is as blunt as the spacing makes it, whatever its radius"
            )
        } else {
            format!("below {RESOLVED} the ploughing force is not resolved")
        };
        let help = if figures.is_graded {
            ""
        } else {
            ": `particles_across_edge` with `grading = {}` in [resolution] makes them small where the edge is"
        };
        format!("particles across the edge radius: {}; {means}{help}", rough(across))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: CutFigures = CutFigures {
        uncut_chip_thickness: 1e-4,
        edge_radius: Some(1e-4),
        cutting_speed: 2.5,
        particle_spacing: 2e-5,
        chip_spacing: 2e-5,
        is_graded: false,
        travel: 1.5e-3,
        length: 2.5e-3,
        depth: 1e-4,
        below: 4e-4,
        side_room: None,
        tool_top: 2e-3,
    };

    #[test]
    fn nothing_to_say_about_a_good_cut() {
        assert_eq!(cut(&GOOD), Vec::<String>::new());
    }

    #[test]
    fn each_shortcoming_is_told_once() {
        let expect = |figures: CutFigures, part: &str| {
            let found = cut(&figures);
            assert_eq!(found.len(), 1, "{found:?}");
            assert!(found[0].contains(part), "{found:?}");
        };
        expect(
            CutFigures { chip_spacing: 2.5e-5, edge_radius: None, ..GOOD },
            "across the uncut chip thickness: 4;",
        );
        expect(
            CutFigures { edge_radius: Some(2e-5), ..GOOD },
            "across the edge radius: 1; below 2",
        );
        expect(
            CutFigures { edge_radius: Some(6e-5), ..GOOD },
            "across the edge radius: 3; below 5",
        );
        expect(CutFigures { edge_radius: Some(1.2e-4), ..GOOD }, "larger than the uncut chip");
        expect(CutFigures { cutting_speed: 20.0, ..GOOD }, "the cutting speed is 1200 m/min");
        expect(CutFigures { edge_radius: Some(0.0), ..GOOD }, "sharp");
        expect(CutFigures { travel: 5e-4, ..GOOD }, "rarely steady");
        expect(CutFigures { length: 1.6e-3, ..GOOD }, "before the back side");
        expect(CutFigures { tool_top: 1e-3, ..GOOD }, "climb over");
        expect(CutFigures { below: 1.5e-4, ..GOOD }, "below the cut");
        expect(CutFigures { side_room: Some(1e-4), ..GOOD }, "beside the grooves");
    }
}
