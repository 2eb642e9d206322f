//! The batch scripts.

use super::deal::{JobRequest, LEAD_SECONDS};
use std::path::{Path, PathBuf};

/// Times that a task may run out of time and go on.
const MOST_RESTARTS: u32 = 200;
/// Minutes and MiB of the collecting job: it reads summaries and draws one page.
const COLLECTING: (u64, u64) = (60, 4096);

/// Options that would break what the scripts rely on, with what to use instead.
const OURS: [(&str, &str, &str); 15] = [
    ("--array", "-a", "the runs decide it; --at-once limits how many tasks run"),
    ("--dependency", "-d", "the collecting job waits for the array"),
    ("--cpus-per-task", "-c", "use --threads"),
    ("--ntasks", "-n", "a task is one process; use --threads"),
    ("--nodes", "-N", "a task is one process; use --threads"),
    ("--output", "-o", "the tasks' texts belong to the submission"),
    ("--error", "-e", "the tasks' texts belong to the submission"),
    ("--open-mode", "", "the tasks' texts belong to the submission"),
    ("--signal", "", "it tells a task to write its checkpoint"),
    ("--wrap", "", "the script is written by sphcut"),
    ("--wait", "-W", "`sphcut sweep status` tells when it is done"),
    ("--test-only", "", "use --dry-run"),
    ("--parsable", "", "sphcut reads the job's number itself"),
    ("--clusters", "-M", "submit on the cluster that is to compute"),
    ("--chdir", "-D", "all paths are absolute"),
];

/// What a script says.
#[derive(Debug, Clone, PartialEq)]
pub struct Script {
    /// The program, as the nodes find it.
    pub program: PathBuf,
    /// Folder of the submission, as the nodes find it.
    pub folder: PathBuf,
    /// Name of the sweep.
    pub name: String,
    /// Number of tasks.
    pub tasks: usize,
    /// Most tasks at once.
    pub at_once: Option<usize>,
    /// What every task asks for.
    pub request: JobRequest,
    /// Options of the user for `sbatch`, as they stand after `#SBATCH`; they win over ours.
    pub options: Vec<String>,
}

/// Why `option` cannot be handed to `sbatch`.
#[must_use]
pub fn refused_option(option: &str) -> Option<String> {
    if !option.starts_with('-') || option.contains(char::is_control) {
        return Some(format!(
            "`{}` is no option of sbatch: write it as --slurm-option=--partition=NAME",
            option.escape_debug()
        ));
    }
    let name = option.split(['=', ' ']).next().unwrap_or(option);
    let is = |long: &str, short: &str| {
        // `-a1-5` is `-a 1-5`.
        name == long || (!short.is_empty() && name.starts_with(short) && !name.starts_with("--"))
    };
    let (long, _, instead) = OURS.iter().find(|(long, short, _)| is(long, short))?;
    Some(format!("{long} of sbatch is set by sphcut: {instead}"))
}

/// Why `path` cannot stand in a script. A line break in it would end a line of the script.
#[must_use]
pub fn refused_path(path: &Path) -> Option<String> {
    let reason = match path.to_str() {
        None => "is not UTF-8 text",
        Some(text) if text.contains(char::is_control) => "has control characters",
        Some(_) => return None,
    };
    let shown = path.display().to_string();
    Some(format!("`{}` {reason}: no script can name it; rename it", shown.escape_debug()))
}

/// The script of the job array.
#[must_use]
pub fn array_script(script: &Script) -> String {
    let limit = script.at_once.map_or_else(String::new, |most| format!("%{most}"));
    let request = &script.request;
    let mut text = head(
        &format!("sphcut-{}", script.name),
        (&script.folder, "log/%a.txt"),
        (request.minutes, request.mebibytes, request.threads),
    );
    text += &format!("#SBATCH --array=1-{}{limit}\n", script.tasks);
    // To the script alone: it tells its run, and a cancelled task is told by SIGTERM.
    text += &format!("#SBATCH --signal=B:USR1@{LEAD_SECONDS}\n");
    text += &users(script);
    text += &format!(
        r#"
# At USR1 time is nearly over: the run writes its checkpoint, and the task queues again.
# At TERM it is cancelled or pre-empted: the run writes its checkpoint; Slurm queues a pre-empted task itself.
warned=
signalled=
code=127
trap 'warned=yes; signalled=yes; kill -TERM "$run"' USR1
trap 'signalled=yes; kill -TERM "$run"' TERM
{program} sweep task {folder} "$SLURM_ARRAY_TASK_ID" &
run=$!
while :; do
    signalled=
    wait "$run"
    now=$?
    [ "$now" = 127 ] || code=$now
    [ -n "$signalled" ] || break
done
if [ "$code" = 130 ] && [ -n "$warned" ] && [ "${{SLURM_RESTART_COUNT:-0}}" -lt {MOST_RESTARTS} ]; then
    echo "out of time: queued again, goes on from the checkpoint"
    scontrol requeue "$SLURM_JOB_ID"
fi
exit "$code"
"#,
        program = quoted(&script.program),
        folder = quoted(&script.folder),
    );
    text
}

