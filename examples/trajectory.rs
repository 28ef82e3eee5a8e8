//! The trajectory of a model file, XPPAUT's `.ode` or a statement in RON, as CSV at equally spaced
//! times:
//!
//! ```sh
//! cargo run --release --example trajectory -- model.ode --time 100 --count 500
//! ```
//!
//! Motion begins at the file's own initial values, which are 0 where none are given. Maps are
//! iterated `count` times. Without a file it is `examples/lorenz.ron`.

use std::error::Error;
use std::io::{BufWriter, Write, stdout};
use std::sync::Arc;
use tangency::core::hybrid::{HybridFlow, HybridSettings, HybridState, HybridSystem};
use tangency::core::ode::{Flow, Scheme, Settings};
use tangency::core::problem::DiscreteMap;
use tangency::core::problem::VectorField;
use tangency::language::{Field, Hybrid, Iteration, Model, Source, xpp};

/// Of the steps of explicit and implicit schemes; the latter need too many for the former.
const TOLERANCES: [(Scheme, f64); 2] = [(Scheme::DormandPrince8, 1e-13), (Scheme::Rodas5P, 1e-12)];

/// What is asked for.
struct Request {
    start: f64,
    time: f64,
    count: usize,
    output: BufWriter<std::io::Stdout>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let (mut file, mut time, mut count) = (None, None, 500);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or(format!("{argument} needs a value"));
        match argument.as_str() {
            "--time" => time = Some(value()?.parse()?),
            "--count" => count = value()?.parse()?,
            _ => file = Some(argument),
        }
    }
    let file = file.unwrap_or("examples/lorenz.ron".into());
    // Files may be older than UTF-8.
    let text = String::from_utf8_lossy(&std::fs::read(&file)?).into_owned();
    let source = Source::new(file.as_str(), text);
    let understood = match file.ends_with(".ode") {
        true => xpp::read(&source)
            .and_then(|read| Ok((read.statement.model(&source, &[])?, read.options, read.clock))),
        false => Model::read(&source, &[]).map(|model| (model, Default::default(), None)),
    };
    let (model, options, clock) = match understood {
        Ok(understood) => understood,
        Err(error) => {
            eprintln!("{error}");
            std::process::exit(1);
        }
    };
    let time = time.or(options.total).unwrap_or(20.0);
    let output = BufWriter::new(stdout());
    let mut request = Request { start: options.start, time, count, output };
    let initial: Vec<(String, f64)> = model.initial(model.defaults());
    match model {
        Model::Field(field) => smooth(&field, &initial, &mut request),
        Model::Map(map) => iterated(&map, &initial, clock.is_some(), &mut request),
        Model::Hybrid(system) => with_events(&system, &initial, &mut request),
        _ => Err("only vector fields, maps and hybrid systems move".into()),
    }
}

/// The states where motion begins.
fn beginning(names: &[String], initial: &[(String, f64)]) -> Vec<f64> {
    let value = |name: &String| initial.iter().find(|(known, _)| known == name);
    names.iter().map(|name| value(name).map_or(0.0, |(_, value)| *value)).collect()
}

impl Request {
    fn header(&mut self, states: &[String], monitors: &[String]) -> std::io::Result<()> {
        let names: Vec<&str> = states.iter().chain(monitors).map(String::as_str).collect();
        writeln!(self.output, "t,{}", names.join(","))
    }

    fn row(&mut self, t: f64, values: impl IntoIterator<Item = f64>) -> std::io::Result<()> {
        write!(self.output, "{t:.17e}")?;
        for value in values {
            write!(self.output, ",{value:.17e}")?;
        }
        writeln!(self.output)
    }

    /// The time of a row.
    fn at(&self, k: usize) -> f64 {
        self.start + self.time * k as f64 / self.count as f64
    }
}

fn settings(scheme: Scheme, tolerance: f64) -> Settings {
    Settings { max_steps: 200_000, ..Settings::new(scheme, tolerance) }
}

fn smooth(
    field: &Field,
    initial: &[(String, f64)],
    request: &mut Request,
) -> Result<(), Box<dyn Error>> {
    let names = VectorField::names(field);
    let states: Vec<String> = names.unknowns.iter().map(|group| group.name.clone()).collect();
    let p = field.defaults();
    let mut x = beginning(&states, initial);
    request.header(&states, &names.monitors)?;
    let mut schemes = TOLERANCES.into_iter();
    let next = |schemes: &mut dyn Iterator<Item = (Scheme, f64)>| {
        schemes.next().map(|(scheme, tolerance)| Flow::<f64>::new(settings(scheme, tolerance)))
    };
    let mut flow = next(&mut schemes).ok_or("no scheme")??;
    for k in 0..=request.count {
        let t = request.at(k);
        let monitors = (0..names.monitors.len()).map(|m| field.monitor(m, t, &x, &p));
        request.row(t, x.iter().copied().chain(monitors))?;
        if k == request.count {
            break;
        }
        let before = x.clone();
        let length = request.at(k + 1) - t;
        while let Err(error) = flow.advance(field, t, length, &mut x, &p) {
            // From here on implicitly.
            flow = next(&mut schemes).ok_or(error)??;
            x.copy_from_slice(&before);
        }
    }
    Ok(())
}

fn iterated(
    map: &Iteration,
    initial: &[(String, f64)],
    counted: bool,
    request: &mut Request,
) -> Result<(), Box<dyn Error>> {
    let names = DiscreteMap::names(map);
    let states: Vec<String> = names.unknowns.iter().map(|group| group.name.clone()).collect();
    let p = map.defaults();
    let mut x = beginning(&states, initial);
    // A state that counts iterates is the time.
    let shown = states.len() - usize::from(counted);
    request.header(&states[..shown], &names.monitors)?;
    for k in 0..=request.count {
        let monitors = (0..names.monitors.len()).map(|m| map.monitor(m, &x, &p));
        request.row(request.start + k as f64, x[..shown].iter().copied().chain(monitors))?;
        let before = x.clone();
        map.next(&before, &p, &mut x);
    }
    Ok(())
}

fn with_events(
    system: &Arc<Hybrid>,
    initial: &[(String, f64)],
    request: &mut Request,
) -> Result<(), Box<dyn Error>> {
    let mode = system.modes().swap_remove(0);
    let p = HybridSystem::defaults(&**system);
    let x = beginning(&mode.states, initial);
    let monitors = HybridSystem::monitors(&**system);
    request.header(&mode.states, &monitors)?;
    let mut state = HybridState { mode: 0, time: request.start, x };
    let mut schemes = TOLERANCES.into_iter();
    let next = |schemes: &mut dyn Iterator<Item = (Scheme, f64)>| {
        let flow = schemes.next().map(|(scheme, tolerance)| settings(scheme, tolerance));
        let settings = flow.map(|flow| HybridSettings { flow, ..HybridSettings::default() });
        settings.map(|settings| HybridFlow::<f64>::new(&**system, settings))
    };
    let mut flow = next(&mut schemes).ok_or("no scheme")??;
    for k in 0..=request.count {
        let t = request.at(k);
        let HybridState { mode, x, .. } = &state;
        let values = (0..monitors.len()).map(|m| system.monitor(m, *mode, t, x, &p));
        request.row(t, x.iter().copied().chain(values))?;
        if k == request.count {
            break;
        }
        let before = state.clone();
        let length = request.at(k + 1) - state.time;
        while let Err(error) = flow.advance(&mut state, length, &p, &mut ()) {
            flow = next(&mut schemes).ok_or(error)??;
            state = before.clone();
        }
    }
    Ok(())
}
