//! Promise: branches of hybrid orbits end where they graze, in one G, and go on from there.

mod common;
mod hybrid;

use common::close;
use hybrid::impact_oscillator::{ClosedForm, resonance};
use hybrid::orbits::{Start, by_both, found};
use hybrid::reference::Reference;
use std::f64::consts::{PI, TAU};
use tangency::core::continuation::{Continuation, Kind, Branch};

const DIGITS: f64 = 1e-10;

fn nonimpacting(form: &ClosedForm, part: f64) -> [Start; 2] {
    let amplitude = part * form.grazing();
    let p = [amplitude, form.frequency, form.restitution, form.damping, form.clearance];
    let state = form.motion(amplitude, 0.0);
    by_both(Reference::ImpactOscillator, "flight", &[&state], &[], &p)
}

fn show(branch: &Branch) {
    println!("{} {:?} {} points, itinerary {}, unstable {:?}", branch.name, branch.ends, branch.points.len(), branch.itinerary, branch.points.iter().map(|p| p.unstable).collect::<Vec<_>>().len());
    for s in &branch.special { println!("   {} {} {:?} {:?} {:e}", s.kind, s.event, s.parameters, s.monitors, s.error); }
}

#[test]
fn grazes() {
    for frequency in [1.0, 1.2, 2.2] {
        let form = ClosedForm::usual(frequency);
        println!("grazing {} fold {} pd {}", form.grazing(), form.fold_amplitude(), form.amplitude(form.doubling()));
        for mut start in nonimpacting(&form, 0.5) {
            let grazing = form.grazing();
            let range = [0.1 * grazing, 2.0 * grazing];
            let branch = start.along("amplitude", range).trace().unwrap();
            show(&branch);
            let label = branch.of_kind(Kind::G).next().unwrap().label;
            let impacting = Continuation::of(start.system.as_mut())
                .restart(&branch, label)
                .switch()
                .along("amplitude", range[0]..=range[1])
                .trace();
            match impacting { Ok(b) => show(&b), Err(e) => println!("{e}") }
        }
    }
}

#[test]
fn curves() {
    let form = ClosedForm::usual(1.2);
    for switch in [false, true] {
    for mut start in nonimpacting(&form, 0.5) {
        let branch = start.along("amplitude", [0.1, 1.0]).trace().unwrap();
        let label = branch.of_kind(Kind::G).next().unwrap().label;
        let mut run = Continuation::of(start.system.as_mut()).restart(&branch, label);
        if switch { run = run.switch(); }
        let curve = run
            .hold(Kind::G)
            .along("amplitude", 0.0..=10.0)
            .along("frequency", 0.45..=2.5)
            .trace();
        match curve { Ok(b) => {
            show(&b);
            let worst = b.points.iter().map(|p| { let f = ClosedForm::usual(p.parameters[1]); (p.parameters[0] - f.grazing()).abs() }).fold(0.0, f64::max);
            println!("worst {worst:e}");
        }, Err(e) => println!("{e}") }
    }
    }
    println!("{:?}", (1..5).map(|n| resonance(n, 0.1)).collect::<Vec<_>>());
}
