//! Chooses the ticks of an axis at round numbers.

use crate::output::error::FigureError;
use crate::output::number::significant;
use crate::output::units;

/// An axis with its range, its ticks and the labels of the ticks.
#[derive(Debug, PartialEq)]
pub(super) struct Ticks {
    /// The range of the axis, which is slightly wider than the data.
    pub(super) range: [f64; 2],
    /// The ticks within the range, with their labels.
    pub(super) ticks: Vec<(f64, String)>,
    /// The exponent of the power of ten by which all labels of the axis are multiplied; a multiple
    /// of 3.
    exponent: i32,
    logarithmic: bool,
}

impl Ticks {
    /// Returns the ticks of a linear or logarithmic axis for given data; one or both ends of the
    /// axis can be prescribed.
    pub(super) fn of(
        [low, high]: [f64; 2],
        ends: [Option<f64>; 2],
        count: f64,
        logarithmic: bool,
    ) -> Result<Self, FigureError> {
        let data = [ends[0].unwrap_or(low), ends[1].unwrap_or(high)];
        if logarithmic { Ticks::decades(data, ends, count) } else { Ticks::new(data, ends, count) }
    }

    /// Returns about `count` ticks for positive data between two values. The ticks are at powers of
    /// ten; at 1, 2 and 5 times powers of ten if the range contains fewer than three powers; and as
    /// on a linear axis if the range is shorter than a third of a decade.
    fn decades(data: [f64; 2], ends: [Option<f64>; 2], count: f64) -> Result<Self, FigureError> {
        let [low, high] = widened(data.map(f64::log10), ends.map(|end| end.map(f64::log10)));
        let range = [low, high].map(|end| 10f64.powf(end));
        if !(range[0] > 0.0 && range[1].is_finite()) {
            return Err(FigureError::TooWide { low: data[0], high: data[1] });
        }
        if high - low < 1.0 / 3.0 {
            let Ticks { ticks, exponent, .. } = Ticks::new(data, ends, count)?;
            return Ok(Ticks { range, ticks, exponent, logarithmic: true });
        }
        let powers = (low.ceil() as i32)..=(high.floor() as i32);
        let number = powers.clone().count();
        let every = (number as f64 / count.max(1.0)).ceil().max(1.0) as i32;
        let named: Vec<i32> = powers.filter(|power| power.rem_euclid(every) == 0).collect();
        let plain = named.iter().all(|power| (-3..=4).contains(power));
        let label = |power: i32| match power {
            0 => "1".into(),
            _ if plain => format!("{}", 10f64.powi(power)),
            _ => power_of_ten(power).replacen('×', "", 1),
        };
        let mut ticks: Vec<(f64, String)> =
            named.iter().map(|power| (10f64.powi(*power), label(*power))).collect();
        if number < 3 {
            let all = (low.floor() as i32..=high.floor() as i32)
                .flat_map(|power| [1, 2, 5].map(|digit| (digit, power)));
            let ticks_of = all.filter_map(|(digit, power)| {
                // Parsing the decimal gives the number with the shortest text.
                let tick: f64 = format!("{digit}e{power}").parse().ok()?;
                let label = match power {
                    -4..=4 => format!("{tick}"),
                    _ => significant(tick, 1),
                };
                (low..=high).contains(&tick.log10()).then_some((tick, label))
            });
            ticks = ticks_of.collect();
        }
        Ok(Ticks { range, ticks, exponent: 0, logarithmic: true })
    }

    /// Returns the position of a value along the axis, as a fraction of the length of the axis.
    pub(super) fn part(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        match self.logarithmic {
            true => (value.ln() - low.ln()) / (high.ln() - low.ln()),
            false => (value - low) / (high - low),
        }
    }

    /// Returns about `count` ticks of a linear axis for data between two values.
    fn new([low, high]: [f64; 2], ends: [Option<f64>; 2], count: f64) -> Result<Self, FigureError> {
        let range = widened([low, high], ends);
        let width = range[1] - range[0];
        if !width.is_finite() {
            return Err(FigureError::TooWide { low, high });
        }
        let (step, step_exponent) = round_step(width / count);
        let largest = range[0].abs().max(range[1].abs());
        let exponent = units::exponent(largest);
        let decimals = usize::try_from(exponent - step_exponent).unwrap_or(0);
        let scale = 10f64.powi(-exponent);
        let first = (range[0] / step).ceil();
        let number = ((range[1] / step).floor() - first) as usize;
        let ticks = (0..=number.min(50)).map(|i| {
            // Adding zero turns -0 into 0.
            let tick = (first + i as f64) * step + 0.0;
            (tick, format!("{:.decimals$}", tick * scale).replace('-', "−"))
        });
        Ok(Ticks { range, ticks: ticks.collect(), exponent, logarithmic: false })
    }

    /// Returns the label of the axis, and the common factor of its numbers, which is written at the
    /// end of the axis: where possible, a prefix of the unit in the label replaces the factor, as
    /// in `gap (µm)` instead of `gap (m)` with `×10⁻⁶`. If an axis shows several columns, the
    /// common factor is not replaced.
    pub(super) fn label(&self, label: &str) -> (String, String) {
        let own = units::parts(label)
            .and_then(|(words, unit)| Some((words, units::prefixed(unit, self.exponent)?)));
        match own {
            Some((words, unit)) => (format!("{words} ({unit})"), String::new()),
            None => (label.to_owned(), power_of_ten(self.exponent)),
        }
    }

    /// Returns an axis for data between two values; the axis has the given names as labels at 0, 1,
    /// 2, ….
    pub(super) fn named(data: [f64; 2], ends: [Option<f64>; 2], names: &[String]) -> Self {
        let ticks = names.iter().enumerate().map(|(k, name)| (k as f64, name.clone()));
        let data = [ends[0].unwrap_or(data[0]), ends[1].unwrap_or(data[1])];
        let range = widened(data, ends);
        Ticks { range, ticks: ticks.collect(), exponent: 0, logarithmic: false }
    }
}

/// Returns the range of the data for an axis, extended by 4 % of its width at both ends, except at
/// ends that were chosen explicitly. A range that contains a single value is widened; a range of
/// values too small for a representable power of ten is widened, too.
fn widened([low, high]: [f64; 2], ends: [Option<f64>; 2]) -> [f64; 2] {
    let largest = low.abs().max(high.abs());
    let width = high - low;
    let margin = match width <= 1e-12 * largest {
        _ if largest < 1e-290 => 1.0,
        true => 0.05 * largest,
        false => 0.04 * width,
    };
    [ends[0].unwrap_or(low - margin), ends[1].unwrap_or(high + margin)]
}

/// Returns the round step nearest to a width, which is 1, 2 or 5 times a power of ten, and the
/// exponent of the power.
fn round_step(width: f64) -> (f64, i32) {
    let exponent = width.log10().floor() as i32;
    let power = 10f64.powi(exponent);
    match width / power {
        ..1.5 => (power, exponent),
        1.5..3.5 => (2.0 * power, exponent),
        3.5..7.5 => (5.0 * power, exponent),
        _ => (10.0 * power, exponent + 1),
    }
}

fn power_of_ten(exponent: i32) -> String {
    if exponent == 0 {
        return String::new();
    }
    let superscript = |letter: char| match letter.to_digit(10) {
        Some(digit) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize],
        None => '⁻',
    };
    format!("×10{}", exponent.to_string().chars().map(superscript).collect::<String>())
}
