//! The attractors at a point of a diagram in two parameters.

use super::session::HOPF;
use super::{Program, Session};
use serde_json::json;

/// Traces the curve of Hopf points `m = w/4` in the plane of `m` and `w`, and shows attractors.
fn plane(program: &Program) -> Option<Session> {
    let mut session = Session::open(program)?;
    session.type_equations(HOPF);
    session.fill("[aria-label='m, upper end of its range']", "1");
    session.fill("[aria-label='m, lower end of its range']", "-1");
    session.choose("branch", "HB");
    session.fill("[aria-label='lower end of the second parameter']", "1");
    session.fill("[aria-label='upper end of the second parameter']", "4");
    session.press("Follow: curve of Hopf points in two parameters");
    session.browser.wait("!document.getElementById('attractors').hidden");
    session.click("document.getElementById('attractors-toggle')");
    searched(&mut session);
    Some(session)
}

fn searched(session: &mut Session) {
    session.browser.wait("document.body.dataset.attractors === 'done'");
}

fn labels(session: &mut Session) -> Vec<String> {
    let labels = session.value(
        "[...document.querySelectorAll('#attractors-list li')].map(item => item.textContent)",
    );
    serde_json::from_value(labels).unwrap()
}

/// The values of the two parameters at the cross.
fn at(session: &mut Session) -> [f64; 2] {
    let text = session.text("document.getElementById('attractors-text').textContent");
    let values = text.split(':').next().unwrap().split(", ");
    let values: Vec<f64> = values
        .map(|part| part.split(" = ").nth(1).unwrap().replace('−', "-").parse().unwrap())
        .collect();
    [values[0], values[1]]
}

/// Drags the cross by some pixels, and returns the labels during the drag.
fn drag(session: &mut Session, by: [f64; 2]) -> Vec<String> {
    let [x, y] = session.place_of("document.querySelector('.cross')");
    session.browser.mouse("mouseMoved", [x, y]);
    session.browser.mouse("mousePressed", [x, y]);
    for step in 1..=20 {
        let share = f64::from(step) / 20.0;
        let place = [x + share * by[0], y + share * by[1]];
        session.browser.call(
            "Input.dispatchMouseEvent",
            json!({ "type": "mouseMoved", "x": place[0], "y": place[1], "button": "left", "buttons": 1 }),
        );
    }
    session.browser.wait("document.body.dataset.attractors === 'quick'");
    let during = labels(session);
    session.browser.mouse("mouseReleased", [x + by[0], y + by[1]]);
    searched(session);
    during
}

/// The normal form of a Hopf point: rest for `m < w/4`, and a cycle of the period `2π/w` for `m > w/4`.
#[test]
fn a_drag_across_a_hopf_curve_changes_the_attractor() {
    let program = Program::start(&[]);
    let Some(mut session) = plane(&program) else { return };
    // The cross begins in the middle of the picture, on the Hopf curve.
    let during = drag(&mut session, [-150.0, 0.0]);
    let [m, w] = at(&mut session);
    assert!(m < w / 4.0 - 0.05, "{m} {w}");
    assert!(during.iter().all(|it| it == "equilibrium" || it == "not settled yet"), "{during:?}");
    assert_eq!(labels(&mut session), ["equilibrium"]);
    session.value("(document.getElementById('attractors').scrollIntoView({ block: 'end' }), 0)");
    session.picture("attractors-rest");
    drag(&mut session, [320.0, 20.0]);
    let [m, w] = at(&mut session);
    assert!(m > w / 4.0 + 0.05, "{m} {w}");
    let found = labels(&mut session);
    let period: f64 = found[0].strip_prefix("period ").unwrap().parse().unwrap();
    // The page shows the parameter with four digits.
    let exact = std::f64::consts::TAU / w;
    assert!((period - exact).abs() < 2e-3 * exact, "{period} and {exact}");
    assert_eq!(found.len(), 1, "{found:?}");
    session.value("(document.getElementById('attractors').scrollIntoView({ block: 'end' }), 0)");
    session.picture("attractors-cycle");
    session.browser.resize(420, 900);
    session.browser.wait("document.documentElement.scrollWidth <= 420");
    session.value("(document.getElementById('attractors').scrollIntoView({ block: 'end' }), 0)");
    session.picture("attractors-narrow");
    println!("first answer: {} ms", session.text("document.body.dataset.dragged"));
}

