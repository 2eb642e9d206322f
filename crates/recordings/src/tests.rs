//! Records with a known truth.

use super::*;
use sphcut_physics::Channel;
use sphcut_postprocess::synthetic::SyntheticChannel;

fn settings() -> EvaluationSettings {
    let channel = |component: Channel, name: &str| ForceChannel {
        component,
        name: name.to_owned(),
        scale: 1.0,
        full_scale: None,
        response: None,
    };
    EvaluationSettings {
        time: TimeSource { sampling_rate: Some(2000.0), ..TimeSource::default() },
        channels: vec![channel(Channel::CuttingForce, "Fx"), channel(Channel::FeedForce, "Fy")],
        trigger: None,
        detection: Detection::Automatic { smoothing: 0.02 },
        guard: 0.02,
        shortest_air: 0.05,
        low_pass: Some((4, 400.0)),
        precision: 0.02,
        largest_drift: 0.05,
        unsteady: Unsteady::Refuse,
    }
}

fn conditions() -> Conditions {
    Conditions {
        name: "cut".to_owned(),
        cutting_speed: 2.5,
        uncut_chip_thickness: 0.1e-3,
        revolution: Some(10.0),
        order: 1,
        ..Conditions::default()
    }
}

fn table(x: Vec<f64>, y: Vec<f64>) -> RawTable {
    let column = |name: &str, values| RawColumn { name: name.to_owned(), values, clock: None };
    RawTable { columns: vec![column("Fx", x), column("Fy", y)] }
}

/// A cut with everything that a real one has: 500 N and 250 N.
fn channel(force: f64) -> SyntheticChannel {
    SyntheticChannel {
        force,
        transient: (0.2, 0.05),
        offset: 35.0,
        drift: -4.0,
        noise: [2.0, 0.03 * force],
        memory: 0.004,
        run_out: (10.0, 0.05 * force),
        resonance: (700.0, 0.04 * force),
        ..SyntheticChannel::default()
    }
}

fn record(seed: u64) -> RawTable {
    table(channel(500.0).series(2 * seed), channel(250.0).series(2 * seed + 1))
}

#[test]
fn a_record_gives_its_forces_back() {
    let cut = evaluate_cut(&record(1), &settings(), &conditions());
    assert!(cut.accepted, "{:?}", cut.faults);
    assert!(cut.faults.is_empty(), "{:?}", cut.faults);
    for (component, truth) in [(Channel::CuttingForce, 500.0), (Channel::FeedForce, 250.0)] {
        let found = cut.component(component).unwrap();
        assert!((found.mean - truth).abs() < 2.0 * found.ci95, "{component:?}: {}", found.mean);
        assert!(found.ci95 < 0.01 * truth, "{component:?}: {}", found.ci95);
        // From the middle of 0.25 to that of 2.75 s at -4 N/s.
        assert!((found.zero.drift().unwrap() + 10.0).abs() < 1.0);
        let line = found.revolution.unwrap();
        // 3 % noise with a correlation time of 8 ms over 1.8 s: 0.3 % of the force.
        assert!((line.amplitudes[0] - 0.05 * truth).abs() < 0.009 * truth, "{line:?}");
        assert!(line.stands_out());
        let nearest = found.resonances.first().unwrap();
        assert!((nearest.frequency - 700.0).abs() < 10.0, "{:?}", found.resonances);
    }
    let span = cut.span.unwrap();
    assert!(span.entry.abs_diff(1000) < 30 && span.exit.abs_diff(5000) < 30, "{span:?}");
    // Whole revolutions of 200 samples, after the transient.
    let window = cut.window.unwrap();
    assert_eq!((window.exit - window.entry) % 200, 0);
    assert!(window.exit <= 4990 && window.entry > 1100, "{window:?}");
}

