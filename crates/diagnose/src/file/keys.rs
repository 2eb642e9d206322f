//! Sections of a file of a diagnosis.

use sphcut_input::section::{Field, Kind, Presence, Section, between, positive};
use sphcut_physics::{BATCH_SCATTER, Quantity, Range};

/// What the data without a missing effect are used for.
pub(crate) const USES: &[&str] = &["bias_field", "difference"];

/// Every section, for the reference page.
pub(crate) fn sections() -> Vec<Section> {
    vec![root(), measured(), reference(), series(), air(), priors(), checks(), next(), runs()]
}

/// The top of the file.
pub(crate) fn root() -> Section {
    let table = |key, presence, meaning| Field::new(key, Kind::Table, presence, meaning);
    Section::new(
        "",
        "A diagnosis: what was measured, and the scenario that is to explain it.",
        vec![
            Field::required("title", Kind::Text, "one line that says what was measured")
                .example("\"Orthogonal cuts of AISI 1045\""),
            Field::required("source", Kind::Text, "where the measurements come from; goes into the patch of the scenario")
            .example("\"own tests\""),
            Field::derived("scenario", Kind::Path, "needed with [measured]", "the cut as it is simulated so far, relative to this file; its speed and thickness, rake and edge radius are replaced by those that the table has")
            .example("\"cut.toml\""),
            table("measured", Presence::Derived("[series] alone is diagnosed"), "the cuts that are to be explained")
                .example("[measured] with file"),
            table("series", Presence::Optional, "recordings of the force over time: where a mismatch lives in time and in frequency"),
            table("reference", Presence::Optional, "cuts without a missing effect: a fresh edge of known radius, an uncoated tool"),
            table("priors", Presence::Derived("scatter between batches, or between published constants"), "what may differ without being a discovery"),
            table("checks", Presence::Derived("200 and 50 recordings"), "how the diagnosis tests itself"),
            table("runs", Presence::Derived("the range of the table, 30 thicknesses of travel"), "runs of the particle solver that tell what each effect changes"),
            table("next", Presence::Derived("4 cuts, half beyond the table"), "what could be measured next"),
        ],
    )
}

fn file() -> Field {
    Field::required("file", Kind::Path, "v_c [m/min],h [mm] and any of F_c [N],F_f [N],F_p [N],T_interface [degC],chip_thickness [mm],contact_length [mm],\
         springback [um] in any order and units, a line per cut; beside them their standard deviations (F_c_sd [N]), n, order, \
         cut_length [m], and rake [deg] and edge_radius [um] where the tools differ. Repeats or standard deviations are needed: they say what is noise")
    .example("\"cuts.csv\"")
}

/// `[measured]`.
pub(crate) fn measured() -> Section {
    Section::new("measured", "The cuts that are to be explained.", vec![file()])
}

/// `[reference]`.
pub(crate) fn reference() -> Section {
    Section::new(
        "reference",
        "Cuts without a missing effect. They teach what the simulation gets wrong by itself, which would else be taken for \
         missing physics.",
        vec![
            file(),
            Field::with_default(
                "use",
                Kind::Choice(USES.to_vec()),
                "bias_field",
                "bias_field: a smooth bias over speed and thickness is learnt. difference: only what differs between the two \
                 tables at the same speed and thickness is diagnosed",
            ),
            Field::with_default(
                "same_batch",
                Kind::Switch,
                "false",
                "whether both tables come from the same bar and the same calibration of the instruments",
            ),
        ],
    )
}

/// `[series]`.
pub(crate) fn series() -> Section {
    let frequency = |key, presence, meaning| {
        Field::new(key, positive(Quantity::Frequency, 1e9), presence, meaning)
    };
    Section::new(
        "series",
        "Recordings of the force over time: lines in their spectra and what these follow, and what changes within a cut.",
        vec![
            Field::required("recordings", Kind::Path, "a file of recordings (recordings.md): layout of the files, channels, window, and one [[cut]] for each record with its \
                 cutting speed, thickness and rotation")
            .example("\"recordings.toml\""),
            Field::optional("air", Kind::Table, "a record of the free-running machine, which cuts nothing"),
            frequency(
                "resolution",
                Presence::Derived("8 segments in the shortest cut"),
                "width of a bin of the spectra: narrower needs longer cuts",
            ),
            frequency(
                "natural_frequency",
                Presence::Optional,
                "a natural frequency of tool, workpiece or dynamometer from an impact test: chatter lies above it",
            ),
        ],
    )
}

/// `[series.air]`.
pub(crate) fn air() -> Section {
    Section::new(
        "series.air",
        "A record of the free-running machine, laid out as those of the cuts: what shows in it is not made by the cut.",
        vec![
            Field::required("file", Kind::Path, "the record").example("\"air.csv\""),
            Field::derived(
                "group",
                Kind::Text,
                "the top of the file",
                "hdf5: the group with the channels",
            ),
            Field::optional(
                "rotational_speed",
                positive(Quantity::AngularSpeed, 1e5),
                "rotation of the free-running machine",
            ),
        ],
    )
}

