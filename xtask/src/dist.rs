//! `cargo xtask dist`: one archive that runs on any Linux of this processor: the program, linked statically and stripped, manual pages,
//! completions, scenarios with materials, documents, licences.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Shells whose completions are in it, and the names their files have there.
const COMPLETIONS: [(&str, &str); 3] =
    [("bash", "sphcut.bash"), ("zsh", "_sphcut"), ("fish", "sphcut.fish")];
/// What is copied beside the program.
const COPIED: [&str; 6] =
    ["README.md", "CHANGELOG.md", "LICENSE-APACHE", "LICENSE-MIT", "scenarios", "docs"];

/// Makes the archive in `target/dist`.
pub fn run(root: &Path) -> Result<(), String> {
    let host = host()?;
    let target = root.join("target/dist");
    let program = built(root, &host, &target)?;
    let name = format!("sphcut-{}-{host}", env!("CARGO_PKG_VERSION"));
    let folder = target.join(&name);
    let told = |error: std::io::Error| format!("{}: {error}", folder.display());
    if folder.exists() {
        std::fs::remove_dir_all(&folder).map_err(told)?;
    }
    for part in ["bin", "share/man/man1", "share/completions"] {
        std::fs::create_dir_all(folder.join(part)).map_err(told)?;
    }
    std::fs::copy(&program, folder.join("bin/sphcut")).map_err(told)?;
    for (shell, file) in COMPLETIONS {
        let script = said(&program, &["completions", shell])?;
        std::fs::write(folder.join("share/completions").join(file), script).map_err(told)?;
    }
    for words in pages(&program)? {
        let page = said(&program, &[&["man".to_owned()], words.as_slice()].concat())?;
        let file = [&["sphcut".to_owned()], words.as_slice()].concat().join("-") + ".1";
        std::fs::write(folder.join("share/man/man1").join(file), page).map_err(told)?;
    }
    for part in COPIED {
        done(Command::new("cp").arg("-r").arg(root.join(part)).arg(&folder))?;
    }
    let archive = target.join(format!("{name}.tar.gz"));
    // The same content gives the same bytes: no times, no names of people.
    let ordered = ["--sort=name", "--mtime=@0", "--owner=0", "--group=0", "--numeric-owner"];
    let mut tar = Command::new("tar");
    tar.args(ordered).args(["--use-compress-program", "gzip -n"]);
    done(tar.arg("-C").arg(&target).arg("-cf").arg(&archive).arg(&name))?;
    checked(&archive, &name, &target)?;
    let size = std::fs::metadata(&archive).map_err(told)?.len();
    println!("{}: {:.1} MB", archive.display(), size as f64 / 1e6);
    Ok(())
}

/// The triple of this machine.
fn host() -> Result<String, String> {
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    let said = said(Path::new(&rustc), &["-vV"])?;
    let host = said.lines().find_map(|line| line.strip_prefix("host: "));
    let host = host.ok_or("rustc does not say for which machine it compiles")?;
    match host.contains("linux") {
        true => Ok(host.to_owned()),
        false => Err(format!("a static archive is made on Linux, not on {host}")),
    }
}

/// Linked with everything it needs: `--target` keeps the flags away from what runs while compiling.
fn built(root: &Path, host: &str, target: &Path) -> Result<PathBuf, String> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let mut build = Command::new(cargo);
    build.args(["build", "--release", "-p", "sphcut-cli", "--target", host, "--manifest-path"]);
    build.arg(root.join("Cargo.toml")).arg("--target-dir").arg(target);
    build.env("RUSTFLAGS", "-C target-feature=+crt-static -C strip=symbols");
    done(&mut build)?;
    Ok(target.join(host).join("release/sphcut"))
}

/// The words of all commands, those that have commands of their own with these.
fn pages(program: &Path) -> Result<Vec<Vec<String>>, String> {
    let mut found = vec![Vec::new()];
    let mut next = 0;
    while next < found.len() {
        let words: Vec<String> = found[next].clone();
        let help = said(program, &[words.as_slice(), &["--help".to_owned()]].concat())?;
        found.extend(commands(&help).into_iter().map(|word| [words.clone(), vec![word]].concat()));
        next += 1;
    }
    Ok(found)
}

/// The commands that a help names.
fn commands(help: &str) -> Vec<String> {
    let lines = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let names = lines.take_while(|line| line.starts_with("  "));
    let words = names
        .filter(|line| !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next());
    words.filter(|word| *word != "help").map(str::to_owned).collect()
}

/// Unpacks the archive elsewhere and tries what is in it.
fn checked(archive: &Path, name: &str, target: &Path) -> Result<(), String> {
    let place = target.join("tried");
    let _ = std::fs::remove_dir_all(&place);
    std::fs::create_dir_all(&place).map_err(|error| error.to_string())?;
    done(Command::new("tar").arg("-C").arg(&place).arg("-xzf").arg(archive))?;
    let program = place.join(name).join("bin/sphcut");
    let linked = Command::new("ldd").arg(&program).output();
    let shared = linked.is_ok_and(|said| String::from_utf8_lossy(&said.stdout).contains("=>"));
    if shared {
        return Err(format!("{} is not static", program.display()));
    }
    let scenario = place.join(name).join("scenarios/quickstart.toml");
    let scenario = scenario.to_string_lossy().into_owned();
    let said = said(&program, &["check", &scenario, "--no-measure"])?;
    let _ = std::fs::remove_dir_all(&place);
    match said.contains("particles") {
        true => Ok(()),
        false => Err(format!("check of the quick start says: {said}")),
    }
}

fn done(command: &mut Command) -> Result<(), String> {
    let status = command.status().map_err(|error| format!("{command:?}: {error}"))?;
    if status.success() { Ok(()) } else { Err(format!("{command:?}: {status}")) }
}

/// What a program prints.
fn said<S: AsRef<std::ffi::OsStr>>(program: &Path, words: &[S]) -> Result<String, String> {
    let mut command = Command::new(program);
    let output = command.args(words).output().map_err(|error| format!("{command:?}: {error}"))?;
    if !output.status.success() {
        let complaint = String::from_utf8_lossy(&output.stderr).into_owned();
        return Err(format!("{command:?}: {complaint}"));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_read_from_a_help() {
        let help = "Cut\n\nUsage: sphcut <COMMAND>\n\nCommands:\n  run      Run a scenario\n           and more\n  help     Print this\n\nOptions:\n  -h, --help  Print help\n";
        assert_eq!(commands(help), ["run"]);
        assert!(commands("Usage: sphcut run\n\nOptions:\n  -h\n").is_empty());
    }
}