#[test]
fn the_interval_covers_the_truth_as_often_as_it_says() {
    // The numbers of 200 covered at 95 % lie between 181 and 198 in 99.8 % of all trials if the interval
    // is exact; one that takes the wider of two estimates may cover more.
    let (mut covered, mut accepted, mut widths) = ([0, 0], 0, 0.0);
    for seed in 0..200 {
        let cut = evaluate_cut(&record(1000 + seed), &settings(), &conditions());
        accepted += u32::from(cut.accepted);
        for (k, truth) in [500.0, 250.0].into_iter().enumerate() {
            let found = &cut.components[k];
            covered[k] += u32::from((found.mean - truth).abs() <= found.ci95);
            widths += found.ci95 / truth / 400.0;
        }
    }
    assert!(covered.iter().all(|c| (181..=200).contains(c)), "{covered:?}");
    assert!(accepted >= 180, "{accepted} of 200 good records accepted");
    // 3 % noise, tau = 2 * 4 ms over 1.8 s, quantile 2.1: 0.42 %; wider by the choice of the wider estimate.
    assert!(widths > 0.003 && widths < 0.008, "{widths}");
}

/// Faults of a record after `change`.
fn faults(change: impl Fn(&mut RawTable, &mut EvaluationSettings)) -> (bool, Vec<Fault>) {
    let (mut table, mut settings) = (record(5), settings());
    change(&mut table, &mut settings);
    let cut = evaluate_cut(&table, &settings, &conditions());
    (cut.accepted, cut.faults)
}

/// With time stamps that `stamp` gives each sample.
fn stamped(stamp: impl Fn(usize) -> f64) -> impl Fn(&mut RawTable, &mut EvaluationSettings) {
    move |table, settings| {
        let values = (0..table.columns[0].values.len()).map(&stamp).collect();
        table.columns.push(RawColumn { name: "t".to_owned(), values, clock: None });
        settings.time.column = Some(("t".to_owned(), 1.0));
    }
}

macro_rules! refused {
    ($change:expr, $fault:pat) => {{
        let (accepted, found) = faults($change);
        assert!(!accepted, "accepted: {found:?}");
        assert!(found.iter().any(|fault| matches!(fault, $fault)), "{found:?}");
        assert!(found.iter().all(|fault| !fault.to_string().is_empty()));
    }};
}

#[test]
fn missing_samples_are_named_and_bridged_only_where_allowed() {
    let hole = |from: usize, to: usize| {
        move |table: &mut RawTable, _: &mut EvaluationSettings| {
            table.columns[0].values[from..to].fill(f64::NAN);
        }
    };
    refused!(hole(3000, 3001), Fault::Gap { samples: 1, .. });
    let (accepted, found) = faults(|table, settings| {
        hole(3000, 3004)(table, settings);
        settings.time.longest_gap = 0.0025;
    });
    assert!(accepted && found.contains(&Fault::Bridged { channel: "Fx".to_owned(), samples: 4 }));
    refused!(
        |table: &mut RawTable, settings: &mut EvaluationSettings| {
            hole(3000, 3005)(table, settings);
            settings.time.longest_gap = 0.0025;
        },
        Fault::Gap { samples: 5, .. }
    );
    // A gap in the time stamps: fifty samples were not written.
    let jump = |k: usize| (k + if k >= 3000 { 50 } else { 0 }) as f64 / 2000.0;
    refused!(stamped(jump), Fault::Gap { samples: 50, .. });
    // An infinite number is none.
    refused!(
        |table: &mut RawTable, _: &mut EvaluationSettings| table.columns[1].values[7] =
            f64::INFINITY,
        Fault::Gap { .. }
    );
}

#[test]
fn clocks_that_do_not_agree_are_named() {
    let (accepted, found) = faults(stamped(|k| 12.5 + k as f64 / 2000.0));
    assert!(accepted && found.is_empty(), "{found:?}");
    refused!(stamped(|k| k as f64 / 2004.0), Fault::RateDiffers { .. });
    refused!(
        stamped(|k| if k == 900 { 0.0 } else { k as f64 / 2000.0 }),
        Fault::TimeNotRising { .. }
    );
    refused!(stamped(|k| (k as f64 / 2000.0).powi(2)), Fault::UnevenClock { .. });
    // Stamps with three decimals at 2 kHz: the even clock through them is right.
    let (accepted, found) = faults(stamped(|k| (k as f64 / 2.0).floor() / 1000.0));
    assert!(accepted && matches!(found[..], [Fault::CoarseTime { .. }]), "{found:?}");
    refused!(
        |table: &mut RawTable, _: &mut EvaluationSettings| {
            table.columns[0].clock = Some((0.0, 0.0005));
            table.columns[1].clock = Some((0.0, 0.000_501));
        },
        Fault::UnequalClocks { .. }
    );
    refused!(
        |table: &mut RawTable, _: &mut EvaluationSettings| table.columns[1].values.truncate(5990),
        Fault::UnequalLengths { .. }
    );
    refused!(
        |_: &mut RawTable, settings: &mut EvaluationSettings| settings.time.sampling_rate = None,
        Fault::NoClock
    );
}

