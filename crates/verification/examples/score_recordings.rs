//! Scores what the diagnoses of real recordings said against what was concealed from them:
//! `cargo run --release -p sphcut-verification --example score_recordings`.
//!
//! The concealed columns are not in the repository; without `../shared/data` beside it this says so and ends.

use sphcut_verification::diagnoses::{score_edge_radius, score_wear};
use sphcut_verification::{CaseBody, cases};
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let data = root.join("../shared/data");
    if !data.is_dir() {
        println!("the concealed columns (../shared/data) are not here: nothing is scored");
        return Ok(());
    }
    for case in cases(&root.join("validation"))? {
        let CaseBody::Diagnoses(diagnoses) = &case.body else { continue };
        match case.head.name.as_str() {
            "diagnosis_klippel" => print!("{}", score_edge_radius((&case.head, diagnoses), &data)?),
            "diagnosis_wear" => print!("{}", score_wear((&case.head, diagnoses), &data)?),
            _ => {}
        }
    }
    Ok(())
}
