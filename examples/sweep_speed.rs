//! How many periods of a motion with impacts are simulated in a second: Mita's actuator at ω = 0.5,
//! on P(1,1) (V = 0.52) and in chaos (V = 0.65), many motions abreast and one after another, with
//! the error of the state after one period; and what a second thread gives to a sweep.
//!
//! ```sh
//! cargo run --profile fastest --example sweep_speed              # both voltages, and threads
//! sweep_speed VOLTAGE TOLERANCE PERIODS STATES IMAGES            # rows of one table; see below
//! ```
//!
//! With arguments it reads the file `STATES`, or, if there is none, writes 500 states along the
//! motion into it: lines with the mode and displacement, velocity and velocity of the frame at the
//! beginning of a period. It writes what they become in one period into `IMAGES`, and prints a row
//! for so many periods of each. `benches/peers/sweep.py` runs it so beside heyoka and SciPy, and
//! puts all into one table.

use cpu_time::ProcessTime;
use std::error::Error;
use std::f64::consts::PI;
use std::fmt::Write;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::time::Instant;
use tangency::core::attractor::{AttractorSearch, PeriodMap, StroboscopicError, StroboscopicMap};
use tangency::core::hybrid::{
    Fleet, FleetObserver, HybridFlow, HybridSettings, HybridState, HybridStatistics, Member,
};
use tangency::core::ode::{Scheme, Settings};
use tangency::core::sweep::{Axis, Found, Order, Part, Plan, Quantity, execute};
use tangency::problems::mita::Actuator;

/// The period of the forcing at ω = 0.5.
const PERIOD: f64 = 2.0 * PI;

/// A leg begins with a twentieth of what is left of the period: finding out would cost two
/// evaluations.
fn settings(tolerance: f64) -> HybridSettings {
    let flow =
        Settings { first_step: Some(0.05), ..Settings::new(Scheme::DormandPrince8, tolerance) };
    HybridSettings { flow, ..HybridSettings::default() }
}

/// Follows every member for so many periods.
struct Periods {
    most: usize,
    done: Vec<usize>,
}

impl FleetObserver<f64> for Periods {
    fn arrived(
        &mut self,
        member: usize,
        state: &mut HybridState<f64>,
        _statistics: &HybridStatistics,
    ) -> ControlFlow<()> {
        state.time = 0.0;
        self.done[member] += 1;
        if self.done[member] < self.most {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    }
}

/// Members after so many periods, abreast.
fn abreast(
    members: &[Member<f64>],
    most: usize,
    tolerance: f64,
) -> Result<Vec<Member<f64>>, Box<dyn Error>> {
    let mut members = members.to_vec();
    let mut periods = Periods { most, done: vec![0; members.len()] };
    let mut fleet = Fleet::new(&Actuator, settings(tolerance))?;
    let results = fleet.advance(&mut members, |_| PERIOD, &mut periods);
    results.into_iter().collect::<Result<(), _>>()?;
    Ok(members)
}

/// The same one after another.
fn alone(
    members: &[Member<f64>],
    most: usize,
    tolerance: f64,
) -> Result<Vec<Member<f64>>, Box<dyn Error>> {
    let mut members = members.to_vec();
    let mut flow = HybridFlow::new(&Actuator, settings(tolerance))?;
    for Member { state, p } in &mut members {
        for _ in 0..most {
            flow.advance(state, PERIOD, p, &mut ())?;
            state.time = 0.0;
        }
    }
    Ok(members)
}

/// 500 states along the motion that begins at rest, after ten periods.
fn states(voltage: f64) -> Result<Vec<Member<f64>>, Box<dyn Error>> {
    let mut p = Actuator::DEFAULTS.to_vec();
    p[0] = voltage;
    let state = HybridState { mode: Actuator::STICK, time: 0.0, x: vec![0.0; 2] };
    let mut members = alone(&[Member { state, p }], 10, 1e-13)?;
    for k in 0..499 {
        let next = alone(&members[k..=k], 1, 1e-13)?;
        members.extend(next);
    }
    Ok(members)
}

/// Displacement, velocity, and velocity of the frame.
fn motion(state: &HybridState<f64>) -> [f64; 3] {
    [state.x[0], state.x[1], state.x.get(2).copied().unwrap_or(0.0)]
}

/// Lines with mode and motion.
fn lines(members: &[Member<f64>]) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    for Member { state, .. } in members {
        let [q, u, v] = motion(state);
        writeln!(text, "{} {q:?} {u:?} {v:?}", state.mode)?;
    }
    Ok(text)
}

