//! What other programs read from the files: h5py from `run.h5`, VTK (hence
//! ParaView) from `snapshots.vtkhdf`.
//!
//! Needs Python with `h5py` and `vtk`; says so and does nothing where they are
//! missing. `SPHCUT_PYTHON` names another interpreter than `python3`.

mod support;

use serde_json::Value;
use sphcut_record::driver::{self, Control, Start};
use sphcut_record::{Run, RunFiles, Snapshots, export_vtkhdf};
use sphcut_sph::{CHANNELS, ChannelId};
use std::path::Path;
use std::process::Command;
use support::{Fake, Folder, options, provenance, snapshot_of};

/// What the script says when a module is missing.
const MODULE_MISSING: i32 = 77;

/// What `reader` finds in `file`; `None` where Python or the module is missing.
fn read_back(reader: &str, file: &Path) -> Option<Value> {
    let python = std::env::var("SPHCUT_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/python/read_back.py");
    let output = match Command::new(&python).arg(script).arg(reader).arg(file).output() {
        Ok(output) => output,
        Err(error) => {
            eprintln!("skipped: `{python}` cannot be started ({error})");
            return None;
        }
    };
    let complaint = String::from_utf8_lossy(&output.stderr);
    if output.status.code() == Some(MODULE_MISSING) {
        eprintln!("skipped: {}", complaint.trim());
        return None;
    }
    assert!(output.status.success(), "{complaint}");
    Some(serde_json::from_slice(&output.stdout).unwrap())
}

fn finished_run(folder: &Folder) -> Run {
    let fake = Fake { particles: 3000, steps: 40, sampling: 3, ..Fake::default() };
    let options = options(&folder.0, Start::New);
    driver::run(&fake, &provenance(), &options, &mut |_| Control::Continue).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(values) => values.iter().flat_map(numbers).collect(),
        number => vec![number.as_f64().unwrap()],
    }
}

#[test]
fn h5py_reads_the_record() {
    let folder = Folder::new("h5py");
    let run = finished_run(&folder);
    let Some(seen) = read_back("h5py", &RunFiles::in_dir(&folder.0).record()) else { return };
    assert_eq!(seen["layout"], 2);
    assert_eq!(seen["channels"].as_object().unwrap().len(), CHANNELS.len());
    for (channel, column) in CHANNELS.iter().zip(run.samples.columns()) {
        let series = &seen["channels"][channel.name];
        assert_eq!(numbers(&series["values"]), *column, "{}", channel.name);
        // Of a plane run.
        let unit = match channel.unit {
            "" => "1",
            "N" => "N/m",
            "N s" => "N s/m",
            "J" => "J/m",
            unit => unit,
        };
        assert_eq!(series["unit"], unit, "{}", channel.name);
        assert_eq!(series["meaning"], channel.meaning);
        assert_eq!(series["extendible"], true);
    }
    assert_eq!(seen["scenario_text"], run.provenance.scenario_text);
    assert_eq!(seen["title"], run.provenance.title);
    assert_eq!(seen["effects"][0][1], run.provenance.effects[0].1);
    assert_eq!(seen["settings"][0][3], run.provenance.settings[0].value);
    assert_eq!(seen["settings"][1][2], "", "an empty text stays empty");
    assert_eq!(seen["steps"], 40);
    assert_eq!(seen["outcome"], "finished");
    assert_eq!(seen["material"], run.facts.materials[0].name);
    assert_eq!(seen["initial_yield"], 5.53e8);
    let times: Vec<f64> = run.snapshots.index().iter().map(|info| info.time).collect();
    assert_eq!(numbers(&seen["times"]), times);
    let first = run.snapshots.get(0).unwrap();
    assert_eq!(numbers(&seen["position"]), first.position.as_flattened());
    assert_eq!(numbers(&seen["temperature"]), first.temperature);
    assert_eq!(seen["id"][2999], 2999 * 3);
    assert_eq!(seen["state"]["clock/step"][0], 40);
    assert_eq!(seen["state"]["empty"], Value::Array(vec![]));
}

#[test]
fn vtk_reads_points_scalars_and_time_steps() {
    let folder = Folder::new("vtk");
    let mut run = finished_run(&folder);
    // Another number of particles in every step, none at all in one.
    let counts = [5, 9, 0, 3000, 2];
    let snapshots = counts.iter().enumerate().map(|(step, count)| {
        let state: Vec<f64> = (0..*count).map(|i| f64::from(i) * 0.25 + step as f64).collect();
        snapshot_of(&state, step as f64 * 1e-4, step as u64 * 10)
    });
    run.snapshots = Snapshots::in_memory(snapshots.collect());
    let path = folder.0.join("changing.vtkhdf");
    export_vtkhdf(&run, &path, &folder.0.join("tool.vtkhdf")).unwrap();
    let Some(seen) = read_back("vtk", &path) else { return };
    let frames = seen["frames"].as_array().unwrap();
    assert_eq!(frames.len(), counts.len());
    for (number, frame) in frames.iter().enumerate() {
        let snapshot = run.snapshots.get(number).unwrap();
        assert_eq!(frame["time"].as_f64().unwrap(), snapshot.time);
        // All values of these snapshots are multiples of 1/4 and exact in single precision.
        assert_eq!(numbers(&frame["points"]), snapshot.position.as_flattened(), "frame {number}");
        assert_eq!(frame["vertices"], counts[number]);
        let connectivity: Vec<f64> = (0..counts[number]).map(f64::from).collect();
        assert_eq!(numbers(&frame["connectivity"]), connectivity);
        let arrays = &frame["arrays"];
        assert_eq!(numbers(&arrays["temperature"]), snapshot.temperature);
        assert_eq!(numbers(&arrays["velocity"]), snapshot.velocity.as_flattened());
        assert_eq!(numbers(&arrays["stress"]), snapshot.stress.as_flattened());
        let ids: Vec<f64> = snapshot.id.iter().map(|id| *id as f64).collect();
        assert_eq!(numbers(&arrays["id"]), ids);
        let neighbours: Vec<f64> = snapshot.neighbours.iter().map(|n| f64::from(*n)).collect();
        assert_eq!(numbers(&arrays["neighbours"]), neighbours);
    }
}