#[test]
fn what_a_chain_does_to_a_signal_is_named() {
    refused!(
        |table: &mut RawTable, _: &mut EvaluationSettings| {
            table.columns[0].values.iter_mut().for_each(|v| *v = v.min(540.0));
        },
        Fault::Clipped { .. }
    );
    refused!(
        |_: &mut RawTable, settings: &mut EvaluationSettings| settings.channels[0].full_scale =
            Some(550.0),
        Fault::Clipped { .. }
    );
    refused!(
        |_: &mut RawTable, settings: &mut EvaluationSettings| settings.channels[0].scale = -1.0,
        Fault::WrongSign { .. }
    );
    let (accepted, found) = faults(|_, settings| settings.channels[1].scale = -1.0);
    assert!(accepted && matches!(found[..], [Fault::NegativeFeed { .. }]), "{found:?}");
    refused!(
        |_: &mut RawTable, settings: &mut EvaluationSettings| settings.channels[1].name =
            "Fz".to_owned(),
        Fault::MissingChannel { .. }
    );
    refused!(
        |_: &mut RawTable, settings: &mut EvaluationSettings| settings.low_pass = Some((4, 1000.0)),
        Fault::LowPassTooHigh { .. }
    );
    let trigger = |high: f64| {
        move |table: &mut RawTable, settings: &mut EvaluationSettings| {
            let on = |k: usize| if (1000..5000).contains(&k) { high } else { 0.0 };
            let values = (0..6000).map(on).collect();
            table.columns.push(RawColumn { name: "T".to_owned(), values, clock: None });
            settings.trigger = Some("T".to_owned());
            settings.detection = Detection::Trigger { level: 2.5 };
        }
    };
    refused!(trigger(2.0), Fault::NoTrigger { .. });
    let (accepted, found) = faults(trigger(5.0));
    assert!(accepted && found.is_empty(), "{found:?}");
}

#[test]
fn where_the_zero_is_not_known_it_is_said() {
    let keep = |from: usize, to: usize| {
        move |table: &mut RawTable, _: &mut EvaluationSettings| {
            for column in &mut table.columns {
                column.values = column.values[from..to].to_vec();
            }
        }
    };
    let (accepted, found) = faults(keep(0, 4500));
    assert!(accepted, "{found:?}");
    assert_eq!(found, [Fault::EndsInCut, Fault::DriftUnknown]);
    let (accepted, found) = faults(keep(1500, 6000));
    assert!(accepted, "{found:?}");
    assert_eq!(found, [Fault::BeginsInCut, Fault::DriftUnknown]);
    refused!(keep(1500, 4500), Fault::NoCut { .. });
    refused!(
        |table: &mut RawTable, settings: &mut EvaluationSettings| {
            keep(950, 5050)(table, settings);
        },
        Fault::NoAirCut { .. }
    );
}

#[test]
fn a_cut_that_is_not_steady_gives_no_force_unless_asked() {
    let ramp = |table: &mut RawTable, _: &mut EvaluationSettings| {
        for (k, value) in table.columns[0].values.iter_mut().enumerate() {
            let share = (k as f64 - 1000.0) / 4000.0;
            *value += if (0.0..1.0).contains(&share) { 120.0 * share } else { 0.0 };
        }
    };
    refused!(ramp, Fault::Unsteady { .. });
    let (accepted, found) = faults(|table, settings| {
        ramp(table, settings);
        settings.unsteady = Unsteady::Keep;
    });
    assert!(accepted && matches!(found[..], [Fault::Unsteady { .. }]), "{found:?}");
    refused!(
        |_: &mut RawTable, settings: &mut EvaluationSettings| settings.precision = 0.001,
        Fault::Unsteady { reason: NotSteady::Imprecise { .. }, .. }
    );
}