#[test]
fn the_cross_is_moved_by_the_keyboard_alone() {
    let program = Program::start(&[]);
    let Some(mut session) = plane(&program) else { return };
    session.value("(document.querySelector('.cross').focus(), 0)");
    let before = at(&mut session);
    for _ in 0..10 {
        session.browser.key("ArrowRight");
    }
    session.browser.key("ArrowUp");
    session.browser.wait("document.body.dataset.attractors === 'running' || document.body.dataset.attractors === 'quick'");
    searched(&mut session);
    let after = at(&mut session);
    assert!(after[0] > before[0] && after[1] > before[1], "{before:?} {after:?}");
    let focused = "document.activeElement.className";
    assert_eq!(session.text(focused), "cross");
    session.click("document.getElementById('attractors-toggle')");
    assert_eq!(session.value("document.querySelector('.cross')"), json!(null));
}

/// `x' = m x − x³ + h` has two stable equilibria for small `h` and `m > 0`.
#[test]
fn other_initial_states_find_a_second_attractor() {
    let program = Program::start(&[]);
    let Some(mut session) = Session::open(&program) else { return };
    session.type_equations("x' = h + m*x - x^3\npar h=-1, m=1\ninit x=-1.3\n");
    session.fill("[aria-label='h, upper end of its range']", "1");
    session.choose("branch", "LP");
    session.fill("[aria-label='lower end of the second parameter']", "0.2");
    session.fill("[aria-label='upper end of the second parameter']", "2");
    session.press("Follow: curve of folds in two parameters");
    session.browser.wait("!document.getElementById('attractors').hidden");
    session.click("document.getElementById('attractors-toggle')");
    searched(&mut session);
    // The folds are at h = ±2 (m/3)^1.5; between them, the motion has two attractors.
    drag(&mut session, [-150.0, 0.0]);
    let [h, m] = at(&mut session);
    assert!(h.abs() < 2.0 * (m / 3.0).powf(1.5), "{h} {m}");
    assert_eq!(labels(&mut session), ["equilibrium", "equilibrium"]);
    session.value("(document.getElementById('attractors').scrollIntoView({ block: 'end' }), 0)");
    session.picture("attractors-two");
}

/// A page without a result, and a result without a curve in two parameters.
#[test]
fn calls_without_a_diagram_are_answered() {
    let program = Program::start(&[]);
    let place = json!({ "at": [["m", 0.5], ["w", 2.0]], "from": [], "shown": [null, null], "refined": true });
    let attractors = |turn: u64| {
        let call = json!({ "attractors": { "page": "p", "turn": turn, "place": place } });
        program.call(call.to_string().as_bytes())
    };
    let swept = json!({ "count": 3, "both": true, "at": "nothing" });
    // The number of a page's turn increases with every call.
    let sweep = |turn: u64| {
        let call = json!({ "sweep": { "page": "p", "turn": turn, "sweep": swept } });
        program.call(call.to_string().as_bytes())
    };
    assert!(attractors(1).contains("the page has no result"));
    assert!(sweep(1).contains("the page has no result"));
    let trace =
        json!({ "trace": { "page": "p", "turn": 1, "setup": { "name": "t", "text": HOPF } } });
    assert!(program.call(trace.to_string().as_bytes()).contains("\"done\""));
    let answer = attractors(2);
    assert!(answer.contains("\"end\":true") && answer.contains("no curve"), "{answer}");
    let answer = sweep(2);
    assert!(answer.contains("\"failed\"") && answer.contains("\"end\":true"), "{answer}");
}
