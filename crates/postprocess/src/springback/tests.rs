use super::*;
use crate::evaluate;
use crate::synthetic::SyntheticCut;
use sphcut_record::Snapshots;
use sphcut_sph::Snapshot;

fn measured(cut: &SyntheticCut) -> Springback {
    let cut = SyntheticCut { length: 1.5e-3, height: 0.3e-3, flank_force: 14e3, ..cut.clone() };
    let run = cut.run(1.2e-3, 43);
    measure(&run, &evaluate(&run).unwrap()).unwrap()
}

#[test]
fn the_drawn_springback_is_found_whatever_the_disorder_and_the_direction() {
    for (springback, disorder, orientation) in
        [(0.0, 0.0, 0.0), (1e-6, 0.0, 0.0), (-0.5e-6, 0.2, 0.0), (1e-6, 0.2, 0.6458)]
    {
        let cut = SyntheticCut { springback, disorder, orientation, ..SyntheticCut::default() };
        let found = measured(&cut);
        let mean = found.mean.unwrap();
        // Particles are displaced by up to 0.1 spacings, 1 um, evenly: a standard deviation of
        // 0.58 um over the root of some fifty particles is 0.08 um, three times that. What the
        // recovery lacks 130 um behind the tool is e^-13.
        let allowed = 1e-11 + 0.25e-6 * disorder / 0.2;
        assert!((mean.mean - springback).abs() < allowed, "{springback}: {mean:?}");
        assert!(mean.half_width < 1e-9 + 0.4e-6 * disorder / 0.2, "{mean:?}");
        assert!(found.touched.len() > 30 && found.torn == 0, "{}", found.touched.len());
        assert_eq!(found.clear_distance, 50e-6 + 0.1e-3);
    }
}

#[test]
fn without_disorder_the_strips_agree_and_loose_particles_do_not_matter() {
    let mut cut = SyntheticCut { springback: 1e-6, disorder: 0.0, ..SyntheticCut::default() };
    for loose in [0, 40] {
        cut.loose_particles = loose;
        let strips = measured(&cut).strips;
        // Snapshots while the tool was still near show e^-13 less.
        assert!((strips.mean - 1e-6).abs() < 1e-11 && strips.roughness < 1e-11, "{strips:?}");
        assert!(strips.distance.len() > 45);
    }
}

/// Of a groove across the rows of a lattice only some particles reach the tool; the others lie deeper and carry a force all the same.
#[test]
fn what_carries_a_force_across_a_gap_is_no_surface() {
    let cut = SyntheticCut { springback: 1e-6, disorder: 0.0, ..SyntheticCut::default() };
    let cut = SyntheticCut { length: 1.5e-3, height: 0.3e-3, flank_force: 14e3, ..cut };
    let run = cut.run(1.2e-3, 43);
    let rows = (cut.height / cut.particle_spacing).round() as u64;
    let lowered = |snapshot: &Snapshot| {
        let mut snapshot = snapshot.clone();
        for index in 0..snapshot.id.len() {
            // The surface row of every second column.
            let (column, row) = (snapshot.id[index] / rows, snapshot.id[index] % rows);
            let depth = -snapshot.position[index][1] - cut.uncut_chip_thickness;
            if column % 2 != 0 && row < rows && (0.0..cut.particle_spacing).contains(&depth) {
                snapshot.position[index][1] -= 0.2 * cut.particle_spacing;
            }
        }
        snapshot
    };
    let snapshots: Vec<Snapshot> =
        (0..run.snapshots.len()).map(|k| lowered(&run.snapshots.get(k).unwrap())).collect();
    let run = Run { snapshots: Snapshots::in_memory(snapshots), ..run };
    let found = measure(&run, &evaluate(&run).unwrap()).unwrap();
    assert!((found.mean.unwrap().mean - 1e-6).abs() < 1e-9, "{:?}", found.mean);
    assert!(found.touched.len() > 15 && found.touched.len() < 30, "{}", found.touched.len());
}

/// A springback of 1 um, of 0.7 um up to `end` of the cut; the particles lie up to 0.1 um off.
fn with_run_in_to(end: f64) -> Springback {
    let cut = SyntheticCut { springback: 1e-6, disorder: 0.02, ..SyntheticCut::default() };
    let cut = SyntheticCut { length: 1.5e-3, height: 0.3e-3, flank_force: 14e3, ..cut };
    let run = cut.run(1.2e-3, 43);
    let lowered = |snapshot: &Snapshot| {
        let mut snapshot = snapshot.clone();
        let left = snapshot.tool[0][0] - cut.particle_spacing;
        for position in &mut snapshot.position {
            // Three tenths of a micrometre less once the tool has left it.
            position[1] -= if position[0] < end.min(left) { 0.3e-6 } else { 0.0 };
        }
        snapshot
    };
    let snapshots: Vec<Snapshot> =
        (0..run.snapshots.len()).map(|k| lowered(&run.snapshots.get(k).unwrap())).collect();
    let run = Run { snapshots: Snapshots::in_memory(snapshots), ..run };
    measure(&run, &evaluate(&run).unwrap()).unwrap()
}

