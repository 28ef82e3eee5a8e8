//! The time from a change to the complete new diagram.

use super::session::FOLD;
use super::{Program, Session};
use serde_json::{Value, json};

const LORENZ: &str = "Equations(
    states: [(\"x\", \"sigma*(y - x)\"), (\"y\", \"x*(rho - z) - y\"), (\"z\", \"x*y - beta*z\")],
    parameters: [(\"rho\", 0), (\"sigma\", 10), (\"beta\", \"8/3\")],
    initial: [(\"x\", 1)],
)";
const IMPACTS: &str = "HybridEquations(
    modes: [(name: \"free\", states: [(\"x\", \"v\"), (\"v\", \"(force*cos(2*pi*f*t) - c*v - k*x)/m\")])],
    guards: [(name: \"impact\", modes: [\"free\"], function: \"gap - x\", reset: [(\"v\", \"-e*v\")])],
    parameters: [(\"f\", 30), (\"force\", 1.5), (\"m\", 0.2), (\"c\", 2), (\"k\", 2000), (\"gap\", 2e-3), (\"e\", 0.8)],
    period: \"1/f\",
    scales: [(\"x\", 1e-3), (\"v\", 0.1)],
)";

/// The number of changes of each scene.
const CHANGES: usize = 5;

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Moves the first slider of a parameter that is not varied, and returns the times to the first
/// points, to the complete diagram, and of the trace, in milliseconds.
fn change(session: &mut Session, change: usize) -> [f64; 3] {
    let turn = session.text("document.body.dataset.turn");
    let by = (1 + change as i64) * if change.is_multiple_of(2) { 1 } else { -1 };
    session.value(&format!(
        "(() => {{
            const rows = [...document.querySelectorAll('.parameter:not(.varied)')];
            const slider = rows.map(row => row.querySelector('input[type=range]')).find(it => !it.disabled);
            slider.dataset.base ??= slider.value;
            slider.value = Number(slider.dataset.base) + {by};
            slider.dispatchEvent(new Event('input'));
        }})()"
    ));
    session.browser.wait(&format!(
        "document.body.dataset.busy === 'false' && document.body.dataset.turn !== '{turn}'"
    ));
    let times = ["first", "latency", "millis"];
    times.map(|name| {
        session.text(&format!("document.body.dataset.{name}")).parse().unwrap_or(f64::NAN)
    })
}

/// Every change leads to a complete diagram; prints a table of median times.
#[test]
fn latency() {
    let program = Program::start(&[]);
    let Some(mut session) = Session::open(&program) else { return };
    println!("{:<20}{:>14}{:>14}{:>14}", "ms", "first points", "complete", "trace");
    let measure = |session: &mut Session, name: &str| {
        let times: Vec<[f64; 3]> = (0..CHANGES).map(|k| change(session, k)).collect();
        let [first, complete, trace] =
            [0, 1, 2].map(|k| median(times.iter().map(|times| times[k]).collect()));
        assert!(complete.is_finite() && trace.is_finite(), "{name}: {times:?}");
        println!("{name:<20}{first:>14.0}{complete:>14.0}{trace:>14.0}");
    };
    for (name, text) in
        [("fold, typed", FOLD), ("Lorenz, typed", LORENZ), ("impacts, typed", IMPACTS)]
    {
        session.type_equations(text);
        measure(&mut session, name);
    }
    for name in ["mita-type-1", "lure", "plate-clamped"] {
        let program = Program::start(&[name]);
        let Some(mut session) = Session::open(&program) else { return };
        measure(&mut session, name);
    }
}

/// Returns the messages of the response to a call.
fn messages(program: &Program, call: &Value) -> Vec<Value> {
    let response = program.call(call.to_string().as_bytes());
    response.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
}

/// While a control is dragged, the first picture of a scene that is traced slowly already shows whole branches,
/// which were corrected for the new value; without a drag, the first picture shows the beginning of a branch.
#[test]
fn slow_branches_are_corrected_before_they_are_traced() {
    let program = Program::start(&["swift-hohenberg"]);
    let mut setup = messages(&program, &json!({ "open": {} }))[0]["setup"].clone();
    let mut trace = |turn: u32, nu: f64, draft: bool| {
        setup["set"] = json!([["nu", nu.to_string()]]);
        setup["draft"] = json!(draft);
        let call = json!({ "trace": { "page": "p", "turn": turn, "setup": setup } });
        let all = messages(&program, &call);
        assert!(all.iter().any(|message| message.get("done").is_some()), "{all:?}");
        let first = all.iter().find_map(|message| message["partial"]["curves"].as_array());
        first.map_or(0, |curves| {
            curves.iter().map(|it| it["points"].as_array().unwrap().len()).sum()
        })
    };
    let full = trace(1, 1.6, false);
    assert!(full < 100, "{full}");
    // Correction ends after 0.2 s, which a busy processor may spend on other programs: several changes
    // are tried.
    assert!((2..8).any(|turn| trace(turn, 1.6 + 0.005 * f64::from(turn - 1), true) > 100));
}
