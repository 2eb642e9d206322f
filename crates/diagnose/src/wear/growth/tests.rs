use super::*;
use sphcut_greybox::Random;

/// Five tools of 40 segments whose forces grow in `direction`, each tool at a rate of its own, with 2 N of noise. With `reset`
/// the change of the tool takes it back.
fn series(direction: impl Fn([f64; 3]) -> [f64; 3], reset: bool) -> Vec<WearSegment> {
    let mut random = Random::new(2, &[]);
    let mut grown = 0.0;
    let mut all = Vec::new();
    for tool in 0..5 {
        let fresh = [520.0, 360.0, 170.0].map(|force| force * (1.0 + 0.03 * random.normal()));
        let rate = if reset { 2.0 + f64::from(tool) } else { 3.0 };
        for k in 0..40 {
            let time = f64::from(k);
            let amount = grown + rate * time;
            let d = direction(fresh);
            let forces = [0, 1, 2].map(|c| fresh[c] + amount * d[c] + 2.0 * random.normal());
            all.push(WearSegment { tool: tool.to_string(), time, forces, land: None });
        }
        grown = if reset { 0.0 } else { grown + rate * 40.0 };
    }
    all
}

fn land(_: [f64; 3]) -> [f64; 3] {
    [0.25, 0.9, 0.436]
}

#[test]
fn a_wear_land_is_named_and_followed_on_tools_left_out() {
    let found = grows(&series(land, true), 4).unwrap();
    assert!(found.wear() > 0.99, "{:?}", found.causes);
    let land: f64 = found
        .causes
        .iter()
        .filter(|(c, _)| matches!(c, Cause::WearLand | Cause::WearLandAndStrength))
        .map(|(_, p)| p)
        .sum();
    // The ratio 0.25 is none that a rounded edge can have.
    assert!(land > 0.99, "{:?}", found.causes);
    assert!((found.direction.ratio - 0.25).abs() < 0.04, "{:?}", found.direction);
    assert!(found.ratio() < 0.2, "{}", found.ratio());
    assert!((found.noise[0] - 2.0).abs() < 0.3, "{:?}", found.noise);
    for tool in &found.left_out {
        assert!(tool.wear > 0.9, "{tool:?}");
        // The last segment: the amount since the fresh ones, whose middle is at 1.5 s.
        let last = tool.amounts.last().unwrap();
        let expected = (2.0 + tool.tool.parse::<f64>().unwrap()) * (39.0 - 1.5);
        assert!((last.force - expected).abs() < 0.06 * expected + 5.0, "{last:?} {expected}");
        // A course that only rises is followed, and what is left of it is noise.
        assert!(tool.amounts.windows(2).all(|p| p[0].never_falling <= p[1].never_falling));
        assert!((last.never_falling - expected).abs() < 0.06 * expected + 5.0, "{last:?}");
        assert!(!tool.is_unsteady() && tool.fall < 1.0, "{}", tool.fall);
    }
}

/// The insert of a tool is swapped within its life: the force falls, which the course that never falls cannot follow.
#[test]
fn a_swapped_insert_is_seen() {
    let mut all = series(land, true);
    let swapped: Vec<WearSegment> = all.iter().filter(|s| s.tool == "2").cloned().collect();
    for (k, segment) in all.iter_mut().filter(|s| s.tool == "2").enumerate() {
        segment.forces = swapped[k % 20].forces;
    }
    let found = grows(&all, 4).unwrap();
    let falling: Vec<&str> =
        found.left_out.iter().filter(|t| t.is_unsteady()).map(|t| t.tool.as_str()).collect();
    assert_eq!(falling, ["2"]);
}

#[test]
fn what_is_no_wear_is_not_called_wear() {
    let top = |segments: &[WearSegment]| grows(segments, 4).unwrap().causes[0].0;
    assert_eq!(top(&series(|_| [0.0; 3], true)), Cause::Nothing);
    let proportional = |fresh: [f64; 3]| fresh.map(|force| force / 660.0);
    assert_eq!(top(&series(proportional, true)), Cause::Strength);
    // The same direction as a land, but the new tool does not take it back.
    assert_eq!(top(&series(land, false)), Cause::ZeroDrift);
    // Forces of a rounded edge: 0.6 of the normal force.
    let rounded = grows(&series(|_| [0.6, 0.9, 0.436], true), 4).unwrap();
    assert!(rounded.wear() > 0.99, "{:?}", rounded.causes);
    // Passive force alone falls: no direction of the table.
    assert_eq!(top(&series(|_| [0.2, -0.7, 0.7], true)), Cause::NoneOfThese);
}

#[test]
fn too_little_is_refused() {
    let all = series(land, true);
    let two: Vec<WearSegment> = all.iter().filter(|s| s.tool.as_str() < "2").cloned().collect();
    assert_eq!(grows(&two, 4), Err(DiagnoseError::TooFewTools { found: 2, needed: 3 }));
    let short: Vec<WearSegment> =
        all.iter().filter(|s| s.tool != "0" || s.time < 9.0).cloned().collect();
    let error = grows(&short, 4).unwrap_err();
    assert_eq!(error, DiagnoseError::TooFewSegments { tool: "0".to_owned(), found: 9, needed: 16 });

    for (k, column) in ["F_c", "F_f", "F_p"].into_iter().enumerate() {
        let mut same = all.clone();
        same.iter_mut().for_each(|segment| segment.forces[k] = 207.7);
        let error = grows(&same, 4).unwrap_err().to_string();
        assert_eq!(
            error,
            format!("{column} does not scatter from segment to segment: was it measured?")
        );
    }
    // Times rounded to ten seconds are no mistake.
    let mut coarse = all.clone();
    coarse.iter_mut().for_each(|segment| segment.time = 10.0 * (segment.time / 10.0).floor());
    assert!(grows(&coarse, 4).unwrap().causes.iter().all(|cause| cause.1.is_finite()));
    let mut still = all;
    still.iter_mut().for_each(|segment| segment.time = 5.0);
    let error = grows(&still, 4).unwrap_err().to_string();
    assert_eq!(error, "time is the same in all segments of a tool: was it measured?");
}