/// The mean begins where springback is steady by itself, whatever the forces do.
#[test]
fn a_run_in_of_springback_is_left_out() {
    let found = with_run_in_to(0.45e-3);
    assert!(found.window[0] < 0.4e-3, "{:?}", found.window);
    assert!((0.42e-3..0.55e-3).contains(&found.averaged_from), "{}", found.averaged_from);
    // Disorder of up to 0.1 um, evenly: 0.06 um over the root of some thirty particles, three times that.
    assert!((found.mean.unwrap().mean - 1e-6).abs() < 0.035e-6, "{:?}", found.mean);
}

/// A mean that has to count half of the surface cannot leave out a run-in of more: its interval says so.
#[test]
fn a_run_in_of_more_than_half_of_the_surface_widens_the_interval() {
    let found = with_run_in_to(0.65e-3).mean.unwrap();
    assert!((0.7e-6..0.95e-6).contains(&found.mean), "{found:?}");
    assert!(
        found.mean + found.half_width > 1e-6 && found.mean - found.half_width < 0.7e-6,
        "{found:?}"
    );
}

#[test]
fn recovery_follows_the_drawn_one_behind_the_tool() {
    let cut = SyntheticCut {
        springback: 2e-6,
        recovery_length: 40e-6,
        disorder: 0.0,
        ..SyntheticCut::default()
    };
    for bin in measured(&cut).recovery {
        let drawn = 2e-6 * (1.0 - (-bin.behind / 40e-6).exp());
        // A bin is 25 um wide: the particles lie up to 12.5 um beside its middle where the slope
        // is at most 0.05.
        assert!((bin.height - drawn).abs() < 0.62e-6, "{bin:?}");
        assert!(bin.count > 0);
    }
}

#[test]
fn the_drawn_residual_stress_is_found_in_a_turned_frame() {
    for orientation in [0.0, 0.6458] {
        let cut = SyntheticCut {
            residual_stress: 400e6,
            residual_depth: 50e-6,
            orientation,
            disorder: 0.0,
            ..SyntheticCut::default()
        };
        let stress = measured(&cut).stress;
        // The workpiece of 300 um less the 100 um cut off, in layers of 10 um, the first and the last
        // without a neighbour.
        assert_eq!(stress.len(), 18);
        for bin in stress {
            let drawn = 400e6 * (-bin.depth / 50e-6).exp();
            assert!((bin.layer[0] / drawn - 1.0).abs() < 1e-6, "{bin:?}");
            // (1 + cosh(dx / 50 um)) / 2 = 1.01003
            assert!((bin.cutting / drawn - 1.01003).abs() < 1e-4, "{bin:?}");
            assert!((bin.across / drawn - 0.505017).abs() < 1e-4, "{bin:?}");
            assert!(bin.normal.abs() < 1.0, "{bin:?}");
        }
    }
}

#[test]
fn stress_that_alternates_between_the_rows_is_not_taken_for_residual_stress() {
    let cut = SyntheticCut {
        length: 1.5e-3,
        height: 0.3e-3,
        residual_stress: 100e6,
        residual_depth: 1.0,
        disorder: 0.0,
        ..SyntheticCut::default()
    };
    let mut run = cut.run(1.2e-3, 5);
    let snapshots = (0..run.snapshots.len()).map(|number| {
        let mut snapshot = (*run.snapshots.get(number).unwrap()).clone();
        for (stress, position) in snapshot.stress.iter_mut().zip(&snapshot.position) {
            // 1 GPa in the first row, 50 MPa less with every row.
            let row = ((-0.1e-3 - position[1]) / 10e-6).floor();
            let size = (1e9 - 50e6 * row) * if row % 2.0 == 0.0 { 1.0 } else { -1.0 };
            (0..3).for_each(|k| stress[k] += size);
        }
        snapshot
    });
    run.snapshots = sphcut_record::Snapshots::in_memory(snapshots.collect());
    let stress = measure(&run, &evaluate(&run).unwrap()).unwrap().stress;
    assert!((stress[0].layer[0] + 850e6).abs() < 1e6, "{:?}", stress[0]);
    for bin in stress {
        // The depth scale of the drawn stress is 1 m.
        assert!((bin.cutting - 100e6).abs() < 0.1e6 && bin.normal.abs() < 0.1e6, "{bin:?}");
    }
}

