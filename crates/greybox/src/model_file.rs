//! A fit as a file: models, what they were taught with, and a check that they were read right.

use crate::error::GreyBoxError;
use crate::fit::{ForceTable, GreyBoxFit, NORMAL_95, TableOrigin};
use crate::hull::Hull;
use crate::pairing::{ForceKind, ForceRow};
use crate::regressor::{Method, Model, Regressor, RegressorSettings};
use crate::samples::Input;
use crate::setting::{CutSetting, TableKind};
use serde::{Deserialize, Serialize};

/// What a file has to say it is.
const FORMAT: &str = "sphcut grey box";
/// Its version; another one is not read.
const FORMAT_VERSION: u32 = 1;

/// Corrections of both forces, with their provenance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GreyBox {
    format: String,
    format_version: u32,
    /// Version of the program that made it.
    pub version: String,
    /// Seed of the fit.
    pub seed: u64,
    /// Simulated and measured table.
    pub tables: [TableOrigin; 2],
    /// Their materials, widths and tools; files of earlier versions say nothing of them.
    #[serde(default)]
    pub settings: [CutSetting; 2],
    /// v_c in m/s, h in m, F_c and F_f in N of the measured rows; likewise.
    #[serde(default)]
    pub rows: Vec<[f64; 4]>,
    /// Hull of the measured conditions.
    pub hull: Hull,
    /// F_c and F_f.
    pub corrections: [Correction; 2],
}

/// The regressors of one force.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Correction {
    /// Which force.
    pub force: ForceKind,
    /// The regressor to use.
    pub chosen: Method,
    /// All that were fitted.
    pub regressors: Vec<Taught>,
}

/// A regressor as it is stored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Taught {
    /// Which.
    pub method: Method,
    /// Its hyper-parameters.
    pub settings: RegressorSettings,
    /// Half widths of the 95 % interval inside and outside the hull in N.
    pub half_widths: [f64; 2],
    /// Mean absolute error of the cross-validation in N.
    pub mae: f64,
    /// What was learnt.
    model: Model,
    /// Predictions at some of the measured conditions: what the model has to give when it is read.
    check: Vec<(Input, f64)>,
}

/// A corrected force. N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// f_T.
    pub simulated: f64,
    /// f_T + f_D.
    pub corrected: f64,
    /// 95 % interval of a new measurement.
    pub interval: [f64; 2],
    /// Whether the condition lies within the hull of the measured ones.
    pub inside: bool,
}

/// What units leave of a difference between equal numbers.
const ROUNDING: f64 = 1e-9;
/// Conditions whose predictions are checked.
const CHECKED: usize = 8;

impl GreyBox {
    /// What is kept of a fit.
    #[must_use]
    pub fn of(fit: &GreyBoxFit) -> Self {
        let conditions = &fit.pairs.conditions;
        let step = conditions.len().div_ceil(CHECKED).max(1);
        let corrections = fit.forces.each_ref().map(|force| Correction {
            force: force.force,
            chosen: force.choice.method,
            regressors: force
                .methods
                .iter()
                .map(|found| Taught {
                    method: found.method,
                    settings: found.settings.clone(),
                    half_widths: found.half_widths,
                    mae: found.interpolation.scores.mae.value,
                    check: conditions
                        .iter()
                        .step_by(step)
                        .map(|condition| (condition.input, found.model.predict(condition.input)))
                        .collect(),
                    model: found.model.clone(),
                })
                .collect(),
        });
        Self {
            format: FORMAT.to_owned(),
            format_version: FORMAT_VERSION,
            version: fit.version.to_owned(),
            seed: fit.options.seed,
            tables: fit.origins.clone(),
            settings: fit.settings.clone(),
            rows: fit.pairs.rows.iter().map(|row| numbers(&row.measured)).collect(),
            hull: fit.hull.clone(),
            corrections,
        }
    }

