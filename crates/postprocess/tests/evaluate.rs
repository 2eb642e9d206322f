//! A drawn run with known answers, from the record to `summary.json`.

use serde_json::Value;
use sphcut_postprocess::synthetic::{AMBIENT, INTERFACE_TEMPERATURE, SyntheticCut};
use sphcut_postprocess::{
    AlongEdge, EdgeSection, Missing, ProcessResult, Warning, evaluate, springback, summary_json,
};
use sphcut_record::{Outcome, Run, Setting, Snapshots};
use sphcut_sph::ChannelId;
use sphcut_sph::setup::Pass;

fn drawn() -> SyntheticCut {
    SyntheticCut { loose_particles: 0, ..SyntheticCut::default() }
}

fn run() -> Run {
    drawn().run(2.0e-3, 21)
}

fn codes(result: &ProcessResult) -> Vec<&'static str> {
    result.warnings.iter().map(Warning::code).collect()
}

/// The run with one channel changed.
fn with_channel(mut run: Run, id: ChannelId, change: impl Fn(usize, f64) -> f64) -> Run {
    let mut columns = run.samples.columns().to_vec();
    for (k, value) in columns[id as usize].iter_mut().enumerate() {
        *value = change(k, *value);
    }
    run.samples = sphcut_record::Samples::from_columns(columns).unwrap();
    run
}

#[test]
fn the_drawn_cut_is_found_in_its_record() {
    let run = run();
    let result = evaluate(&run).unwrap();
    assert!(result.steady.reached, "{}", result.steady.reason);
    let force = result.forces.cutting;
    // 200 N/mm, 3 mm wide.
    assert!((force.mean_per_width - 200e3).abs() < 2.0 * force.ci95_per_width, "{force:?}");
    assert!((force.mean / force.mean_per_width - 3e-3).abs() < 1e-12);
    assert!(force.ci95_per_width < 0.03 * 200e3);
    // The interval reported is the one that was judged.
    assert!((force.ci95_per_width / result.steady.ci95 - 1.0).abs() < 1e-12);
    let chip = result.geometry.chip.unwrap();
    assert!((chip.compression_ratio - 2.2).abs() < 0.05, "{chip:?}");
    assert!((chip.speed_ratio - 2.2).abs() < 0.01, "{chip:?}");
    assert!(chip.snapshots > 10 && chip.thickness_deviation < 1e-6, "{chip:?}");
    let contact = result.geometry.contact.unwrap();
    assert!((contact.length() - 0.12e-3).abs() < 10e-6, "{contact:?}");
    let surface = result.geometry.surface.unwrap();
    assert!(surface.depth_error.abs() < 2e-6 && surface.jump < 2e-6, "{surface:?}");
    assert!((result.temperature.max - AMBIENT - 907.0).abs() < 5.0);
    // 5 + 0.5 + 1.2 + 0.2 %.
    assert!((result.energy.unwrap().numerical_dissipation - 0.069).abs() < 1e-9);
    assert!(result.momentum.unwrap().closure().unwrap() < 1e-9);
    assert_eq!(result.warnings, []);
}

#[test]
fn chip_and_surface_are_found_in_the_record() {
    let cut = SyntheticCut { residual_stress: -300e6, disorder: 0.0, ..drawn() };
    let run = cut.run(2.0e-3, 41);
    let result = evaluate(&run).unwrap();
    let geometry = &result.geometry;
    assert!((geometry.rake_angle.unwrap().to_degrees() - 5.0).abs() < 1e-9);
    // tan phi = cos 5 / (2.2 - sin 5) = 0.99619 / 2.11284: phi = 25.244 degrees. A thickness that is 2 %
    // wrong makes it half a degree.
    let angle = geometry.shear_angle.clone().unwrap().to_degrees();
    assert!((angle - 25.244).abs() < 0.5, "{angle}");
    let zone = geometry.shear_zone.clone().unwrap();
    assert!((zone.angle.to_degrees() - 25.244).abs() < 1.5, "{zone:?}");
    assert!((zone.width / 40e-6 - 1.0).abs() < 0.08, "{zone:?}");
    let contact = geometry.contact.clone().unwrap();
    assert!((contact.sticking.unwrap() - 40e-6).abs() < 10e-6, "{contact:?}");
    assert!((contact.without_slip.unwrap() - 20e-6).abs() < 10e-6, "{contact:?}");
    let interface = geometry.interface.clone().unwrap();
    // 98 % of 120 um; the first 40 um stick. Bins of 10 um move with the particles in them.
    assert!((interface.contact_length - 117.6e-6).abs() < 2e-6, "{interface:?}");
    assert!((interface.sticking_length.unwrap() - 40e-6).abs() < 5e-6, "{interface:?}");
    assert!((interface.mean_temperature - INTERFACE_TEMPERATURE).abs() < 1e-6, "{interface:?}");
    assert!(matches!(geometry.segments, Err(Missing::Continuous { .. })));
    let stress = result.residual_stress.unwrap();
    for bin in stress.iter().filter(|bin| bin.depth < 100e-6) {
        // -300 MPa exp(-depth / 50 um), smoothed over dx: (10 / 100 um)^2 = 1 % too much.
        let drawn = -300e6 * (-bin.depth / 50e-6).exp();
        assert!((bin.cutting / drawn - 1.0).abs() < 0.03, "{bin:?}");
        assert!((bin.across / bin.cutting - 0.5).abs() < 1e-9, "{bin:?}");
    }
}

