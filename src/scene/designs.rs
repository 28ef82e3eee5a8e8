//! The designs of a grid, that is, its combinations of values of the settings.

use super::error::SceneError;
use super::statement::Grid;
use crate::core::spelling::shown;
use crate::core::sweep::spaced;
use crate::output::significant;

/// The maximum number of designs in a grid.
const MOST: usize = 100_000;

/// The number of significant digits of the values in a design.
const DIGITS: usize = 12;

/// The values of a setting in a grid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choices {
    /// The name of the setting.
    pub name: String,
    /// The values of the setting, as in `--set`.
    pub values: Vec<String>,
}

impl From<Grid> for Choices {
    /// Returns the equally spaced values of a range. A longer list is cut off after one value more
    /// than the maximum number of designs in a grid.
    fn from(Grid { name, low, high, count }: Grid) -> Self {
        let value = |k: usize| significant(spaced([low, high], count, k), DIGITS);
        let values = (0..count.min(MOST + 1)).map(value).collect();
        Choices { name, values }
    }
}

/// Returns all designs of a grid; a design consists of settings by name, in the form of `--set`.
/// In the order of the designs, the last setting varies first.
///
/// # Errors
/// [`SceneError::Invalid`] if the grid has no values, a duplicate name, or more than 100 000
/// designs.
///
/// ```
/// use tangency::scene::{Choices, Grid, designs};
/// let gap = Grid { name: "gap".into(), low: 1e-6, high: 4e-6, count: 4 };
/// let supports = Choices { name: "supports".into(), values: vec!["CCCC".into(), "SSSS".into()] };
/// let all = designs(&[Choices::from(gap), supports])?;
/// assert_eq!(all.len(), 8);
/// assert_eq!(all[3], [("gap".into(), "2e-6".into()), ("supports".into(), "SSSS".into())]);
/// # Ok::<(), tangency::scene::SceneError>(())
/// ```
pub fn designs(grid: &[Choices]) -> Result<Vec<Vec<(String, String)>>, SceneError> {
    let count = grid.iter().try_fold(1_usize, |all, axis| all.checked_mul(axis.values.len()));
    let Some(count) = count.filter(|count| (1..=MOST).contains(count)) else {
        let counts: Vec<String> = grid.iter().map(|axis| axis.values.len().to_string()).collect();
        let counts = counts.join(" × ");
        let message = format!(
            "the grid has {counts} designs, but the number of designs must be \
                               from 1 to 100 000"
        );
        return Err(SceneError::invalid(message));
    };
    let twice = |(k, axis): &(usize, &Choices)| grid[..*k].iter().any(|it| it.name == axis.name);
    if let Some((_, axis)) = grid.iter().enumerate().find(twice) {
        let name = shown(&axis.name);
        let message = format!(
            "the setting `{name}` occurs twice in the grid, but may occur only \
                               once"
        );
        return Err(SceneError::invalid(message));
    }
    let design = |mut index: usize| {
        let setting = |axis: &Choices| {
            let value = axis.values[index % axis.values.len()].clone();
            index /= axis.values.len();
            (axis.name.clone(), value)
        };
        let mut design: Vec<_> = grid.iter().rev().map(setting).collect();
        design.reverse();
        design
    };
    Ok((0..count).map(design).collect())
}
