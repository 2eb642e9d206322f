//! Sweeps on a real Slurm cluster: controller and node daemon on this machine, started by `cluster.sh`.
//!
//! Skipped, with the reason, where none can be started.

use super::SUBMIT;
use super::one_node::Cluster;
use crate::common::{Ended, TINY, Workshop};
use crate::sweep::forces;
use serde_json::Value;
use std::collections::BTreeMap;

/// Twelve runs.
const SWEEP: &str = "title = \"Friction\"\nbase = \"tiny.toml\"\n[[vary]]\nkey = \"tool.friction.friction_coefficient\"\n\
                     from = 0.05\nto = 0.60\nstep = 0.05\n";

/// What a run that is under way has in its folder.
const CHECKPOINT: &str = "run.partial/checkpoint.bin";

/// A folder with the sweep.
fn shop(name: &str, sweep: &str, travel: &str) -> Workshop {
    // A blank and a quote in the path go through scripts and queues.
    let shop = Workshop::new(&format!("o'hara {name}"));
    shop.write(
        "tiny.toml",
        &TINY.replace("travel = \"0.2 mm\"", &format!("travel = \"{travel}\"")),
    );
    shop.write("sweep.toml", sweep);
    shop
}

/// Runs the program with the cluster in reach.
fn sphcut(cluster: &Cluster, shop: &Workshop, arguments: &[&str]) -> Ended {
    let mut command = shop.command(arguments);
    Ended::from(cluster.known_to(&mut command).output().unwrap())
}

fn status(cluster: &Cluster, shop: &Workshop) -> (Option<i32>, Value) {
    let ended = sphcut(cluster, shop, &["sweep", "status", "out", "--json"]);
    let page = serde_json::from_str(&ended.out).unwrap_or_else(|_| panic!("{ended:?}"));
    (ended.code, page)
}

/// Waits until the collecting job has ended, too.
fn wait_for_end(cluster: &Cluster, shop: &Workshop) {
    cluster.wait("the end of all jobs", || cluster.queue().is_empty().then_some(()));
    assert_eq!(status(cluster, shop).1["tasks_in_queue"], 0);
}

/// The same sweep computed here.
fn undisturbed(shop: &Workshop) -> BTreeMap<String, String> {
    shop.sphcut(&["sweep", "sweep.toml", "--out", "here", "--quiet"]).expect_code(0);
    forces(shop, "here/store")
}

fn whole(shop: &Workshop, runs: usize) {
    let found = forces(shop, "out/store");
    assert_eq!(found.len(), runs);
    assert!(found == undisturbed(shop), "the bits of a sweep that nobody disturbed");
    let unfinished = std::fs::read_dir(shop.path("out/store/work")).unwrap().count();
    assert_eq!(unfinished, 0);
    let table = shop.read("out/table.csv");
    assert_eq!(table.lines().filter(|line| line.contains(",finished,")).count(), runs, "{table}");
}

/// One cluster for all: its start is not what is tested, and its jobs wait for each other.
#[test]
fn sweeps_on_a_cluster() {
    let Some(cluster) = Cluster::start() else { return };
    refused(&cluster);
    computed_and_collected(&cluster);
    lost_with_its_node(&cluster);
    cancelled_by_hand(&cluster);
    cancelled_by_sphcut(&cluster);
    pre_empted(&cluster);
    out_of_time(&cluster);
    unreachable(cluster);
}

/// What a cluster refuses is told in its words, and nothing of it stays.
fn refused(cluster: &Cluster) {
    let shop = shop("refused", SWEEP, "0.02 mm");
    let submit = [SUBMIT.as_slice(), &["--slurm-option=--partition=nowhere"]].concat();
    let ended = sphcut(cluster, &shop, &submit).expect_code(5);
    ended.expect_err("the cluster refused (sbatch)").expect_err("nowhere");
    sphcut(cluster, &shop, &["sweep", "status", "out"])
        .expect_code(4)
        .expect_err("nothing was submitted");
    assert!(cluster.queue().is_empty());
}

