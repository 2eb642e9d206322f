//! Sections of a file of recordings.

use sphcut_input::section::{Field, Kind, Presence, Section, between, default, positive};
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
            Field::new(
                "title",
                Kind::Text,
                Presence::Required,
                "one line that says what was measured",
            )
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
            Field::new("cut", Kind::Tables, Presence::Required, "one record")
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
            Field::new(
                "format",
                Kind::Choice(FORMATS.to_vec()),
                Presence::Required,
                "kind of file",
            ),
            Field::new(
                "separator",
                Kind::Choice(vec!["comma", "semicolon", "tab", "space"]),
                default("comma"),
                "csv: what stands between two cells",
            ),
            Field::new(
                "decimal",
                Kind::Choice(vec!["point", "comma"]),
                default("point"),
                "csv: what stands before the decimals",
            ),
            Field::new(
                "header_line",
                Kind::Count { min: 1, max: 1000 },
                default("1"),
                "csv: line of the column names",
            ),
            Field::new(
                "skip_lines",
                Kind::Count { min: 0, max: 1000 },
                default("0"),
                "csv: lines between the names and the numbers, such as one of units",
            ),
            Field::new(
                "time_column",
                Kind::Text,
                Presence::Derived("no time stamps"),
                "column with the time",
            )
            .example("\"t\""),
            Field::new(
                "time_scale",
                positive(Quantity::Time, 3600.0),
                default("1 s"),
                "time that the number 1 of that column means",
            ),
            Field::new(
                "sampling_rate",
                positive(Quantity::Frequency, HIGHEST_RATE),
                Presence::Derived("that of the time stamps or of the file"),
                "samples per second; beside time stamps it is checked against them",
            )
            .example("\"10 kHz\""),
            Field::new(
                "longest_gap",
                between(Quantity::Time, 0.0, 10.0),
                default("0 s"),
                "longest gap, samples missing or no numbers, that a straight line may bridge",
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
            Field::new("column", Kind::Text, Presence::Required, "name of the channel in the files")
                .example("\"Fx\""),
            Field::new(
                "scale",
                Kind::Quantity(Quantity::Force, Range::closed(-1e9, 1e9)),
                Presence::Required,
                "force that the number 1 of the file means; negative for a channel that is wired the \
                 other way round",
            )
            .example("\"1 N\""),
            Field::new(
                "full_scale",
                positive(Quantity::Force, 1e9),
                Presence::Derived("unknown: clipping shows in equal extreme values"),
                "end of the range: values at or beyond it are clipped",
            )
            .example("\"5 kN\""),
            Field::new(
                "response",
                Kind::Path,
                Presence::Derived("nothing is undone"),
                "frequency response of the measuring chain from an impact test, to be undone: \
                 frequency [Hz],gain,phase [deg]",
            )
            .example("\"response_fx.csv\""),
            Field::new(
                "regularisation",
                between(Quantity::Dimensionless, 1e-6, 1.0),
                default("0.1"),
                "lambda of the inverse: no frequency is amplified by more than 1 / (2 lambda)",
            ),
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
            Field::new(
                "column",
                Kind::Text,
                Presence::Required,
                "name of the channel in the files",
            )
            .example("\"Trigger\""),
            Field::new("level", number, Presence::Required, "level in the numbers of the file")
                .example("2.5"),
        ],
    )
}

/// `[detection]`.
pub(crate) fn detection() -> Section {
    Section::new(
        "detection",
        "How the cut is found in a record, and what of it is air.",
        vec![
            Field::new(
                "method",
                Kind::Choice(vec!["automatic", "trigger", "given"]),
                default("automatic"),
                "from the cutting force, from [trigger], or `entry` and `exit` of each cut",
            ),
            Field::new(
                "smoothing",
                positive(Quantity::Time, 10.0),
                default("20 ms"),
                "automatic: length of the moving mean in which the cut is looked for",
            ),
            Field::new(
                "guard",
                between(Quantity::Time, 0.0, 10.0),
                default("20 ms"),
                "time next to entry and exit that counts neither as air nor as cut",
            ),
            Field::new(
                "shortest_air",
                positive(Quantity::Time, 100.0),
                default("50 ms"),
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
            Field::new(
                "cut_off",
                positive(Quantity::Frequency, HIGHEST_RATE),
                Presence::Required,
                "frequency at which half the amplitude passes",
            )
            .example("\"1 kHz\""),
            Field::new("order", Kind::Count { min: 1, max: 12 }, default("4"), "order of one run"),
        ],
    )
}

/// `[steady]`.
pub(crate) fn steady() -> Section {
    Section::new(
        "steady",
        "What is asked of the mean of a cut.",
        vec![
            Field::new(
                "precision",
                Kind::Quantity(Quantity::Dimensionless, Range::above(0.0, 1.0)),
                default("0.02"),
                "half width of the 95 % interval as a share of the cutting force",
            ),
            Field::new(
                "largest_drift",
                Kind::Quantity(Quantity::Dimensionless, Range::above(0.0, 1.0)),
                default("0.05"),
                "largest drift over the window that may remain possible, as a share of the cutting force",
            ),
            Field::new(
                "otherwise",
                Kind::Choice(vec!["refuse", "keep"]),
                default("refuse"),
                "what becomes of a cut whose tests do not pass: no force, or one with a warning",
            ),
        ],
    )
}

/// `[[cut]]`.
pub(crate) fn cut() -> Section {
    let time = |key, meaning| {
        Field::new(key, between(Quantity::Time, 0.0, 1e6), Presence::Optional, meaning)
            .example("\"0.5 s\"")
    };
    Section::new(
        "cut",
        "One record and what was cut.",
        vec![
            Field::new("file", Kind::Path, Presence::Required, "the record").example("\"cut_1.csv\""),
            Field::new(
                "name",
                Kind::Text,
                Presence::Derived("the name of the file"),
                "name in tables and on the page",
            )
            .example("\"cut 1\""),
            Field::new(
                "group",
                Kind::Text,
                Presence::Derived("the top of the file"),
                "hdf5: the group with the channels",
            )
            .example("\"/cut_1\""),
            Field::new(
                "cutting_speed",
                positive(Quantity::Speed, 1e4),
                Presence::Required,
                "v_c",
            )
            .example("\"150 m/min\""),
            Field::new(
                "uncut_chip_thickness",
                positive(Quantity::Length, 0.1),
                Presence::Required,
                "h; in an orthogonal cut the feed per revolution",
            )
            .example("\"0.1 mm\""),
            Field::new("width_of_cut", positive(Quantity::Length, 1.0), Presence::Optional, "b")
                .example("\"3 mm\""),
            Field::new(
                "workpiece_diameter",
                positive(Quantity::Length, 10.0),
                Presence::Optional,
                "diameter at the tool: v_c over the circumference is the frequency of the revolution",
            )
            .example("\"118 mm\""),
            Field::new(
                "rotational_speed",
                positive(Quantity::AngularSpeed, 1e5),
                Presence::Optional,
                "instead of `workpiece_diameter`",
            )
            .example("\"400 rpm\""),
            Field::new(
                "order",
                Kind::Count { min: 1, max: 1_000_000 },
                Presence::Derived("place in this file"),
                "place in the order of the experiments",
            ),
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