/// `[priors]`.
pub(crate) fn priors() -> Section {
    let share = |key, text, meaning| {
        Field::with_default(key, positive(Quantity::Dimensionless, 1.0), text, meaning)
    };
    let constant = |place: usize, without, meaning| {
        Field::derived(
            BATCH_SCATTER[place].0,
            positive(Quantity::Dimensionless, 1.0),
            without,
            meaning,
        )
    };
    Section::new(
        "priors",
        "Standard deviations of the nuisance parameters, which are fitted under every explanation.",
        vec![
            constant(0, "8 % with [reference], else 25 %", "A: from batch to batch where reference cuts are of the same constants, else between published sets of one material"),
            constant(1, "8 % with [reference], else 40 %", "B, likewise"),
            constant(2, "10 % with [reference], else 40 %", "n, likewise"),
            constant(3, "25 % with [reference], else 60 %", "C, likewise"),
            constant(4, "12 % with [reference], else 30 %", "m, likewise"),
            constant(5, "15 % with [reference], else 50 %", "mu, likewise"),
            share("gain", "1 %", "gain of each channel"),
            Field::with_default("offset", positive(Quantity::Force, 1e6), "3 N", "zero of each force"),
            share("drift", "2 %", "drift of each channel from the first cut to the last"),
            Field::optional("model_error", between(Quantity::Dimensionless, 0.0, 1.0), "by how much the model of the cut is wrong by itself, as a share that changes smoothly over speed and thickness: \
                 from comparisons of the model with other measurements; 0: it is exact. Only without [reference], which teaches it. Without both: what comparisons with measured cuts say")
            .example("\"10 %\""),
        ],
    )
}

/// `[checks]`.
pub(crate) fn checks() -> Section {
    let count = |key, max, text, meaning| {
        Field::with_default(key, Kind::Count { min: 0, max }, text, meaning)
    };
    Section::new(
        "checks",
        "How the diagnosis tests itself.",
        vec![
            count(
                "self_test",
                10_000,
                "200",
                "simulated recordings without a missing effect, for the rate of false alarms",
            ),
            count(
                "control",
                10_000,
                "50",
                "simulated recordings in which the claimed effect is concealed",
            ),
            count("seed", i64::MAX, "1", "seed of everything random"),
        ],
    )
}

/// `[next]`.
pub(crate) fn next() -> Section {
    let speed = |key, meaning| {
        Field::derived(key, positive(Quantity::Speed, 1e4), "half beyond the table", meaning)
    };
    let length = |key, meaning| {
        Field::derived(key, positive(Quantity::Length, 1.0), "half beyond the table", meaning)
    };
    Section::new(
        "next",
        "What could be measured next.",
        vec![
            Field::with_default(
                "cuts",
                Kind::Count { min: 1, max: 12 },
                "4",
                "how many cuts are proposed",
            ),
            speed("lowest_speed", "lowest v_c that can be cut"),
            speed("highest_speed", "highest v_c that can be cut"),
            length("thinnest", "lowest h that can be cut"),
            length("thickest", "highest h that can be cut"),
        ],
    )
}

/// `[runs]`.
pub(crate) fn runs() -> Section {
    let end = |key, quantity, max, meaning| {
        Field::derived(key, positive(quantity, max), "that of the table", meaning)
    };
    Section::new(
        "runs",
        "Paired runs of the particle solver, the same cut with and without every effect: at three cutting speeds and three \
         thicknesses from the lowest to the highest, even in the logarithm.",
        vec![
            end("lowest_speed", Quantity::Speed, 1e4, "lowest v_c that is run"),
            end("highest_speed", Quantity::Speed, 1e4, "highest v_c that is run"),
            end("thinnest", Quantity::Length, 1.0, "lowest h that is run"),
            end("thickest", Quantity::Length, 1.0, "highest h that is run"),
            Field::with_default(
                "travel",
                Kind::Quantity(Quantity::Dimensionless, Range::closed(5.0, 10_000.0)),
                "30",
                "travel of each run in uncut chip thicknesses; runs without an effect go four times as far",
            ),
            Field::with_default(
                "repaired",
                Kind::Count { min: 0, max: 1000 },
                "6",
                "conditions of the table at which the corrected scenario is run, beside the one as it is and one with recalibrated nuisance parameters",
            ),
            Field::with_default(
                "most",
                Kind::Count { min: 1, max: 100_000 },
                "600",
                "the budget: a diagnosis that needs more runs than this ends before the first one",
            ),
        ],
    )
}

/// The page of all keys, as Markdown.
#[must_use]
pub fn reference_page() -> String {
    let about = ("Files of diagnoses", "diagnose", "howto/diagnose.md");
    sphcut_input::reference::keys_of_file(about, &sections(), &[])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_is_explained_and_its_default_and_example_can_be_read() {
        assert_eq!(sphcut_input::section::faults(&sections()), [""; 0]);
    }
}
