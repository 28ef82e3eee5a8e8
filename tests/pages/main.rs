//! Interactive pages in a browser: Chromium without a window, driven by its own protocol.
//!
//! Where `chromium` is not installed nothing can be tested, and each test says that.

mod browser;
#[cfg(all(feature = "cli", feature = "live"))]
mod live;

use browser::Browser;
use serde_json::{Value, json};
use std::time::Duration;
use tangency::core::continuation::Branch;
use tangency::core::sweep::Part;
use tangency::output::{Document, Format, Render, Results, example_branch};
use tangency::scene::{LIBRARY, Scene, execute, sweep};
use tempfile::TempDir;

/// A page of documents, open in a browser; `None` without a browser.
struct Page {
    browser: Browser,
    folder: TempDir,
}

impl Page {
    fn of(documents: &[(&str, &Document)]) -> Option<Page> {
        Page::showing(&Results { documents, ..Results::default() })
    }

    fn showing(results: &Results) -> Option<Page> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("page.html");
        std::fs::write(&file, results.render(Format::Html).unwrap()).unwrap();
        let Some(mut browser) = Browser::start(folder.path()) else {
            eprintln!("pages: chromium is not installed, so that this test cannot run");
            return None;
        };
        browser.open(&file);
        browser.wait("document.body?.dataset.ready === 'true'");
        Some(Page { browser, folder })
    }

    /// The value of an expression in the page.
    fn value(&mut self, expression: &str) -> Value {
        self.browser.evaluate(expression)
    }

    /// The values of a list of numbers.
    fn numbers(&mut self, expression: &str) -> Vec<f64> {
        self.browser.numbers(expression)
    }

    /// Where a point of a panel is on the screen, in pixels, after it has been scrolled to.
    fn pixels(&mut self, panel: usize, at: [f64; 2]) -> [f64; 2] {
        self.browser.pixels(panel, at)
    }

    /// The rows of the text beside the pointer at a point of a panel.
    fn hovered(&mut self, panel: usize, at: [f64; 2]) -> Vec<(String, String)> {
        self.browser.hovered(panel, at)
    }

    /// Clicks at a point of a panel. On a loaded machine Plotly may lose a click that follows a motion of
    /// the pointer closely. The test then clicks again, as a user would.
    fn click(&mut self, panel: usize, at: [f64; 2]) {
        self.value(&format!(
            "(window.clicks = 0, document.querySelectorAll('#panels .plot')[{panel}].on('plotly_click', () => window.clicks++), 0)"
        ));
        browser::patiently("a click", || {
            let _ = self.hovered(panel, at);
            let place = self.pixels(panel, at);
            self.browser.mouse("mousePressed", place);
            self.browser.mouse("mouseReleased", place);
            // Longer than between the two parts of a double click.
            std::thread::sleep(Duration::from_millis(500));
            (self.value("window.clicks > 0") == true).then_some(())
        });
    }

    /// A file that the page saves.
    fn download(&mut self, click: &str, name: &str) -> String {
        self.value(&format!("{click}.click()"));
        let file = self.folder.path().join(name);
        browser::patiently(name, || std::fs::read_to_string(&file).ok().filter(|it| !it.is_empty()))
    }
}

/// The document of a scene of the library.
fn traced(name: &str) -> Document {
    let scene = LIBRARY.iter().find(|scene| scene.name == name).unwrap();
    let outcome = execute(&Scene::parse(scene.text).unwrap(), None, &mut ());
    assert_eq!(outcome.error, None);
    outcome.document
}

/// A number as the page shows it: 12 significant digits.
fn agrees(shown: &str, value: f64) -> bool {
    let shown: f64 = shown.split(" ± ").next().unwrap().parse().unwrap();
    (shown - value).abs() <= 1e-11 * value.abs()
}

fn column(branch: &Branch, name: &str) -> usize {
    branch.column(name).unwrap_or_else(|| panic!("{name}"))
}

/// Numbers are equal but for their last bit, which reading JSON may change.
fn equal(a: &[f64], b: &[f64]) {
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(b) {
        assert!((a - b).abs() <= 2.0 * f64::EPSILON * b.abs(), "{a} {b}");
    }
}

