//! Evaluates a `run.h5` and writes its report: `cargo run -p sphcut-report --example page -- run.h5 folder`.

use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [record, folder] = arguments.as_slice() else {
        return Err("two arguments: a run.h5 and the folder of the report".into());
    };
    let run = sphcut_record::Run::load(record)?;
    let result = sphcut_postprocess::evaluate(&run)?;
    sphcut_report::write_report(&run, &result, folder)?;
    std::fs::write(folder.join("summary.json"), sphcut_postprocess::summary_json(&result))?;
    Ok(())
}