/// An array and a job that collects; asked again there is nothing to do, and after a change
/// of the sweep only what is new.
fn computed_and_collected(cluster: &Cluster) {
    let shop = shop("whole", SWEEP, "0.02 mm");
    let submit = [SUBMIT.as_slice(), &["--json", "--at-once", "2"]].concat();
    let ended = sphcut(cluster, &shop, &submit).expect_code(0);
    let told: Value = serde_json::from_str(&ended.out).unwrap();
    assert_eq!((&told["runs"], &told["tasks"]), (&12.into(), &1.into()), "{told}");
    wait_for_end(cluster, &shop);
    assert!(shop.path("out/sweep.html").exists());
    whole(&shop, 12);
    let (code, standing) = status(cluster, &shop);
    assert_eq!((code, &standing["tasks"]["COMPLETED"]), (Some(0), &1.into()), "{standing}");
    let again = sphcut(cluster, &shop, &SUBMIT).expect_code(0);
    assert!(again.out.contains("nothing to submit"), "{}", again.out);
    shop.write("sweep.toml", &SWEEP.replace("0.60", "0.65"));
    let more = sphcut(cluster, &shop, &SUBMIT).expect_code(0);
    assert!(more.out.contains("1 task of 1 run"), "{}", more.out);
    wait_for_end(cluster, &shop);
    assert_eq!(forces(&shop, "out/store").len(), 13);
}

/// Two runs of several seconds, and a checkpoint every second.
fn long(name: &str) -> Workshop {
    let shop = shop(name, &SWEEP.replace("0.60", "0.10"), "0.7 mm");
    let text = shop
        .read("tiny.toml")
        .replace("particle_spacing = \"25 um\"", "particle_spacing = \"14 um\"")
        .replace("snapshots = 4", "snapshots = 4\ncheckpoint_interval = \"1 s\"");
    shop.write("tiny.toml", &text);
    shop
}

/// Submits and waits until the first run is well under way.
fn under_way(cluster: &Cluster, shop: &Workshop, more: &[&str]) -> u64 {
    let submit = [SUBMIT.as_slice(), &["--json"], more].concat();
    let ended = sphcut(cluster, shop, &submit).expect_code(0);
    let told: Value = serde_json::from_str(&ended.out).unwrap();
    let work = shop.path("out/store/work");
    cluster.wait("a checkpoint", || {
        let begun = std::fs::read_dir(&work).ok()?.flatten().next()?;
        begun.path().join(CHECKPOINT).exists().then_some(())
    });
    told["array"].as_u64().unwrap()
}

fn log(shop: &Workshop, name: &str) -> String {
    shop.read(&format!("out/slurm/001/log/{name}"))
}

/// The node daemon and all it runs are killed: the controller queues the task again, and it goes on.
fn lost_with_its_node(cluster: &Cluster) {
    let shop = long("lost");
    under_way(cluster, &shop, &[]);
    cluster.script("kill-node");
    let begun = std::fs::read_dir(shop.path("out/store/work")).unwrap().count();
    assert!(begun >= 1, "it was killed in the middle");
    let (code, standing) = status(cluster, &shop);
    assert_eq!((code, &standing["tasks_in_queue"]), (Some(0), &1.into()), "{standing}");
    cluster.wait("the controller that misses its node", || {
        let queued = status(cluster, &shop).1["tasks"]["PENDING"] == 1;
        queued.then_some(())
    });
    cluster.script("start-node");
    wait_for_end(cluster, &shop);
    let said = log(&shop, "1.txt");
    assert!(said.contains("restarted 0 times") && said.contains("restarted 1 times"), "{said}");
    whole(&shop, 2);
}

