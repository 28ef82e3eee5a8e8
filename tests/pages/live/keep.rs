//! Undo, links, files, several pages, and a server that does not answer.

use super::session::FOLD;
use super::{Program, Session};
use tangency::scene::{Scene, execute};

/// The field with the end of the load.
const END: &str = "[aria-label='load, upper end of its range']";

#[test]
fn changes_are_undone_kept_in_links_and_saved() {
    let program = Program::start(&[]);
    let Some(mut session) = Session::open(&program) else { return };
    session.type_equations(FOLD);
    session.fill(END, "2");
    session.fill("#parameter-k", "2");
    session.fill("#parameter-k", "3");
    let fold = |session: &mut Session| session.at_points("branch", "LP", "load")[0] * 4.0;
    assert!((fold(&mut session) - 3.0).abs() < 1e-8);
    session.click("document.getElementById('undo')");
    session.value("new Promise(done => setTimeout(() => done(0), 50))");
    session.settle();
    assert!((fold(&mut session) - 2.0).abs() < 1e-8);
    session.click("document.getElementById('redo')");
    session.value("new Promise(done => setTimeout(() => done(0), 50))");
    session.settle();
    assert!((fold(&mut session) - 3.0).abs() < 1e-8);
    // The saved scene has the same fold in the terminal.
    let saved = Scene::parse(&session.download("scene", "hysteresis.ron")).unwrap();
    let document = execute(&saved, None, &mut ()).document;
    let point = document.branches[0].special.iter().find(|it| it.kind.letters() == "LP").unwrap();
    assert!((point.parameters[0] - 3.0 / 4.0).abs() < 1e-12);
    assert!(session.download("svg", "hysteresis.svg").starts_with("<svg"));
    assert!(session.download("csv", "hysteresis.csv").contains("load"));
    assert!(session.download("html", "hysteresis.html").contains("plotly"));
    // The link opens the session in another page.
    session.browser.wait("location.hash.startsWith('#s=')");
    session.value("new Promise(done => setTimeout(() => done(0), 500))");
    let link = session.text("location.href");
    let Some(mut other) = Session::at(&link) else { return };
    assert!((fold(&mut other) - 3.0).abs() < 1e-8);
}

#[test]
fn two_pages_have_their_own_results() {
    let program = Program::start(&[]);
    let Some(mut one) = Session::open(&program) else { return };
    let Some(mut two) = Session::open(&program) else { return };
    for session in [&mut one, &mut two] {
        session.type_equations(FOLD);
        session.fill(END, "2");
    }
    one.fill("#parameter-k", "2");
    two.fill("#parameter-k", "5");
    let folds = [&mut one, &mut two].map(|it| it.at_points("branch", "LP", "load")[0] * 4.0);
    assert!((folds[0] - 2.0).abs() < 1e-8 && (folds[1] - 5.0).abs() < 1e-8, "{folds:?}");
    one.choose("branch", "LP");
    let value = one.text("document.querySelector('#details td').textContent");
    assert!(value.starts_with("0.5"), "{value}");
}

/// A stopped process does not answer; when it runs again, so does the page.
#[test]
fn the_page_says_when_the_server_is_away_and_reconnects() {
    let program = Program::start(&[]);
    let Some(mut session) = Session::open(&program) else { return };
    session.type_equations(FOLD);
    program.signal("STOP");
    session
        .browser
        .wait("document.body.dataset.gone === 'true' && !document.getElementById('gone').hidden");
    session.picture("gone");
    program.signal("CONT");
    session
        .browser
        .wait("document.body.dataset.gone === 'false' && document.getElementById('gone').hidden");
    session.fill("#parameter-k", "2");
    assert!((session.at_points("branch", "LP", "load")[0] - 2.0 / 4.0).abs() < 1e-9);
}

#[test]
fn the_program_ends_at_once() {
    let mut program = Program::start(&["lorenz"]);
    program.signal("INT");
    crate::browser::patiently("the end", || (!program.is_running()).then_some(()));
}
