//! [`Calibration`]: what a camera file tells of a camera, for the keys of a setup's [camera].

use anyhow::{Result, bail, ensure};
use toml::Value;

use super::document_tree::Node;
use super::fisheye::Fisheye;
use super::size::Size;

#[derive(Default)]
pub(crate) struct Calibration {
    pub(crate) size: Option<Size>,
    /// fx, fy, cx, cy
    pub(crate) intrinsics: [f64; 4],
    /// In OpenCV's order.
    pub(crate) distortion: Vec<f64>,
    /// A key of the readout time with its value.
    pub(crate) readout: Option<(&'static str, f64)>,
    pub(crate) is_bottom_to_top: bool,
}

/// How the coefficients of a lens are meant.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum LensModel {
    /// `k1 k2 p1 p2 [k3 [k4 k5 k6]]`
    BrownConrady,
    /// `k1 k2 k3 k4` of the angle off the axis.
    Fisheye,
}

impl Calibration {
    /// With the coefficients in the list of this name.
    pub(crate) fn with_lens(mut self, model: LensModel, node: &Node<'_>, name: &str) -> Result<Self> {
        let Some(coefficients) = node.numbers(name)? else { return Ok(self) };
        self.distortion = match model {
            LensModel::BrownConrady => brown_conrady(coefficients, node, name)?,
            LensModel::Fisheye => self.fisheye(&coefficients, node, name)?,
        };
        Ok(self)
    }

    fn fisheye(&self, coefficients: &[f64], node: &Node<'_>, name: &str) -> Result<Vec<f64>> {
        let at = node.at(name);
        let Ok(k) = <[f64; 4]>::try_from(coefficients) else {
            bail!("`{at}` has {} coefficients, but must have 4: a fisheye lens", coefficients.len());
        };
        let [fx, fy, cx, cy] = self.intrinsics;
        let Some(size) = self.size else {
            bail!("the size of the image is missing: of a fisheye lens only what lies in the image can be used");
        };
        Ok(Fisheye { k, focal_px: [fx, fy], centre_px: [cx, cy], size }.rational()?.into())
    }

    /// The same as keys of [camera].
    pub(crate) fn keys(&self) -> Vec<(&'static str, Value)> {
        let mut keys = Vec::new();
        if let Some(size) = self.size {
            keys.push(("columns", Value::Integer(size.columns.into())));
            keys.push(("rows", Value::Integer(size.rows.into())));
        }
        let [fx, fy, cx, cy] = self.intrinsics;
        keys.extend([("fx", fx), ("fy", fy), ("cx", cx), ("cy", cy)].map(|(key, value)| (key, Value::Float(value))));
        if self.distortion.iter().any(|coefficient| *coefficient != 0.0) {
            let coefficients = self.distortion.iter().copied().map(Value::Float).collect();
            keys.push(("distortion", Value::Array(coefficients)));
        }
        keys.extend(self.readout.map(|(key, value)| (key, Value::Float(value))));
        if self.is_bottom_to_top {
            keys.push(("direction", Value::String("bottom-to-top".to_string())));
        }
        keys
    }
}

/// Five or eight of them: further ones (thin prism, tilt) must be zero.
fn brown_conrady(mut coefficients: Vec<f64>, node: &Node<'_>, name: &str) -> Result<Vec<f64>> {
    let (at, found) = (node.at(name), coefficients.len());
    let is_known = matches!(found, 0 | 4 | 5 | 8 | 12 | 14);
    ensure!(is_known, "`{at}` has {found} coefficients, but must have 4, 5 or 8: k1 k2 p1 p2 [k3 [k4 k5 k6]]");
    if let Some(further) = coefficients.iter().skip(8).find(|further| **further != 0.0) {
        bail!("`{at}` has a coefficient of thin prism or tilt, {further}, but these must be zero");
    }
    let is_rational = coefficients.iter().skip(5).any(|further| *further != 0.0);
    coefficients.resize(if is_rational { 8 } else { 5 }, 0.0);
    Ok(coefficients)
}

/// Of the matrix `fx 0 cx, 0 fy cy, 0 0 1`.
pub(crate) fn intrinsics(node: &Node<'_>, name: &str) -> Result<[f64; 4]> {
    let matrix = node.numbers(name)?.ok_or_else(|| node.missing(name, "a matrix of 3 × 3 numbers"))?;
    let at = node.at(name);
    let [fx, skew, cx, b, fy, cy, c, d, one] = match <[f64; 9]>::try_from(matrix) {
        Ok(matrix) => matrix,
        Err(matrix) => bail!("`{at}` has {} numbers, but must have 9: fx 0 cx, 0 fy cy, 0 0 1", matrix.len()),
    };
    let is_camera = [b, c, d] == [0.0; 3] && one == 1.0;
    ensure!(is_camera, "`{at}` must be fx 0 cx, 0 fy cy, 0 0 1");
    ensure!(skew.abs() <= 1e-6 * fx.abs(), "`{at}` has a skew of {skew}, but it must be 0");
    Ok([fx, fy, cx, cy])
}

/// Width and height under these names.
pub(crate) fn size(node: &Node<'_>, [columns, rows]: [&str; 2]) -> Result<Option<Size>> {
    let side = |name: &str| -> Result<Option<u32>> {
        let Some(number) = node.number(name)? else { return Ok(None) };
        let is_side = number.fract() == 0.0 && (1.0..=32_767.0).contains(&number);
        if is_side { Ok(Some(number as u32)) } else { Err(node.refuse(name, "a whole number of pixels")) }
    };
    Ok(side(columns)?.zip(side(rows)?).map(|(columns, rows)| Size { columns, rows }))
}
