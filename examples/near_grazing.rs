//! How well a local map tells what happens near a grazing: Mita's actuator by its flow, and by its
//! maps of orders 1 to 5.
//!
//! At ω = 0.485 the fixed points with an impact against their penetration, and about the degenerate
//! point, from which folds (LP) and period doublings (PD) begin, the voltages of both against the
//! frequency. The exponent beside each error is its rate. `out/near-grazing.svg` draws all.

use std::error::Error;
use std::f64::consts::PI;
use tangency::core::bvp::{BoundarySystem, Mesh, Shooting};
use tangency::core::continuation::{Branch, Continuation, Settings};
use tangency::core::hybrid::{HybridSystem, virtual_point};
use tangency::core::local_map::{GrazingPoint, LocalMap, LocalOrbit, MapSettings};
use tangency::core::ode::Scheme;
use tangency::core::orbit::{HybridOrbit, Itinerary};
use tangency::core::system::{Kind, System};
use tangency::output::{Figure, PAGE, Series, Style, draw, write_atomically};
use tangency::problems::mita::Actuator;

type Orbits = BoundarySystem;
type Found<T> = Result<T, Box<dyn Error>>;

const ORDERS: std::ops::RangeInclusive<usize> = 1..=5;

/// Orbits of the flow: at first those without events.
fn flow() -> Found<Orbits> {
    let orbit = HybridOrbit::of(Actuator, Itinerary::smooth(Actuator::STICK, 1))?;
    let method = Shooting::new(Scheme::DormandPrince8, 1e-13)?;
    Ok(BoundarySystem::new(orbit, method, vec![Mesh::uniform(1)])?)
}

/// The branch without impacts in the voltage, at a frequency: of the flow, or of a local map.
fn passing(orbits: &mut dyn System, frequency: f64) -> Found<Branch> {
    let names = orbits.names().parameters.clone();
    let (all, mut run) = (Actuator.parameters(), Continuation::new(orbits));
    for (name, value) in all.iter().zip(Actuator::DEFAULTS).filter(|(name, _)| names.contains(name))
    {
        run = run.at(name, value);
    }
    let run = run.at("voltage", 0.17).at("frequency", frequency);
    Ok(run.along("voltage", 0.17..=0.25).trace()?)
}

/// The label of the first special point of a kind.
fn first(branch: &Branch, kind: Kind) -> Found<usize> {
    let point =
        branch.of_kind(kind).next().ok_or_else(|| format!("no {kind} on {}", branch.name))?;
    Ok(point.label)
}

/// The local map at a grazing that a branch or a curve has found.
fn map(orbits: &mut Orbits, branch: &Branch, label: usize) -> Found<LocalMap> {
    let grazing = branch.labelled(label).ok_or("no such point")?;
    let point = GrazingPoint::at(orbits, &branch.solution(grazing))?;
    let point = point.located(&Actuator, "voltage")?;
    let settings = MapSettings { order: *ORDERS.end(), ..MapSettings::default() };
    Ok(LocalMap::of(&Actuator, &point, &["voltage", "frequency"], settings)?)
}

/// Settings for short branches.
fn fine() -> Settings {
    Settings { initial_step: 1e-3, max_step: 0.02, ..Settings::default() }
}

/// Fixed points with an impact at voltages: `y` and the phase of their virtual points, by what
/// tells them of a state and the parameters.
fn fixed_points(
    orbits: &mut Orbits,
    voltages: &[f64],
    virtual_of: impl Fn(&mut Orbits, &[f64], &[f64]) -> Found<[f64; 2]>,
) -> Found<Vec<[f64; 2]>> {
    let passing = passing(orbits, 0.485)?;
    let label = first(&passing, Kind::G)?;
    let run = Continuation::new(orbits).restart(&passing, label).switch().settings(fine());
    let run = run.along("voltage", 0.17..=1.01 * voltages[voltages.len() - 1]);
    let branch = voltages.iter().fold(run, |run, v| run.mark("voltage", *v)).trace()?;
    let marks: Vec<_> = branch.of_kind(Kind::UZ).cloned().collect();
    // The trace has left the system as it was: it takes over each point.
    let take = |mark: &tangency::core::continuation::SpecialPoint| {
        orbits.resume_from(&branch.solution(mark))?;
        virtual_of(orbits, &mark.state, &mark.parameters)
    };
    marks.iter().map(take).collect()
}

/// `y` and phase of the virtual point of an orbit of the flow.
fn virtual_of_flow(orbits: &mut Orbits, state: &[f64], p: &[f64]) -> Found<[f64; 2]> {
    let x = orbits.states(&[state, p].concat(), 1, 1.0)?;
    let time: f64 = state[state.len() - 3..].iter().sum();
    let guard = (Actuator::FRONT, Actuator::STICK);
    let (time, x) =
        virtual_point(&Actuator, guard, (time, &x), p, 6.0).ok_or("no virtual point")?;
    Ok([(x[0] - p[2]).sqrt(), (p[1] * time).rem_euclid(PI)])
}

