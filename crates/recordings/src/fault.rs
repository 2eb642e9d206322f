//! What can be wrong with a recording, each with its name and its place.

use std::fmt;

/// Something about a recording that the user has to know. Times in s from the start of the record.
#[derive(Debug, Clone, PartialEq)]
pub enum Fault {
    /// The file has no channel of this name.
    MissingChannel {
        /// The name asked for.
        channel: String,
        /// The names that are there.
        present: Vec<String>,
    },
    /// Channels of different length.
    UnequalLengths {
        /// Names and samples of the two.
        channels: [(String, usize); 2],
    },
    /// Channels whose files state different clocks.
    UnequalClocks {
        /// Name, first time in s and sampling interval in s of the two.
        channels: [(String, f64, f64); 2],
    },
    /// The stated sampling rate is not that of the time stamps.
    RateDiffers {
        /// Hz, as stated.
        stated: f64,
        /// Hz, from the time stamps.
        found: f64,
    },
    /// Nothing says how fast the samples follow each other.
    NoClock,
    /// Too few samples for anything.
    TooFewSamples {
        /// Their number.
        samples: usize,
    },
    /// A time stamp that is not above the one before.
    TimeNotRising {
        /// Index of the sample.
        sample: usize,
    },
    /// Time stamps that scatter about an even clock by more than half an interval.
    UnevenClock {
        /// Largest distance from the even clock in sampling intervals.
        intervals: f64,
    },
    /// Time stamps with a resolution that is coarse beside the interval; the even clock is used.
    CoarseTime {
        /// Largest distance from the even clock in sampling intervals.
        intervals: f64,
    },
    /// Samples that are missing or no numbers, in stretches too long to be bridged.
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
    Bridged {
        /// Channel; empty if the time stamps have the gap.
        channel: String,
        /// Samples filled in all.
        samples: usize,
    },
    /// Samples at the end of the range, or many equal extreme ones in a row.
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
    NoTrigger {
        /// The level, in the numbers of the file.
        level: f64,
        /// Smallest and largest value of the channel.
        range: [f64; 2],
    },
    /// Nothing in the record looks like a cut.
    NoCut {
        /// Levels of the two halves of the smoothed force in N.
        levels: [f64; 2],
    },
    /// More than one cut in the record.
    SeveralCuts {
        /// Start and end of each in s.
        cuts: Vec<[f64; 2]>,
    },
    /// The record begins inside the cut.
    BeginsInCut,
    /// The record ends inside the cut.
    EndsInCut,
    /// No air cut to take the zero from.
    NoAirCut {
        /// Seconds of air before and after.
        found: [f64; 2],
        /// Seconds needed.
        needed: f64,
    },
    /// Air on one side only: an offset, but no drift.
    DriftUnknown,
    /// The zero moved by a good part of the force.
    LargeDrift {
        /// Channel.
        channel: String,
        /// Change over the record in N.
        drift: f64,
        /// Mean force in N.
        mean: f64,
    },
    /// A force that points the wrong way.
    WrongSign {
        /// Channel.
        channel: String,
        /// Its mean in N.
        mean: f64,
    },
    /// A feed force that points away from the workpiece.
    NegativeFeed {
        /// Channel.
        channel: String,
        /// Its mean in N.
        mean: f64,
    },
    /// The low-pass lies at or above half the sampling rate.
    LowPassTooHigh {
        /// Hz.
        cut_off: f64,
        /// Sampling rate in Hz.
        rate: f64,
    },
    /// The measured response ends below the low-pass, or there is none.
    ResponseTooShort {
        /// Channel.
        channel: String,
        /// Highest frequency of the response in Hz.
        highest: f64,
        /// Highest frequency that passes in Hz.
        needed: f64,
    },
    /// The tests for a steady state do not pass.
    Unsteady {
        /// Channel.
        channel: String,
        /// Which one and by how much.
        reason: NotSteady,
    },
    /// The steady window holds less than two revolutions: run-out is part of the mean.
    FewRevolutions {
        /// Revolutions.
        revolutions: f64,
    },
}

/// Why the mean of a record does not stand for a steady cut. Shares of the largest mean force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NotSteady {
    /// The run-in ends in the later half of the cut.
    RunIn {
        /// Seconds after entry.
        time: f64,
    },
    /// The window holds too few correlation times.
    Correlated {
        /// Their number.
        times: f64,
        /// The number needed.
        needed: f64,
    },
    /// A drift over the window cannot be excluded.
    Drift {
        /// The drift that is seen.
        found: f64,
        /// The largest one that its 95 % interval allows.
        possible: f64,
        /// The largest one that may remain.
        allowed: f64,
    },
    /// The interval of the mean is too wide.
    Imprecise {
        /// Its half width.
        share: f64,
        /// The wanted one.
        wanted: f64,
    },
}

