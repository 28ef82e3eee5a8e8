//! A page of the server in a browser, and the actions of a user.

use super::Program;
use crate::browser::{Browser, patiently};
use serde_json::{Value, json};
use std::path::PathBuf;
use tempfile::TempDir;

/// An open page.
pub struct Session {
    pub browser: Browser,
    pub folder: TempDir,
}

/// The fold of `load = k u (1 − u)` is at `u = 1/2`, `load = k/4`.
pub const FOLD: &str = "u' = load - k*u*(1 - u)\npar load=0, k=1\ninit u=0\n";

/// The normal form of a Hopf point at `m = w/4`, with the angular frequency `w`.
pub const HOPF: &str = "x' = (m - w/4)*x - w*y - x*(x^2 + y^2)\ny' = w*x + (m - w/4)*y - y*(x^2 + y^2)\npar m=-0.5, w=2\ninit x=0, y=0\n";

impl Session {
    /// Opens the page of a program; `None` without a browser.
    pub fn open(program: &Program) -> Option<Session> {
        Session::at(&program.address)
    }

    pub fn at(address: &str) -> Option<Session> {
        let folder = tempfile::tempdir().unwrap();
        let Some(mut browser) = Browser::start(folder.path()) else {
            eprintln!("pages: chromium is not installed, so that this test cannot run");
            return None;
        };
        browser.go(address);
        browser.wait("document.body?.dataset.ready === 'true'");
        let mut session = Session { browser, folder };
        session.settle();
        Some(session)
    }

    /// Waits until the last change is traced, or refused.
    pub fn settle(&mut self) {
        self.browser.wait("document.body.dataset.busy === 'false'");
    }

    pub fn value(&mut self, expression: &str) -> Value {
        self.browser.evaluate(expression)
    }

    pub fn text(&mut self, expression: &str) -> String {
        self.value(expression).as_str().unwrap_or_default().to_string()
    }

    /// Types a text in place of the equations.
    pub fn type_equations(&mut self, text: &str) {
        self.value("(document.getElementById('text').focus(), document.getElementById('text').select(), 0)");
        self.browser.call("Input.insertText", json!({ "text": text }));
        self.settle();
    }

    /// Types a text in place of the content of a field, and leaves it.
    pub fn fill(&mut self, selector: &str, text: &str) {
        self.value(&format!("(document.querySelector({selector:?}).focus(), document.querySelector({selector:?}).select(), 0)"));
        self.browser.call("Input.insertText", json!({ "text": text }));
        self.value("(document.activeElement.blur(), 0)");
        self.settle();
    }

    /// The cells of the table of special points, row by row.
    pub fn rows(&mut self) -> Vec<Vec<String>> {
        let rows = self.value(
            "[...document.querySelectorAll('#points tbody tr')].map(row => [...row.cells].map(cell => cell.textContent))",
        );
        serde_json::from_value(rows).unwrap()
    }

    /// The values `name = value` of the special points of a kind, on a branch.
    pub fn at_points(&mut self, branch: &str, kind: &str, name: &str) -> Vec<f64> {
        let rows = self.rows();
        let rows = rows.iter().filter(|row| row[0] == branch && row[2] == kind);
        let value = |row: &Vec<String>| {
            let mut parts = row[3].split(", ").filter_map(|part| part.split_once(" = "));
            parts.find(|(key, _)| *key == name).map(|(_, value)| value.parse().unwrap())
        };
        rows.filter_map(value).collect()
    }

    /// Clicks at the middle of an element, with the mouse.
    pub fn click(&mut self, expression: &str) {
        let place = self.place_of(expression);
        self.browser.mouse("mouseMoved", place);
        self.browser.mouse("mousePressed", place);
        self.browser.mouse("mouseReleased", place);
    }

    /// The middle of an element on the screen.
    pub fn place_of(&mut self, expression: &str) -> [f64; 2] {
        let box_of = format!(
            "(() => {{
                const element = {expression};
                element.scrollIntoView({{ block: 'center' }});
                const box = element.getBoundingClientRect();
                return [box.left + box.width / 2, box.top + box.height / 2];
            }})()"
        );
        serde_json::from_value(self.value(&box_of)).unwrap()
    }

    /// Clicks the row of the first special point of a kind on a branch, and waits for its details.
    pub fn choose(&mut self, branch: &str, kind: &str) {
        let row = format!(
            "[...document.querySelectorAll('#points tbody tr')].find(row => row.cells[0].textContent === {branch:?} && row.cells[2].textContent === {kind:?})"
        );
        self.click(&row);
        let title = format!(
            "document.querySelector('#details h2')?.textContent.startsWith('{branch}: {kind} ')"
        );
        self.browser.wait(&title);
    }

    /// Presses a button of the details by its text.
    pub fn press(&mut self, text: &str) {
        self.click(&format!("[...document.querySelectorAll('#details button')].find(button => button.textContent === {text:?})"));
        self.value("new Promise(done => setTimeout(() => done(0), 50))");
        self.settle();
    }

    /// A file that the page saves.
    pub fn download(&mut self, format: &str, name: &str) -> String {
        self.value(&format!("document.querySelector('#save [data-format={format}]').click()"));
        let file = self.folder.path().join(name);
        patiently(name, || std::fs::read_to_string(&file).ok().filter(|it| !it.is_empty()))
    }

    /// Keeps a picture of the page for readers.
    pub fn picture(&mut self, name: &str) {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("live");
        std::fs::create_dir_all(&folder).unwrap();
        let shot = self.browser.call("Page.captureScreenshot", json!({ "format": "png" }));
        let data = shot["data"].as_str().unwrap();
        std::fs::write(folder.join(format!("{name}.png")), decoded(data)).unwrap();
    }
}

/// The bytes of a text in base 64.
fn decoded(text: &str) -> Vec<u8> {
    let digit = |letter: u8| match letter {
        b'A'..=b'Z' => letter - b'A',
        b'a'..=b'z' => letter - b'a' + 26,
        b'0'..=b'9' => letter - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let digits: Vec<u32> =
        text.bytes().filter(|it| *it != b'=').map(|it| u32::from(digit(it))).collect();
    let bytes = digits.chunks(4).flat_map(|part| {
        let bits = part.iter().fold(0, |bits, digit| bits << 6 | digit) << (6 * (4 - part.len()));
        let count = part.len() * 6 / 8;
        bits.to_be_bytes()[1..=count].to_vec()
    });
    bytes.collect()
}
