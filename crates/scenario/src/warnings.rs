//! What a scenario may do but its author should know.

use crate::units::significant;

/// Fewest particles across a length that is to be resolved.
const RESOLVED: f64 = 5.0;
/// Travel in uncut chip thicknesses before a mean force can be steady: the prototype's mean still
/// moved after ten.
const STEADY_TRAVEL: f64 = 10.0;
/// Distance from the back side, in uncut chip thicknesses, below which it changes the forces.
const BACK_ROOM: f64 = 3.0;
/// Material below the cut in uncut chip thicknesses.
const DEPTH_BELOW: f64 = 2.0;

/// The figures that the warnings of a cut look at, in SI.
pub(crate) struct CutFigures {
    pub(crate) uncut_chip_thickness: f64,
    pub(crate) edge_radius: Option<f64>,
    pub(crate) particle_spacing: f64,
    pub(crate) travel: f64,
    pub(crate) length: f64,
    pub(crate) height: f64,
}

/// One sentence for each thing to know.
pub(crate) fn cut(figures: &CutFigures) -> Vec<String> {
    let depth = figures.uncut_chip_thickness;
    let mut warnings = Vec::new();
    let across = depth / figures.particle_spacing;
    // Rounding of the quotient of two decimal numbers must not turn 5 into a warning.
    if across < RESOLVED * (1.0 - 1e-9) {
        warnings.push(format!(
            "{} particles across the uncut chip thickness: below {RESOLVED} the chip is not \
             resolved; choose a spacing of at most {} um",
            significant(across),
            significant(depth / RESOLVED * 1e6)
        ));
    }
    warnings.extend(edge_warning(figures));
    if figures.travel < STEADY_TRAVEL * depth {
        warnings.push(format!(
            "the travel is {} uncut chip thicknesses: mean forces are rarely steady before {STEADY_TRAVEL}",
            significant(figures.travel / depth)
        ));
    }
    let room = figures.length - figures.travel;
    if room < BACK_ROOM * depth {
        warnings.push(format!(
            "the tool ends {} mm before the back side, nearer than {BACK_ROOM} uncut chip \
             thicknesses: the held side changes the forces",
            significant(room * 1e3)
        ));
    }
    if figures.height - depth < DEPTH_BELOW * depth {
        warnings.push(format!(
            "only {} mm of material below the cut, less than {DEPTH_BELOW} uncut chip \
             thicknesses: the held bottom changes the forces",
            significant((figures.height - depth) * 1e3)
        ));
    }
    warnings
}

fn edge_warning(figures: &CutFigures) -> Option<String> {
    let radius = figures.edge_radius?;
    let across = radius / figures.particle_spacing;
    if radius == 0.0 {
        return Some("the edge is sharp: its ploughing force is left out".to_owned());
    }
    (across < RESOLVED * (1.0 - 1e-9)).then(|| {
        format!(
            "{} particles across the edge radius: below {RESOLVED} the ploughing force is not \
             resolved",
            significant(across)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: CutFigures = CutFigures {
        uncut_chip_thickness: 1e-4,
        edge_radius: Some(1e-4),
        particle_spacing: 2e-5,
        travel: 1.5e-3,
        length: 2.5e-3,
        height: 5e-4,
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
        expect(CutFigures { uncut_chip_thickness: 8e-5, ..GOOD }, "4 particles across the uncut");
        expect(CutFigures { edge_radius: Some(2e-5), ..GOOD }, "1 particles across the edge");
        expect(CutFigures { edge_radius: Some(0.0), ..GOOD }, "sharp");
        expect(CutFigures { travel: 5e-4, ..GOOD }, "rarely steady");
        expect(CutFigures { length: 1.6e-3, ..GOOD }, "before the back side");
        expect(CutFigures { height: 2.5e-4, ..GOOD }, "below the cut");
    }
}
