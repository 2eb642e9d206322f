//! The colours of charts and plots: those of Okabe and Ito, which most colour-blind people can tell apart.

pub(crate) const BLUE: &str = "#0072b2";
pub(crate) const BLUE_LIGHT: &str = "#9cc7e2";
pub(crate) const RED: &str = "#d55e00";
pub(crate) const RED_LIGHT: &str = "#f0b890";
pub(crate) const GREEN: &str = "#009e73";
pub(crate) const GREEN_LIGHT: &str = "#99d8c7";
/// Text and axes.
pub(crate) const INK: &str = "#22262b";
/// What stands back behind the data: marks and backgrounds.
pub(crate) const SLATE: &str = "#5b6470";
/// What is compared with.
pub(crate) const GREY: &str = "#8b949e";

/// Lines of one chart that have no meaning of their own.
pub(crate) const DISTINCT: [&str; 8] =
    [BLUE, RED, GREEN, "#cc79a7", "#e69f00", "#56b4e9", SLATE, "#8c564b"];