#[test]
fn a_serrated_chip_gives_its_pitch_and_frequency() {
    let cut = SyntheticCut {
        tooth_pitch: 100e-6,
        tooth_height: 90e-6,
        particle_spacing: 6e-6,
        height: 0.3e-3,
        ..drawn()
    };
    let result = evaluate(&cut.run(2.0e-3, 11)).unwrap();
    let found = result.geometry.segments.unwrap();
    // 100 um in the chip, 220 um before the cut; 2.5 m/s / 220 um = 11.4 kHz.
    assert!((found.pitch / 100e-6 - 1.0).abs() < 0.05, "{found:?}");
    assert!((found.frequency / 11_364.0 - 1.0).abs() < 0.05, "{found:?}");
}

#[test]
fn what_cannot_be_told_is_null_with_a_reason() {
    // 0.2 mm of travel make 0.09 mm of chip, 0.22 mm thick.
    let value: Value =
        serde_json::from_str(&summary_json(&evaluate(&drawn().run(0.2e-3, 5)).unwrap())).unwrap();
    for (group, key) in [
        (&value["chip"], "thickness_mm"),
        (&value["chip"], "shear_angle_deg"),
        (&value["chip"]["segmentation"], "pitch_mm"),
        (&value["residual_stress"], "surface"),
    ] {
        assert!(group[key].is_null(), "{key}");
        assert!(group["reason"].as_str().is_some_and(|reason| reason.len() > 20), "{key}");
    }
    assert!(value["chip"]["reason"].as_str().unwrap().contains("too short"));
    assert!(value["shear_zone"]["reason"].is_null());
    let still = SyntheticCut { shear_rate: 0.0, contact_length: 0.0, ..drawn() };
    let value: Value =
        serde_json::from_str(&summary_json(&evaluate(&still.run(2.0e-3, 11)).unwrap())).unwrap();
    assert!(value["shear_zone"]["reason"].as_str().unwrap().contains("5 % of v_c / h"));
    assert!(value["contact"]["reason"].as_str().unwrap().contains("nothing touches"));
    assert!(value["interface"]["mean_temperature_k"].is_null());
}

#[test]
fn turning_the_cut_changes_nothing() {
    let turned = SyntheticCut { orientation: 37_f64.to_radians(), ..drawn() };
    let (straight, turned) =
        (evaluate(&run()).unwrap(), evaluate(&turned.run(2.0e-3, 21)).unwrap());
    let (a, b) = (straight.geometry.chip.unwrap(), turned.geometry.chip.unwrap());
    // Neighbours at just 1.6 spacings may fall to either side by rounding.
    assert!((a.thickness / b.thickness - 1.0).abs() < 0.01, "{a:?} {b:?}");
    let (a, b) = (straight.geometry.contact.unwrap(), turned.geometry.contact.unwrap());
    assert!((a.length() - b.length()).abs() < 1e-9, "{a:?} {b:?}");
    let (a, b) = (straight.geometry.surface.unwrap(), turned.geometry.surface.unwrap());
    assert!((a.depth_error - b.depth_error).abs() < 1e-6, "{a:?} {b:?}");
}

