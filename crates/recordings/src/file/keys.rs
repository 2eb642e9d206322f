//! Sections of a file of recordings.

use sphcut_input::section::{Field, Kind, Presence, Section, between, positive};
use sphcut_physics::{Channel, Quantity, Range};

/// The forces, as keys of `[channels]`.
pub(crate) const FORCE_CHANNELS: [(Channel, &str); 3] = [
    (Channel::CuttingForce, "F_c, positive against the motion of the tool"),
    (Channel::FeedForce, "F_f, positive away from the workpiece"),
    (Channel::PassiveForce, "F_p"),
];

/// File formats.
pub(crate) const FORMATS: &[&str] = &["csv", "lvm", "hdf5"];

const HIGHEST_RATE: f64 = 1e9;

/// Every section, for the reference page.
pub(crate) fn sections() -> Vec<Section> {
    let mut sections = vec![root(), file(), channels()];
    sections.push(force("channels.cutting_force"));
    sections.extend([trigger(), detection(), low_pass(), steady(), cut()]);
    sections
}

/// The top of the file.
pub(crate) fn root() -> Section {
    let table = |key, presence, meaning| Field::new(key, Kind::Table, presence, meaning);
    Section::new(
        "",
        "Recordings of cuts: how their files are read, what is done with them, and one [[cut]] for each.",
        vec![
            Field::required("title", Kind::Text, "one line that says what was measured")
                .example("\"Orthogonal cuts of AISI 1045\""),
            table("file", Presence::Required, "how the files are laid out")
                .example("[file] with format and time_column or sampling_rate"),
            table(
                "channels",
                Presence::Required,
                "the forces: [channels.cutting_force] and others",
            )
            .example("[channels.cutting_force] with column and scale"),
            table("trigger", Presence::Optional, "a channel that says when the tool cuts"),
            table("detection", Presence::Derived("automatic"), "how the cut is found in a record"),
            table("low_pass", Presence::Derived("no filter"), "low-pass without a shift in time"),
            table(
                "steady",
                Presence::Derived("known to 2 %, drift excluded above 5 %"),
                "what is asked of the mean",
            ),
            Field::required("cut", Kind::Tables, "one record")
                .example("[[cut]] with file, cutting_speed and uncut_chip_thickness"),
        ],
    )
}

/// `[file]`.
pub(crate) fn file() -> Section {
    Section::new(
        "file",
        "How the files are laid out. All cuts of a file of recordings have the same layout.",
        vec![
            Field::required("format", Kind::Choice(FORMATS.to_vec()), "kind of file"),
            Field::with_default(
                "separator",
                Kind::Choice(vec!["comma", "semicolon", "tab", "space"]),
                "comma",
                "csv: what stands between two cells",
            ),
            Field::with_default(
                "decimal",
                Kind::Choice(vec!["point", "comma"]),
                "point",
                "csv: what stands before the decimals",
            ),
            Field::with_default(
                "header_line",
                Kind::Count { min: 1, max: 1000 },
                "1",
                "csv: line of the column names",
            ),
            Field::with_default(
                "skip_lines",
                Kind::Count { min: 0, max: 1000 },
                "0",
                "csv: lines between the names and the numbers, such as one of units",
            ),
            Field::derived("time_column", Kind::Text, "no time stamps", "column with the time")
                .example("\"t\""),
            Field::with_default(
                "time_scale",
                positive(Quantity::Time, 3600.0),
                "1 s",
                "time that the number 1 of that column means",
            ),
            Field::derived(
                "sampling_rate",
                positive(Quantity::Frequency, HIGHEST_RATE),
                "that of the time stamps or of the file",
                "samples per second; beside time stamps it is checked against them",
            )
            .example("\"10 kHz\""),
            Field::with_default(
                "longest_gap",
                between(Quantity::Time, 0.0, 10.0),
                "0 s",
                "longest gap, samples missing or no numbers, that a straight line may bridge",
            ),
            Field::with_default(
                "most_values",
                Kind::Count { min: 1, max: 1 << 40 },
                "20000000",
                "hdf5: a channel with more values is refused before memory is asked for",
            ),
        ],
    )
}

/// `[channels]`.
pub(crate) fn channels() -> Section {
    let fields = FORCE_CHANNELS
        .iter()
        .map(|(channel, meaning)| {
            let is_cutting = *channel == Channel::CuttingForce;
            let presence = if is_cutting { Presence::Required } else { Presence::Optional };
            Field::new(channel.key(), Kind::Table, presence, meaning)
                .example("[channels.cutting_force] with column and scale")
        })
        .collect();
    Section::new("channels", "Which channel of the files is which force.", fields)
}

/// `[channels.FORCE]`.
pub(crate) fn force(name: &str) -> Section {
    Section::new(
        name,
        "One component of the force.",
        vec![
            Field::required("column", Kind::Text, "name of the channel in the files")
                .example("\"Fx\""),
            Field::required("scale", Kind::Quantity(Quantity::Force, Range::closed(-1e9, 1e9)), "force that the number 1 of the file means; negative for a channel that is wired the \
                 other way round")
            .example("\"1 N\""),
            Field::derived("full_scale", positive(Quantity::Force, 1e9), "unknown: clipping shows in equal extreme values", "end of the range: values at or beyond it are clipped")
            .example("\"5 kN\""),
            Field::derived("response", Kind::Path, "nothing is undone", "frequency response of the measuring chain from an impact test, to be undone: \
                 frequency [Hz],gain,phase [deg]")
            .example("\"response_fx.csv\""),
            Field::with_default("regularisation", between(Quantity::Dimensionless, 1e-6, 1.0), "0.1", "lambda of the inverse: no frequency is amplified by more than 1 / (2 lambda)"),
        ],
    )
}