#[test]
fn vtk_reads_the_tool_step_by_step() {
    let folder = Folder::new("vtk-tool");
    let mut run = finished_run(&folder);
    // An outline of three corners, one of five, none, a heated mesh of two triangles.
    let snapshots = [3, 5, 0, 4].into_iter().enumerate().map(|(step, corners)| {
        let mut snapshot = snapshot_of(&[1.0, 2.0], step as f64 * 1e-4, step as u64 * 10);
        snapshot.dimension = 2;
        snapshot.tool_nodes.clear();
        snapshot.tool_elements.clear();
        snapshot.tool_temperature.clear();
        snapshot.tool = (0..corners).map(|k| [f64::from(k), step as f64, 0.0]).collect();
        if corners == 4 {
            snapshot.tool_nodes = snapshot.tool.clone();
            snapshot.tool_elements = vec![0, 1, 2, 1, 3, 2];
            snapshot.tool_temperature = vec![300.0, 301.0, 302.0, 303.0];
        }
        snapshot
    });
    run.snapshots = Snapshots::in_memory(snapshots.collect());
    let path = folder.0.join("tool.vtkhdf");
    assert!(export_vtkhdf(&run, &folder.0.join("particles.vtkhdf"), &path).unwrap());
    let Some(seen) = read_back("vtk", &path) else { return };
    let frames = seen["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 4);
    let expected: [&[f64]; 4] =
        [&[0.0, 1.0, 2.0], &[0.0, 1.0, 2.0, 3.0, 4.0], &[], &[0.0, 1.0, 2.0, 1.0, 3.0, 2.0]];
    for (number, (frame, corners)) in frames.iter().zip(expected).enumerate() {
        let snapshot = run.snapshots.get(number).unwrap();
        assert_eq!(frame["time"].as_f64().unwrap(), snapshot.time);
        assert_eq!(numbers(&frame["points"]), snapshot.tool.as_flattened(), "frame {number}");
        assert_eq!(numbers(&frame["polygons"]), corners, "frame {number}");
    }
}

#[test]
fn vtk_reads_what_a_run_leaves() {
    let folder = Folder::new("vtk-run");
    let run = finished_run(&folder);
    let Some(seen) = read_back("vtk", &RunFiles::in_dir(&folder.0).vtkhdf()) else { return };
    let frames = seen["frames"].as_array().unwrap();
    assert_eq!(frames.len(), run.snapshots.len());
    for (frame, info) in frames.iter().zip(run.snapshots.index()) {
        assert_eq!(frame["time"].as_f64().unwrap(), info.time);
        assert_eq!(frame["vertices"], 3000);
    }
    let tool = read_back("vtk", &RunFiles::in_dir(&folder.0).tool()).unwrap();
    let frames = tool["frames"].as_array().unwrap();
    assert_eq!(frames.len(), run.snapshots.len());
    for frame in frames {
        assert_eq!(numbers(&frame["polygons"]), [0.0, 1.0, 2.0, 0.0, 2.0, 3.0]);
        let temperature = numbers(&frame["arrays"]["temperature"]);
        assert_eq!(temperature, [300.0, 310.5, 320.0, 330.25]);
    }
}

#[test]
fn h5py_compares_the_checksums() {
    let folder = Folder::new("h5py-checksums");
    let run = finished_run(&folder);
    let record = RunFiles::in_dir(&folder.0).record();
    let Some(seen) = read_back("checksums", &record) else { return };
    assert!(seen["compared"].as_u64().unwrap() > CHANNELS.len() as u64, "{seen}");
    assert_eq!(seen["wrong"].as_array().unwrap().len(), 0, "{seen}");
    // The sign of one force on disk, where it is stored as it is.
    let force = run.samples.channel(ChannelId::CuttingForce)[3].to_le_bytes();
    let mut bytes = std::fs::read(&record).unwrap();
    let place = bytes.windows(8).position(|window| window == force).unwrap();
    bytes[place + 7] ^= 0x80;
    std::fs::write(&record, bytes).unwrap();
    let seen = read_back("checksums", &record).unwrap();
    assert_eq!(seen["wrong"][0], "channels/cutting_force", "{seen}");
    assert!(Run::load(&record).unwrap_err().to_string().contains("cutting_force"));
}
