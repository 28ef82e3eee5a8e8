//! Many motions at once are what each of them is alone.

use std::f64::consts::PI;
use std::ops::ControlFlow;
use tangency::core::hybrid::{
    Event, Fleet, FleetObserver, HybridError, HybridFlow, HybridSettings, HybridState,
    HybridStatistics, Member,
};
use tangency::core::ode::{Scheme, Settings};
use tangency::problems::mita::Actuator;

/// Follows members for as many periods, and counts their events.
struct Periods {
    most: usize,
    done: Vec<usize>,
    events: Vec<usize>,
}

impl FleetObserver<f64> for Periods {
    fn event(&mut self, member: usize, _event: &Event<f64>) {
        self.events[member] += 1;
    }

    fn arrived(
        &mut self,
        member: usize,
        state: &mut HybridState<f64>,
        statistics: &HybridStatistics,
    ) -> ControlFlow<()> {
        self.done[member] += 1;
        assert!(statistics.flow.accepted > 7 && statistics.flow.evaluations > 80);
        state.time = 0.0;
        if self.done[member] < self.most {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    }
}

fn members(count: usize) -> Vec<Member<f64>> {
    let member = |k: usize| {
        let mut p = Actuator::DEFAULTS.to_vec();
        // From motion without impacts, by way of chatter, to chaos.
        p[0] = 0.2 + 0.6 * k as f64 / count as f64;
        let x = vec![0.1 - 0.2 * k as f64 / count as f64, 0.05];
        Member { state: HybridState { mode: Actuator::STICK, time: 0.0, x }, p }
    };
    (0..count).map(member).collect()
}

fn followed(
    members: &mut [Member<f64>],
    settings: HybridSettings,
    most: usize,
) -> (Vec<Result<(), HybridError>>, Vec<usize>) {
    let count = members.len();
    let mut periods = Periods { most, done: vec![0; count], events: vec![0; count] };
    let mut fleet = Fleet::new(&Actuator, settings).expect("settings");
    let results = fleet.advance(members, |member| PI / member.p[1], &mut periods);
    (results, periods.events)
}

fn settings(scheme: Scheme) -> HybridSettings {
    HybridSettings { flow: Settings::new(scheme, 1e-11), ..HybridSettings::default() }
}

#[test]
fn members_of_a_fleet_move_as_they_do_alone() {
    for scheme in [Scheme::DormandPrince8, Scheme::DormandPrince5, Scheme::Rodas5P] {
        let mut fleet = members(if scheme == Scheme::Rodas5P { 10 } else { 150 });
        let starts = fleet.clone();
        let (results, events) = followed(&mut fleet, settings(scheme), 3);
        let mut flow = HybridFlow::new(&Actuator, settings(scheme)).expect("settings");
        for (k, Member { state, p }) in starts.into_iter().enumerate() {
            let (mut state, mut count) = (state, 0);
            for _ in 0..3 {
                let statistics =
                    flow.advance(&mut state, PI / p[1], &p, &mut ()).expect("a motion");
                count += statistics.events;
                state.time = 0.0;
            }
            assert!(results[k].is_ok() && events[k] == count && fleet[k].state.mode == state.mode);
            for (a, b) in state.x.iter().zip(&fleet[k].state.x) {
                assert!((a - b).abs() < 1e-9, "{scheme:?}, V = {}: {state:?} {:?}", p[0], fleet[k]);
            }
        }
    }
}

#[test]
fn a_member_of_a_fleet_does_not_see_the_others() {
    let (mut all, mut few) = (members(100), members(100).split_off(63));
    few.reverse();
    followed(&mut all, settings(Scheme::DormandPrince8), 4);
    followed(&mut few, settings(Scheme::DormandPrince8), 4);
    few.reverse();
    // To the last bit.
    assert_eq!(all[63..], few);
}

#[test]
fn errors_of_members_are_those_of_their_motions() {
    let mut fleet = members(9);
    fleet[3].p[2] = 1.5;
    fleet[5].state.x[0] = 0.7;
    fleet[7].state.x.push(0.0);
    let flow = Settings { max_steps: 5, ..Settings::default() };
    let few_steps = HybridSettings { flow, ..HybridSettings::default() };
    for settings in [HybridSettings::default(), few_steps] {
        let starts = fleet.clone();
        let (results, _) = followed(&mut fleet.clone(), settings.clone(), 1);
        let mut motion = HybridFlow::new(&Actuator, settings).expect("settings");
        for (Member { mut state, p }, result) in starts.into_iter().zip(results) {
            let alone = motion.advance(&mut state, PI / p[1], &p, &mut ());
            assert_eq!(
                alone.map(|_| ()).map_err(|e| e.to_string()),
                result.map_err(|e| e.to_string())
            );
        }
    }
}