#[test]
fn repeats_are_pooled() {
    let cut = |seed: u64, force: f64, thickness: f64| {
        let x = SyntheticChannel { force, ..channel(500.0) }.series(seed);
        let known = Conditions { uncut_chip_thickness: thickness, ..conditions() };
        evaluate_cut(&table(x, channel(250.0).series(seed + 1)), &settings(), &known)
    };
    let cuts =
        [cut(10, 500.0, 1e-4), cut(20, 510.0, 1e-4), cut(30, 490.0, 1e-4), cut(40, 800.0, 2e-4)];
    let pooled = pool(&cuts);
    assert_eq!(pooled.conditions.len(), 2);
    let first = &pooled.conditions[0];
    assert_eq!(first.cuts, [0, 1, 2]);
    let force = first.forces[0];
    assert!((force.mean - 500.0).abs() < 2.0, "{force:?}");
    // 490, 500, 510: 2 %, and 0.25 % of each mean.
    assert!((force.deviation - 10.0).abs() < 2.5, "{force:?}");
    // t(2) = 4.303 over sqrt(3); of one cut the same without the root.
    assert!((force.ci95 - 4.303 * force.deviation / 3_f64.sqrt()).abs() < 1e-2, "{force:?}");
    let single = pooled.conditions[1].forces[0];
    assert!((single.ci95 / single.mean - 4.303 * force.deviation / force.mean).abs() < 1e-4);
    // Without repeats the interval is that within the cut.
    let alone = pool(&cuts[3..]);
    assert!(alone.repeatability.is_empty());
    let found = alone.conditions[0].forces[0];
    assert!((found.ci95 - cuts[3].components[0].ci95).abs() < 1e-12);
}

mod files_of_strangers {
    use super::*;
    use crate::formats::{CsvLayout, DecimalMark, Separator, read_csv, read_lvm};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_text_makes_a_reader_panic(text in "(LabVIEW Measurement\t\n)?[0-9a-zX_*;:,.\t\r\n \"-]{0,300}", header in 0_usize..4) {
            for separator in [Separator::Comma, Separator::Semicolon, Separator::Tab, Separator::Space] {
                for decimal in [DecimalMark::Point, DecimalMark::Comma] {
                    let _ = read_csv(&text, CsvLayout { separator, decimal, header, skip: header });
                }
            }
            let _ = read_lvm(&text);
        }

        #[test]
        fn no_numbers_make_the_evaluation_panic(
            values in proptest::collection::vec(proptest::num::f64::ANY, 0..400),
            times in proptest::collection::vec(proptest::num::f64::ANY, 0..400),
            stamped in any::<bool>(),
        ) {
            let mut table = table(values.clone(), values);
            table.columns.push(RawColumn { name: "t".to_owned(), values: times, clock: None });
            let mut settings = settings();
            settings.time.column = stamped.then(|| ("t".to_owned(), 1.0));
            let _ = evaluate_cut(&table, &settings, &conditions());
        }

        #[test]
        fn no_record_makes_the_evaluation_panic(
            levels in proptest::collection::vec(-1e6..1e6_f64, 2..12),
            length in 20_usize..200,
            revolution in proptest::option::of(0.01..5000.0_f64),
            cut_off in 1.0..2000.0_f64,
        ) {
            let values: Vec<f64> = levels.iter().flat_map(|level| {
                (0..length).map(move |k| level + (k as f64 * 1.7).sin())
            }).collect();
            let table = table(values.clone(), values);
            let settings = EvaluationSettings { low_pass: Some((4, cut_off)), ..settings() };
            let known = Conditions { revolution, ..conditions() };
            let cut = evaluate_cut(&table, &settings, &known);
            let _ = (cuts_csv(std::slice::from_ref(&cut)), forces_csv(&pool(&[cut])));
        }
    }
}
