//! `forces.csv`: forces, energies and temperatures over time as text, units in the header.

use super::atomic;
use crate::{Facts, RunError, Samples};
use sphcut_sph::ChannelId;
use std::io::{self, Write};
use std::path::Path;

/// The forces of a row: channel and name.
const FORCES: [(ChannelId, &str); 3] = [
    (ChannelId::CuttingForce, "cutting_force"),
    (ChannelId::FeedForce, "feed_force"),
    (ChannelId::PassiveForce, "passive_force"),
];

/// Energies since the start, of a plane run for its width of cut.
const ENERGIES: [(ChannelId, &str); 5] = [
    (ChannelId::ToolWork, "tool_work"),
    (ChannelId::PlasticWork, "plastic_work"),
    (ChannelId::FrictionWork, "friction_work"),
    (ChannelId::KineticEnergy, "kinetic_energy"),
    (ChannelId::ElasticEnergy, "elastic_energy"),
];

/// Temperatures; 0 where nothing is in contact.
const TEMPERATURES: [(ChannelId, &str); 2] = [
    (ChannelId::InterfaceTemperature, "interface_temperature"),
    (ChannelId::MaxTemperature, "max_temperature"),
];

/// Writes the forces of `samples`, in N and in a plane run also per mm of width, energies and temperatures.
pub(crate) fn write(path: &Path, facts: &Facts, samples: &Samples) -> Result<(), RunError> {
    atomic::replace(path, |writer| put(writer, facts, samples))
}

pub(crate) fn put(writer: &mut dyn Write, facts: &Facts, samples: &Samples) -> io::Result<()> {
    writeln!(writer, "{}", header(facts))?;
    (0..samples.len()).try_for_each(|index| row(writer, facts, samples, index))
}

/// Whether sphcut wrote `path`.
pub(crate) fn is_ours(path: &Path) -> bool {
    std::fs::read(path).is_ok_and(|bytes| bytes.starts_with(b"time [s],travel [mm],"))
}

fn is_plane(facts: &Facts) -> bool {
    facts.dimension == 2
}

fn header(facts: &Facts) -> String {
    let mut columns = vec!["time [s]".to_owned(), "travel [mm]".to_owned()];
    if is_plane(facts) {
        columns.extend(FORCES.map(|(_, name)| format!("{name} [N/mm]")));
    }
    columns.extend(FORCES.map(|(_, name)| format!("{name} [N]")));
    columns.extend(ENERGIES.map(|(_, name)| format!("{name} [J]")));
    columns.extend(TEMPERATURES.map(|(_, name)| format!("{name} [K]")));
    columns.join(",")
}

fn row(writer: &mut dyn Write, facts: &Facts, samples: &Samples, index: usize) -> io::Result<()> {
    let value = |id: ChannelId| samples.channel(id)[index];
    write!(writer, "{},{}", value(ChannelId::Time), value(ChannelId::Travel) * 1e3)?;
    if is_plane(facts) {
        for (id, _) in FORCES {
            // N/m to N/mm.
            write!(writer, ",{}", value(id) * 1e-3)?;
        }
    }
    for (id, _) in FORCES.into_iter().chain(ENERGIES) {
        write!(writer, ",{}", value(id) * facts.force_factor())?;
    }
    for (id, _) in TEMPERATURES {
        write!(writer, ",{}", value(id))?;
    }
    writeln!(writer)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sphcut_sph::setup::Dimension;
    use sphcut_sph::{CHANNELS, Sample, Setup};

    fn lines(dimension: Dimension) -> Vec<String> {
        let mut setup = Setup::empty(dimension, 1e-5, 1e-3);
        setup.width_of_cut = 3e-3;
        let mut values = vec![0.0; CHANNELS.len()];
        values[ChannelId::Time as usize] = 0.5;
        values[ChannelId::Travel as usize] = 0.25;
        values[ChannelId::CuttingForce as usize] = 2000.0;
        values[ChannelId::ToolWork as usize] = 500.0;
        values[ChannelId::FrictionWork as usize] = 100.0;
        values[ChannelId::InterfaceTemperature as usize] = 900.0;
        let mut samples = Samples::default();
        samples.push(&Sample { values });
        let name = format!("sphcut-forces-{}-{}.csv", std::process::id(), dimension as u8);
        let path = std::env::temp_dir().join(name);
        write(&path, &Facts::of(&setup), &samples).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        text.lines().map(ToOwned::to_owned).collect()
    }

    #[test]
    fn a_plane_run_gives_forces_per_width_and_forces() {
        // 2000 N/m = 2 N/mm, and times 3 mm of width 6 N; 0.25 m = 250 mm. 500 and 100 J/m times 3 mm are 1.5 and
        // 0.3 J, within rounding of binary numbers.
        let lines = lines(Dimension::Two);
        assert_eq!(
            lines[0],
            "time [s],travel [mm],cutting_force [N/mm],feed_force [N/mm],passive_force [N/mm],\
             cutting_force [N],feed_force [N],passive_force [N],tool_work [J],plastic_work [J],\
             friction_work [J],kinetic_energy [J],elastic_energy [J],interface_temperature [K],\
             max_temperature [K]"
        );
        let row: Vec<f64> = lines[1].split(',').map(|cell| cell.parse().unwrap()).collect();
        let expected =
            [0.5, 250.0, 2.0, 0.0, 0.0, 6.0, 0.0, 0.0, 1.5, 0.0, 0.3, 0.0, 0.0, 900.0, 0.0];
        assert_eq!(row.len(), expected.len());
        for (value, expected) in row.iter().zip(expected) {
            assert!((value - expected).abs() <= 4.0 * f64::EPSILON * expected.abs(), "{lines:?}");
        }
    }

    #[test]
    fn a_run_in_three_dimensions_gives_forces() {
        let lines = lines(Dimension::Three);
        assert_eq!(
            lines[0],
            "time [s],travel [mm],cutting_force [N],feed_force [N],passive_force [N],tool_work [J],\
             plastic_work [J],friction_work [J],kinetic_energy [J],elastic_energy [J],\
             interface_temperature [K],max_temperature [K]"
        );
        assert_eq!(lines[1], "0.5,250,2000,0,0,500,0,100,0,0,900,0");
    }
}