/// Voltages of folds or doublings at frequencies, beginning at the last of these, where the branch
/// has one.
fn curve(orbits: &mut dyn System, kind: Kind, frequencies: &[f64]) -> Found<Vec<f64>> {
    let far = frequencies[frequencies.len() - 1];
    let passing = passing(orbits, far)?;
    let grazing = first(&passing, Kind::G)?;
    let one = Continuation::new(orbits).restart(&passing, grazing).switch().settings(fine());
    let one = one.along("voltage", 0.17..=0.25).trace()?;
    let special = one.labelled(first(&one, kind)?).ok_or("no special point")?.clone();
    let run = Continuation::new(orbits).restart(&one, special.label).hold(kind).settings(fine());
    let run = run.along("voltage", 0.17..=0.18);
    // From the far end towards the degenerate point.
    let (low, high) = (far.min(frequencies[0]), far.max(frequencies[0]));
    let run = run.along("frequency", low - 1e-9..=high + 1e-9);
    let marked = frequencies[1..frequencies.len() - 1].iter();
    let curve = marked.fold(run, |run, w| run.mark("frequency", *w)).trace()?;
    let mut found: Vec<(f64, f64)> =
        curve.of_kind(Kind::UZ).map(|point| (point.parameters[1], point.parameters[0])).collect();
    found.sort_by(|a, b| (a.0 - far).abs().total_cmp(&(b.0 - far).abs()).reverse());
    Ok(found.into_iter().map(|(_, voltage)| voltage).collect())
}

/// Errors of maps, by order.
type Errors = Vec<(usize, Vec<f64>)>;

/// Prints errors with their rates, and draws those above rounding in logarithms.
fn table(title: &str, what: &str, places: &[f64], errors: &Errors, rounding: f64) -> Figure {
    let head = errors.iter().map(|(order, _)| format!("{:>10}      ", format!("order {order}")));
    println!("\n{title}\n{what:>22}{}", head.collect::<String>());
    for (k, place) in places.iter().enumerate() {
        let cells = errors.iter().map(|(_, errors)| {
            let before = k.checked_sub(1);
            let rate = before.map(|b| (errors[k] / errors[b]).ln() / (place / places[b]).ln());
            format!("{:>10.1e} {:>5}", errors[k], rate.map_or(String::new(), |r| format!("{r:.2}")))
        });
        println!("{place:>22.3e}{}", cells.collect::<String>());
    }
    let mut figure = Figure::new(title, format!("log₁₀ {what}"), "log₁₀ error");
    for (order, errors) in errors {
        let seen = places.iter().zip(errors).filter(|(_, error)| **error > rounding);
        let points = seen.map(|(place, error)| [place.log10(), error.log10()]);
        figure = figure.with(Series::new(format!("order {order}"), Style::DottedLine, points));
    }
    figure
}

fn main() -> Found<()> {
    // Fixed points at ω = 0.485, of type II.
    let mut orbits = flow()?;
    let branch = passing(&mut orbits, 0.485)?;
    let at = map(&mut orbits, &branch, first(&branch, Kind::G)?)?;
    let origin = (at.origin().0.to_vec(), at.origin().1[0]);
    let voltages: Vec<f64> = (0..8).map(|k| origin.1 + 2e-5 * 2.0_f64.powi(k)).collect();
    let exact = fixed_points(&mut flow()?, &voltages, virtual_of_flow)?;
    let penetration: Vec<f64> = exact.iter().map(|[y, _]| y * y).collect();
    let error = |order: usize| -> Found<(usize, Vec<f64>)> {
        let mut points =
            LocalOrbit::of(at.clone(), &[false]).to_order(order).in_place().system()?;
        let found = fixed_points(&mut points, &voltages, |_, state, _| {
            Ok([state[state.len() - 1], (origin.0[1] + state[state.len() - 2]).rem_euclid(PI)])
        })?;
        let miss = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
        Ok((order, found.iter().zip(&exact).map(miss).collect()))
    };
    let errors = ORDERS.map(error).collect::<Found<Errors>>()?;
    let title = "Fixed points at ω = 0.485: y and phase";
    let mut figures = vec![table(title, "penetration", &penetration, &errors, 2e-12)];

    // Folds and doublings about the degenerate point.
    let mut orbits = flow()?;
    let branch = passing(&mut orbits, 0.5)?;
    let label = first(&branch, Kind::G)?;
    let births = Continuation::new(&mut orbits).restart(&branch, label).switch().hold(Kind::G);
    let births = births.along("voltage", 0.1..=0.3).along("frequency", 0.48..=0.51).trace()?;
    let at = map(&mut orbits, &births, first(&births, Kind::GD)?)?;
    for (kind, far) in [(Kind::LP, 4e-3), (Kind::PD, -4e-4)] {
        let sizes: Vec<f64> = (0..6).map(|k| far * 0.5_f64.powi(5 - k)).collect();
        let edges = [vec![0.5 * sizes[0]], sizes.clone(), vec![1.1 * far]].concat();
        let frequencies: Vec<f64> = edges.iter().map(|w| at.origin().1[1] + w).collect();
        let exact = curve(&mut flow()?, kind, &frequencies)?;
        let error = |order: usize| -> Found<(usize, Vec<f64>)> {
            let points = LocalOrbit::of(at.clone(), &[false]).to_order(order).in_place();
            let found = curve(&mut points.system()?, kind, &frequencies)?;
            Ok((order, found.iter().zip(&exact).map(|(a, b)| (a - b).abs()).collect()))
        };
        // The first order has no special points.
        let errors = (2..=*ORDERS.end()).map(error).collect::<Found<Errors>>()?;
        let sizes: Vec<f64> = sizes.iter().map(|w| w.abs()).collect();
        let title = format!("Voltage of the {} near the degenerate point", kind.meaning());
        figures.push(table(&title, "|Δω|", &sizes, &errors, 1e-14));
    }
    Ok(write_atomically("out/near-grazing.svg", &draw(&figures, PAGE)?)?)
}
