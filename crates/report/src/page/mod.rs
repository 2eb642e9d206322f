//! One folder or file per page: what is shown. How, says `kit`.

mod calibration;
mod cut_calibration;
mod diagnosis;
mod greybox;
mod identification;
mod materials;
mod preview;
mod recordings;
mod residual_stress;
mod run;
mod springback;
mod sweep;
mod wear;

pub use calibration::{calibration_words, render_calibration};
pub use cut_calibration::{CutCalibrationPage, render_cut_calibration};
pub use diagnosis::{
    DiagnosisPage, SeriesPage, SimulatedPair, diagnosis_text, render_diagnosis, render_series,
    series_summary,
};
pub use greybox::{greybox_words, render_comparison, render_greybox};
pub use identification::{IdentificationPage, identification_words, render_identification};
pub use materials::{ComparedMaterial, compared_states, render_materials};
pub use preview::{PreviewPage, render_preview};
pub use recordings::{RecordingsPage, recordings_words, render_recordings};
pub use run::{render_report, write_report};
pub use springback::{SpringbackRun, render_springback};
pub use sweep::{SweepPage, render_sweep, sweep_words};
pub use wear::{WearPage, render_wear};
