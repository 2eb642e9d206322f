//! `sphcut`: metal cutting by particles, from a scenario file to a report.

mod memory;

fn main() -> std::process::ExitCode {
    sphcut_cli::program(std::env::args_os()).into()
}
