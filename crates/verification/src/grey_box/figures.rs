//! What the fits of a case give, computed or kept.

use super::{ComparisonSpecification, FitSpecification, GreyBoxFits};
use crate::error::CaseError;
use crate::head::{CaseHead, text_of};
use crate::options::{CaseProgress, ProgressWatch};
use crate::store::CaseStore;
use serde::{Deserialize, Serialize};
use sphcut_greybox::regressor::Method;
use sphcut_greybox::{
    BootstrapEstimate, Extrapolated, FitOptions, ForceFit, ForceKind, ForceTable, GreyBox,
    NoiseFloor, Scores, TableComparison, compare, fit,
};
use std::path::Path;

/// What is kept of one fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitFigures {
    /// Name of the fit.
    pub fit: String,
    /// Version of the program.
    pub version: String,
    /// Seed of the fit.
    pub seed: u64,
    /// SHA-256 of the simulated table.
    pub simulated_table: String,
    /// SHA-256 of the measured table.
    pub measured_table: String,
    /// Measured rows.
    pub rows: usize,
    /// Measured conditions.
    pub conditions: usize,
    /// F_c and F_f.
    pub forces: Vec<ForceFigures>,
    /// Against other measurements.
    pub comparisons: Vec<ComparisonFigures>,
}

/// One force of a fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceFigures {
    /// Which.
    pub force: ForceKind,
    /// The regressor to use.
    pub chosen: Method,
    /// The simulation alone.
    pub simulated: Scores,
    /// Corrected, conditions left out, the regressor chosen anew in every fold.
    pub corrected: Scores,
    /// What the scatter of repeats leaves to a perfect model.
    pub floor: Option<NoiseFloor>,
    /// Without the simulation, conditions left out.
    pub without_simulation: Scores,
    /// Whole speeds left out.
    pub speeds: Option<LevelsLeftOut>,
    /// Whole thicknesses left out.
    pub thicknesses: Option<LevelsLeftOut>,
}

/// Errors of the regressor to use where whole levels were left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LevelsLeftOut {
    /// One level at a time.
    pub all: Scores,
    /// The lowest and the highest alone: extrapolation.
    pub ends: Scores,
    /// The simulation alone at these two.
    pub simulated_at_ends: Scores,
}

/// A fit against other measurements.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ComparisonFigures {
    /// Name of the comparison.
    pub comparison: String,
    /// SHA-256 of the simulated table.
    pub simulated_table: String,
    /// SHA-256 of the measured table.
    pub measured_table: String,
    /// Measured rows.
    pub rows: usize,
    /// Rows inside the hull of the conditions of the fit.
    pub inside: usize,
    /// F_c and F_f.
    pub forces: Vec<ForceCompared>,
}

/// One force of a comparison.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceCompared {
    /// Which.
    pub force: ForceKind,
    /// The regressor.
    pub method: Method,
    /// Share of the measurements inside the predicted 95 % intervals.
    pub coverage: f64,
    /// The simulation alone.
    pub simulated: Scores,
    /// Corrected.
    pub corrected: Scores,
    /// Corrected, inside the hull.
    pub corrected_inside: Option<Scores>,
    /// Measured minus corrected in N, inside the hull.
    pub bias_inside: Option<BootstrapEstimate>,
}

impl GreyBoxFits {
    /// The kept figures of a fit if they belong to its tables, or if the tables are not there to be compared.
    pub(super) fn kept(
        &self,
        head: &CaseHead,
        specification: &FitSpecification,
        store: &CaseStore,
    ) -> Result<Option<FitFigures>, CaseError> {
        let Some(kept) = store.read_as::<FitFigures>(&head.name, &specification.name)? else {
            return Ok(None);
        };
        let same = |path: &Path, hash: &str| {
            let path = head.folder.join(path);
            let absent = specification.made_by.is_some() && !path.is_file();
            Ok::<bool, CaseError>(absent || table(&path)?.origin.sha256 == hash)
        };
        let mut belongs = same(&specification.simulated, &kept.simulated_table)?
            && same(&specification.measured, &kept.measured_table)?;
        let asked: Vec<_> =
            self.comparisons.iter().filter(|c| c.fit == specification.name).collect();
        belongs &= asked.len() == kept.comparisons.len();
        for (asked, found) in asked.iter().zip(&kept.comparisons) {
            belongs = belongs
                && asked.name == found.comparison
                && same(&asked.simulated, &found.simulated_table)?
                && same(&asked.measured, &found.measured_table)?;
        }
        Ok(belongs.then_some(kept))
    }

