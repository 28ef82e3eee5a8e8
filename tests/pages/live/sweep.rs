//! Sweeps whose points are drawn under the diagram.

use super::session::HOPF;
use super::{Program, Session};
use serde_json::{Value, json};

/// The solution of `x' = r cos t − x` converges to `r cos(t − π/4)/√2`.
const FORCED: &str =
    "Equations(states: [(\"x\", \"r*cos(t) - x\")], parameters: [(\"r\", 1)], period: \"2*pi\")";

/// The messages of a call whose response is a stream of lines.
fn messages(response: &str) -> Vec<Value> {
    response.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
}

/// Types the equations, and varies `r` from 1 to 3 with `max_x` on the vertical axis.
fn forced(program: &Program) -> Option<Session> {
    let mut session = Session::open(program)?;
    session.type_equations(FORCED);
    session.fill("[aria-label='r, lower end of its range']", "1");
    session.fill("[aria-label='r, upper end of its range']", "3");
    vertical(&mut session, "max_x");
    Some(session)
}

fn vertical(session: &mut Session, column: &str) {
    session.value(&format!(
        "(select => {{ select.value = '{column}'; select.dispatchEvent(new Event('change')); return 0; }})(document.getElementById('axis-y'))"
    ));
    session.browser.wait(&format!(
        "document.querySelector('#panels svg').getAttribute('aria-label').startsWith('{column} ')"
    ));
}

fn sweep(session: &mut Session) {
    session.browser.wait("!document.getElementById('sweep-start').disabled");
    session.click("document.getElementById('sweep-start')");
    session.browser.wait("document.body.dataset.sweep === 'done'");
}

/// The number of points that the page draws.
fn specks(session: &mut Session) -> f64 {
    let count = "[...document.querySelectorAll('#panels .specks')].reduce((sum, it) => sum + Number(it.dataset.count), 0)";
    session.value(count).as_f64().unwrap()
}

fn status(session: &mut Session) -> String {
    session.text("document.getElementById('sweep-text').textContent")
}

#[test]
fn each_speck_has_the_exact_amplitude() {
    let program = Program::start(&[]);
    let setup = json!({
        "name": "t", "text": FORCED, "along": [{ "name": "r", "low": 1.0, "high": 3.0 }], "y": "max_x",
    });
    let call = json!({ "trace": { "page": "p", "turn": 1, "setup": setup } }).to_string();
    assert!(program.call(call.as_bytes()).contains("\"done\""));
    let swept = json!({ "count": 11, "both": true, "at": null });
    let call = json!({ "sweep": { "page": "p", "turn": 1, "sweep": swept } }).to_string();
    let all = messages(&program.call(call.as_bytes()));
    let curves = all.iter().flat_map(|it| it["specks"]["curves"].as_array().into_iter().flatten());
    let mut counts = [0; 2];
    for curve in curves {
        counts[usize::from(curve["name"] == "down")] += curve["points"].as_array().unwrap().len();
        for point in curve["points"].as_array().unwrap() {
            let [r, amplitude] = [0, 1].map(|k| point[k].as_f64().unwrap());
            assert!((amplitude - r / 2.0_f64.sqrt()).abs() < 1e-7 * r, "{amplitude} at r = {r}");
        }
    }
    assert_eq!(counts, [11, 11]);
    let end = all.iter().find(|it| !it["swept"].is_null()).unwrap();
    assert_eq!((&end["swept"]["done"], &end["swept"]["failed"]), (&json!(22), &json!(0)));
}

