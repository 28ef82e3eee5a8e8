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

/// Returns all designs of a grid; a design (a combination of values) consists of settings by name,
/// in the form of the option `--set`. In the list of designs, the last setting varies fastest.
///
/// # Errors
/// [`SceneError::Invalid`] if the grid has no values, a duplicate name, or more than 100 000
/// designs.
///
/// ```
/// use tangency::scene::{Grid, designs};
/// let axis = |name: &str, low, high, count| Grid { name: name.into(), low, high, count };
/// let all = designs(&[axis("gap", 1e-6, 4e-6, 4), axis("thickness", 1.0, 2.0, 2)])?;
/// assert_eq!(all.len(), 8);
/// assert_eq!(all[3], [("gap".into(), "2e-6".into()), ("thickness".into(), "2".into())]);
/// # Ok::<(), tangency::scene::SceneError>(())
/// ```
pub fn designs(grid: &[Grid]) -> Result<Vec<Vec<(String, String)>>, SceneError> {
    let count = grid.iter().try_fold(1_usize, |all, axis| all.checked_mul(axis.count));
    let Some(count) = count.filter(|count| (1..=MOST).contains(count)) else {
        let counts: Vec<String> = grid.iter().map(|axis| axis.count.to_string()).collect();
        let counts = counts.join(" × ");
        let message = format!(
            "the grid has {counts} designs, but the number of designs must be \
                               from 1 to 100 000"
        );
        return Err(SceneError::invalid(message));
    };
    let twice = |(k, axis): &(usize, &Grid)| grid[..*k].iter().any(|it| it.name == axis.name);
    if let Some((_, axis)) = grid.iter().enumerate().find(twice) {
        let name = shown(&axis.name);
        let message = format!(
            "the setting `{name}` occurs twice in the grid, but may occur only \
                               once"
        );
        return Err(SceneError::invalid(message));
    }
    let design = |mut index: usize| {
        let setting = |axis: &Grid| {
            let value = spaced([axis.low, axis.high], axis.count, index % axis.count);
            index /= axis.count;
            (axis.name.clone(), significant(value, DIGITS))
        };
        let mut design: Vec<_> = grid.iter().rev().map(setting).collect();
        design.reverse();
        design
    };
    Ok((0..count).map(design).collect())
}