/// `[trigger]`.
pub(crate) fn trigger() -> Section {
    let number = Kind::Quantity(Quantity::Dimensionless, Range::closed(-1e12, 1e12));
    Section::new(
        "trigger",
        "A channel that lies above `level` while the tool cuts.",
        vec![
            Field::required("column", Kind::Text, "name of the channel in the files")
                .example("\"Trigger\""),
            Field::required("level", number, "level in the numbers of the file").example("2.5"),
        ],
    )
}

/// `[detection]`.
pub(crate) fn detection() -> Section {
    Section::new(
        "detection",
        "How the cut is found in a record, and what of it is air.",
        vec![
            Field::with_default(
                "method",
                Kind::Choice(vec!["automatic", "trigger", "given"]),
                "automatic",
                "from the cutting force, from [trigger], or `entry` and `exit` of each cut",
            ),
            Field::with_default(
                "smoothing",
                positive(Quantity::Time, 10.0),
                "20 ms",
                "automatic: length of the moving mean in which the cut is looked for",
            ),
            Field::with_default(
                "guard",
                between(Quantity::Time, 0.0, 10.0),
                "20 ms",
                "time next to entry and exit that counts neither as air nor as cut",
            ),
            Field::with_default(
                "shortest_air",
                positive(Quantity::Time, 100.0),
                "50 ms",
                "shortest air cut from which a zero is taken",
            ),
        ],
    )
}

/// `[low_pass]`.
pub(crate) fn low_pass() -> Section {
    Section::new(
        "low_pass",
        "Butterworth filter run forwards and backwards: no shift in time, half the amplitude at the cut-off.",
        vec![
            Field::required(
                "cut_off",
                positive(Quantity::Frequency, HIGHEST_RATE),
                "frequency at which half the amplitude passes",
            )
            .example("\"1 kHz\""),
            Field::with_default("order", Kind::Count { min: 1, max: 12 }, "4", "order of one run"),
        ],
    )
}

/// `[steady]`.
pub(crate) fn steady() -> Section {
    Section::new(
        "steady",
        "What is asked of the mean of a cut.",
        vec![
            Field::with_default(
                "precision",
                Kind::Quantity(Quantity::Dimensionless, Range::above(0.0, 1.0)),
                "0.02",
                "half width of the 95 % interval as a share of the cutting force",
            ),
            Field::with_default(
                "largest_drift",
                Kind::Quantity(Quantity::Dimensionless, Range::above(0.0, 1.0)),
                "0.05",
                "largest drift over the window that may remain possible, as a share of the cutting force",
            ),
            Field::with_default(
                "otherwise",
                Kind::Choice(vec!["refuse", "keep"]),
                "refuse",
                "what becomes of a cut whose tests do not pass: no force, or one with a warning",
            ),
        ],
    )
}

/// `[[cut]]`.
pub(crate) fn cut() -> Section {
    let time = |key, meaning| {
        Field::optional(key, between(Quantity::Time, 0.0, 1e6), meaning).example("\"0.5 s\"")
    };
    Section::new(
        "cut",
        "One record and what was cut.",
        vec![
            Field::required("file", Kind::Path, "the record").example("\"cut_1.csv\""),
            Field::derived("name", Kind::Text, "the name of the file", "name in tables and on the page")
            .example("\"cut 1\""),
            Field::derived("group", Kind::Text, "the top of the file", "hdf5: the group with the channels")
            .example("\"/cut_1\""),
            Field::required("cutting_speed", positive(Quantity::Speed, 1e4), "v_c")
            .example("\"150 m/min\""),
            Field::required("uncut_chip_thickness", positive(Quantity::Length, 0.1), "h; in an orthogonal cut the feed per revolution")
            .example("\"0.1 mm\""),
            Field::optional("width_of_cut", positive(Quantity::Length, 1.0), "b")
                .example("\"3 mm\""),
            Field::optional("workpiece_diameter", positive(Quantity::Length, 10.0), "diameter at the tool: v_c over the circumference is the frequency of the revolution")
            .example("\"118 mm\""),
            Field::optional("rotational_speed", positive(Quantity::AngularSpeed, 1e5), "instead of `workpiece_diameter`")
            .example("\"400 rpm\""),
            Field::derived("order", Kind::Count { min: 1, max: 1_000_000 }, "place in this file", "place in the order of the experiments"),
            time("time", "when it was cut, from any zero: tool wear and drift go with it"),
            time("entry", "detection `given`: start of the cut in the record"),
            time("exit", "detection `given`: its end"),
        ],
    )
}

/// The page of all keys, as Markdown.
#[must_use]
pub fn reference_page() -> String {
    let about = ("Files of recordings", "recordings", "recordings.md");
    sphcut_input::reference::keys_of_file(about, &sections(), &["cut"])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_is_explained_and_its_default_and_example_can_be_read() {
        assert_eq!(sphcut_input::section::faults(&sections()), [""; 0]);
    }
}