/// Values, error and multipliers of points under the pointer are the document's; a click shows the
/// orbit, in the plane and in space.
#[test]
fn points_show_their_values_and_their_orbits() {
    let document = traced("lorenz");
    let Some(mut page) = Page::of(&[("lorenz", &document)]) else { return };
    let cycles = document.branch("cycles").unwrap();
    let (rho, x) = (column(cycles, "rho"), column(cycles, "min_x"));
    for special in &cycles.special {
        let at = [special.value(rho).unwrap(), special.value(x).unwrap()];
        // The first point is marked as the Hopf point of the other branch.
        if special.label == 1 {
            continue;
        }
        let rows = page.hovered(0, at);
        assert!(
            rows[0].1.contains(&format!("cycles: {} {}", special.kind, special.label)),
            "{rows:?}"
        );
        let of = |name: &str| &rows.iter().find(|row| row.0 == name).unwrap().1;
        assert!(of("rho").contains(" ± "));
        for name in cycles.columns() {
            let value = special.value(column(cycles, name)).unwrap();
            assert!(agrees(of(name), value), "{name}: {} {value}", of(name));
        }
        // Beside a homoclinic orbit multipliers are not determined.
        match special.eigenvalues.first() {
            Some(first) => assert!(agrees(of("eigenvalue or multiplier 1"), first.0)),
            None => assert!(special.undetermined.is_some()),
        }
    }
    let point = &cycles.points[8];
    let rows = page.hovered(0, [point.value(rho).unwrap(), point.value(x).unwrap()]);
    assert_eq!(rows[0].1, "cycles, point 8");
    assert!(rows.iter().any(|row| row.0 == "min_x" && agrees(&row.1, point.value(x).unwrap())));

    let special = cycles.special.iter().find(|special| special.label == 2).unwrap();
    page.click(0, [special.value(rho).unwrap(), special.value(x).unwrap()]);
    page.browser.wait("!document.getElementById('solution').hidden");
    let profile = |name: &str| {
        special.profiles.iter().find(|it| it.name == name && it.along == "time").unwrap()
    };
    let values = |name: &str| profile(name).points.iter().map(|at| at[1]).collect::<Vec<f64>>();
    for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
        let curve = page.numbers(&format!("document.querySelector('#solution .plot').data[{k}].y"));
        equal(&curve, &values(name));
    }
    for (field, name) in [("horizontal", "x"), ("vertical", "y"), ("depth", "z")] {
        page.value(&format!(
            "(() => {{
                const labels = [...document.querySelectorAll('#solution label')];
                const field = labels.find(label => label.firstChild.textContent === '{field}').querySelector('select');
                field.value = '{name}';
                field.dispatchEvent(new Event('change'));
            }})()"
        ));
    }
    let curve = "document.querySelector('#solution .plot').data[0]";
    assert_eq!(page.value(&format!("{curve}.type")), json!("scatter3d"));
    for (axis, name) in ["x", "y", "z"].into_iter().zip(["x", "y", "z"]) {
        equal(&page.numbers(&format!("{curve}.{axis}")), &values(name));
    }
}

/// Each state of a hybrid orbit is drawn over its own times: modes may lack some states.
#[test]
fn states_have_their_own_times() {
    let document = traced("stick-slip");
    let Some(mut page) = Page::of(&[("actuator", &document)]) else { return };
    let rows = "[...document.querySelectorAll('#table tbody tr')]";
    let (branch, special) = document
        .branches
        .iter()
        .flat_map(|branch| branch.special.iter().map(move |special| (branch, special)))
        .find(|(branch, _)| branch.name == "one impact")
        .unwrap();
    let histories: Vec<_> = special.profiles.iter().filter(|it| it.along == "time").collect();
    assert!(histories.iter().any(|it| it.points.len() != histories[0].points.len()));
    page.value(&format!(
        "{rows}.find(row => row.cells[0].textContent === '{}' && row.cells[1].textContent === '{}').click()",
        branch.name, special.label
    ));
    page.browser.wait("!document.getElementById('solution').hidden");
    for (k, history) in histories.iter().enumerate() {
        let curve = format!("document.querySelector('#solution .plot').data[{k}]");
        let times = page.numbers(&format!("{curve}.x.filter(time => time !== null)"));
        equal(&times, &history.points.iter().map(|at| at[0]).collect::<Vec<f64>>());
        let values = page.numbers(&format!("{curve}.y.filter(value => value !== null)"));
        equal(&values, &history.points.iter().map(|at| at[1]).collect::<Vec<f64>>());
    }
}

