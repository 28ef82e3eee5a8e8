//! The phase plane: simulations, nullclines, and ranges over the diagram.

use super::{Program, Session};
use serde_json::{Value, json};

/// The stable focus of `x'' + 0.5 x' + x = a` is at `x = a`.
const FOCUS: &str = "x' = y\ny' = a - x - 0.5*y\npar a=0\n";
/// The FitzHugh–Nagumo equations.
const FHN: &str = "v' = v - v^3/3 - w + I\nw' = eps*(v + a - b*w)\npar I=0, eps=0.08, a=0.7, b=0.8\ninit v=-1.2, w=-0.62\n";
/// An oscillator under the force `A cos 2πt`.
const FORCED: &str = "Equations(
    states: [(\"x\", \"v\"), (\"v\", \"A*cos(2*pi*t) - k*x - c*v\")],
    parameters: [(\"A\", 1), (\"c\", 1), (\"k\", 4)],
    period: \"1\",
)\n";

const PLANE: &str = "document.querySelector('#details .plane')";

/// Waits until a number of simulations is shown.
fn wait_for(session: &mut Session, count: usize) {
    session.browser.wait(&format!(
        "{PLANE}?.dataset.simulations === '{count}' && {PLANE}.dataset.busy === 'false'"
    ));
}

/// The final states of the last simulation.
fn end(session: &mut Session) -> Value {
    serde_json::from_str(&session.text(&format!("{PLANE}.dataset.end"))).unwrap()
}

/// Clicks in the phase plane at a place in fractions of the plot.
fn click_plane(session: &mut Session, [x, y]: [f64; 2]) {
    let frame = format!("{PLANE}.querySelector('.plot .frame')");
    let [middle, height] = session.place_of(&frame);
    let sizes = format!("(box => [box.width, box.height])({frame}.getBoundingClientRect())");
    let [width, tall]: [f64; 2] = serde_json::from_value(session.value(&sizes)).unwrap();
    let place = [middle + (x - 0.5) * width, height - (y - 0.5) * tall];
    for event in ["mouseMoved", "mousePressed", "mouseReleased"] {
        session.browser.mouse(event, place);
    }
}

fn press_button(session: &mut Session, text: &str) {
    session.click(&format!(
        "[...document.querySelectorAll('.plane button')].find(it => it.textContent === {text:?})"
    ));
}

fn number(session: &mut Session, label: &str) -> f64 {
    session
        .text(&format!("document.querySelector('[aria-label=\"{label}\"]').value"))
        .parse()
        .unwrap()
}

/// The labels of a plot do not cover each other.
fn assert_labels_are_apart(session: &mut Session) {
    let overlapping = "(() => {
        const all = [...document.querySelectorAll('#details .plot')].flatMap(plot => {
            const boxes = [...plot.querySelectorAll('text')].map(it => [it.textContent, it.getBoundingClientRect()]);
            return boxes.flatMap(([a, p], k) => boxes.slice(k + 1).filter(([, q]) =>
                p.left < q.right - 1 && q.left < p.right - 1 && p.top < q.bottom - 1 && q.top < p.bottom - 1
            ).map(([b]) => `${a} and ${b}`));
        });
        return all.join('; ');
    })()";
    assert_eq!(session.text(overlapping), "");
}

#[test]
fn a_click_near_a_focus_starts_a_simulation_to_the_focus() {
    let program = Program::start(&[]);
    let Some(mut session) = Session::open(&program) else { return };
    session.type_equations(FOCUS);
    session.fill("[aria-label='a, upper end of its range']", "2");
    session.choose("branch", "EP");
    session.fill("[aria-label='duration of the simulation']", "80");
    click_plane(&mut session, [0.8, 0.7]);
    wait_for(&mut session, 1);
    let a = session.at_points("branch", "EP", "a")[0];
    let [x, y] = ["initial x", "initial y"].map(|label| number(&mut session, label));
    assert!(x > a && y > 0.0, "{x} {y}");
    let at = end(&mut session);
    let exact = focus_at([x - a, y], 80.0);
    // The motion decays as exp(−t/4) towards (a, 0).
    for ((name, exact), rest) in ["x", "y"].iter().zip(exact).zip([a, 0.0]) {
        let value = at[name].as_f64().unwrap() - rest;
        assert!((value - exact).abs() < 1e-8 && value.abs() < 1e-7, "{name}: {value} {exact}");
    }
    // A second simulation is shown beside the first one, and a double click is none.
    click_plane(&mut session, [0.2, 0.4]);
    wait_for(&mut session, 2);
    let drawn = "new Set([...document.querySelectorAll('.plane > .plot path')].map(it => it.dataset.name).filter(it => it?.startsWith('simulation'))).size";
    assert_eq!(session.value(drawn), json!(2));
    session.picture("plane");
    assert_labels_are_apart(&mut session);
    assert_eq!(session.value("document.querySelectorAll('#panels .bar').length"), json!(2));
    press_button(&mut session, "Clear");
    wait_for(&mut session, 0);
    assert_eq!(session.value("document.querySelectorAll('#panels .bar').length"), json!(0));
}

/// The solution of `x'' + x'/2 + x = 0`.
fn focus_at([x, y]: [f64; 2], t: f64) -> [f64; 2] {
    let (decay, omega) = (0.25, (1.0_f64 - 0.0625).sqrt());
    let second = (y + decay * x) / omega;
    let [cos, sin] = [(omega * t).cos(), (omega * t).sin()];
    let shrink = (-decay * t).exp();
    let value = shrink * (x * cos + second * sin);
    let slope = shrink * omega * (second * cos - x * sin) - decay * value;
    [value, slope]
}

#[test]
fn nullclines_pass_through_the_equilibrium_and_the_cubic() {
    let program = Program::start(&[]);
    let Some(mut session) = Session::open(&program) else { return };
    session.type_equations(FHN);
    session.choose("branch", "HB");
    session.browser.wait(&format!("{PLANE}.dataset.field !== undefined"));
    let drawn =
        "new Set([...document.querySelectorAll('.plane > .plot path')].map(it => it.dataset.name))";
    let has = |name: &str| {
        format!("{drawn}.has('{name}') && document.querySelector('.plane .arrows') !== null")
    };
    assert_eq!(session.value(&has("v′ = 0")), json!(true));
    assert_eq!(session.value(&has("w′ = 0")), json!(true));
    session.picture("nullclines");
    assert_labels_are_apart(&mut session);
    // The checkbox hides them.
    session.click("document.getElementById('nullclines')");
    session.browser.wait("document.querySelector('.plane .arrows') === null");
    session.click("document.getElementById('nullclines')");
    session.browser.wait("document.querySelector('.plane .arrows') !== null");
    // Another range has its own nullclines.
    let before = session.text(&format!("{PLANE}.dataset.field"));
    press_button(&mut session, "wider");
    session.browser.wait(&format!("{PLANE}.dataset.field !== {before:?}"));
    session.browser.resize(420, 900);
    session.browser.wait("document.documentElement.scrollWidth <= 420");
    session.place_of(PLANE);
    session.picture("plane-narrow");
    assert_labels_are_apart(&mut session);
}

/// The last line of a response that has the name.
fn message(response: &str, name: &str) -> Value {
    let lines = response.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let mut found = lines.filter(|line| !line[name].is_null());
    found.next().unwrap_or_else(|| panic!("no `{name}` in {response}"))[name].clone()
}

fn call(program: &Program, call: Value) -> String {
    program.call(call.to_string().as_bytes())
}

fn traced(program: &Program, text: &str) {
    let setup = json!({ "name": "t", "text": text });
    let response = call(program, json!({ "trace": { "page": "p", "turn": 1, "setup": setup } }));
    message(&response, "done");
}

#[test]
fn the_server_computes_nullclines_to_rounding_error() {
    let program = Program::start(&[]);
    traced(&program, FHN);
    let at = json!({ "branch": 0, "point": 0 });
    let point = call(&program, json!({ "point": { "page": "p", "at": at } }));
    let point: Value = serde_json::from_str(point.lines().last().unwrap()).unwrap();
    let states = &point["details"]["plane"]["states"];
    let equilibrium = [0, 1].map(|k| states[k]["value"].as_f64().unwrap());
    let asked = json!({ "page": "p", "at": at, "states": ["v", "w"], "ranges": [[-2.5, 2.5], [-2.0, 2.0]] });
    let field = message(&call(&program, json!({ "field": asked })), "field");
    let lines: [Vec<Vec<[f64; 2]>>; 2] =
        serde_json::from_value(field["nullclines"].clone()).unwrap();
    let input = rate(equilibrium);
    let nearest = |lines: &[Vec<[f64; 2]>]| {
        let distances = lines.iter().flatten();
        let all = distances.map(|[v, w]| (v - equilibrium[0]).hypot(w - equilibrium[1]));
        all.fold(f64::INFINITY, f64::min)
    };
    assert!(lines[0].iter().flatten().count() > 200 && lines[1].len() == 1);
    for [v, w] in lines[0].iter().flatten() {
        assert!((v - v.powi(3) / 3.0 + input - w).abs() < 1e-10, "{v} {w}");
    }
    for [v, w] in lines[1].iter().flatten() {
        assert!((v + 0.7 - 0.8 * w).abs() < 1e-10, "{v} {w}");
    }
    // Neighbouring points of a line are less than a cell apart.
    assert!(lines.iter().all(|lines| nearest(lines) < 5.0 / 120.0));
    let arrows: Vec<[[f64; 2]; 2]> = serde_json::from_value(field["arrows"].clone()).unwrap();
    assert!(arrows.len() > 200);
    for [[v, w], [u, up]] in arrows {
        let rates = [(v - v.powi(3) / 3.0 - w + input) / 5.0, 0.08 * (v + 0.7 - 0.8 * w) / 4.0];
        let length = rates[0].hypot(rates[1]);
        assert!((rates[0] / length - u).abs() < 1e-9 && (rates[1] / length - up).abs() < 1e-9);
    }
}

/// The parameter I for which the states are an equilibrium.
fn rate([v, w]: [f64; 2]) -> f64 {
    w - v + v.powi(3) / 3.0
}

#[test]
fn the_range_over_the_diagram_has_the_amplitude_of_a_forced_oscillator() {
    let program = Program::start(&[]);
    let Some(mut session) = Session::open(&program) else { return };
    session.type_equations(FORCED);
    session.fill("[aria-label='A, lower end of its range']", "0.5");
    // At the first end of the branch the motion is x = Re(A exp(2πit)/(4 − 4π² + 2πi)).
    session.choose("branch", "EP");
    let a = session.at_points("branch", "EP", "A")[0];
    let amplitude = |a: f64| {
        let omega = std::f64::consts::TAU;
        a / (4.0 - omega * omega).hypot(omega)
    };
    press_button(&mut session, "Simulate");
    wait_for(&mut session, 1);
    let bar = "document.querySelector('#panels .bar').dataset";
    let [at, low, high] = ["at", "low", "high"]
        .map(|name| session.text(&format!("{bar}.{name}")).parse::<f64>().unwrap());
    assert!((at - a).abs() < 1e-9, "{at} {a}");
    let exact = amplitude(at);
    // The samples lie beside the extremes by less than a fraction of a step.
    assert!(
        (high - exact).abs() < 1e-3 * exact && (low + exact).abs() < 1e-3 * exact,
        "{low} {high} {exact}"
    );
    let title = session.text("document.querySelector('#panels .bar title').textContent");
    assert!(title.starts_with("simulation 1: x from "), "{title}");
    session.value("(document.getElementById('panels').scrollIntoView(), 0)");
    session.picture("range");
    session.place_of(PLANE);
    session.picture("orbit-plane");
    assert_labels_are_apart(&mut session);
    // Other axes have their own range; an axis without a state has none.
    let choose = |session: &mut Session, name: &str| {
        session.value(&format!(
            "(it => {{ it.value = {name:?}; it.dispatchEvent(new Event('change')); return 0; }})(document.getElementById('axis-y'))"
        ));
    };
    choose(&mut session, "max_v");
    session
        .browser
        .wait("document.querySelector('#panels .bar title')?.textContent.includes(': v from')");
    choose(&mut session, "period");
    session.browser.wait("document.querySelector('#panels .bar') === null");
}

#[test]
fn the_keyboard_alone_simulates() {
    let program = Program::start(&[]);
    let Some(mut session) = Session::open(&program) else { return };
    session.type_equations(FOCUS);
    session.choose("branch", "EP");
    let press = |session: &mut Session, key: &str, code: u32, text: Option<&str>| {
        for event in ["keyDown", "keyUp"] {
            let mut parameters =
                json!({ "type": event, "key": key, "code": key, "windowsVirtualKeyCode": code });
            if let Some(text) = text.filter(|_| event == "keyDown") {
                parameters["text"] = json!(text);
            }
            session.browser.call("Input.dispatchKeyEvent", parameters);
        }
    };
    session.value("(document.getElementById('details').focus(), 0)");
    let is_at = "document.activeElement.getAttribute('aria-label') === 'initial x'";
    let steps = (0..40).take_while(|_| {
        press(&mut session, "Tab", 9, None);
        session.value(is_at) != json!(true)
    });
    assert!(steps.count() < 40, "the initial state is not reached");
    session.value("(document.activeElement.select(), 0)");
    session.browser.call("Input.insertText", json!({ "text": "0.5" }));
    press(&mut session, "Enter", 13, Some("\r"));
    wait_for(&mut session, 1);
    let said = session.text("document.querySelector('.plane .outcome').textContent");
    assert!(said.starts_with("Simulation 1 ends at t = "), "{said}");
    // A text is no initial state.
    session.browser.call("Input.insertText", json!({ "text": "fast" }));
    press(&mut session, "Enter", 13, Some("\r"));
    session.browser.wait("document.querySelector('.plane .outcome.wrong') !== null");
    assert_eq!(session.text("document.activeElement.getAttribute('aria-invalid')"), "true");
    wait_for(&mut session, 1);
}

/// The solution of `x' = x²` from 1 ends at the time 1.
#[test]
fn a_motion_that_blows_up_is_reported() {
    let program = Program::start(&[]);
    let Some(mut session) = Session::open(&program) else { return };
    session.type_equations("x' = x^2 + a\ny' = -y\npar a=-1\ninit x=-1\n");
    session.fill("[aria-label='a, lower end of its range']", "-2");
    session.fill("[aria-label='a, upper end of its range']", "-1");
    session.choose("branch", "EP");
    session.fill("[aria-label='initial x']", "3");
    press_button(&mut session, "Simulate");
    session.browser.wait("document.querySelector('.plane .outcome.wrong') !== null");
    let said = session.text("document.querySelector('.plane .outcome').textContent");
    assert!(said.starts_with("the solution grows without bound"), "{said}");
    session.picture("blow-up");
    wait_for(&mut session, 0);
    // The page works as before.
    session.fill("[aria-label='initial x']", "-3");
    press_button(&mut session, "Simulate");
    wait_for(&mut session, 1);
    session.fill("#parameter-a", "-1.5");
    assert_eq!(session.value("document.querySelectorAll('#panels .bar').length"), json!(0));
}

/// In the Lorenz equations each non-trivial equilibrium has x = y and z = ρ − 1.
#[test]
fn other_states_can_be_on_the_axes() {
    let program = Program::start(&["lorenz"]);
    let Some(mut session) = Session::open(&program) else { return };
    let rows = session.rows();
    let hopf = rows.iter().find(|row| row[2] == "HB").expect("a Hopf point");
    session.choose(&hopf[0].clone(), "HB");
    session.value(
        "(it => { it.value = 'z'; it.dispatchEvent(new Event('change')); return 0; })(document.getElementById('plane-horizontal'))",
    );
    assert_eq!(session.text("document.activeElement.id"), "plane-horizontal");
    let before = ["initial x", "initial y", "initial z"].map(|label| number(&mut session, label));
    assert!((before[0] - before[1]).abs() < 1e-8);
    session.fill("[aria-label='duration of the simulation']", "5");
    click_plane(&mut session, [0.7, 0.6]);
    wait_for(&mut session, 1);
    // The plane shows z and y; x keeps the value of the point.
    let after = ["initial x", "initial y", "initial z"].map(|label| number(&mut session, label));
    assert!(after[0] == before[0] && after[1] != before[1] && after[2] > before[2], "{after:?}");
    let labels = "document.querySelector('.plane > .plot svg').getAttribute('aria-label')";
    assert_eq!(session.text(labels), "y over z");
    session.place_of(PLANE);
    session.picture("three-states");
    assert_labels_are_apart(&mut session);
    session.browser.resize(420, 900);
    session.browser.wait("document.documentElement.scrollWidth <= 420");
    session.place_of("document.querySelector('.plane .start')");
    session.picture("three-states-narrow");
    assert_labels_are_apart(&mut session);
}

/// A mass between impacts starts in flight, from the clicked states.
#[test]
fn an_orbit_with_impacts_can_be_left_by_a_click() {
    let program = Program::start(&["impact-oscillator"]);
    let Some(mut session) = Session::open(&program) else { return };
    let rows = session.rows();
    let grazing = rows.iter().find(|row| row[2] == "G").expect("a grazing");
    session.choose(&grazing[0].clone(), "G");
    click_plane(&mut session, [0.4, 0.5]);
    wait_for(&mut session, 1);
    session.place_of(PLANE);
    session.picture("impacts");
    let x = number(&mut session, "initial displacement");
    // The impacts are at the clearance of 1.
    assert!(x.abs() < 1.0 && x != 0.0, "{x}");
    assert_labels_are_apart(&mut session);
}

#[test]
fn one_state_has_a_history_without_a_plane() {
    let program = Program::start(&[]);
    let Some(mut session) = Session::open(&program) else { return };
    session.choose("branch", "LP");
    assert_eq!(session.value("document.querySelector('.plane > .plot')"), json!(null));
    session.fill("[aria-label='initial x']", "2");
    press_button(&mut session, "Simulate");
    wait_for(&mut session, 1);
    session.browser.wait("document.querySelectorAll('.plane .course svg path').length > 0");
    session.picture("one-state");
}

/// Requests that the page would never send.
#[test]
fn unsuitable_simulations_are_refused() {
    let program = Program::start(&[]);
    let at = json!({ "branch": 0, "point": 0 });
    let simulate = |at: &Value, state: Value, duration: f64| {
        let asked =
            json!({ "page": "p", "number": 1, "at": at, "state": state, "duration": duration });
        call(&program, json!({ "simulate": asked }))
    };
    let failed =
        |response: &str| message(response, "failed")["message"].as_str().unwrap().to_string();
    assert!(failed(&simulate(&at, json!([]), 1.0)).contains("no result"));
    traced(&program, FOCUS);
    let state = json!([["x", 1.0], ["y", 0.0]]);
    message(&simulate(&at, state.clone(), 1.0), "simulated");
    assert!(failed(&simulate(&at, json!([["z", 1.0]]), 1.0)).contains("`z`"));
    for duration in [-1.0, 0.0] {
        assert!(failed(&simulate(&at, state.clone(), duration)).contains("duration"));
    }
    for point in [i64::MIN, -99, 1 << 40] {
        let at = json!({ "branch": 0, "point": point });
        assert!(failed(&simulate(&at, state.clone(), 1.0)).contains("not known"), "{point}");
    }
    let field = |states: [&str; 2], ranges: Value| {
        let asked = json!({ "page": "p", "at": at, "states": states, "ranges": ranges });
        call(&program, json!({ "field": asked }))
    };
    failed(&field(["x", "x"], json!([[0, 1], [0, 1]])));
    failed(&field(["x", "z"], json!([[0, 1], [0, 1]])));
    failed(&field(["x", "y"], json!([[1, 0], [0, 1]])));
    failed(&field(["x", "y"], json!([[-1e308, 1e308], [0, 1]])));
    message(&field(["x", "y"], json!([[0, 1], [0, 1]])), "field");
}
