//! What can be wrong with a recording, each with its name and its place.

/// Something about a recording that the user has to know. Times in s from the start of the record.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Fault {
    /// The file has no channel of this name.
    #[error("no channel `{channel}`; the file has {}", .present.join(", "))]
    MissingChannel {
        /// The name asked for.
        channel: String,
        /// The names that are there.
        present: Vec<String>,
    },
    /// Channels of different length.
    #[error(
        "channel `{}` has {} samples, `{}` has {}",
        .channels[0].0, .channels[0].1, .channels[1].0, .channels[1].1
    )]
    UnequalLengths {
        /// Names and samples of the two.
        channels: [(String, usize); 2],
    },
    /// Channels whose files state different clocks.
    #[error(
        "unequal clocks: channel `{}` begins at {} s with a sample every {} s, `{}` at \
         {} s with one every {} s",
        .channels[0].0, .channels[0].1, .channels[0].2, .channels[1].0, .channels[1].1, .channels[1].2
    )]
    UnequalClocks {
        /// Name, first time in s and sampling interval in s of the two.
        channels: [(String, f64, f64); 2],
    },
    /// The stated sampling rate is not that of the time stamps.
    #[error("the sampling rate is stated as {stated} Hz, the time stamps say {found:.6} Hz")]
    RateDiffers {
        /// Hz, as stated.
        stated: f64,
        /// Hz, from the time stamps.
        found: f64,
    },
    /// Nothing says how fast the samples follow each other.
    #[error("the file states no sampling rate: write `time_column` or `sampling_rate`")]
    NoClock,
    /// Too few samples for anything.
    #[error("only {samples} samples")]
    TooFewSamples {
        /// Their number.
        samples: usize,
    },
    /// A time stamp that is not above the one before.
    #[error("the time stamp of sample {sample} is not above the one before")]
    TimeNotRising {
        /// Index of the sample.
        sample: usize,
    },
    /// Time stamps that scatter about an even clock by more than half an interval.
    #[error("the time stamps lie up to {intervals:.2} sampling intervals from an even clock")]
    UnevenClock {
        /// Largest distance from the even clock in sampling intervals.
        intervals: f64,
    },
    /// Time stamps with a resolution that is coarse beside the interval; the even clock is used.
    #[error(
        "the time stamps are rounded by up to {intervals:.2} sampling intervals; the even \
         clock through them is used"
    )]
    CoarseTime {
        /// Largest distance from the even clock in sampling intervals.
        intervals: f64,
    },
    /// Samples that are missing or no numbers, in stretches too long to be bridged.
    #[error(
        "{}: {samples} samples are missing or not numbers, the longest gap {:.3} ms at \
         {start:.4} s",
        of(.channel), .length * 1e3
    )]
    Gap {
        /// Channel; empty if the time stamps have the gap.
        channel: String,
        /// Start of the longest in s.
        start: f64,
        /// Its length in s.
        length: f64,
        /// Samples missing in all.
        samples: usize,
    },
    /// The same, bridged by straight lines as the user allowed.
    #[error("{}: {samples} missing samples bridged by straight lines", of(.channel))]
    Bridged {
        /// Channel; empty if the time stamps have the gap.
        channel: String,
        /// Samples filled in all.
        samples: usize,
    },
    /// Samples at the end of the range, or many equal extreme ones in a row.
    #[error(
        "channel `{channel}` is clipped at {level:.1} N: {samples} samples, the first at \
         {start:.4} s"
    )]
    Clipped {
        /// Channel.
        channel: String,
        /// Level in N.
        level: f64,
        /// First time in s.
        start: f64,
        /// Samples.
        samples: usize,
    },
    /// The trigger never passes its level.
    #[error(
        "the trigger never passes its level {level}: the channel lies between {} and {}",
        .range[0], .range[1]
    )]
    NoTrigger {
        /// The level, in the numbers of the file.
        level: f64,
        /// Smallest and largest value of the channel.
        range: [f64; 2],
    },
    /// Nothing in the record looks like a cut.
    #[error(
        "no cut found: the smoothed cutting force has no two levels that stand apart \
         ({:.1} N and {:.1} N)",
        .levels[0], .levels[1]
    )]
    NoCut {
        /// Levels of the two halves of the smoothed force in N.
        levels: [f64; 2],
    },
    /// More than one cut in the record.
    #[error("{} cuts in one record ({}): state `entry` and `exit`", .cuts.len(), spans(.cuts))]
    SeveralCuts {
        /// Start and end of each in s.
        cuts: Vec<[f64; 2]>,
    },
    /// The record begins inside the cut.
    #[error("the record begins inside the cut")]
    BeginsInCut,
    /// The record ends inside the cut.
    #[error("the record ends inside the cut")]
    EndsInCut,
    /// No air cut to take the zero from.
    #[error(
        "no air cut for the zero: {:.3} s before and {:.3} s after the cut, \
         {needed:.3} s are needed on one side",
        .found[0], .found[1]
    )]
    NoAirCut {
        /// Seconds of air before and after.
        found: [f64; 2],
        /// Seconds needed.
        needed: f64,
    },
    /// Air on one side only: an offset, but no drift.
    #[error("air on one side of the cut only: the offset is known, the drift is not")]
    DriftUnknown,
    /// The zero moved by a good part of the force.
    #[error(
        "the zero of channel `{channel}` moves by {drift:+.1} N from the air before the cut \
         to that after it, beside a force of {mean:.1} N"
    )]
    LargeDrift {
        /// Channel.
        channel: String,
        /// Change over the record in N.
        drift: f64,
        /// Mean force in N.
        mean: f64,
    },
    /// A force that points the wrong way.
    #[error(
        "channel `{channel}` has the wrong sign: {mean:.1} N in the cut; turn the sign of its \
         `scale` if it is wired so"
    )]
    WrongSign {
        /// Channel.
        channel: String,
        /// Its mean in N.
        mean: f64,
    },
    /// A feed force that points away from the workpiece.
    #[error(
        "channel `{channel}`: the feed force is {mean:.1} N; it pulls the tool into the \
         workpiece only at large rake angles, otherwise turn the sign of its `scale`"
    )]
    NegativeFeed {
        /// Channel.
        channel: String,
        /// Its mean in N.
        mean: f64,
    },
    /// The low-pass lies at or above half the sampling rate.
    #[error("the low-pass at {cut_off} Hz is not below half the sampling rate of {rate:.1} Hz")]
    LowPassTooHigh {
        /// Hz.
        cut_off: f64,
        /// Sampling rate in Hz.
        rate: f64,
    },
    /// The measured response ends below the low-pass, or there is none.
    #[error(
        "the frequency response of channel `{channel}` ends at {highest} Hz, frequencies up to \
         {needed} Hz pass: lower the low-pass"
    )]
    ResponseTooShort {
        /// Channel.
        channel: String,
        /// Highest frequency of the response in Hz.
        highest: f64,
        /// Highest frequency that passes in Hz.
        needed: f64,
    },
    /// The tests for a steady state do not pass.
    #[error("channel `{channel}` is not steady: {reason}")]
    Unsteady {
        /// Channel.
        channel: String,
        /// Which one and by how much.
        reason: NotSteady,
    },
    /// The steady window holds less than two revolutions: run-out is part of the mean.
    #[error("the steady window holds {revolutions:.1} revolutions: run-out does not average out")]
    FewRevolutions {
        /// Revolutions.
        revolutions: f64,
    },
}