impl fmt::Display for NotSteady {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::RunIn { time } => {
                write!(f, "the run-in ends {time:.3} s after entry, in the later half of the cut")
            }
            Self::Correlated { times, needed } => {
                write!(f, "the window holds {times:.1} correlation times, {needed} are needed")
            }
            Self::Drift { found, possible, allowed } => write!(
                f,
                "it drifts by {:+.1} % over the window, and up to {:.1} % cannot be excluded; {:.1} % is \
                 allowed",
                found * 100.0,
                possible * 100.0,
                allowed * 100.0
            ),
            Self::Imprecise { share, wanted } => write!(
                f,
                "the 95 % interval is \u{b1} {:.1} % wide; \u{b1} {:.1} % is wanted",
                share * 100.0,
                wanted * 100.0
            ),
        }
    }
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

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MissingChannel { channel, present } => {
                write!(f, "no channel `{channel}`; the file has {}", present.join(", "))
            }
            Self::UnequalLengths { channels: [(a, m), (b, n)] } => {
                write!(f, "channel `{a}` has {m} samples, `{b}` has {n}")
            }
            Self::UnequalClocks { channels: [(a, s, d), (b, t, e)] } => write!(
                f,
                "unequal clocks: channel `{a}` begins at {s} s with a sample every {d} s, `{b}` at \
                 {t} s with one every {e} s"
            ),
            Self::RateDiffers { stated, found } => write!(
                f,
                "the sampling rate is stated as {stated} Hz, the time stamps say {found:.6} Hz"
            ),
            Self::NoClock => {
                write!(
                    f,
                    "the file states no sampling rate: write `time_column` or `sampling_rate`"
                )
            }
            Self::TooFewSamples { samples } => write!(f, "only {samples} samples"),
            Self::TimeNotRising { sample } => {
                write!(f, "the time stamp of sample {sample} is not above the one before")
            }
            Self::UnevenClock { intervals } => write!(
                f,
                "the time stamps lie up to {intervals:.2} sampling intervals from an even clock"
            ),
            Self::CoarseTime { intervals } => write!(
                f,
                "the time stamps are rounded by up to {intervals:.2} sampling intervals; the even \
                 clock through them is used"
            ),
            Self::Gap { channel, start, length, samples } => write!(
                f,
                "{}: {samples} samples are missing or not numbers, the longest gap {:.3} ms at \
                 {start:.4} s",
                of(channel),
                length * 1e3
            ),
            Self::Bridged { channel, samples } => {
                write!(f, "{}: {samples} missing samples bridged by straight lines", of(channel))
            }
            Self::Clipped { channel, level, start, samples } => write!(
                f,
                "channel `{channel}` is clipped at {level:.1} N: {samples} samples, the first at \
                 {start:.4} s"
            ),
            Self::NoTrigger { level, range: [low, high] } => write!(
                f,
                "the trigger never passes its level {level}: the channel lies between {low} and {high}"
            ),
            Self::NoCut { levels: [low, high] } => write!(
                f,
                "no cut found: the smoothed cutting force has no two levels that stand apart \
                 ({low:.1} N and {high:.1} N)"
            ),
            Self::SeveralCuts { cuts } => {
                let list: Vec<String> =
                    cuts.iter().map(|[a, b]| format!("{a:.3} to {b:.3} s")).collect();
                write!(
                    f,
                    "{} cuts in one record ({}): state `entry` and `exit`",
                    cuts.len(),
                    list.join(", ")
                )
            }
            Self::BeginsInCut => write!(f, "the record begins inside the cut"),
            Self::EndsInCut => write!(f, "the record ends inside the cut"),
            Self::NoAirCut { found: [before, after], needed } => write!(
                f,
                "no air cut for the zero: {before:.3} s before and {after:.3} s after the cut, \
                 {needed:.3} s are needed on one side"
            ),
            Self::DriftUnknown => {
                write!(f, "air on one side of the cut only: the offset is known, the drift is not")
            }
            Self::LargeDrift { channel, drift, mean } => write!(
                f,
                "the zero of channel `{channel}` moves by {drift:+.1} N from the air before the cut \
                 to that after it, beside a force of {mean:.1} N"
            ),
            Self::WrongSign { channel, mean } => write!(
                f,
                "channel `{channel}` has the wrong sign: {mean:.1} N in the cut; turn the sign of its \
                 `scale` if it is wired so"
            ),
            Self::NegativeFeed { channel, mean } => write!(
                f,
                "channel `{channel}`: the feed force is {mean:.1} N; it pulls the tool into the \
                 workpiece only at large rake angles, otherwise turn the sign of its `scale`"
            ),
            Self::LowPassTooHigh { cut_off, rate } => write!(
                f,
                "the low-pass at {cut_off} Hz is not below half the sampling rate of {rate:.1} Hz"
            ),
            Self::ResponseTooShort { channel, highest, needed } => write!(
                f,
                "the frequency response of channel `{channel}` ends at {highest} Hz, frequencies up to \
                 {needed} Hz pass: lower the low-pass"
            ),
            Self::Unsteady { channel, reason } => {
                write!(f, "channel `{channel}` is not steady: {reason}")
            }
            Self::FewRevolutions { revolutions } => write!(
                f,
                "the steady window holds {revolutions:.1} revolutions: run-out does not average out"
            ),
        }
    }
}
