//! Mass scaling from how little inertia may matter.

use crate::sections;
use sphcut_input::document::contradiction;
use sphcut_input::findings::Findings;
use sphcut_input::reader;
use sphcut_input::record::Record;
use sphcut_input::units::significant;
use sphcut_physics::flow_stress::FlowState;
use sphcut_sph::options;
use sphcut_sph::setup::Setup;
use toml::de::DeTable;

/// Plastic strain at which the flow stress is taken: that of a shear zone.
const STRAIN: f64 = 1.0;

/// The factor s on the inertia with which the stress of inertia is the share I of the flow stress:
///
/// ```text
/// s = I sigma_y(1, v_c / h, T_0) / (rho v_c^2),   within the range of `mass_scaling`
/// ```
///
/// Turning the material from the speed of the cut into that of the chip takes `s rho v_c^2 h` per width of force, and the shear zone resists with the
/// flow stress times some `h`: I is the share of inertia in the forces to the order of one, at any speed and in any
/// material. With a constant `mass_scaling` it grows with the square of the speed (docs/numerics.md).
/// The reported `balances.kinetic_share` says what the kinetic energy came to.
///
/// The least of all materials counts. None, with the contradiction told, if no material ever yields.
fn factor(number: f64, setup: &Setup, cutting_speed: f64, rate: f64) -> Option<Factor> {
    let of = |material: &sphcut_sph::setup::Material, temperature: f64| {
        let state = FlowState { plastic_strain: STRAIN, plastic_strain_rate: rate, temperature };
        let law = (material.flow_stress.build)(&material.flow_stress_values);
        number * law.flow_stress(&state) / (material.density * cutting_speed.powi(2))
    };
    let factors =
        setup.bodies.iter().map(|body| of(&setup.materials[body.material], body.temperature));
    let least = factors.fold(f64::INFINITY, f64::min);
    let range = options::NUMERICS.iter().find(|option| option.key == KEY)?.range;
    least.is_finite().then(|| Factor { wanted: least, taken: least.clamp(range.min, range.max) })
}

/// What follows, before and after the range of `mass_scaling`.
#[derive(Debug, Clone, Copy)]
struct Factor {
    wanted: f64,
    taken: f64,
}

impl Factor {
    /// Says what the range has done to the number that was asked for.
    fn warning(self, number: f64, cutting_speed: f64) -> Option<String> {
        if self.wanted == self.taken {
            return None;
        }
        // I is in proportion to s, the number of steps to its inverse root.
        let (share, steps) = (self.taken / self.wanted, (self.wanted / self.taken).sqrt());
        let speed = significant(cutting_speed * 60.0);
        let asked = format!(
            "inertia_number = {} at {speed} m/min asks for mass_scaling = {}",
            significant(number),
            significant(self.wanted)
        );
        let is = significant(number * share);
        Some(if share < 1.0 {
            format!(
                "{asked}, {} is the most: the inertia number is {is}, and the run takes {} times as many steps",
                significant(self.taken),
                format_args!("{steps:.1}")
            )
        } else {
            format!(
                "{asked}, {} is the least: the inertia number is {is}, that of the material itself",
                significant(self.taken)
            )
        })
    }
}

/// Key of the factor in `[numerics]`.
const KEY: &str = "mass_scaling";

/// Follows `inertia_number` of `[numerics]`, if it is written; `process`: v_c and h. Tells where the range of
/// `mass_scaling` does not let it.
pub(crate) fn scale(
    findings: &mut Findings,
    root: &Record<'_>,
    setup: &mut Setup,
    process: Option<(f64, f64)>,
) -> Option<String> {
    let empty = DeTable::new();
    let place = root.table("numerics").unwrap_or((&empty, root.heading.clone()));
    // Its mistakes were told when the section was read.
    let mut told = Findings::default();
    let record = reader::read(&mut told, &root.source, place, &sections::numerics(), 2);
    let number = record.number("inertia_number")?;
    if record.is_written(KEY) {
        let message = format!("`inertia_number` and `{KEY}` exclude each other");
        contradiction(findings, &record, "inertia_number", message, "keep one of them");
        return None;
    }
    let Some((cutting_speed, thickness)) = process else {
        let message = "`inertia_number` needs a cutting speed, and this scenario has no [process]";
        contradiction(findings, &record, "inertia_number", message, "write `mass_scaling`");
        return None;
    };
    let Some(factor) = factor(number, setup, cutting_speed, cutting_speed / thickness) else {
        let message = "`inertia_number` needs a material that yields";
        contradiction(findings, &record, "inertia_number", message, "write `mass_scaling`");
        return None;
    };
    let given: Vec<(&str, f64)> = setup
        .numerics
        .iter()
        .map(|(option, value)| (option.key, if option.key == KEY { factor.taken } else { value }))
        .collect();
    if let Ok(values) = sphcut_physics::Values::resolve(options::NUMERICS, &given) {
        setup.numerics = values;
        findings.followed("numerics", KEY, factor.taken);
    }
    factor.warning(number, cutting_speed)
}
