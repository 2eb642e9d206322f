//! What is fuzzed: every reader of a file that may come from elsewhere.

use sphcut_diagnose::{WearSegment, grows, lands, load_diagnosis_file};
use sphcut_geometry::mesh::Mesh;
use sphcut_greybox::{ForceKind, GreyBox};
use sphcut_identify::load_identification;
use sphcut_input::{
    OutsideFiles, read_cut_table, read_force_table, read_measured_forces, read_measured_springback,
    read_series_table,
};
use sphcut_record::{Run, RunFiles, read_columns_h5, recover, verify_h5};
use sphcut_recordings::formats::{CsvLayout, read_csv, read_lvm};
use sphcut_recordings::load_recordings;
use sphcut_scenario::{LoadOptions, parse};
use sphcut_sweep::{Store, load_sweep};
use std::path::Path;

/// A reader and where its inputs come from.
pub struct Target {
    /// Its name.
    pub name: &'static str,
    /// Files that are changed: ends of paths in the repository, or in what the program has made of its examples.
    pub corpus: &'static [&'static str],
    /// Where the input lies in `scenarios`, so that the names in it lead to files.
    pub folder: &'static str,
    /// Reads the input, which lies at the path, too; what it answers does not matter.
    pub read: fn(&[u8], &Path),
}

/// All of them.
pub const TARGETS: &[Target] = &[
    Target {
        name: "scenario",
        corpus: &["scenarios/", "scenario.toml", "good/"],
        folder: "",
        read: scenario,
    },
    Target { name: "tables", corpus: &[".csv"], folder: "", read: tables },
    Target { name: "meshes", corpus: &[".stl", ".msh"], folder: "", read: meshes },
    Target { name: "lvm", corpus: &[".lvm", "cut_1.csv"], folder: "", read: lvm },
    Target {
        name: "recordings",
        corpus: &["recordings/example.toml"],
        folder: "recordings",
        read: recordings,
    },
    Target { name: "recordings_h5", corpus: &["recordings.h5"], folder: "", read: recordings_h5 },
    Target { name: "run_h5", corpus: &["whole/run.h5"], folder: "", read: run_h5 },
    Target { name: "unfinished", corpus: &["run.partial/"], folder: "", read: unfinished },
    Target { name: "model", corpus: &["model.json"], folder: "", read: model },
    Target {
        name: "store",
        corpus: &["entry.json", "store.json", "sweeps/"],
        folder: "",
        read: store,
    },
    Target { name: "sweep", corpus: &["_sweep.toml"], folder: "", read: sweep },
    Target {
        name: "identification",
        corpus: &["identification/", "identification.toml"],
        folder: "identification",
        read: identification,
    },
    Target { name: "diagnosis", corpus: &["diagnosis/"], folder: "diagnosis", read: diagnosis },
];

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn scenario(bytes: &[u8], path: &Path) {
    let _ = parse(&text(bytes), "fuzz.toml", path.parent(), &LoadOptions::default());
}

fn tables(bytes: &[u8], _: &Path) {
    let text = text(bytes);
    let _ = (read_cut_table(&text), read_force_table(&text), read_measured_forces(&text, None));
    let _ = (read_measured_springback(&text), read_csv(&text, CsvLayout::default()));
    let _ = sphcut_geometry::outline::parse(&text);
    if let Ok(rows) = read_series_table(&text) {
        let segments: Vec<WearSegment> = rows
            .iter()
            .map(|row| WearSegment {
                tool: row.tool.clone(),
                time: row.time,
                forces: row.forces,
                land: row.land,
            })
            .collect();
        let _ = grows(&segments, 1).map(|found| lands(&found));
    }
}

fn meshes(bytes: &[u8], _: &Path) {
    if let Ok(mesh) = Mesh::read(bytes) {
        let _ = mesh.cross_section();
        let _ = mesh.closed_surface();
        let _ = mesh.scaled(1e-3);
    }
}

fn lvm(bytes: &[u8], _: &Path) {
    let _ = read_lvm(&text(bytes));
}

fn recordings(_: &[u8], path: &Path) {
    let _ = load_recordings(path, OutsideFiles::Refused);
}

fn recordings_h5(_: &[u8], path: &Path) {
    let _ = verify_h5(path);
    for group in ["/", "cuts", "cut_1", "series"] {
        let _ = read_columns_h5(path, group);
    }
}

fn run_h5(_: &[u8], path: &Path) {
    let _ = (verify_h5(path), Run::load_state(path));
    if let Ok(run) = Run::load(path) {
        (0..run.snapshots.len()).for_each(|number| drop(run.snapshots.get(number)));
    }
}

/// The file takes the place of the checkpoint, and of a snapshot, of an unfinished run beside it.
fn unfinished(bytes: &[u8], path: &Path) {
    let Some(folder) = path.parent() else { return };
    let partial = RunFiles::in_dir(folder).partial();
    let _ = std::fs::create_dir_all(&partial);
    let names = ["origin.bin", "samples.journal", "checkpoint.bin", "snapshot-000000.bin"];
    for name in names {
        let _ = std::fs::write(partial.join(name), bytes);
    }
    let _ = recover(folder);
}

fn model(bytes: &[u8], _: &Path) {
    if let Ok(model) = GreyBox::from_json(&text(bytes)) {
        let _ = model.predict(ForceKind::Cutting, None, [2.0, 1e-4], 300.0);
    }
}

/// The file takes the place of every note of a store beside it.
fn store(bytes: &[u8], path: &Path) {
    let Some(root) = path.parent().map(|folder| folder.join("store")) else { return };
    let shard = root.join("results").join("ab").join("ab".repeat(32));
    let _ = (std::fs::create_dir_all(&shard), std::fs::create_dir_all(root.join("sweeps")));
    for note in [shard.join("entry.json"), root.join("sweeps/fuzz.json"), root.join("store.json")] {
        let _ = std::fs::write(note, bytes);
    }
    let _ = Store::open(&root);
    let mark = "{\"layout\": 1, \"what\": \"results of sphcut by address\"}\n";
    let _ = std::fs::write(root.join("store.json"), mark);
    if let Ok(store) = Store::open(&root) {
        let _ = (store.damaged_notes(), store.damaged_results(), store.leftovers());
        for entry in store.list().iter().flat_map(|contents| &contents.results).flatten() {
            let _ = store.verify(entry);
        }
    }
}

fn sweep(_: &[u8], path: &Path) {
    let _ = load_sweep(path, &LoadOptions::default());
}

fn identification(_: &[u8], path: &Path) {
    let _ = load_identification(path, OutsideFiles::Refused);
}

fn diagnosis(_: &[u8], path: &Path) {
    let _ = load_diagnosis_file(path, &LoadOptions::default());
}
