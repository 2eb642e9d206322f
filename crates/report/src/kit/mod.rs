//! What all pages and pictures are made of, each thing once: the shell of a page, notes, figures and tables, colours,
//! number formats, charts, plots and maps, and the canvas that pictures are painted on.

pub(crate) mod canvas;
pub(crate) mod chart;
pub(crate) mod colours;
pub(crate) mod drawing;
pub(crate) mod map;
pub(crate) mod numbers;
pub(crate) mod parity;
pub(crate) mod plot;
pub(crate) mod shell;
pub(crate) mod table;
pub(crate) mod text;
pub(crate) mod ticks;
