//! A cluster of one node, for the time of a test.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

/// Exit code of the script where no cluster can be started.
const IMPOSSIBLE: i32 = 77;
/// A task that is queued again begins a minute or two later; a node that died is missed after ten seconds. A busy machine takes several times as long.
const PATIENCE: Duration = Duration::from_secs(600);

/// A running cluster; it ends with this value.
pub struct Cluster {
    folder: PathBuf,
}

impl Cluster {
    /// Starts it; none, with the reason on standard error, where that is not possible.
    pub fn start() -> Option<Self> {
        // Paths of sockets are short.
        let folder = std::env::temp_dir().join(format!("sphcut_slurm_{}", std::process::id()));
        let cluster = Self { folder };
        let output = cluster.ask("start");
        if output.status.code() == Some(IMPOSSIBLE) {
            // Not by `eprintln!`, which a test that passes keeps to itself.
            let reason = String::from_utf8_lossy(&output.stderr);
            let _ = writeln!(std::io::stderr(), "skipped, sweeps on a cluster: {reason}");
            return None;
        }
        assert!(output.status.success(), "{output:?}");
        Some(cluster)
    }

    /// Runs the script with `what` to do.
    pub fn script(&self, what: &str) {
        let output = self.ask(what);
        assert!(output.status.success(), "{what}: {output:?}");
    }

    fn ask(&self, what: &str) -> Output {
        let script =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/end_to_end/cluster/cluster.sh");
        Command::new("bash").arg(script).arg(what).arg(&self.folder).output().unwrap()
    }

    /// `command` with this cluster in reach.
    pub fn known_to<'c>(&self, command: &'c mut Command) -> &'c mut Command {
        command.env("SLURM_CONF", self.folder.join("slurm.conf"))
    }

    /// Runs a command of Slurm; what it says.
    pub fn command(&self, program: &str, arguments: &[&str]) -> String {
        let mut command = Command::new(program);
        let output = self.known_to(command.args(arguments)).output().unwrap();
        assert!(output.status.success(), "{program} {arguments:?}: {output:?}");
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// What has not ended.
    pub fn queue(&self) -> Vec<String> {
        let said = self.command("squeue", &["--noheader", "--array"]);
        said.lines().map(str::to_owned).collect()
    }

    /// Waits until `happened` says so.
    pub fn wait<T>(&self, what: &str, happened: impl Fn() -> Option<T>) -> T {
        let start = Instant::now();
        loop {
            if let Some(found) = happened() {
                return found;
            }
            assert!(start.elapsed() < PATIENCE, "{what} does not come: {:#?}", self.queue());
            std::thread::sleep(Duration::from_millis(200));
        }
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        let _ = self.ask("stop");
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}