/// Why the mean of a record does not stand for a steady cut. Shares of the largest mean force.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NotSteady {
    /// The run-in ends in the later half of the cut.
    #[error("the run-in ends {time:.3} s after entry, in the later half of the cut")]
    RunIn {
        /// Seconds after entry.
        time: f64,
    },
    /// The window holds too few correlation times.
    #[error("the window holds {times:.1} correlation times, {needed} are needed")]
    Correlated {
        /// Their number.
        times: f64,
        /// The number needed.
        needed: f64,
    },
    /// A drift over the window cannot be excluded.
    #[error(
        "it drifts by {:+.1} % over the window, and up to {:.1} % cannot be excluded; {:.1} % is \
         allowed",
        .found * 100.0, .possible * 100.0, .allowed * 100.0
    )]
    Drift {
        /// The drift that is seen.
        found: f64,
        /// The largest one that its 95 % interval allows.
        possible: f64,
        /// The largest one that may remain.
        allowed: f64,
    },
    /// The interval of the mean is too wide.
    #[error(
        "the 95 % interval is \u{b1} {:.1} % wide; \u{b1} {:.1} % is wanted",
        .share * 100.0, .wanted * 100.0
    )]
    Imprecise {
        /// Its half width.
        share: f64,
        /// The wanted one.
        wanted: f64,
    },
}

impl Fault {
    /// Whether a cut with this fault gives no force. Whether an unsteady one does is for the user to
    /// say.
    #[must_use]
    pub fn refuses(&self) -> bool {
        !matches!(
            self,
            Self::CoarseTime { .. }
                | Self::Bridged { .. }
                | Self::BeginsInCut
                | Self::EndsInCut
                | Self::DriftUnknown
                | Self::LargeDrift { .. }
                | Self::NegativeFeed { .. }
                | Self::Unsteady { .. }
                | Self::FewRevolutions { .. }
        )
    }
}

fn of(channel: &str) -> String {
    if channel.is_empty() { "time stamps".to_owned() } else { format!("channel `{channel}`") }
}

fn spans(cuts: &[[f64; 2]]) -> String {
    let list: Vec<String> = cuts.iter().map(|[a, b]| format!("{a:.3} to {b:.3} s")).collect();
    list.join(", ")
}
