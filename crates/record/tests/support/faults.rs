//! Faults at the N-th operation of a program that changes a file: see `faults.c`.

use std::path::{Path, PathBuf};
use std::process::Command;

/// What happens there, by turns.
const KINDS: [&str; 4] = ["full", "error", "kill", "power"];

/// The library that is loaded before the program.
pub struct Shim {
    library: PathBuf,
    folder: PathBuf,
}

/// One fault.
#[derive(Debug, Clone, Copy)]
pub struct Fault {
    pub kind: &'static str,
    pub at: u64,
}

impl Shim {
    /// Compiled into `folder`; `None`, and a message, where that is not possible.
    pub fn compiled(folder: &Path) -> Option<Self> {
        let source = concat!(env!("CARGO_MANIFEST_DIR"), "/../record/tests/support/faults.c");
        let library = folder.join("faults.so");
        let mut compiler = Command::new("gcc");
        compiler.args(["-shared", "-fPIC", "-O1", "-o"]).arg(&library).args([source, "-ldl"]);
        let done = cfg!(target_os = "linux") && compiler.status().is_ok_and(|done| done.success());
        if !done {
            eprintln!("skipped: no gcc that makes a library to be loaded before a program");
        }
        done.then(|| Self { library, folder: folder.to_owned() })
    }

    /// Ends `command`, with `fault` below `root`; its exit code, `None` if it was killed.
    pub fn run(&self, mut command: Command, root: &Path, fault: Option<Fault>) -> Option<i32> {
        if let Some(Fault { kind, at }) = fault {
            command.env("LD_PRELOAD", &self.library).env("FAULT_ROOT", root);
            command.env("FAULT_KIND", kind).env("FAULT_AT", at.to_string());
            let _ = std::fs::remove_file(self.log());
            command.env("FAULT_LOG", self.log());
        }
        command.output().unwrap().status.code()
    }

    fn log(&self) -> PathBuf {
        self.folder.join("operations")
    }

    /// Operations of the last program, or of the process it started that had most.
    pub fn operations(&self) -> u64 {
        let log = std::fs::read_to_string(self.log()).unwrap();
        log.lines().map(|line| line.parse().unwrap()).max().unwrap()
    }
}

/// Positions that a test tries: some, or the number in `SPHCUT_FAULTS`.
fn positions() -> u64 {
    std::env::var("SPHCUT_FAULTS").map_or(6, |count| count.parse().unwrap())
}

/// Puts faults at places spread over what `attempt` does, each on what `reset` prepares. A program that ends with 0 must
/// have left what an undisturbed one leaves (`answer`); one that does not must say so by one of `codes`, and a second,
/// undisturbed attempt gives the same answer.
pub fn at_every_place<A: PartialEq>(
    (what, shim, codes): (&str, &Shim, &[i32]),
    reset: impl Fn(),
    attempt: impl Fn(Option<Fault>) -> Option<i32>,
    answer: impl Fn() -> A,
) {
    reset();
    assert_eq!(attempt(Some(Fault { kind: "error", at: 0 })), Some(0), "{what}");
    let (expected, operations, count) = (answer(), shim.operations(), positions());
    let (mut told, mut killed) = (0, 0);
    for number in 0..count {
        let at = 1 + (number * operations + number % operations) / count % operations;
        let fault = Fault { kind: KINDS[(number % 4) as usize], at };
        reset();
        match attempt(Some(fault)) {
            Some(0) => {
                assert!(answer() == expected, "{what}, {fault:?}: exit 0 with another answer");
                continue;
            }
            Some(code) if codes.contains(&code) => told += 1,
            None if matches!(fault.kind, "kill" | "power") => killed += 1,
            other => panic!("{what}, {fault:?}: ended with {other:?}"),
        }
        assert_eq!(attempt(None), Some(0), "{what}, {fault:?}: does not go on");
        assert!(answer() == expected, "{what}, {fault:?}: goes on to another answer");
    }
    let harmless = count - told - killed;
    eprintln!(
        "{what}: {count} faults over {operations} operations: {told} told, {killed} killed, {harmless} without harm"
    );
}