/// A tool that lies lower overlaps the surface it has made: a softer contact.
#[test]
fn what_the_contact_adds_at_the_lowest_point_is_taken_off() {
    let cut = SyntheticCut { springback: 1e-6, disorder: 0.0, ..SyntheticCut::default() };
    let cut = SyntheticCut { length: 1.5e-3, height: 0.3e-3, flank_force: 14e3, ..cut };
    let run = cut.run(1.2e-3, 43);
    let pressed_by = |overlap: f64| {
        let lowered = (0..run.snapshots.len()).map(|number| {
            let mut snapshot = (*run.snapshots.get(number).unwrap()).clone();
            snapshot.tool.iter_mut().for_each(|corner| corner[1] -= overlap);
            snapshot
        });
        let lowered = Snapshots::in_memory(lowered.collect());
        let run = Run { snapshots: lowered, facts: run.facts.clone(), ..cut.run(1.2e-3, 43) };
        measure(&run, &evaluate(&run).unwrap()).unwrap()
    };
    let (hard, soft) = (pressed_by(0.0), pressed_by(0.2e-6));
    assert!((soft.overlap.mean - hard.overlap.mean - 0.2e-6).abs() < 1e-9, "{:?}", soft.overlap);
    assert!((soft.mean.unwrap().mean - hard.mean.unwrap().mean).abs() < 1e-9, "{:?}", soft.mean);
    assert!((soft.error.overlap - OVERLAP_SHARE * soft.overlap.mean).abs() < 1e-15);
    assert!((soft.error.resolution - 0.1e-6).abs() < 1e-15);
    let sum = soft.mean.unwrap().half_width + soft.error.overlap + 0.1e-6;
    assert!((soft.error.total() - sum).abs() < 1e-12);
}

/// Every third column lies 0.3 um lower, under the tool and behind it: neither mean nor median has it.
#[test]
fn a_hollow_under_the_tool_is_no_springback() {
    let cut = SyntheticCut { springback: 1e-6, disorder: 0.0, ..SyntheticCut::default() };
    let cut = SyntheticCut { length: 1.5e-3, height: 0.3e-3, flank_force: 14e3, ..cut };
    let run = cut.run(1.2e-3, 241);
    let rows = (cut.height / cut.particle_spacing).round() as u64;
    let hollow = (0..run.snapshots.len()).map(|number| {
        let mut snapshot = (*run.snapshots.get(number).unwrap()).clone();
        for index in 0..snapshot.id.len() {
            if (snapshot.id[index] / rows).is_multiple_of(3) {
                snapshot.position[index][1] -= 0.3e-6;
            }
        }
        snapshot
    });
    let hollow = Snapshots::in_memory(hollow.collect());
    let run = Run { snapshots: hollow, facts: run.facts.clone(), ..cut.run(1.2e-3, 43) };
    let found = measure(&run, &evaluate(&run).unwrap()).unwrap();
    assert!((found.mean.unwrap().mean - 1e-6).abs() < 0.02e-6, "{:?}", found.mean);
    assert!((found.median.unwrap().median - 1e-6).abs() < 1e-9, "{:?}", found.median);
}

#[test]
fn an_overlap_of_one_particle_is_not_known() {
    assert_eq!(Overlap::of(&[1e-7]).half_width, f64::INFINITY);
    let two = Overlap::of(&[1e-7, 3e-7]);
    // A standard deviation of 0.1414 um over the root of two.
    assert!((two.mean - 2e-7).abs() < 1e-15 && (two.half_width - 2e-7).abs() < 1e-12, "{two:?}");
}

#[test]
fn runs_without_a_machined_surface_are_refused() {
    let refused = |run: &Run| measure(run, &evaluate(run).unwrap()).unwrap_err().to_string();
    let mut run = SyntheticCut::default().run(0.3e-3, 5);
    // 4 dx + (50 + 100) um + 20 dx = 390 um, and 4 um that the lowest point is behind the travel.
    assert!(refused(&run).contains("0.394 mm are needed"), "{}", refused(&run));
    let enough = SyntheticCut::default().run(0.396e-3, 5);
    assert!(measure(&enough, &evaluate(&enough).unwrap()).is_ok());
    let short = SyntheticCut::default().run(0.392e-3, 5);
    assert!(refused(&short).contains("0.394 mm are needed"), "{}", refused(&short));
    run.facts.tool_velocity = None;
    assert!(refused(&run).contains("no cut"));
    assert!(refused(&SyntheticCut::default().run(1e-3, 0)).contains("no snapshots"));
}