#[test]
fn each_warning_has_its_cause() {
    let code = |run: Run| codes(&evaluate(&run).unwrap());
    let drift = with_channel(run(), ChannelId::CuttingForce, |k, f| f * (1.0 + 2e-4 * k as f64));
    assert!(code(drift.clone()).contains(&"not_steady"));
    // One sentence: what is uncertain and what to do, which depends on how the run ended.
    let said = |run: Run| evaluate(&run).unwrap().warnings[0].to_string();
    let finished = said(drift.clone());
    assert!(
        finished.starts_with("The cutting force is not steady: the run-in lasts to "),
        "{finished}"
    );
    assert!(finished.ends_with("a longer `travel` in [stop] settles it."), "{finished}");
    let stopped = said(Run { outcome: Outcome::Steady, ..drift });
    assert!(stopped.ends_with("[stop.steady] makes the run go on."), "{stopped}");
    let drift = with_channel(run(), ChannelId::FeedForce, |k, f| f * (1.0 + 2e-4 * k as f64));
    assert_eq!(code(drift)[0], "feed_not_steady");
    let hourglass = with_channel(run(), ChannelId::HourglassWork, |_, w| 2.0 * w);
    assert_eq!(code(hourglass), ["numerical_share"]);
    let error = with_channel(run(), ChannelId::EnergyError, |_, w| -11.0 * w);
    assert_eq!(code(error), ["energy_closure"]);
    let reaction = with_channel(run(), ChannelId::ReactionCutting, |_, f| 0.99 * f);
    assert_eq!(code(reaction), ["momentum_closure"]);
    let kinetic = with_channel(run(), ChannelId::KineticEnergy, |_, w| 6.0 * w);
    assert_eq!(code(kinetic), ["kinetic_share"]);
    let lost = with_channel(run(), ChannelId::MinNeighbours, |k, n| if k == 7 { 0.0 } else { n });
    assert_eq!(code(lost), ["lost_particle"]);
    let coarse = SyntheticCut { particle_spacing: 25e-6, ..drawn() };
    let warnings = evaluate(&coarse.run(2.0e-3, 0)).unwrap().warnings;
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    let loose = SyntheticCut { loose_particles: 5, ..drawn() };
    assert_eq!(code(loose.run(2.0e-3, 3)), ["loose_particles"]);
    let heated = |outer_rise: f64| {
        let hot = |k: usize, _| 300.0 + k as f64;
        let heated = with_channel(run(), ChannelId::ToolMaxTemperature, hot);
        with_channel(heated, ChannelId::ToolOuterRise, |_, _| outer_rise)
    };
    // The hottest place rises by 999 K over 1000 samples.
    assert!(code(heated(0.019 * 999.0)).is_empty());
    assert_eq!(code(heated(0.021 * 999.0)), ["tool_cut_off"]);
    // A chip of 0.22 instead of 0.1 mm, 0.118 mm of it in contact, of which 0.182 and 0.136 mm are followed.
    let windowed = |behind: &str| {
        let (section, key) = ("window".to_owned(), "behind".to_owned());
        let mut run = run();
        let behind = behind.to_owned();
        run.provenance.settings.push(Setting { section, key, value: behind, ..Setting::default() });
        run
    };
    assert!(code(windowed("0.0004")).is_empty());
    assert_eq!(code(windowed("0.0003")), ["chip_cut_off"]);
    let text = said(windowed("0.0003"));
    assert!(text.contains("0.14 mm of the chip, 0.12 mm of it in contact"), "{text}");
    assert!(text.ends_with("a `behind` of 0.60 mm in [window] tells."), "{text}");
    // Longer than the travel: nothing of the chip has left.
    assert!(code(windowed("0.003")).is_empty());
    let mut interrupted = run();
    interrupted.outcome = Outcome::Interrupted;
    interrupted.facts.end_time *= 2.0;
    let result = evaluate(&interrupted).unwrap();
    assert_eq!(result.warnings[0].to_string(), "The run was interrupted after 50.0 % of its time.");
}

#[test]
fn the_criterion_of_the_scenario_counts() {
    let mut run = run();
    for (key, value) in [("relative_half_width", "0.001"), ("minimum_travel", "0.0015")] {
        run.provenance.settings.push(Setting {
            section: "stop.steady".to_owned(),
            key: key.to_owned(),
            value: value.to_owned(),
            ..Setting::default()
        });
    }
    let result = evaluate(&run).unwrap();
    assert_eq!(result.criterion.minimum_travel, 1.5e-3);
    assert!(!result.steady.reached);
}

#[test]
fn the_feed_force_may_have_its_own_criterion() {
    let reached = |keys: &[(&str, &str)]| {
        let mut run = run();
        run.provenance.settings.extend(keys.iter().map(|(key, value)| Setting {
            section: "stop.steady".to_owned(),
            key: (*key).to_owned(),
            value: (*value).to_owned(),
            ..Setting::default()
        }));
        let result = evaluate(&run).unwrap();
        (result.steady.reached, result.feed_steady.reached)
    };
    assert_eq!(reached(&[]), (true, true));
    assert_eq!(reached(&[("feed_relative_half_width", "0.0001")]), (true, false));
    let tight = ("relative_half_width", "0.0001");
    assert_eq!(reached(&[tight]), (false, false));
    assert_eq!(reached(&[tight, ("feed_relative_half_width", "0.1")]), (false, true));
}

