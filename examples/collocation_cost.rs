//! What one correction of a periodic orbit by collocation costs, against the number of intervals
//! and against the number of states: assembling, factoring and solving, in CPU time on one thread
//! (median of many).
//!
//! The field is Lorenz' of 1996, `x_i' = (x_{i+1} − x_{i−2}) x_{i−1} − x_i + F`, for any number of
//! states. Its cost is linear in their number: what grows faster is linear algebra. The exponent
//! beside each line is that of growth from the size before, `log(t/t₋)/log(s/s₋)`.
//! `out/collocation-cost.svg` draws both.

use cpu_time::ProcessTime;
use std::error::Error;
use std::f64::consts::TAU;
use tangency::core::bvp::Collocation;
use tangency::core::linalg::{Border, Factors, Form};
use tangency::core::orbit::periodic_orbits;
use tangency::core::problem::{Group, Names, VectorField};
use tangency::core::scalar::Scalar;
use tangency::core::system::System;
use tangency::output::{Figure, PAGE, Series, Style, draw, write_atomically};

/// Lorenz' field of 1996 with this number of states.
#[derive(Clone)]
struct Ring(usize);

impl VectorField for Ring {
    fn names(&self) -> Names {
        let state = |i| Group::new(format!("x{i}"), 1);
        Names::new((0..self.0).map(state), ["F"])
    }

    fn field<T: Scalar>(&self, _t: T, x: &[T], p: &[T], f: &mut [T]) {
        let n = self.0;
        for i in 0..n {
            f[i] = (x[(i + 1) % n] - x[(i + n - 2) % n]) * x[(i + n - 1) % n] - x[i] + p[0];
        }
    }
}

/// CPU time in microseconds for assembling, factoring and solving.
type Cost = [f64; 3];

/// How often a size is measured: for so many seconds, and so many times at least.
const SECONDS: f64 = 0.25;
const TIMES: usize = 7;

/// The cost of one correction with the parameter released, as along a branch.
fn cost(states: usize, intervals: usize) -> Result<Cost, Box<dyn Error>> {
    let mut system = periodic_orbits(Ring(states), intervals, Collocation::new(4)?)?;
    let wave = |_, tau: f64, x: &mut [f64]| {
        x.iter_mut().enumerate().for_each(|(i, x)| *x = (TAU * tau + i as f64).sin() + 2.0);
    };
    let mut x = system.sampled(&[2.0], wave);
    let n = x.len();
    x.push(8.0);
    let mut direction = vec![0.0; n + 1];
    direction[n] = 1.0;
    let mut column = vec![0.0; n];
    system.derivative(&x, &[&direction], &mut column).unwrap();
    let row = vec![1.0 / n as f64; n];
    let border = Border { width: 1, columns: &column, rows: &row, corner: &[1.0], units: &[] };
    let mut right = vec![1.0; n + 1];
    let mut times: [Vec<f64>; 3] = Default::default();
    let begin = ProcessTime::now();
    while begin.elapsed().as_secs_f64() < SECONDS || times[0].len() < TIMES {
        // At the same point nothing would be assembled anew.
        x[n] += 1e-9;
        let start = ProcessTime::now();
        system.assemble(&x)?;
        let assembled = start.elapsed();
        let mut factors = Factors::default();
        system.factor(Form::Jacobian, border, &mut factors)?;
        let factored = start.elapsed();
        right.fill(1.0);
        factors.solve(&mut right);
        let solved = start.elapsed();
        let parts = [assembled, factored - assembled, solved - factored];
        times.iter_mut().zip(parts).for_each(|(times, part)| times.push(part.as_secs_f64() * 1e6));
    }
    Ok(times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    }))
}

/// Measures and prints one cost for each size, and draws them, in logarithms, beside a line of
/// slope `power`.
fn table(
    title: &str,
    what: &str,
    sizes: &[usize],
    power: i32,
    measure: impl Fn(usize) -> Result<Cost, Box<dyn Error>>,
) -> Result<Figure, Box<dyn Error>> {
    println!("{what:>10}  assemble µs    factor µs     solve µs       sum µs  exponent");
    let mut points: Vec<[[f64; 2]; 3]> = Vec::new();
    let mut before: Option<(f64, f64)> = None;
    for &size in sizes {
        let parts = measure(size)?;
        let (s, sum) = (size as f64, parts.iter().sum::<f64>());
        let exponent = before.map(|(s0, t0)| (sum / t0).ln() / (s / s0).ln());
        let exponent = exponent.map_or(String::new(), |exponent| format!("{exponent:.2}"));
        let [assemble, factor, solve] = parts;
        println!(
            "{size:>10} {assemble:>12.1} {factor:>12.1} {solve:>12.1} {sum:>12.1} {exponent:>9}"
        );
        before = Some((s, sum));
        points.push(parts.map(|part| [s.log10(), part.log10()]));
    }
    let mut figure = Figure::new(title, format!("log₁₀ {what}"), "log₁₀ CPU time (µs)");
    for (k, name) in ["assemble", "factor", "solve"].iter().enumerate() {
        figure = figure.with(Series::new(*name, Style::DottedLine, points.iter().map(|p| p[k])));
    }
    // Through the last point of the dearest part.
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return Ok(figure) };
    let top = last.iter().map(|p| p[1]).fold(f64::MIN, f64::max);
    let [left, right] = [first[0][0], last[0][0]];
    let line = [[left, top - f64::from(power) * (right - left)], [right, top]];
    Ok(figure.with(Series::new(format!("slope {power}"), Style::Dashed, line)))
}

fn main() -> Result<(), Box<dyn Error>> {
    let title = "One correction: 3 states, 4 Gauss points";
    let sizes = [10, 20, 40, 80, 160, 320, 640];
    let intervals = table(title, "intervals", &sizes, 1, |intervals| cost(3, intervals))?;
    println!();
    let title = "One correction: 20 intervals, 4 Gauss points";
    let sizes = [2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96];
    let states = table(title, "states", &sizes, 3, |states| cost(states, 20))?;
    Ok(write_atomically("out/collocation-cost.svg", &draw(&[intervals, states], PAGE)?)?)
}
