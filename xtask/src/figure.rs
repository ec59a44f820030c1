//! [`Figure`]: one line of `docs/budget.csv`.

use std::path::Path;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

use crate::board::{BackEnd, Board, Opt};

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) struct Figure {
    pub(crate) board: Board,
    pub(crate) backend: BackEnd,
    pub(crate) opt: Opt,
    #[serde(rename = "use")]
    pub(crate) of: String,
    pub(crate) quantity: String,
    pub(crate) value: String,
}

impl Figure {
    /// All but the value.
    pub(crate) fn is_of_same(&self, other: &Self) -> bool {
        let key =
            |figure: &Self| (figure.board, figure.backend, figure.opt, figure.of.clone(), figure.quantity.clone());
        key(self) == key(other)
    }

    pub(crate) fn number(&self) -> f64 {
        self.value.parse().unwrap_or(f64::NAN)
    }
}

pub(crate) fn read(path: &Path) -> Result<Vec<Figure>> {
    let mut reader = csv::Reader::from_path(path).with_context(|| path.display().to_string())?;
    reader.deserialize().map(|figure| figure.with_context(|| path.display().to_string())).collect()
}

pub(crate) fn write(path: &Path, figures: &[Figure]) -> Result<()> {
    let mut writer = csv::Writer::from_path(path)?;
    for figure in figures {
        writer.serialize(figure)?;
    }
    writer.flush().with_context(|| path.display().to_string())
}