/// The script of the job that writes table and page for the sweep whose results go to `out`.
#[must_use]
pub fn collecting_script(script: &Script, out: &Path) -> String {
    let (minutes, mebibytes) = COLLECTING;
    let mut text = head(
        &format!("sphcut-{}-collect", script.name),
        (&script.folder, "log/collect.txt"),
        (minutes, mebibytes, 1),
    );
    text += &users(script);
    text += &format!("\nexec {} sweep collect {}\n", quoted(&script.program), quoted(out));
    text
}

fn head(
    name: &str,
    (folder, log): (&Path, &str),
    (minutes, mebibytes, threads): (u64, u64, usize),
) -> String {
    // A `%` in a path would be a pattern of Slurm.
    let folder = PathBuf::from(folder.display().to_string().replace('%', "%%"));
    format!(
        "#!/bin/bash\n\
         #SBATCH --job-name={name}\n\
         #SBATCH --time={minutes}\n\
         #SBATCH --mem={mebibytes}M\n\
         #SBATCH --nodes=1\n\
         #SBATCH --ntasks=1\n\
         #SBATCH --cpus-per-task={threads}\n\
         #SBATCH --requeue\n\
         #SBATCH --open-mode=append\n\
         #SBATCH --output={log}\n",
        name = word(name),
        log = quoted(&folder.join(log)),
    )
}

fn users(script: &Script) -> String {
    script.options.iter().map(|option| format!("#SBATCH {option}\n")).collect()
}

/// Only what a job's name can hold without quotes.
fn word(text: &str) -> String {
    let fits = |letter: char| letter.is_ascii_alphanumeric() || "-_.".contains(letter);
    text.chars().map(|letter| if fits(letter) { letter } else { '_' }).collect()
}

