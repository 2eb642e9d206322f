//! Provenance and facts as sections of an archive.

use super::archive::{Archive, ArchiveFile};
use crate::{Facts, MaterialFacts, Provenance, RunError, Setting};
use sphcut_sph::setup::{CuttingFrame, Pass, Vector};

/// What an unfinished run saves has this format; together with the version of the results it says whether it can be gone
/// on with. Archives from before it was noted are of format 1.
const FORMAT: u64 = 1;
const FORMAT_SECTION: &str = "format";

fn formats() -> [u64; 2] {
    [FORMAT, u64::from(sphcut_sph::RESULTS_VERSION)]
}

/// Adds provenance and facts to `archive`.
pub(crate) fn put<'a>(archive: &mut Archive<'a>, provenance: &'a Provenance, facts: &'a Facts) {
    for (name, text) in [
        ("scenario_text", &provenance.scenario_text),
        ("scenario_name", &provenance.scenario_name),
        ("title", &provenance.title),
        ("version", &provenance.version),
    ] {
        archive.text(format!("provenance/{name}"), text.as_str());
    }
    archive.integers(FORMAT_SECTION, formats().to_vec());
    archive.integers("provenance/seed", vec![provenance.seed]);
    for (name, strings) in lists(provenance) {
        archive.integers(format!("provenance/{name}/count"), vec![strings.len() as u64]);
        for (index, text) in strings.into_iter().enumerate() {
            archive.text(format!("provenance/{name}/{index}"), text);
        }
    }
    archive.reals("facts", facts_numbers(facts));
    if !facts.passes.is_empty() {
        let times = facts.passes.iter().flat_map(|pass| [pass.start, pass.end]);
        archive.reals("passes", times.collect::<Vec<f64>>());
    }
    for (index, material) in facts.materials.iter().enumerate() {
        let section = |name: &str| format!("facts/materials/{index}/{name}");
        archive.text(section("name"), material.name.as_str());
        archive.text(section("law"), material.flow_stress_law.as_str());
        archive.reals(section("numbers"), material_numbers(material).to_vec());
        let keys: Vec<&str> = material.flow_stress.iter().map(|(key, _)| key.as_str()).collect();
        archive.text(section("keys"), keys.join("\n"));
        let values: Vec<f64> = material.flow_stress.iter().map(|(_, value)| *value).collect();
        archive.reals(section("values"), values);
    }
}

/// Reads provenance and facts from `archive`.
pub(crate) fn get(archive: &ArchiveFile) -> Result<(Provenance, Facts), RunError> {
    let text = |name: &str| archive.text(&format!("provenance/{name}"));
    if archive.holds_integers(FORMAT_SECTION) {
        let found = archive.integers(FORMAT_SECTION)?;
        if let ([format, results], true) = (found.as_slice(), found != formats()) {
            let ([ours, computed], version) = (formats(), text("version")?);
            return Err(archive.mismatch(format!(
                "sphcut {version} wrote it in format {format} with results of version {results}; this sphcut reads \
                 format {ours} and computes results of version {computed}"
            )));
        }
    }
    let list = |name: &str| -> Result<Vec<String>, RunError> {
        let count = archive.integers(&format!("provenance/{name}/count"))?;
        let count = count.first().copied().unwrap_or(0);
        (0..count).map(|index| text(&format!("{name}/{index}"))).collect()
    };
    let seed = archive.integers("provenance/seed")?;
    let provenance = Provenance {
        scenario_text: text("scenario_text")?,
        scenario_name: text("scenario_name")?,
        title: text("title")?,
        version: text("version")?,
        seed: seed.first().copied().unwrap_or(0),
        effects: effects_from(&list("effects")?),
        settings: settings_from(&list("settings")?),
        warnings: list("warnings")?,
    };
    Ok((provenance, get_facts(archive)?))
}

