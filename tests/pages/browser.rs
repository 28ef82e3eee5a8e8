//! Chromium without a window, by the DevTools protocol over a pair of pipes: messages are JSON, each
//! ended by a zero byte. The clients for it in the registry bring a hundred crates and more.

use serde_json::{Value, json};
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// How long anything may take.
const PATIENCE: Duration = Duration::from_secs(60);

/// A browser with one page.
pub struct Browser {
    child: Child,
    to: File,
    from: Receiver<Value>,
    /// The number of the last message.
    last: u64,
    session: Option<String>,
    /// The addresses from which pages requested something.
    requests: Vec<String>,
}

/// Waits until there is a value.
pub fn patiently<T>(wanted: &str, mut value: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(value) = value() {
            return value;
        }
        assert!(start.elapsed() < PATIENCE, "still waiting for {wanted}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

impl Browser {
    /// A browser that keeps its files, and what it downloads, in a folder; `None` where Chromium is
    /// not installed.
    pub fn start(folder: &Path) -> Option<Browser> {
        Command::new("chromium").arg("--version").stderr(Stdio::null()).output().ok()?;
        let pipes = ["in", "out"].map(|name| folder.join(name));
        assert!(Command::new("mkfifo").args(&pipes).status().unwrap().success());
        // The sandbox needs rights that a container may not have; the pages are our own.
        let script = "exec chromium --headless --no-sandbox --disable-dev-shm-usage --disable-gpu --enable-unsafe-swiftshader --hide-scrollbars \
                      --user-data-dir=\"$0/profile\" --remote-debugging-pipe 3<\"$0/in\" 4>\"$0/out\"";
        let child = Command::new("sh")
            .args(["-c", script])
            .arg(folder)
            .stderr(Stdio::null())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let to = OpenOptions::new().write(true).open(&pipes[0]).unwrap();
        let mut pipe = BufReader::new(File::open(&pipes[1]).unwrap());
        let (sender, from) = channel();
        std::thread::spawn(move || {
            let mut message = Vec::new();
            while pipe.read_until(0, &mut message).is_ok_and(|count| count > 0) {
                message.pop();
                if sender.send(serde_json::from_slice(&message).unwrap()).is_err() {
                    return;
                }
                message.clear();
            }
        });
        let mut browser = Browser { child, to, from, last: 0, session: None, requests: Vec::new() };
        let target = browser.call("Target.createTarget", json!({ "url": "about:blank" }));
        let target = json!({ "targetId": target["targetId"], "flatten": true });
        let session = browser.call("Target.attachToTarget", target)["sessionId"].clone();
        browser.session = session.as_str().map(String::from);
        browser.call("Runtime.enable", json!({}));
        browser.call("Page.enable", json!({}));
        browser.call("Network.enable", json!({}));
        browser.call(
            "Browser.setDownloadBehavior",
            json!({ "behavior": "allow", "downloadPath": folder }),
        );
        browser.resize(1200, 900);
        Some(browser)
    }

    /// The result of a method of the protocol.
    pub fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.answer(method, parameters).unwrap_or_else(|error| panic!("{method}: {error}"))
    }

    /// The result of a method of the protocol, or its error.
    fn answer(&mut self, method: &str, parameters: Value) -> Result<Value, Value> {
        self.last += 1;
        let mut message = json!({ "id": self.last, "method": method, "params": parameters });
        if let (Some(session), false) = (&self.session, method.starts_with("Browser.")) {
            message["sessionId"] = json!(session);
        }
        self.to.write_all(format!("{message}\0").as_bytes()).unwrap();
        loop {
            let answer = self.from.recv_timeout(PATIENCE).unwrap_or_else(|_| panic!("{method}"));
            // An error on the page that nothing there catches.
            let thrown = &answer["params"]["exceptionDetails"]["exception"]["description"];
            assert_ne!(answer["method"], "Runtime.exceptionThrown", "{thrown}");
            if answer["method"] == "Network.requestWillBeSent" {
                let address = answer["params"]["request"]["url"].as_str();
                self.requests.extend(address.map(String::from));
            }
            if answer["id"] == self.last {
                let error = &answer["error"];
                return if error.is_null() {
                    Ok(answer["result"].clone())
                } else {
                    Err(error.clone())
                };
            }
        }
    }

    /// The addresses from which pages requested something, in order.
    pub fn requests(&self) -> &[String] {
        &self.requests
    }

    /// Opens a file.
    pub fn open(&mut self, file: &Path) {
        self.go(&format!("file://{}", file.display()));
    }

    /// Opens an address.
    pub fn go(&mut self, url: &str) {
        self.call("Page.navigate", json!({ "url": url }));
    }

    /// Gives the window a size in pixels.
    pub fn resize(&mut self, width: u32, height: u32) {
        let size =
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.call("Emulation.setDeviceMetricsOverride", size);
    }

    /// The value of an expression on the page.
    pub fn evaluate(&mut self, expression: &str) -> Value {
        self.evaluated(expression).unwrap_or_else(|error| panic!("{expression}: {error}"))
    }

    /// The value of an expression, or the error of a page that is left meanwhile.
    fn evaluated(&mut self, expression: &str) -> Result<Value, Value> {
        let parameters =
            json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let answer = self.answer("Runtime.evaluate", parameters)?;
        assert!(answer["exceptionDetails"].is_null(), "{expression}: {answer}");
        Ok(answer["result"]["value"].clone())
    }

    /// Waits until an expression is true, on the next page if a click has left this page.
    pub fn wait(&mut self, expression: &str) {
        patiently(expression, || (self.evaluated(expression) == Ok(json!(true))).then_some(()));
    }

    /// The values of a list of numbers.
    pub fn numbers(&mut self, expression: &str) -> Vec<f64> {
        let value = self.evaluate(expression);
        let list = value.as_array().unwrap_or_else(|| panic!("{expression}: {value}"));
        list.iter().map(|it| it.as_f64().unwrap_or(f64::NAN)).collect()
    }

    /// Where a point of a panel is on the screen, in pixels, after it has been scrolled to.
    pub fn pixels(&mut self, panel: usize, at: [f64; 2]) -> [f64; 2] {
        let [x, y] = at;
        let place = self.numbers(&format!(
            "(() => {{
                const plot = document.querySelectorAll('#panels .plot')[{panel}];
                plot.scrollIntoView({{ block: 'center' }});
                const {{ xaxis, yaxis, _size }} = plot._fullLayout;
                const box = plot.getBoundingClientRect();
                return [box.left + _size.l + xaxis.c2p({x:?}), box.top + _size.t + yaxis.c2p({y:?})];
            }})()"
        ));
        [place[0], place[1]]
    }

    /// The rows of the text beside the pointer at a point of a panel.
    pub fn hovered(&mut self, panel: usize, at: [f64; 2]) -> Vec<(String, String)> {
        // What was shown before goes first.
        self.mouse("mouseMoved", [5.0, 5.0]);
        self.wait("document.getElementById('tip').hidden");
        let [x, y] = self.pixels(panel, at);
        self.mouse("mouseMoved", [x + 1.0, y]);
        self.mouse("mouseMoved", [x, y]);
        self.wait("!document.getElementById('tip').hidden");
        let rows = self.evaluate(
            "[['', document.querySelector('#tip strong').textContent],
              ...[...document.querySelectorAll('#tip tr')].map(row => [...row.cells].map(cell => cell.textContent))]",
        );
        let text = |value: &Value| value.as_str().unwrap().to_string();
        rows.as_array().unwrap().iter().map(|row| (text(&row[0]), text(&row[1]))).collect()
    }

    /// What the mouse does at a place in pixels: `mouseMoved`, `mousePressed`, `mouseReleased`.
    pub fn mouse(&mut self, event: &str, [x, y]: [f64; 2]) {
        let button = if event == "mouseMoved" { "none" } else { "left" };
        let parameters =
            json!({ "type": event, "x": x, "y": y, "button": button, "clickCount": 1 });
        self.call("Input.dispatchMouseEvent", parameters);
    }

    /// Presses a key.
    pub fn key(&mut self, key: &str) {
        for event in ["keyDown", "keyUp"] {
            self.call("Input.dispatchKeyEvent", json!({ "type": event, "key": key }));
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
