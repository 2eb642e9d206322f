//! A published table of segment means (turning, seven tools, 1 s each) is read as channels; it has no air
//! cut, so it gives no force of its own.

use sphcut_physics::Channel;
use sphcut_recordings::formats::{CsvLayout, read_csv};
use sphcut_recordings::{
    Conditions, Detection, EvaluationSettings, Fault, ForceChannel, TimeSource, Unsteady,
    evaluate_cut,
};
use std::path::Path;

#[test]
fn the_published_table_loads_and_says_what_it_lacks() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/data/vicomtech_turning_forces.csv");
    let Ok(text) = std::fs::read_to_string(&path) else {
        println!("skipped: `{}` is not there", path.display());
        return;
    };
    let mut table = read_csv(&text, CsvLayout::default()).unwrap();
    assert_eq!(table.columns.len(), 8);
    assert!(table.columns.iter().all(|column| column.values.iter().all(|v| v.is_finite())));
    // The tool with the longest record: a mean every second.
    let tools = &table.columns[0].values;
    let longest = tools.chunk_by(|a, b| a == b).map(<[f64]>::len).max().unwrap();
    let start = tools.chunk_by(|a, b| a == b).map(<[f64]>::len).take_while(|n| *n < longest).sum();
    let rows = start..start + longest;
    assert!(rows.len() > 100, "{rows:?}");
    for column in &mut table.columns {
        column.values = column.values[rows.clone()].to_vec();
    }
    let settings = EvaluationSettings {
        time: TimeSource { sampling_rate: Some(1.0), ..TimeSource::default() },
        channels: vec![ForceChannel {
            component: Channel::CuttingForce,
            name: "F_c_MEAN_N".to_owned(),
            scale: 1.0,
            full_scale: None,
            response: None,
        }],
        trigger: None,
        detection: Detection::Given,
        guard: 0.0,
        shortest_air: 5.0,
        low_pass: None,
        precision: 0.02,
        largest_drift: 0.05,
        unsteady: Unsteady::Refuse,
    };
    let known = Conditions { given: Some([0.0, longest as f64]), ..Conditions::default() };
    let cut = evaluate_cut(&table, &settings, &known);
    assert!(
        !cut.accepted && matches!(cut.faults[..], [Fault::NoAirCut { .. }]),
        "{:?}",
        cut.faults
    );
}
