//! Changes of parameters, settings and equations.

use super::session::FOLD;
use super::{Program, Session};
use serde_json::json;

/// Drags the slider of a parameter by some pixels.
fn drag(session: &mut Session, name: &str, by: f64) {
    let slider = format!("document.querySelector('[aria-label=\"{name}, slider\"]')");
    let share = format!("{slider}.valueAsNumber / {slider}.max");
    let [x, y] = session.place_of(&slider);
    let width = session.value(&format!("{slider}.getBoundingClientRect().width")).as_f64().unwrap();
    let from = x + (session.value(&share).as_f64().unwrap() - 0.5) * (width - 16.0);
    session.browser.mouse("mouseMoved", [from, y]);
    session.browser.mouse("mousePressed", [from, y]);
    for step in 1..=10 {
        let at = [from + by * f64::from(step) / 10.0, y];
        session.browser.call(
            "Input.dispatchMouseEvent",
            json!({ "type": "mouseMoved", "x": at[0], "y": at[1], "button": "left", "buttons": 1 }),
        );
    }
    session.browser.mouse("mouseReleased", [from + by, y]);
    session.settle();
}

#[test]
fn the_fold_follows_a_slider_to_its_exact_value() {
    let program = Program::start(&[]);
    let Some(mut session) = Session::open(&program) else { return };
    session.type_equations(FOLD);
    let [before] = session.at_points("branch", "LP", "load")[..] else { panic!("one fold") };
    assert!((before - 1.0 / 4.0).abs() < 1e-9, "{before}");
    session.picture("fold");
    drag(&mut session, "k", 60.0);
    let k: f64 = session.text("document.getElementById('parameter-k').value").parse().unwrap();
    assert!(k > 1.1, "the slider has moved to {k}");
    let [after] = session.at_points("branch", "LP", "load")[..] else { panic!("one fold") };
    assert!((after - k / 4.0).abs() < 1e-9, "{after} at k = {k}");
    // The mark in the picture has moved, too.
    assert_eq!(session.value("document.querySelectorAll('#panels svg [data-label=\"LP\"], #panels svg [data-label^=\"LP\"]').length"), 1);
}

#[test]
fn equations_are_edited_and_errors_are_at_their_place() {
    let program = Program::start(&[]);
    let Some(mut session) = Session::open(&program) else { return };
    session.type_equations("x' = a - 3*x^2\npar a=1\ninit x=0.5\n");
    session.fill("[aria-label='a, lower end of its range']", "-1");
    let [fold] = session.at_points("branch", "LP", "a")[..] else { panic!("one fold") };
    assert!(fold.abs() < 1e-9);
    // The unknown name is marked in the text, and the picture stays.
    session.type_equations("x' = a - 3*x^2 + bb*x\npar a=1\ninit x=0.5\n");
    assert_eq!(session.text("document.querySelector('.editor mark').textContent"), "bb");
    let message = session.text("document.getElementById('trouble').textContent");
    assert!(message.starts_with("line 1, column 18") && message.contains("bb"), "{message}");
    assert_eq!(session.at_points("branch", "LP", "a").len(), 1);
    session.picture("error");
    // The button leads to the place.
    session.click("document.querySelector('#trouble button')");
    let selected = "(area => area.value.slice(area.selectionStart, area.selectionEnd))(document.getElementById('text'))";
    assert_eq!(session.text(selected), "bb");
    session.type_equations("x' = a + 3*x^2\npar a=-1\ninit x=0.5\n");
    session.fill("[aria-label='a, upper end of its range']", "1");
    assert_eq!(session.value("document.getElementById('trouble').hidden"), true);
}

