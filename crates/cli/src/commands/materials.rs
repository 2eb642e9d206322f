//! `sphcut materials`: flow stress of the shipped materials, and of one's own, beside each other.

use crate::common_arguments::ScenarioArguments;
use crate::failure::{ExitCode, Failure};
use crate::{files, loading, terminal};
use clap::Args;
use sphcut_report::{ComparedMaterial, compared_states, render_materials};
use std::fmt::Write as _;
use std::path::PathBuf;

const HELP: &str = "\
Examples:
  sphcut materials                              all that are shipped
  sphcut materials ti6al4v_seo_2005 mine.toml   one that is shipped beside a material file

The page has the curves over strain, strain rate and temperature, and every parameter.";

/// Arguments of `materials`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct MaterialsArguments {
    /// Names of shipped materials, or material files in this folder [default: all shipped].
    #[arg(value_name = "MATERIAL")]
    pub materials: Vec<String>,
    /// The page that is written.
    #[arg(long, value_name = "FILE", default_value = "out/materials.html")]
    pub out: PathBuf,
    /// Replace an existing page.
    #[arg(long)]
    pub force: bool,
}

/// A scenario around a material: every file of materials is read and checked as in a run.
fn scenario(material: &str) -> String {
    format!(
        "title = \"a material\"\n[workpiece]\nmaterial = {material:?}\nlength = \"1 mm\"\nheight = \"0.3 mm\"\ntemperature = \"20 degC\"\n\
         [tool]\nrake_angle = \"5 deg\"\nclearance_angle = \"7 deg\"\nedge_radius = \"20 um\"\n\
         [tool.friction]\nlaw = \"coulomb\"\nfriction_coefficient = 0.3\n\
         [process]\ncutting_speed = \"150 m/min\"\nuncut_chip_thickness = \"0.1 mm\"\nwidth_of_cut = \"1 mm\"\n\
         [resolution]\npreset = \"draft\"\n[stop]\ntravel = \"0.2 mm\"\n"
    )
}

/// Compares them in the terminal and on a page.
pub fn materials(arguments: &MaterialsArguments) -> Result<ExitCode, Failure> {
    files::unless_there([arguments.out.clone()], arguments.force)?;
    let shipped = sphcut_scenario::shipped_materials().iter().map(|(key, _)| (*key).to_owned());
    let names = match arguments.materials.as_slice() {
        [] => shipped.collect(),
        asked => asked.to_vec(),
    };
    let mut found: Vec<ComparedMaterial> = Vec::new();
    // Material files are looked for in this folder.
    let place = ScenarioArguments { scenario: PathBuf::from("."), allow_outside: false };
    for name in names {
        let mut setup = loading::varied(&place, &scenario(&name))?.setup;
        let material = setup.materials.swap_remove(0);
        let (law, values) = (material.flow_stress, material.flow_stress_values);
        let same = |other: &&mut ComparedMaterial| {
            other.law.key == law.key
                && other.values.iter().map(|v| v.1).eq(values.iter().map(|v| v.1))
        };
        match found.iter_mut().find(same) {
            Some(other) => other.names.push(name),
            None => found.push(ComparedMaterial { names: vec![name], law, values }),
        }
    }
    files::save_alone(
        &arguments.out,
        render_materials(&found, env!("CARGO_PKG_VERSION")).as_bytes(),
    )?;
    let mut page = "flow stress in MPa at plastic strain, strain rate and temperature\n".to_owned();
    let states = compared_states();
    let line = |name: &str, cells: &[String]| {
        let cells: Vec<String> = cells
            .iter()
            .zip(&states)
            .map(|(cell, head)| format!("{cell:>w$}", w = head.chars().count()))
            .collect();
        format!("{name:<27}{}\n", cells.join("  "))
    };
    page.push_str(&line("", &states));
    for material in &found {
        let cells = material.compared().map(|stress| format!("{stress:.0}"));
        page.push_str(&line(&material.names[0], &cells));
        for other in &material.names[1..] {
            let _ = writeln!(page, "  also {other}");
        }
    }
    terminal::answer(&page)?;
    terminal::report(&arguments.out, "`sphcut catalogue NAME` shows one with its sources");
    Ok(ExitCode::Done)
}