#[test]
fn specks_lie_on_the_branch_until_an_input_changes() {
    let program = Program::start(&[]);
    let Some(mut session) = forced(&program) else { return };
    sweep(&mut session);
    assert_eq!(status(&mut session), "202 runs");
    assert_eq!(specks(&mut session), 202.0);
    session.picture("sweep");
    // The branch is a straight line through the origin.
    let distance = "(() => {
        const numbers = path => path.getAttribute('d').split(/[MLh]/).filter(Boolean).map(part => part.trim().split(' ').map(Number)).filter(part => part.length === 2);
        const [branch] = [...document.querySelectorAll('#panels svg g path[stroke-width]')].map(numbers).filter(it => it.length > 2);
        const [[a, b], [c, d]] = [branch[0], branch.at(-1)];
        const away = ([x, y]) => Math.abs((c - a) * (y - b) - (d - b) * (x - a)) / Math.hypot(c - a, d - b);
        return Math.max(...[...document.querySelectorAll('#panels .specks')].flatMap(numbers).map(away));
    })()";
    assert!(session.value(distance).as_f64().unwrap() <= 1.0);
    session.browser.resize(420, 900);
    session.browser.wait("document.documentElement.scrollWidth <= 420");
    session.value("(document.getElementById('sweep').scrollIntoView({ block: 'end' }), 0)");
    session.picture("sweep-narrow");
    session.browser.resize(1200, 900);
    // A sweep records the columns on the axes of the diagram.
    vertical(&mut session, "x");
    assert_eq!(specks(&mut session), 0.0);
    sweep(&mut session);
    // The page draws the largest and the smallest value, as in the branch.
    assert_eq!(specks(&mut session), 404.0);
    session.fill("[aria-label='r, upper end of its range']", "2");
    assert_eq!(specks(&mut session), 0.0);
    // With the checkbox, a change repeats the sweep.
    session.click("document.getElementById('sweep-repeat')");
    sweep(&mut session);
    session.fill("[aria-label='r, upper end of its range']", "2.5");
    session.browser.wait("document.body.dataset.sweep === 'done'");
    assert_eq!(specks(&mut session), 404.0);
}

#[test]
fn a_sweep_stops_and_keeps_its_finished_runs() {
    let program = Program::start(&[]);
    let Some(mut session) = forced(&program) else { return };
    session.fill("#sweep-count", "9000");
    session.click("document.getElementById('sweep-start')");
    session
        .browser
        .wait("/^[1-9]\\d* of 18000 runs/.test(document.getElementById('sweep-text').textContent)");
    session.click("document.getElementById('sweep-stop')");
    session.browser.wait("document.body.dataset.sweep === 'done'");
    let text = status(&mut session);
    assert!(text.starts_with("stopped after ") && text.ends_with(" of 18000 runs"), "{text}");
    let kept = specks(&mut session);
    assert!(kept > 0.0 && kept < 18000.0, "{kept}");
    // A change of an input also stops a sweep.
    session.click("document.getElementById('sweep-start')");
    session.browser.wait("document.body.dataset.sweep === 'running'");
    session.fill("[aria-label='r, upper end of its range']", "2");
    assert_eq!(session.text("document.body.dataset.sweep"), "none");
    assert_eq!(specks(&mut session), 0.0);
    sweep_by_keys(&mut session);
}

/// Without the mouse.
fn sweep_by_keys(session: &mut Session) {
    session.fill("#sweep-count", "5");
    session.browser.wait("!document.getElementById('sweep-start').disabled");
    session.value("(document.getElementById('sweep-start').focus(), 0)");
    for event in ["keyDown", "keyUp"] {
        let enter = json!({ "type": event, "key": "Enter", "code": "Enter", "windowsVirtualKeyCode": 13, "text": "\r" });
        session.browser.call("Input.dispatchKeyEvent", enter);
    }
    session.browser.wait("document.body.dataset.sweep === 'done'");
    assert_eq!(specks(session), 10.0);
}

#[test]
fn the_page_says_why_no_sweep_is_possible() {
    let program = Program::start(&[]);
    let Some(mut session) = Session::open(&program) else { return };
    session.type_equations(HOPF);
    assert_eq!(session.value("document.querySelector('#sweep form').hidden"), true);
    let why = session.text("document.querySelector('#sweep p').textContent");
    assert!(why.contains("neither a forcing nor an event"), "{why}");
    // The vertical axis shows a column that sweeps do not record.
    session.type_equations(FORCED);
    vertical(&mut session, "period");
    sweep(&mut session);
    let text = status(&mut session);
    assert!(text.contains("no column `period`"), "{text}");
}
