//! What a correction holds for beside v_c and h: material, width and tool.

use crate::error::GreyBoxError;
use serde::{Deserialize, Serialize};

/// Widths that differ by less, relative to the first, are the same.
const SAME_WIDTH: f64 = 0.01;

/// What a table says of its cuts. Forces are in N, so they belong to one width; a correction belongs to one material.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct CutSetting {
    /// Name of the material.
    pub material: Option<String>,
    /// b in m.
    pub width_of_cut: Option<f64>,
    /// Names of the tools, each once.
    pub tools: Vec<String>,
}

impl CutSetting {
    /// Of the rows of a table: width, material, tool.
    ///
    /// # Errors
    /// Two materials or two widths in one table.
    pub(crate) fn of<'r>(
        rows: impl Iterator<Item = (Option<f64>, Option<&'r str>, Option<&'r str>)>,
    ) -> Result<Self, GreyBoxError> {
        let mut found = Self::default();
        for (width, material, tool) in rows {
            let row = Self {
                material: material.map(str::to_owned),
                width_of_cut: width,
                tools: tool.map(str::to_owned).into_iter().collect(),
            };
            if let Some((first, second)) = found.differs(&row) {
                return Err(GreyBoxError::Mixed { first, second });
            }
            found.material = found.material.or(row.material);
            found.width_of_cut = found.width_of_cut.or(row.width_of_cut);
            found.tools.extend(
                row.tools
                    .into_iter()
                    .filter(|tool| {
                        let known: &[String] = &found.tools;
                        !known.contains(tool)
                    })
                    .collect::<Vec<_>>(),
            );
        }
        Ok(found)
    }

    /// Material or width in which both differ, in words.
    pub(crate) fn differs(&self, other: &Self) -> Option<(String, String)> {
        if let (Some(own), Some(other)) = (&self.material, &other.material)
            && own != other
        {
            return Some((format!("the material `{own}`"), format!("`{other}`")));
        }
        self.differs_in_width(other)
    }

    fn differs_in_width(&self, other: &Self) -> Option<(String, String)> {
        let (own, other) = (self.width_of_cut?, other.width_of_cut?);
        let mm = |width: f64| {
            format!("{:.4}", width * 1e3).trim_end_matches('0').trim_end_matches('.').to_owned()
        };
        ((own - other).abs() > SAME_WIDTH * own)
            .then(|| (format!("cuts {} mm wide", mm(own)), format!("{} mm", mm(other))))
    }
}

/// Whether measurements belong to the simulation beside them. Materials are named differently in both: their names say nothing.
///
/// # Errors
/// Another width.
pub(crate) fn same_width(
    simulated: &CutSetting,
    measured: &CutSetting,
) -> Result<(), GreyBoxError> {
    match simulated.differs_in_width(measured) {
        Some((simulated, measured)) => Err(GreyBoxError::OtherWidth { simulated, measured }),
        None => Ok(()),
    }
}

/// Which of the two tables of a correction another one is held against.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableKind {
    /// Simulated forces.
    Simulated = 0,
    /// Measured ones.
    Measured = 1,
}