/// `scancel` in the middle: the run writes a checkpoint, what is there is collected, the same command goes on.
fn cancelled_by_hand(cluster: &Cluster) {
    let shop = long("by_hand");
    let array = under_way(cluster, &shop, &[]);
    // Two arrays at once from one folder would wait for each other.
    sphcut(cluster, &shop, &SUBMIT).expect_code(2).expect_err("1 task is in the queue already");
    cluster.command("scancel", &[&array.to_string()]);
    wait_for_end(cluster, &shop);
    let said = log(&shop, "1.txt");
    assert!(said.contains("checkpoints are written"), "{said}");
    assert!(shop.read("out/table.csv").contains(",missing,"));
    let ended = sphcut(cluster, &shop, &["sweep", "status", "out"]).expect_code(130);
    assert!(ended.out.contains("tasks were cancelled in the queue"), "{}", ended.out);
    let collected = sphcut(cluster, &shop, &["sweep", "collect", "out"]).expect_code(130);
    assert!(collected.out.contains("without a result"), "{}", collected.out);
    sphcut(cluster, &shop, &SUBMIT).expect_code(0);
    wait_for_end(cluster, &shop);
    whole(&shop, 2);
}

fn cancelled_by_sphcut(cluster: &Cluster) {
    let shop = long("cancelled");
    under_way(cluster, &shop, &[]);
    let ended = sphcut(cluster, &shop, &["sweep", "cancel", "out"]).expect_code(0);
    assert!(ended.out.contains("1 task ended"), "{}", ended.out);
    wait_for_end(cluster, &shop);
    assert!(log(&shop, "1.txt").contains("checkpoints are written"));
    assert!(!shop.path("out/table.csv").exists(), "the collecting job is cancelled, too");
    let ended = sphcut(cluster, &shop, &["sweep", "status", "out"]).expect_code(130);
    assert!(ended.out.contains("`sphcut sweep cancel` ended the array"), "{}", ended.out);
    let again = sphcut(cluster, &shop, &["sweep", "cancel", "out"]).expect_code(0);
    assert!(again.out.contains("nothing to cancel"), "{}", again.out);
    // A scenario that has changed since is not computed under the old name.
    shop.write("tiny.toml", &shop.read("tiny.toml").replace("\"20 um\"", "\"21 um\""));
    let folder = shop.path("out/slurm/001").display().to_string();
    let task = ["sweep", "task", &folder, "1"];
    sphcut(cluster, &shop, &task).expect_code(2).expect_err("is not what was submitted");
    let none = ["sweep", "task", &folder, "7"];
    sphcut(cluster, &shop, &none).expect_code(2).expect_err("its tasks are 1 to 1");
    sphcut(cluster, &shop, &["sweep", "collect", "out"])
        .expect_code(2)
        .expect_err("submit the sweep again");
}

/// A job of a partition with more priority takes the node: the task writes a checkpoint, waits, and goes on.
fn pre_empted(cluster: &Cluster) {
    let shop = long("pre_empted");
    under_way(cluster, &shop, &["--slurm-option=--partition=work"]);
    let urgent = ["--partition=urgent", "--exclusive", "--output=/dev/null", "--wrap=sleep 2"];
    cluster.command("sbatch", &urgent);
    wait_for_end(cluster, &shop);
    let said = log(&shop, "1.txt");
    assert!(
        said.contains("checkpoints are written") && said.contains("restarted 1 times"),
        "{said}"
    );
    whole(&shop, 2);
}

/// The warning before the time limit: the script queues its task again.
fn out_of_time(cluster: &Cluster) {
    let shop = long("time");
    let array = under_way(cluster, &shop, &[]);
    // What Slurm sends at `--signal=B:USR1@...`.
    cluster.command("scancel", &["--batch", "--signal=USR1", &format!("{array}_1")]);
    wait_for_end(cluster, &shop);
    let said = log(&shop, "1.txt");
    assert!(
        said.contains("out of time: queued again") && said.contains("restarted 1 times"),
        "{said}"
    );
    whole(&shop, 2);
}

/// The controller is gone.
fn unreachable(cluster: Cluster) {
    let shop = shop("unreachable", SWEEP, "0.02 mm");
    cluster.script("stop");
    sphcut(&cluster, &shop, &SUBMIT).expect_code(5).expect_err("the cluster refused (sbatch)");
}
