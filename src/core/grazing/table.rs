//! Local maps in print.

use super::map::LocalMap;
use crate::core::jet::Polynomial;
use std::fmt::{Display, Formatter};

/// Coefficients below this are printed as zero.
const LEAST: f64 = 5e-11;

/// A table for each of both maps: a row for each monomial, a column for each coordinate of the image.
///
/// ```
/// use tangency::core::grazing::{GrazingPoint, LocalMap, MapSettings};
/// # use tangency::core::orbit::{HybridOrbit, Itinerary};
/// # use tangency::problems::classic::ImpactOscillator;
/// # let orbit = HybridOrbit::of(ImpactOscillator, Itinerary::smooth(ImpactOscillator::FLIGHT, 1));
/// # let point = GrazingPoint::of(&orbit, &[0.0, 1.0], &[0.1, 1.0, 0.8, 0.1, 1.0])?;
/// // The oscillator of the example of `LocalMap`.
/// let settings = MapSettings { order: 1, ..MapSettings::default() };
/// let map = LocalMap::of(&ImpactOscillator, &point, &["amplitude"], settings)?;
/// let printed = map.to_string();
/// assert!(printed.starts_with("smooth map, order 1"));
/// let row = printed.lines().find(|line| line.starts_with("y ")).expect("the row of y");
/// assert_eq!(row.split_whitespace().collect::<Vec<_>>(), ["y", "0.0000000000", "-2.5455844123"]);
/// # Ok::<(), tangency::core::grazing::GrazingError>(())
/// ```
impl Display for LocalMap {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let deviation = |name: &String| format!("Δ{name}");
        let mut variables: Vec<String> =
            self.coordinates().iter().chain(self.parameters()).map(deviation).collect();
        writeln!(f, "smooth map, order {}", self.space().order())?;
        self.table(f, &variables, self.smooth())?;
        variables[self.normal()] = "y".into();
        let leading = match self.exponent() {
            Some(exponent) => format!("leading term y^{}", 2.0 * exponent),
            None => "the identity up to this order".into(),
        };
        writeln!(f, "discontinuity map, y = √(penetration), {leading}")?;
        self.table(f, &variables, self.discontinuity())
    }
}

impl LocalMap {
    fn table(
        &self,
        f: &mut Formatter<'_>,
        variables: &[String],
        images: &[Polynomial],
    ) -> std::fmt::Result {
        let labels: Vec<String> = (0..self.space().len())
            .map(|k| monomial(variables, self.space().exponents(k)))
            .collect();
        let width = labels.iter().map(|label| label.chars().count()).max().unwrap_or(0);
        write!(f, "{:width$}", "")?;
        for name in self.coordinates() {
            write!(f, " {:>16}", format!("Δ{name}"))?;
        }
        writeln!(f)?;
        for k in 1..self.space().len() {
            let coefficients: Vec<f64> =
                images.iter().map(|image| image.coefficients()[k]).collect();
            if coefficients.iter().all(|c| c.abs() < LEAST) {
                continue;
            }
            write!(f, "{:width$}", labels[k])?;
            for c in coefficients {
                // No negative zeros.
                let c = if c.abs() < LEAST { 0.0 } else { c };
                write!(f, " {c:>16.10}")?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

/// `Δx²Δp`.
fn monomial(variables: &[String], exponents: &[u8]) -> String {
    let power = |(name, power): (&String, &u8)| match power {
        0 => String::new(),
        1 => name.clone(),
        _ => name.clone() + &power.to_string().chars().filter_map(raised).collect::<String>(),
    };
    variables.iter().zip(exponents).map(power).collect()
}

/// A digit as an exponent.
fn raised(digit: char) -> Option<char> {
    "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(digit.to_digit(10)? as usize)
}
