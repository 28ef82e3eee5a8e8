//! Runs that continue from special points.

use super::session::FOLD;
use super::{Program, Session};

#[test]
fn a_click_on_a_label_shows_the_profile() {
    let program = Program::start(&["lure"]);
    let Some(mut session) = Session::open(&program) else { return };
    session.browser.wait("document.querySelectorAll('#panels svg .symbol').length > 2");
    session.choose("orbits", "PD");
    session.browser.wait("document.querySelectorAll('#details .profiles svg path').length > 0");
    let title = session.text("document.querySelector('#details h2').textContent");
    assert!(title.contains("period doubling"), "{title}");
    // The same point by its mark in the picture.
    session.value("(document.getElementById('details').replaceChildren(), 0)");
    session.click("[...document.querySelectorAll('#panels svg .symbol')].find(it => it.dataset.label.startsWith('PD'))");
    session
        .browser
        .wait("document.querySelector('#details h2')?.textContent.includes('period doubling')");
    assert_eq!(session.value("document.querySelectorAll('#panels svg .ring').length > 0"), true);
    session.picture("profile");
}

#[test]
fn a_fold_is_followed_in_two_parameters() {
    let program = Program::start(&[]);
    let Some(mut session) = Session::open(&program) else { return };
    session.type_equations(FOLD);
    session.choose("branch", "LP");
    // At k = 0 the equation has no fold.
    session.fill("[aria-label='lower end of the second parameter']", "0.5");
    session.press("Follow: curve of folds in two parameters");
    // All folds are at load = k/4.
    let ends = session.at_points("branch-LP-curve", "EP", "load");
    let ks = session.at_points("branch-LP-curve", "EP", "k");
    assert!(ends.len() == 2 && ks.contains(&0.5) && ks.contains(&2.0), "{ends:?} {ks:?}");
    for (load, k) in ends.iter().zip(&ks) {
        assert!((load - k / 4.0).abs() < 1e-8, "{load} at {k}");
    }
    assert_eq!(session.value("document.querySelectorAll('#panels .panel').length"), 2);
    session.picture("two-parameters");
    // The curve is a run of the saved scene.
    let scene = session.download("scene", "hysteresis.ron");
    assert!(scene.contains("hold: Some(LP)") || scene.contains("hold: LP"), "{scene}");
    session.click("document.querySelector('#notes li button')");
    session.value("new Promise(done => setTimeout(() => done(0), 50))");
    session.settle();
    assert_eq!(session.at_points("branch-LP-curve", "EP", "k").len(), 0);
}

/// The logistic map doubles its fixed point at r = 3, and the 2-cycle at r = 1 + √6.
#[test]
fn a_doubled_branch_is_followed_from_a_period_doubling() {
    let program = Program::start(&[]);
    let Some(mut session) = Session::open(&program) else { return };
    session.type_equations(
        "Map(\n    states: [(\"x\", \"r*x*(1 - x)\")],\n    parameters: [(\"r\", 2)],\n    initial: [(\"x\", 0.5)],\n)\n",
    );
    session.fill("[aria-label='r, lower end of its range']", "1.5");
    let [first] = session.at_points("branch", "PD", "r")[..] else { panic!("one doubling") };
    assert!((first - 3.0).abs() < 1e-9);
    session.choose("branch", "PD");
    session.press("Follow: doubled orbits");
    let second = session.at_points("branch-PD", "PD", "r");
    let exact = 1.0 + 6.0_f64.sqrt();
    assert!(second.iter().any(|r| (r - exact).abs() < 1e-8), "{second:?}");
    session.picture("doubled");
}