/// `run` as if a window had given up what lies more than `behind` behind the edge.
fn windowed(mut run: Run, behind: f64) -> Run {
    let snapshots = (0..run.snapshots.len()).map(|number| {
        let mut snapshot = (*run.snapshots.get(number).unwrap()).clone();
        let edge = snapshot.tool.iter().min_by(|a, b| a[1].total_cmp(&b[1])).unwrap()[0];
        let kept: Vec<bool> =
            snapshot.position.iter().map(|place| place[0] >= edge - behind).collect();
        let mut keep = kept.iter();
        snapshot.position.retain(|_| *keep.next().unwrap());
        let mut keep = kept.iter();
        snapshot.id.retain(|_| *keep.next().unwrap());
        let mut keep = kept.iter();
        snapshot.stress.retain(|_| *keep.next().unwrap());
        let mut keep = kept.iter();
        snapshot.contact_force.retain(|_| *keep.next().unwrap());
        snapshot
    });
    run.snapshots = sphcut_record::Snapshots::in_memory(snapshots.collect());
    run
}

#[test]
fn a_window_that_keeps_the_surface_until_it_is_clear_gives_the_same_springback() {
    let cut = SyntheticCut {
        springback: 1e-6,
        disorder: 0.0,
        length: 1.5e-3,
        height: 0.3e-3,
        flank_force: 14e3,
        ..SyntheticCut::default()
    };
    let measure = |run: &Run| measure(run, &evaluate(&cut.run(1.2e-3, 43)).unwrap());
    let whole = measure(&cut.run(1.2e-3, 43)).unwrap();
    let kept = measure(&windowed(cut.run(1.2e-3, 43), 0.4e-3)).unwrap();
    assert!((kept.mean.unwrap().mean - 1e-6).abs() < 1e-11, "{:?}", kept.mean);
    assert_eq!(kept.window, whole.window);
    // Clear of the tool are 150 um, and four spacings of 10 um for the particles to be seen.
    let short = measure(&windowed(cut.run(1.2e-3, 43), 0.12e-3));
    let refused = short.err().map(|error| error.to_string()).unwrap_or_default();
    assert!(refused.starts_with("the moving window keeps 0.1"), "{refused}");
    assert!(refused.ends_with("0.190 mm are needed: `behind` in [window]"), "{refused}");
}

#[test]
fn a_wear_land_has_two_ends() {
    let corners = [[0.0, -1e-4], [-2e-4, -1e-4], [-1e-3, 0.0], [0.0, 1e-3]];
    let lowest = Lowest::of(&corners, 1e-5).unwrap();
    assert_eq!((lowest.rear, lowest.front, lowest.height), (-2e-4, 0.0, -1e-4));
    assert_eq!(Lowest::of(&[], 1e-5), None);
}

#[test]
fn a_comparison_knows_what_it_cannot_decide() {
    let found = measured(&SyntheticCut { disorder: 0.0, ..SyntheticCut::default() });
    assert!(!found.is_resolved());
    let verdict = |springback: f64, cutting_speed: f64| {
        let measurement = Measurement {
            cutting_speed,
            springback,
            uncertainty: 0.85e-6,
            cutting_force: None,
            normal_force: None,
        };
        found.compare(&[measurement]).map(|comparison| comparison.agreement)
    };
    // The error bar is 1 % of 10 um and no more: 0.85 + 0.1 = 0.95 um.
    assert_eq!(verdict(0.8e-6, 2.5), Some(Agreement::Within));
    assert_eq!(verdict(0.91e-6, 2.51), Some(Agreement::Undecided));
    assert_eq!(verdict(-0.97e-6, 2.5), Some(Agreement::Outside));
    assert_eq!(verdict(0.8e-6, 2.6), None);
}

#[test]
fn the_files_hold_the_figures_with_their_units() {
    let run = SyntheticCut {
        springback: 1e-6,
        disorder: 0.0,
        flank_force: 14e3,
        ..SyntheticCut::default()
    }
    .run(1.2e-3, 22);
    let result = evaluate(&run).unwrap();
    let springback = measure(&run, &result).unwrap();
    let entry = SpringbackEntry { name: "a, \"b\"", result: &result, springback: &springback };
    let measurement = Measurement {
        cutting_speed: 2.5,
        springback: 1.5e-6,
        uncertainty: 0.85e-6,
        cutting_force: Some(600.0),
        normal_force: None,
    };
    let csv = springback_csv(&[entry], &[measurement]);
    let lines: Vec<&str> = csv.lines().collect();
    assert!(lines[0].starts_with("run,v_c [m/min],springback [um]"));
    assert!(
        lines[1].starts_with("\"a, \"\"b\"\"\",150,") && lines[1].ends_with(",within"),
        "{csv}"
    );
    let json: serde_json::Value =
        serde_json::from_str(&springback_json(&[entry], &[measurement])).unwrap();
    let of = |key: &str| json["runs"][0][key].as_f64().unwrap();
    assert!((of("springback_um") - 1.0).abs() < 1e-4 && of("cutting_speed_m_per_min") == 150.0);
    assert_eq!(json["runs"][0]["comparison"]["agreement"], "within");
    assert_eq!(json["runs"][0]["comparison"]["measured_cutting_force_n"], 600.0);
}