fn read(text: &str, voltage: f64) -> Result<Vec<Member<f64>>, Box<dyn Error>> {
    let mut p = Actuator::DEFAULTS.to_vec();
    p[0] = voltage;
    let member = |line: &str| -> Result<Member<f64>, Box<dyn Error>> {
        let mut words = line.split_whitespace();
        let mode = words.next().ok_or("an empty line")?.parse()?;
        let numbers = words.map(str::parse).collect::<Result<Vec<f64>, _>>()?;
        let x = match (mode, &numbers[..]) {
            (Actuator::STICK, [q, u, _]) => vec![*q, *u],
            (Actuator::FORWARD | Actuator::BACKWARD, [q, u, v]) => vec![*q, *u, *v, 0.0],
            _ => return Err(format!("no state off the stoppers: {line}").into()),
        };
        Ok(Member { state: HybridState { mode, time: 0.0, x }, p: p.clone() })
    };
    text.lines().map(member).collect()
}

/// The median of the errors of states, each its largest component.
fn error(found: &[Member<f64>], exact: &[Member<f64>]) -> f64 {
    let mut errors: Vec<f64> = found
        .iter()
        .zip(exact)
        .map(|(a, b)| {
            let (a, b) = (motion(&a.state), motion(&b.state));
            a.iter().zip(b).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()))
        })
        .collect();
    errors.sort_by(f64::total_cmp);
    errors[errors.len() / 2]
}

type Follow = fn(&[Member<f64>], usize, f64) -> Result<Vec<Member<f64>>, Box<dyn Error>>;

/// Both ways to follow many motions.
const WAYS: [(&str, Follow); 2] = [("abreast", abreast), ("one by one", alone)];

/// Periods in a second of CPU time: the median of five runs.
fn rate(
    follow: Follow,
    members: &[Member<f64>],
    periods: usize,
    tolerance: f64,
) -> Result<f64, Box<dyn Error>> {
    let mut rates = Vec::new();
    for _ in 0..5 {
        let start = ProcessTime::now();
        follow(members, periods, tolerance)?;
        rates.push((members.len() * periods) as f64 / start.elapsed().as_secs_f64());
    }
    rates.sort_by(f64::total_cmp);
    Ok(rates[2])
}

/// A row for each way, for a voltage and a tolerance, from given states.
fn report(
    members: &[Member<f64>],
    (voltage, tolerance): (f64, f64),
    periods: usize,
) -> Result<Vec<Member<f64>>, Box<dyn Error>> {
    let exact = alone(members, 1, 1e-14)?;
    for (name, follow) in WAYS {
        let error = error(&follow(members, 1, tolerance)?, &exact);
        let rate = rate(follow, members, periods, tolerance)?;
        println!("| tangency, {name} | {voltage} | {tolerance:.1e} | {error:.1e} | {rate:.0} |");
    }
    abreast(members, 1, tolerance)
}

/// How long a sweep over 32 voltages takes on so many threads, in seconds.
fn sweep_on(threads: NonZeroUsize) -> Result<f64, Box<dyn Error>> {
    let start = HybridState { mode: Actuator::STICK, time: 0.0, x: vec![0.0; 2] };
    let axis = Axis { quantity: Quantity::Parameter(0), low: 0.55, high: 0.85, count: 32 };
    let search = AttractorSearch { transient: 200, ..AttractorSearch::default() };
    let plan = Plan {
        axes: vec![axis],
        starts: vec![start],
        order: Order::Anew,
        strands: 1,
        search,
        crisis: None,
    };
    let make = || -> Result<Box<dyn StroboscopicMap>, StroboscopicError> {
        Ok(Box::new(PeriodMap::of(&Actuator, settings(1e-9), &[])?))
    };
    let (part, begin) = (Part { threads: Some(threads), ..Part::WHOLE }, Instant::now());
    let mut found = 0;
    execute(&plan, part, &Actuator::DEFAULTS, &make, &|_| None, &mut |_: Found| {
        found += 1;
    })?;
    if found == plan.runs() {
        Ok(begin.elapsed().as_secs_f64())
    } else {
        Err("runs are missing".into())
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [voltage, tolerance, periods, states_file, images] = &arguments[..] {
        let (voltage, tolerance) = (voltage.parse()?, tolerance.parse()?);
        if !std::fs::exists(states_file)? {
            std::fs::write(states_file, lines(&states(voltage)?)?)?;
        }
        let members = read(&std::fs::read_to_string(states_file)?, voltage)?;
        let found = report(&members, (voltage, tolerance), periods.parse()?)?;
        std::fs::write(images, lines(&found)?)?;
        return Ok(());
    }
    println!("| method | V | tolerance | error | periods a second |");
    println!("|---|---|---|---|---|");
    for voltage in [0.52, 0.65] {
        report(&states(voltage)?, (voltage, 1e-9), 20)?;
    }
    // Alternately, and the least of three: other work on the machine only makes times longer.
    let mut least = [f64::INFINITY; 2];
    for _ in 0..3 {
        for (threads, least) in [1, 2].into_iter().filter_map(NonZeroUsize::new).zip(&mut least) {
            *least = sweep_on(threads)?.min(*least);
        }
    }
    let [one, two] = least;
    println!("\nA sweep: {one:.2} s on one thread, {two:.2} s on two, ratio {:.2}.", one / two);
    Ok(())
}