    /// The text of a file.
    ///
    /// # Panics
    /// Never: plain numbers have a JSON form.
    #[must_use]
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).expect("plain numbers have a JSON form")
    }

    /// Reads a file and checks that every model gives the predictions it was stored with.
    ///
    /// # Errors
    /// A text that is no grey box, one of another version, a damaged one.
    pub fn from_json(text: &str) -> Result<Self, GreyBoxError> {
        let wrong = |reason: String| GreyBoxError::Model(reason);
        let head: Head = serde_json::from_str(text)
            .map_err(|error| wrong(format!("not a stored grey box: {error}")))?;
        if head.format != FORMAT {
            return Err(wrong(format!("not a stored grey box: its format is `{}`", head.format)));
        }
        if head.format_version != FORMAT_VERSION {
            return Err(wrong(format!(
                "a grey box of format {}, this program reads format {FORMAT_VERSION}: fit it again",
                head.format_version
            )));
        }
        let found: Self = serde_json::from_str(text)
            .map_err(|error| wrong(format!("a damaged grey box: {error}")))?;
        found.corrections.iter().try_for_each(Correction::check)?;
        Ok(found)
    }

    /// Whether the correction holds for the cuts of `table`; what is to be kept in mind if it does.
    ///
    /// # Errors
    /// Another material or another width.
    pub fn guard(&self, table: &ForceTable, kind: TableKind) -> Result<Vec<String>, GreyBoxError> {
        let own = &self.settings[kind as usize];
        let other = &table.setting;
        if let Some((fitted, given)) = own.differs(other) {
            return Err(GreyBoxError::OtherSetting { fitted, given });
        }
        let name = &table.origin.name;
        let mut notes = Vec::new();
        if let (Some(material), None) = (&own.material, &other.material) {
            notes.push(format!("`{name}` does not say its material: taken to be `{material}`, which the correction was fitted to"));
        }
        for tool in
            other.tools.iter().filter(|tool| !own.tools.is_empty() && !own.tools.contains(tool))
        {
            notes.push(format!(
                "`{name}` has the tool `{tool}`, the correction was fitted to {}: it may not hold",
                own.tools.iter().map(|tool| format!("`{tool}`")).collect::<Vec<_>>().join(", ")
            ));
        }
        Ok(notes)
    }

    /// Whether the correction was fitted to a row of `table`: its numbers are those of a row of the fit.
    #[must_use]
    pub(crate) fn has_seen(&self, table: &ForceTable, row: &ForceRow) -> bool {
        let same = |own: &[f64; 4]| {
            own.iter().zip(numbers(row)).all(|(a, b)| (a - b).abs() <= ROUNDING * a.abs())
        };
        self.tables[1].sha256 == table.origin.sha256 || self.rows.iter().any(same)
    }

    /// The corrected force at a condition whose simulated force is known, by a regressor or the one to use.
    ///
    /// # Errors
    /// A regressor that was not fitted.
    pub fn predict(
        &self,
        force: ForceKind,
        method: Option<Method>,
        input: Input,
        simulated: f64,
    ) -> Result<Prediction, GreyBoxError> {
        let correction = &self.corrections[force.index()];
        let taught = correction.taught(method.unwrap_or(correction.chosen))?;
        let inside = self.hull.contains(input);
        let corrected = simulated + taught.model.predict(input);
        let empirical = taught.half_widths[usize::from(!inside)];
        // Outside, a process that returns to its mean may be too sure of itself.
        let half_width = match taught.model.deviation(input) {
            Some(deviation) if inside => NORMAL_95 * deviation,
            Some(deviation) => (NORMAL_95 * deviation).max(empirical),
            None => empirical,
        };
        let interval = [corrected - half_width, corrected + half_width];
        Ok(Prediction { simulated, corrected, interval, inside })
    }
}

/// Of a row: v_c, h, F_c, F_f.
fn numbers(row: &ForceRow) -> [f64; 4] {
    [row.cutting_speed, row.uncut_chip_thickness, row.forces[0], row.forces[1]]
}

/// Enough of a file to know what it is.
#[derive(Deserialize)]
struct Head {
    format: String,
    format_version: u32,
}

impl Correction {
    /// The regressor of a method.
    ///
    /// # Errors
    /// One that was not fitted.
    pub fn taught(&self, method: Method) -> Result<&Taught, GreyBoxError> {
        self.regressors.iter().find(|taught| taught.method == method).ok_or_else(|| {
            let known: Vec<&str> = self.regressors.iter().map(|t| t.method.key()).collect();
            GreyBoxError::Model(format!(
                "`{}` was not fitted; there are {}",
                method.key(),
                known.join(", ")
            ))
        })
    }

    fn check(&self) -> Result<(), GreyBoxError> {
        let wrong = |method: Method, what: &str| {
            let (name, force) = (method.key(), self.force.symbol());
            Err(GreyBoxError::Model(format!("a damaged grey box: {name} of {force} {what}")))
        };
        self.taught(self.chosen)?;
        for taught in &self.regressors {
            if !taught.model.is_sound() {
                return wrong(taught.method, "cannot be evaluated");
            }
            let same = |(input, value): &(Input, f64)| {
                taught.model.predict(*input).to_bits() == value.to_bits()
            };
            if !taught.check.iter().all(same) {
                return wrong(taught.method, "does not give the predictions it was stored with");
            }
        }
        Ok(())
    }
}