/// Files that the page saves hold the document's numbers, to the last bit.
#[test]
fn downloads_hold_the_numbers_of_the_document() {
    let document = traced("fitzhugh-nagumo");
    let Some(mut page) = Page::of(&[("neuron", &document)]) else { return };
    let text = page.download("document.getElementById('download-csv')", "points.csv");
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    for branch in &document.branches {
        for (index, point) in branch.points.iter().enumerate() {
            let row: Vec<&str> = lines.next().unwrap().split(',').collect();
            assert_eq!(row[1..3], [branch.name.as_str(), &index.to_string()]);
            for (name, text) in names[3..names.len() - 2].iter().zip(&row[3..]) {
                let value = branch.column(name).and_then(|column| point.value(column));
                assert_eq!(text.parse().ok(), value, "{name}");
            }
        }
    }
    assert_eq!(lines.next(), None);

    // A panel in other columns.
    let branch = &document.branches[0];
    let [first, second] = [branch.columns().next().unwrap(), branch.columns().last().unwrap()];
    page.value(&format!(
        "document.querySelectorAll('.panel:first-child select').forEach((field, k) => {{
            field.value = ['{second}', '{first}'][k];
            field.dispatchEvent(new Event('change'));
        }})"
    ));
    let button = "[...document.querySelectorAll('.panel:first-child button')].find(it => it.textContent === 'CSV')";
    let name =
        page.value("(document.title || 'tangency').replace(/[^\\p{L}\\p{N}]+/gu, '-') + '-1.csv'");
    let text = page.download(button, name.as_str().unwrap());
    let rows: Vec<Vec<&str>> = text.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let mut checked = 0;
    for row in rows.iter().filter(|row| row[0] == branch.name && !row[1].is_empty()) {
        let point = &branch.points[row[1].parse::<usize>().unwrap()];
        let [x, y] = [second, first].map(|name| point.value(column(branch, name)).unwrap());
        assert_eq!([row[3].parse(), row[4].parse()], [Ok(x), Ok(y)]);
        checked += 1;
    }
    assert_eq!(checked, branch.points.len());
}

/// Branches and kinds of points are taken away and come back; the table is for the keyboard.
#[test]
fn branches_are_switched_off_and_points_chosen_by_keys() {
    let document = traced("lorenz");
    let Some(mut page) = Page::of(&[("lorenz", &document)]) else { return };
    let shown = "[...new Set(document.querySelector('.panel .plot').data.map(it => it.name).filter(Boolean))].join()";
    assert!(page.value(shown).as_str().unwrap().starts_with("rest,convection,cycles"));
    let switch = "document.querySelectorAll('#branches input')[1].click()";
    page.value(switch);
    assert!(page.value(shown).as_str().unwrap().starts_with("rest,cycles"));
    page.value(switch);
    assert!(page.value(shown).as_str().unwrap().starts_with("rest,convection,cycles"));
    page.value("document.querySelectorAll('#table tbody tr')[8].focus()");
    page.browser.key("Enter");
    page.browser.wait("!document.getElementById('solution').hidden");
    let title = page.value("document.querySelector('#solution h2').textContent");
    assert_eq!(title, json!("cycles: HOM 2, homoclinic orbit"));
}

/// Texts are texts, whatever characters they have, and nothing comes from a network.
#[test]
fn texts_are_no_markup_and_nothing_is_fetched() {
    let mut branch = example_branch();
    branch.name = "<b>a</b></script><script>document.title = 'changed'</script>".into();
    let title =
        "t <!-- b <script> c </title><img src=x onerror=\"document.body.dataset.bad = 1\">&amp;\"'";
    let document = Document::new(title, vec![branch.clone()]);
    let Some(mut page) = Page::of(&[("first", &document), ("</script>", &document)]) else {
        return;
    };
    assert_eq!(page.value("document.title"), json!(title));
    assert_eq!(page.value("document.querySelector('h1').textContent"), json!(title));
    assert_eq!(page.value("document.body.dataset.bad === undefined"), json!(true));
    assert_eq!(page.value("document.querySelectorAll('img, b').length"), json!(0));
    let cell = "document.querySelector('#table tbody td').textContent";
    assert_eq!(page.value(cell), json!(format!("first: {}", branch.name)));
    assert_eq!(page.value("performance.getEntriesByType('resource').length"), json!(0));
    let inside = |address: &String| address.ends_with("/page.html") || address.starts_with("data:");
    let requests = page.browser.requests();
    assert!(!requests.is_empty() && requests.iter().all(inside), "{requests:?}");
}

