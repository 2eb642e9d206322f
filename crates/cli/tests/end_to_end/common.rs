//! A tiny cut and a way to run the program on it.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A cut of a few hundred particles that takes about a second.
pub const TINY: &str = r#"title = "A tiny cut"

[workpiece]
material = "aisi1045_table5"
length = "0.8 mm"
height = "0.3 mm"
temperature = "20 degC"

[tool]
rake_angle = "5 deg"
clearance_angle = "7 deg"
edge_radius = "20 um"

[tool.friction]
law = "shear_capped_coulomb"
friction_coefficient = 0.25

[process]
cutting_speed = "150 m/min"
uncut_chip_thickness = "0.1 mm"
width_of_cut = "3 mm"

[resolution]
particle_spacing = "25 um"

[numerics]
mass_scaling = 1000

[output]
snapshots = 4
pictures = false

[stop]
travel = "0.2 mm"
"#;

/// A cut that diverges within five steps: ten thousand times the inertia, a thousand metres per second, and a tool a
/// hundred times as stiff.
pub fn diverging() -> String {
    let text =
        TINY.replace("150 m/min", "1000 m/s").replace("mass_scaling = 1000", "mass_scaling = 1e4");
    format!("{text}\n[contact]\nstiffness = 100\n")
}

/// A folder of one test, empty at its start.
pub struct Workshop {
    folder: PathBuf,
    inputs: RefCell<BTreeSet<PathBuf>>,
}

impl Workshop {
    /// The folder `name`; tests that run side by side need different names.
    pub fn new(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        if folder.exists() {
            std::fs::remove_dir_all(&folder).expect("an old test folder can be removed");
        }
        std::fs::create_dir_all(&folder).expect("the test folder can be created");
        Self { folder, inputs: RefCell::default() }
    }

    /// A path in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Writes a file and returns its path.
    pub fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.path(name);
        self.inputs.borrow_mut().insert(path.clone());
        std::fs::write(&path, text).expect("a file can be written into the test folder");
        path
    }

    /// Writes the tiny scenario with `from` replaced by `to`.
    pub fn tiny_with(&self, from: &str, to: &str) -> PathBuf {
        assert!(TINY.contains(from), "the tiny scenario has no `{from}`");
        self.write("tiny.toml", &TINY.replace(from, to))
    }

    /// The text of a file.
    pub fn read(&self, name: &str) -> String {
        let path = self.path(name);
        std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    }

    /// The program, started in the folder with `arguments`.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sphcut"));
        command.args(arguments).current_dir(&self.folder);
        command
    }

    /// Runs the program to its end.
    pub fn sphcut(&self, arguments: &[&str]) -> Ended {
        let output = self.command(arguments).output().expect("the program starts");
        Ended::from(output)
    }
}

/// No NaN and no infinity stands in any output of any test.
impl Drop for Workshop {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            all_finite(&self.folder, &self.inputs.borrow());
        }
    }
}

/// `inputs` may be wrong on purpose; so are the tables of measurements of the cases in `validation`.
fn all_finite(path: &Path, inputs: &BTreeSet<PathBuf>) {
    if path.is_dir() && !path.is_symlink() {
        let entries = std::fs::read_dir(path).unwrap().flatten();
        return entries.for_each(|entry| all_finite(&entry.path(), inputs));
    }
    if inputs.contains(path) || path.ends_with("reference.csv") {
        return;
    }
    let kind = path.extension().unwrap_or_default().to_string_lossy().into_owned();
    let found = match kind.as_str() {
        "h5" | "vtkhdf" => not_finite_in_h5(path),
        "csv" | "json" | "html" => {
            let text = String::from_utf8_lossy(&std::fs::read(path).unwrap()).into_owned();
            let is_number = |word: &&str| {
                let word = word.trim_matches('-').to_lowercase();
                ["nan", "inf", "infinity"].contains(&word.as_str())
            };
            let mut words = text.split([',', ';', '\t', '\n', ' ', ':', '[', ']', '>', '<', '\r']);
            words.find(is_number).map(str::to_owned)
        }
        _ => None,
    };
    assert_eq!(found, None, "{}", path.display());
}

/// An array or attribute with what is no number, but for arrays that say what it means. Files that tests have damaged
/// cannot be opened.
fn not_finite_in_h5(path: &Path) -> Option<String> {
    let file = hdf5_pure::File::open(path).ok()?;
    let mut groups = vec![String::new()];
    while let Some(path) = groups.pop() {
        let group = if path.is_empty() { Ok(file.root()) } else { file.group(&path) }.ok()?;
        let inside = |name: String| format!("{path}/{name}").trim_start_matches('/').to_owned();
        groups.extend(group.groups().ok()?.into_iter().map(inside));
        let attributes = group.attrs().ok().map(|attributes| format!("{attributes:?}"));
        if attributes.is_some_and(|text| text.contains("(NaN)") || text.contains("inf)")) {
            return Some(format!("attributes of {path}"));
        }
        for name in group.datasets().ok()?.into_iter().map(inside) {
            let array = file.dataset(&name).ok()?;
            let told = array.attrs().map_or(String::new(), |about| format!("{about:?}"));
            let mut values = array.read_f64().unwrap_or_default().into_iter();
            let told = ["NaN: not known", "inf: no limit"].map(|text| told.contains(text));
            if values.any(|value| !value.is_finite() && !told[usize::from(value.is_infinite())]) {
                return Some(name);
            }
        }
    }
    None
}

/// What a finished program left behind.
#[derive(Debug)]
pub struct Ended {
    /// Its exit code.
    pub code: Option<i32>,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

impl From<Output> for Ended {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            out: String::from_utf8_lossy(&output.stdout).into_owned(),
            err: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }
}

impl Ended {
    /// Fails with everything the program said if it did not end with `code`.
    #[track_caller]
    pub fn expect_code(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "\nout: {}\nerr: {}", self.out, self.err);
        self
    }

    /// Fails unless standard error contains `text`.
    #[track_caller]
    pub fn expect_err(self, text: &str) -> Self {
        assert!(self.err.contains(text), "`{text}` is not in: {}", self.err);
        self
    }
}