#[test]
fn a_run_without_samples_or_tool_is_evaluated_too() {
    let mut run = drawn().run(0.0, 0);
    run.facts.tool_velocity = None;
    let result = evaluate(&run).unwrap();
    assert_eq!(result.energy, None);
    assert_eq!(result.geometry.chip, Err(Missing::NoCut));
    let value: Value = serde_json::from_str(&summary_json(&result)).unwrap();
    assert!(value["balances"]["energy_closure"].is_null());
    assert!(value["forces"]["cutting"]["ci95_n"].is_null());
}

/// The drawn record cut into a pass of 0.8 mm, a return of 0.2 mm without force and another pass of 1 mm with
/// twice the force; the tool goes back to its start in between.
fn two_passes() -> Run {
    let mut run = run();
    let end = run.facts.end_time;
    run.facts.passes = vec![Pass { start: 0.0, end: 0.4 * end }, Pass { start: 0.5 * end, end }];
    let count = run.samples.len();
    let (first, second) = (2 * count / 5, count / 2);
    let again = run.samples.channel(ChannelId::CuttingForce).to_vec();
    run = with_channel(run, ChannelId::CuttingForce, |k, force| match k {
        k if k < first => force,
        k if k < second => 0.0,
        k => 2.0 * again[k - second],
    });
    with_channel(run, ChannelId::Travel, |k, travel| match k {
        k if k < second => travel,
        _ => travel - 1e-3,
    })
}

#[test]
fn each_pass_has_its_own_forces_and_the_last_gives_those_of_the_run() {
    let result = evaluate(&two_passes()).unwrap();
    let numbers: Vec<usize> = result.passes.iter().map(|pass| pass.number).collect();
    assert_eq!(numbers, [1, 2]);
    for (pass, expected) in result.passes.iter().zip([200e3, 400e3]) {
        let force = pass.forces.cutting;
        let off = (force.mean_per_width - expected).abs();
        assert!(off < 2.0 * force.ci95_per_width, "pass {}: {force:?}", pass.number);
        assert!(force.ci95_per_width < 0.05 * expected, "pass {}: {force:?}", pass.number);
    }
    // Neither the return nor the other pass is in a window.
    let [first, second] = [&result.passes[0].window, &result.passes[1].window];
    assert!((first.end - 0.8e-3).abs() < 1e-9 && (second.end - 1e-3).abs() < 1e-9);
    assert!(second.start > 0.0 && second.start < 0.6e-3, "{second:?}");
    assert_eq!(result.forces, result.passes[1].forces);
    assert_eq!(result.window, result.passes[1].window);
}

/// Chip, contact and surface are those of the pass that meets an uncut surface, whatever comes later.
#[test]
fn the_particles_are_measured_in_the_first_pass() {
    let mut run = two_passes();
    let end = run.facts.passes[0].end;
    let snapshots = (0..run.snapshots.len()).map(|k| {
        let mut snapshot = (*run.snapshots.get(k).unwrap()).clone();
        if snapshot.time > end {
            snapshot.position.iter_mut().for_each(|place| place[1] *= 3.0);
        }
        snapshot
    });
    run.snapshots = Snapshots::in_memory(snapshots.collect());
    let result = evaluate(&run).unwrap();
    let chip = result.geometry.chip.clone().unwrap();
    assert!((chip.compression_ratio - 2.2).abs() < 0.05, "{chip:?}");
    let contact = result.geometry.contact.clone().unwrap();
    assert!((contact.length() - 0.12e-3).abs() < 10e-6, "{contact:?}");
    // Nine of 21 snapshots lie in the first pass.
    assert!(result.geometry.snapshots > 3 && result.geometry.snapshots < 9);
    assert!(result.residual_stress.is_ok());
    let springback = springback::measure(&run, &result).unwrap();
    assert_eq!(springback.snapshots, 9);
    assert_eq!(springback.normal_force, result.passes[0].forces.feed);
}

#[test]
fn a_run_that_ended_in_its_first_pass_has_that_one() {
    let mut run = run();
    let end = run.facts.end_time;
    run.facts.passes = vec![Pass { start: 0.0, end }, Pass { start: 2.0 * end, end: 3.0 * end }];
    let result = evaluate(&run).unwrap();
    assert_eq!(result.passes.len(), 1);
    run.facts.passes.clear();
    let single = evaluate(&run).unwrap();
    assert_eq!((result.forces, result.window), (single.forces, single.window));
}