/// Dots of a sweep are an image below the curves, painted anew for each view.
#[test]
fn sweeps_are_painted() {
    let text = "Scene(title: \"Forced\", problem: Equations(states: [(\"x\", \"r*cos(t) - x\")], period: \"2*pi\"), parameters: [(\"r\", 3)],
        sweeps: [(name: \"up\", over: [(name: \"r\", low: 3.5, high: 4, count: 40)], search: (transient: 10, recorded_periods: 4, lyapunov_periods: 0))])";
    let scene = Scene::parse(text).unwrap();
    let sweeps = [sweep(&scene, "forced", Part::WHOLE, None, &mut ()).unwrap()];
    let results = Results { sweeps: &sweeps, ..Results::default() };
    let Some(mut page) = Page::showing(&results) else { return };
    let painted = "(async () => {
        const source = document.querySelector('.plot').layout.images[0].source;
        const image = Object.assign(new Image(), { src: source });
        await image.decode();
        const canvas = Object.assign(document.createElement('canvas'), { width: image.width, height: image.height });
        const context = canvas.getContext('2d');
        context.drawImage(image, 0, 0);
        return context.getImageData(0, 0, image.width, image.height).data.filter((value, k) => k % 4 === 3 && value > 0).length;
    })()";
    let whole = page.value(painted).as_u64().unwrap();
    assert!(whole > 200, "{whole}");
    page.value("Plotly.relayout(document.querySelector('.plot'), { 'xaxis.range': [3.5, 3.51] }).then(() => 0)");
    page.browser.wait("document.querySelector('.plot').layout.images[0].x === 3.5");
    let part = page.value(painted).as_u64().unwrap();
    assert!(part > 0 && part < whole / 4, "{part} of {whole}");
}

/// Each scene of the library that is traced at once has a page without errors, and so have narrow
/// windows.
#[test]
fn pages_of_the_library_open() {
    let quick =
        ["rocking-block", "co-oxidation", "bouncing-ball", "brusselator", "two-walls", "duffing"];
    let mut browser: Option<Page> = None;
    for name in quick {
        let document = traced(name);
        let Some(page) = Page::of(&[(name, &document)]) else { return };
        let page = browser.insert(page);
        page.browser.resize(380, 800);
        let wide = "document.documentElement.scrollWidth <= innerWidth";
        page.browser.wait(wide);
        let curves = page.value("[...document.querySelectorAll('.plot')].filter(it => it.data).every(it => it.data.length > 1)");
        assert_eq!(curves, json!(true), "{name}");
    }
}

/// The point under the pointer has a ring, and the plot is not drawn again for the ring: Plotly
/// repeats a hover after each drawing, so that two near points could take turns for ever.
#[test]
fn pointing_draws_no_plot_again() {
    let document = traced("lorenz");
    let Some(mut page) = Page::of(&[("lorenz", &document)]) else { return };
    page.value(
        "window.drawn = 0;
         document.querySelectorAll('#panels .plot').forEach(plot => plot.on('plotly_afterplot', () => { window.drawn += 1; })); 0",
    );
    let cycles = document.branch("cycles").unwrap();
    let (rho, x) = (column(cycles, "rho"), column(cycles, "min_x"));
    for special in &cycles.special {
        let at = [special.value(rho).unwrap(), special.value(x).unwrap()];
        let _ = page.hovered(0, at);
        let rings = page.numbers(
            "[...document.querySelectorAll('.ring')].flatMap(ring => {
                const box = ring.getBoundingClientRect();
                return [box.left + box.width / 2, box.top + box.height / 2];
            })",
        );
        let [x, y] = page.pixels(0, at);
        assert!(rings.chunks(2).any(|ring| (ring[0] - x).hypot(ring[1] - y) < 1.0), "{rings:?}");
    }
    assert_eq!(page.value("window.drawn"), json!(0));
}