    /// Kept figures, or those of a new fit; `None` if its tables are not in the repository and not there.
    pub(super) fn obtain(
        &self,
        head: &CaseHead,
        specification: &FitSpecification,
        store: Option<&CaseStore>,
        progress: &ProgressWatch<'_>,
    ) -> Result<Option<FitFigures>, CaseError> {
        if let Some(store) = store
            && let Some(kept) = self.kept(head, specification, store)?
        {
            return Ok(Some(kept));
        }
        let measured = head.folder.join(&specification.measured);
        if specification.made_by.is_some() && !measured.is_file() {
            return Ok(None);
        }
        let (simulated, measured) =
            (table(&head.folder.join(&specification.simulated))?, table(&measured)?);
        let mut options = FitOptions::default();
        if let Some(methods) = &specification.regressors {
            options.methods.clone_from(methods);
        }
        let tell = |fraction: f64, _: &str| {
            progress(&CaseProgress { case: &head.name, run: &specification.name, fraction });
        };
        let found = fit(&simulated, &measured, &options, &tell)
            .map_err(|error| CaseError::failed(&specification.name, error))?;
        let model = GreyBox::of(&found);
        let asked = self.comparisons.iter().filter(|c| c.fit == specification.name);
        let comparisons = asked.map(|asked| compared(head, asked, &model, options.resamples));
        let figures = FitFigures {
            fit: specification.name.clone(),
            version: found.version.to_owned(),
            seed: options.seed,
            simulated_table: simulated.origin.sha256,
            measured_table: measured.origin.sha256,
            rows: found.pairs.rows.len(),
            conditions: found.pairs.conditions.len(),
            forces: found.forces.iter().map(force_figures).collect(),
            comparisons: comparisons.collect::<Result<_, _>>()?,
        };
        if let Some(store) = store {
            store.write_as(&head.name, &specification.name, &figures)?;
        }
        Ok(Some(figures))
    }
}

fn force_figures(force: &ForceFit) -> ForceFigures {
    let left_out = |axis: usize| {
        let found: Option<&Extrapolated> = force.chosen().extrapolation[axis].as_ref();
        found.map(|found| LevelsLeftOut {
            all: found.all.scores.clone(),
            ends: found.ends.clone(),
            simulated_at_ends: found.white_box_at_ends.clone(),
        })
    };
    ForceFigures {
        force: force.force,
        chosen: force.choice.method,
        simulated: force.white_box.clone(),
        corrected: force.procedure.clone(),
        floor: force.floor,
        without_simulation: force.alone.interpolation.clone(),
        speeds: left_out(0),
        thicknesses: left_out(1),
    }
}

fn compared(
    head: &CaseHead,
    asked: &ComparisonSpecification,
    model: &GreyBox,
    resamples: usize,
) -> Result<ComparisonFigures, CaseError> {
    let simulated = table(&head.folder.join(&asked.simulated))?;
    let measured = table(&head.folder.join(&asked.measured))?;
    let found: TableComparison = compare(model, None, &simulated, &measured, resamples)
        .map_err(|error| CaseError::failed(&asked.name, error))?;
    let forces = found.forces.iter().map(|force| ForceCompared {
        force: force.force,
        method: force.method,
        coverage: force.coverage,
        simulated: force.white_box.clone(),
        corrected: force.grey_box.clone(),
        corrected_inside: force.grey_box_inside.clone(),
        bias_inside: force.bias_inside,
    });
    Ok(ComparisonFigures {
        comparison: asked.name.clone(),
        simulated_table: simulated.origin.sha256,
        measured_table: measured.origin.sha256,
        rows: found.pairs.rows.len(),
        inside: found.inside,
        forces: forces.collect(),
    })
}

fn table(path: &Path) -> Result<ForceTable, CaseError> {
    let text = text_of(path)?;
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
    ForceTable::read(&name.unwrap_or_default(), &text)
        .map_err(|problem| CaseError::invalid(path, problem.to_string()))
}
