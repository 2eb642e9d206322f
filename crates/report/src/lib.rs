//! Pictures and pages from the plain results of a run.
//!
//! [`write_report`] writes one self-contained `report.html`; [`render_preview`] is the page of `sphcut check --preview`; [`render_materials`] that of `sphcut materials`; [`render_snapshot`] draws a single
//! picture; [`render_springback`] is the page of `sphcut springback`, [`render_calibration`] that of
//! `sphcut calibrate-friction`, [`render_cut_calibration`] that of `sphcut calibrate`, [`render_recordings`] that of `sphcut recordings`, [`render_greybox`] and
//! [`render_comparison`] those of `sphcut greybox`, [`render_identification`] that of `sphcut identify`,
//! [`render_diagnosis`] that of `sphcut diagnose`, [`render_wear`] that of `sphcut wear`, [`render_sweep`] that of `sphcut sweep`.

mod error;
mod kit;
mod page;
mod picture;

pub use error::ReportError;
pub use page::{
    ComparedMaterial, CutCalibrationPage, DiagnosisPage, IdentificationPage, PreviewPage,
    RecordingsPage, SeriesPage, SimulatedPair, SpringbackRun, SweepPage, WearPage,
    calibration_words, compared_states, diagnosis_text, greybox_words, identification_words,
    recordings_words, render_calibration, render_comparison, render_cut_calibration,
    render_diagnosis, render_greybox, render_identification, render_materials, render_preview,
    render_recordings, render_report, render_series, render_springback, render_sweep, render_wear,
    series_summary, sweep_words, write_report,
};
pub use picture::{ParticleField, PictureOptions, Style, View, render_layers, render_snapshot};