/// Every path of a JSON value, array indices left out.
fn paths(value: &Value, prefix: &str, found: &mut Vec<String>) {
    match value {
        Value::Object(map) => map.iter().for_each(|(key, value)| {
            let path = if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") };
            paths(value, &path, found);
        }),
        Value::Array(items) if items.first().is_some_and(Value::is_object) => {
            paths(&items[0], &format!("{prefix}[]"), found);
        }
        _ => found.push(prefix.to_owned()),
    }
}

#[test]
fn the_summary_and_its_description_name_the_same_keys() {
    let mut run = run();
    run.provenance.warnings.push("said before".to_owned());
    let mut result = evaluate(&run).unwrap();
    // What only a cut in space has.
    let geometry = &mut result.geometry;
    geometry.along_edge = Some(AlongEdge {
        sections: vec![EdgeSection {
            place: 0.0,
            uncut_chip_thickness: 1e-4,
            chip: geometry.chip.clone(),
            shear_angle: geometry.shear_angle.clone(),
            contact: geometry.contact.clone(),
        }],
        ..AlongEdge::default()
    });
    let value: Value = serde_json::from_str(&summary_json(&result)).unwrap();
    let mut keys = Vec::new();
    paths(&value, "", &mut keys);
    // A run of several passes has no chip to describe, a run of one no list of passes.
    keys.retain(|key| key != "passes");
    let several = serde_json::from_str(&summary_json(&evaluate(&two_passes()).unwrap())).unwrap();
    let mut of_passes = Vec::new();
    paths(&several, "", &mut of_passes);
    keys.extend(of_passes.into_iter().filter(|key| key.starts_with("passes")));
    keys.sort();
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(folder.join("../../docs/summary_json.md")).unwrap();
    let mut described: Vec<String> = text
        .lines()
        .filter_map(|line| line.strip_prefix("| `")?.split('`').next().map(str::to_owned))
        .collect();
    described.sort();
    assert_eq!(keys, described);
    // What scripts rely on.
    assert_eq!(value["schema_version"], "2.1");
    let force = value["forces"]["cutting"]["mean_n_per_mm"].as_f64().unwrap();
    assert!((force - 200.0).abs() < 3.0, "{force}");
    assert_eq!(value["warnings"][0]["code"], "scenario");
}

#[test]
fn what_is_known_of_the_feed_force_is_said() {
    // 60 N/mm in the drawn cut, 3 mm wide.
    let result = evaluate(&run()).unwrap();
    let known = result.feed_known;
    assert!((known.mean - result.forces.feed.mean_per_width).abs() < 1e-9);
    assert!((known.mean - 60e3).abs() < 2.0 * known.half_width, "{known:?}");
    assert!(!known.drift.is_seen(), "{known}");
    // A feed force that grows by a tenth over the window is told with its drift.
    let count = run().samples.len();
    let grown = with_channel(run(), ChannelId::FeedForce, |k, force| {
        force * (1.0 + 0.3 * k as f64 / count as f64)
    });
    let result = evaluate(&grown).unwrap();
    let known = result.feed_known;
    let expected = 0.3 * 60e3 * (known.window[1] - known.window[0]) / 2.0e-3;
    assert!((known.drift.change / expected - 1.0).abs() < 0.25, "{known:?} {expected}");
    assert!(known.drift.is_seen() && known.to_string().contains("F_f drifts by +"), "{known}");
    let value: Value = serde_json::from_str(&summary_json(&result)).unwrap();
    assert_eq!(value["steady"]["feed_known"], known.to_string());
    let bound = value["steady"]["feed_possible_drift_n_per_mm"].as_f64().unwrap();
    assert!((bound - known.drift.bound() * 1e-3).abs() < 1e-9);
}

#[test]
fn the_share_of_friction_heat_is_in_the_summary() {
    let mut run = run();
    let of = |run: &Run| -> Value {
        serde_json::from_str(&summary_json(&evaluate(run).unwrap())).unwrap()
    };
    assert!(of(&run)["balances"]["friction_heat_share"].is_null());
    run.provenance.settings.push(Setting {
        section: "heat".to_owned(),
        key: "friction_heat_share".to_owned(),
        text: "0.44537".to_owned(),
        value: "0.44537".to_owned(),
        unit: String::new(),
    });
    assert_eq!(of(&run)["balances"]["friction_heat_share"], 0.44537);
}