fn lists(provenance: &Provenance) -> [(&'static str, Vec<&str>); 3] {
    let effects = provenance.effects.iter().flat_map(|(name, what)| [name.as_str(), what.as_str()]);
    let settings = provenance.settings.iter().flat_map(setting_texts);
    let warnings = provenance.warnings.iter().map(String::as_str);
    [
        ("effects", effects.collect()),
        ("settings", settings.collect()),
        ("warnings", warnings.collect()),
    ]
}

/// The texts of a setting in the order of their columns.
pub(crate) fn setting_texts(setting: &Setting) -> [&str; 5] {
    [&setting.section, &setting.key, &setting.text, &setting.value, &setting.unit]
}

/// Pairs of name and description from their texts one after the other.
pub(crate) fn effects_from(texts: &[String]) -> Vec<(String, String)> {
    texts.as_chunks().0.iter().map(|[name, what]| (name.clone(), what.clone())).collect()
}

/// Settings from their texts one after the other.
pub(crate) fn settings_from(texts: &[String]) -> Vec<Setting> {
    let settings = texts.as_chunks().0.iter().map(|[section, key, text, value, unit]| Setting {
        section: section.clone(),
        key: key.clone(),
        text: text.clone(),
        value: value.clone(),
        unit: unit.clone(),
    });
    settings.collect()
}

const FACTS: usize = 20;

/// All numbers of the facts but the materials; not a number stands for what is unknown.
fn facts_numbers(facts: &Facts) -> Vec<f64> {
    let optional = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let mut numbers = vec![
        facts.dimension as f64,
        facts.particle_spacing,
        facts.width_of_cut,
        optional(facts.uncut_chip_thickness),
        optional(facts.edge_radius),
        facts.end_time,
        facts.sampling_interval,
        facts.mass_scaling,
    ];
    numbers.extend(facts.tool_velocity.unwrap_or([f64::NAN; 3]));
    for direction in [facts.frame.cutting, facts.frame.feed, facts.frame.passive] {
        numbers.extend(direction);
    }
    numbers
}

fn get_facts(archive: &ArchiveFile) -> Result<Facts, RunError> {
    let numbers = archive.reals("facts")?;
    let numbers: &[f64; FACTS] = numbers
        .as_slice()
        .try_into()
        .map_err(|_| archive.damaged("`facts` has the wrong length".to_owned()))?;
    let optional = |index: usize| Some(numbers[index]).filter(|value| !value.is_nan());
    let vector = |index: usize| -> Vector { std::array::from_fn(|axis| numbers[index + axis]) };
    let count = archive.names().filter(|name| name.ends_with("/law")).count();
    Ok(Facts {
        dimension: numbers[0] as usize,
        particle_spacing: numbers[1],
        width_of_cut: numbers[2],
        uncut_chip_thickness: optional(3),
        edge_radius: optional(4),
        end_time: numbers[5],
        sampling_interval: numbers[6],
        mass_scaling: numbers[7],
        tool_velocity: optional(8).map(|_| vector(8)),
        frame: CuttingFrame { cutting: vector(11), feed: vector(14), passive: vector(17) },
        passes: get_passes(archive)?,
        materials: (0..count)
            .map(|index| get_material(archive, index))
            .collect::<Result<_, _>>()?,
    })
}

/// None in the file of a run of one pass.
fn get_passes(archive: &ArchiveFile) -> Result<Vec<Pass>, RunError> {
    if !archive.names().any(|name| name == "passes") {
        return Ok(Vec::new());
    }
    let times = archive.reals("passes")?;
    Ok(times.chunks_exact(2).map(|pass| Pass { start: pass[0], end: pass[1] }).collect())
}

fn material_numbers(material: &MaterialFacts) -> [f64; 5] {
    [
        material.density,
        material.bulk_modulus,
        material.shear_modulus,
        material.specific_heat,
        material.thermal_conductivity,
    ]
}

fn get_material(archive: &ArchiveFile, index: usize) -> Result<MaterialFacts, RunError> {
    let section = |name: &str| format!("facts/materials/{index}/{name}");
    let numbers = archive.reals(&section("numbers"))?;
    let &[density, bulk_modulus, shear_modulus, specific_heat, thermal_conductivity] =
        numbers.as_slice()
    else {
        return Err(archive.damaged(format!("material {index} has the wrong length")));
    };
    let keys = archive.text(&section("keys"))?;
    let values = archive.reals(&section("values"))?;
    Ok(MaterialFacts {
        name: archive.text(&section("name"))?,
        density,
        bulk_modulus,
        shear_modulus,
        specific_heat,
        thermal_conductivity,
        flow_stress_law: archive.text(&section("law"))?,
        flow_stress: keys.lines().map(ToOwned::to_owned).zip(values).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sphcut_sph::Setup;
    use sphcut_sph::setup::Dimension;

    #[test]
    fn an_archive_of_another_format_is_refused_with_the_version_that_wrote_it() {
        let facts = Facts::of(&Setup::empty(Dimension::Two, 2e-5, 1e-6));
        let provenance = Provenance { version: "9.8.7".to_owned(), ..Provenance::default() };
        let path = std::env::temp_dir().join(format!("sphcut-format-{}", std::process::id()));
        let read = |numbers: [u64; 2]| {
            let mut archive = Archive::new("a checkpoint");
            // The first section of a name is the one that is read.
            archive.integers(FORMAT_SECTION, numbers.to_vec());
            put(&mut archive, &provenance, &facts);
            let mut file = std::fs::File::create(&path).unwrap();
            archive.write(&mut file).unwrap();
            let read = ArchiveFile::open(&path, "a checkpoint").and_then(|archive| get(&archive));
            std::fs::remove_file(&path).unwrap();
            read
        };
        let [format, results] = formats();
        assert_eq!(read([format, results]).unwrap().0, provenance);
        for other in [[format + 1, results], [format, results + 1]] {
            let error = read(other).unwrap_err();
            assert!(matches!(error, RunError::Mismatch { .. }), "{error}");
            assert!(error.to_string().contains("sphcut 9.8.7 wrote it in format"), "{error}");
        }
    }
}