/// As one word of the shell, which `#SBATCH` lines read the same way.
fn quoted(path: &Path) -> String {
    format!("'{}'", path.display().to_string().replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn script() -> Script {
        Script {
            program: PathBuf::from("/opt/sphcut"),
            folder: PathBuf::from("/nodes/o'hara/my sweep/slurm/001"),
            name: "speed & depth".to_owned(),
            tasks: 12,
            at_once: Some(4),
            request: JobRequest { minutes: 45, mebibytes: 300, threads: 2 },
            options: vec!["--partition=short".to_owned(), "--time=20".to_owned()],
        }
    }

    #[test]
    fn the_array_asks_for_what_the_cost_says_and_the_user_has_the_last_word() {
        let text = array_script(&script());
        assert!(
            text.starts_with("#!/bin/bash\n#SBATCH --job-name=sphcut-speed___depth\n"),
            "{text}"
        );
        for line in [
            "#SBATCH --array=1-12%4",
            "#SBATCH --time=45",
            "#SBATCH --mem=300M",
            "#SBATCH --cpus-per-task=2",
            "#SBATCH --requeue",
            "#SBATCH --signal=B:USR1@180",
            r"#SBATCH --output='/nodes/o'\''hara/my sweep/slurm/001/log/%a.txt'",
            r#"'/opt/sphcut' sweep task '/nodes/o'\''hara/my sweep/slurm/001' "$SLURM_ARRAY_TASK_ID" &"#,
        ] {
            assert!(text.lines().any(|one| one == line), "{line} is not in {text}");
        }
        let place = |what: &str| text.find(what).unwrap();
        assert!(place("--time=20") > place("--time=45"), "the last one counts");
        let script = Script { at_once: None, ..script() };
        assert!(array_script(&script).contains("--array=1-12\n"));
    }

    #[test]
    fn the_collecting_job_reads_the_folder_of_the_sweep() {
        let text = collecting_script(&script(), Path::new("/nodes/o'hara/my sweep"));
        assert!(text.ends_with("exec '/opt/sphcut' sweep collect '/nodes/o'\\''hara/my sweep'\n"));
        assert!(
            text.contains("#SBATCH --partition=short\n") && !text.contains("--array"),
            "{text}"
        );
    }

    #[test]
    fn paths_that_would_break_a_script_are_refused() {
        for bad in ["a\nb", "a\rb", "\u{1b}[2J", "a\u{85}b"] {
            let told = refused_path(Path::new(bad)).unwrap();
            assert!(told.contains("control characters") && !told.contains(bad), "{told}");
        }
        assert_eq!(refused_path(Path::new("/o'hara/\u{fc} $(x) `y` \"z\" \\ %a")), None);
        #[cfg(unix)]
        {
            use std::os::unix::ffi::OsStrExt;
            let told = refused_path(Path::new(std::ffi::OsStr::from_bytes(b"a\xff"))).unwrap();
            assert!(told.contains("not UTF-8"), "{told}");
        }
    }

    /// Names that a shell could take for commands: the script says them to the program as they are, and runs nothing.
    #[cfg(unix)]
    #[test]
    fn a_shell_takes_hostile_names_as_they_are() {
        use std::os::unix::fs::PermissionsExt;
        let place = std::env::temp_dir().join(format!("sphcut_hostile_{}", std::process::id()));
        std::fs::create_dir_all(&place).unwrap();
        let program = place.join("stub '$(touch hit)'");
        std::fs::write(&program, "#!/bin/sh\nprintf '%s|' \"$@\" > told\n").unwrap();
        std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).unwrap();
        for name in [
            "a b",
            "a'b",
            "'; touch hit; '",
            "$(touch hit)",
            "`touch hit`",
            "a\"b",
            "a\\",
            "-rf",
            "*",
            "a;touch hit",
            "a&touch hit&",
            "a|touch hit",
            "a>hit",
            "#a",
            "~",
            "!x",
            "%a",
            "a\\'",
            "${IFS}touch hit",
            "\u{202e}x",
        ] {
            let folder = PathBuf::from(name);
            assert_eq!(refused_path(&folder), None);
            let script =
                Script { program: program.clone(), folder, name: name.to_owned(), ..script() };
            for text in [array_script(&script), collecting_script(&script, Path::new(name))] {
                std::fs::write(place.join("script.sh"), &text).unwrap();
                let status = std::process::Command::new("bash")
                    .arg("script.sh")
                    .current_dir(&place)
                    .env("SLURM_ARRAY_TASK_ID", "1")
                    .status();
                assert!(status.unwrap().success(), "{text}");
                let told = std::fs::read_to_string(place.join("told")).unwrap();
                assert!(told.contains(&format!("|{name}|")), "{told}");
                assert!(!place.join("hit").exists(), "{text}");
            }
        }
        std::fs::remove_dir_all(&place).unwrap();
    }

    #[test]
    fn options_that_would_break_the_array_are_refused() {
        for good in ["--partition=short", "-p short", "--account=a", "--time=2:00:00", "-A me"] {
            assert_eq!(refused_option(good), None, "{good}");
        }
        for (bad, says) in [
            ("--array=1-3", "--at-once"),
            ("-a1-3", "--at-once"),
            ("--cpus-per-task 4", "use --threads"),
            ("--output=x", "belong to the submission"),
            ("partition", "is no option of sbatch"),
            ("--partition=a\nrm", "is no option of sbatch"),
        ] {
            let told = refused_option(bad).unwrap_or_default();
            assert!(told.contains(says), "{bad}: {told}");
        }
    }

    /// A run that needs a moment for its checkpoint, and a script that is told of the time limit: the code of the
    /// run comes through, and the task is queued again only then.
    #[cfg(unix)]
    #[test]
    fn the_script_waits_for_the_checkpoint_and_queues_again_only_when_time_is_over() {
        let folder = std::env::temp_dir().join(format!("sphcut_script_{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let executable = |name: &str, text: &str| {
            use std::os::unix::fs::PermissionsExt;
            let path = folder.join(name);
            std::fs::write(&path, text).unwrap();
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
            path
        };
        let program = executable(
            "sphcut",
            "#!/bin/bash\ntrap 'sleep 0.3; exit 130' TERM\ntouch \"$3/runs\"\nsleep 20 & wait\nexit 3\n",
        );
        executable(
            "scontrol",
            &format!("#!/bin/sh\necho \"$@\" > '{}/queued'\n", folder.display()),
        );
        let script = Script { program, folder: folder.clone(), ..script() };
        std::fs::write(folder.join("array.sh"), array_script(&script)).unwrap();
        for (signal, queued) in [("USR1", true), ("TERM", false)] {
            let path = format!("{}:{}", folder.display(), std::env::var("PATH").unwrap());
            let mut child = std::process::Command::new("bash")
                .arg(folder.join("array.sh"))
                .env("PATH", path)
                .env("SLURM_ARRAY_TASK_ID", "1")
                .env("SLURM_JOB_ID", "77")
                .stdout(std::process::Stdio::null())
                .spawn()
                .unwrap();
            while !folder.join("runs").exists() {
                std::thread::sleep(std::time::Duration::from_millis(5));
            }
            let id = child.id().to_string();
            std::process::Command::new("kill").args(["-s", signal, &id]).status().unwrap();
            assert_eq!(child.wait().unwrap().code(), Some(130), "{signal}");
            assert_eq!(folder.join("queued").exists(), queued, "{signal}");
            let _ = std::fs::remove_file(folder.join("queued"));
            std::fs::remove_file(folder.join("runs")).unwrap();
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