/// A text without a state has no use for bounds, marks, starts and axes of this state.
#[test]
fn columns_that_the_text_no_longer_has_are_left_out_with_a_warning() {
    let program = Program::start(&[]);
    let setup = |text: &str| {
        let setup = json!({
            "name": "t", "text": text, "along": [{ "name": "a", "low": -1.0, "high": 1.0 }],
            "bounds": [{ "name": "y", "low": -5.0, "high": 5.0 }, { "name": "x", "low": -5.0, "high": 5.0 }],
            "marks": [["y", 0.5], ["max_x", 0.5]], "state": [["y", 0.0], ["x", 0.0]], "y": "y",
        });
        json!({ "trace": { "page": "p", "turn": 1, "setup": setup } }).to_string().into_bytes()
    };
    let both = program.call(&setup("x' = a - x\ny' = x - y\npar a=0\n"));
    assert!(both.contains("\"done\"") && !both.contains("left out"), "{both}");
    let setup = String::from_utf8(setup("x' = a - x\npar a=0\n")).unwrap();
    let one = program.call(setup.replace("\"turn\":1", "\"turn\":2").as_bytes());
    assert!(one.contains("\"done\"") && !one.contains("\"failed\":{"), "{one}");
    assert_eq!(one.matches("is left out").count(), 1, "{one}");
    assert!(one.contains("the bound, mark, start or axis of `y` is left out"), "{one}");
}

#[test]
fn a_wrong_value_is_shown_at_its_field() {
    let program = Program::start(&["lorenz"]);
    let Some(mut session) = Session::open(&program) else { return };
    session.click("document.querySelector('#settings summary')");
    session.browser.wait("document.getElementById('setting-max_step') !== null");
    let help = session.text("document.getElementById('setting-max_step-meaning').textContent");
    assert!(help.starts_with("The maximum step of the continuation."), "{help}");
    session.fill("#setting-max_step", "wide");
    let field = "document.getElementById('setting-max_step')";
    assert_eq!(session.text(&format!("{field}.getAttribute('aria-invalid')")), "true");
    session.picture("settings");
    session.fill("#setting-max_step", "0.1");
    assert_eq!(session.value(&format!("{field}.getAttribute('aria-invalid')")), json!(null));
    assert!(
        session
            .text("document.getElementById('command').textContent")
            .contains("--set max_step=0.1")
    );
}

#[test]
fn the_keyboard_alone_changes_a_parameter_and_opens_a_point() {
    let program = Program::start(&[]);
    let Some(mut session) = Session::open(&program) else { return };
    let press = |session: &mut Session, key: &str, code: u32| {
        for event in ["rawKeyDown", "keyUp"] {
            let parameters =
                json!({ "type": event, "key": key, "code": key, "windowsVirtualKeyCode": code });
            session.browser.call("Input.dispatchKeyEvent", parameters);
        }
    };
    let is_at = "document.activeElement.getAttribute('aria-label') === 'b, slider'";
    let steps = (0..60).take_while(|_| {
        press(&mut session, "Tab", 9);
        session.value(is_at) != json!(true)
    });
    assert!(steps.count() < 60, "the slider is not reached");
    press(&mut session, "ArrowRight", 39);
    session.settle();
    let k: f64 = session.text("document.getElementById('parameter-b').value").parse().unwrap();
    assert!(k > 1.0);
    let is_row = "document.activeElement.closest('#points tbody tr') !== null";
    let steps = (0..60).take_while(|_| {
        press(&mut session, "Tab", 9);
        session.value(is_row) != json!(true)
    });
    assert!(steps.count() < 60, "the table is not reached");
    press(&mut session, "ArrowDown", 40);
    press(&mut session, "Enter", 13);
    session.browser.wait(
        "document.querySelector('#details h2') !== null && document.activeElement.id === 'details'",
    );
}

#[test]
fn a_narrow_window_shows_everything_below_one_another() {
    let program = Program::start(&["lure"]);
    let Some(mut session) = Session::open(&program) else { return };
    session.browser.resize(420, 900);
    session.browser.wait("document.documentElement.scrollWidth <= 420");
    session.value("(document.getElementById('panels').scrollIntoView(), 0)");
    session.picture("narrow");
    let inside = "[...document.querySelectorAll('#panels svg')].every(it => it.getBoundingClientRect().right <= 420)";
    assert_eq!(session.value(inside), true);
}
