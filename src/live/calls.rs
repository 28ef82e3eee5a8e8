//! The calls that a web page sends to the server, and the server's responses.

use super::attractors::{self, Place};
use super::describe::settings;
use super::details::details;
use super::http::{self, Refusal};
use super::library::Library;
use super::opened::{Opened, beginning, example};
use super::pages::{Kept, Message, Tasks};
use super::plane::{self, Point, field, simulate};
use super::setup::Setup;
use super::sweeping::{self, Sweeping};
use super::trouble::Trouble;
use super::work::{Drawing, trace};
use crate::core::cancel::CancelToken;
use crate::core::failure::one_line;
use crate::output::{Format, Render, Results};
use serde::Deserialize;
use serde_json::{Value, json};
use std::io::Write;
use std::net::TcpStream;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

/// The maximum duration of a trace (the computation of the branches for a page), after which the
/// server stops it.
const LONGEST: Duration = Duration::from_secs(120);
/// The interval at which the server checks the connection of a computation that sends no messages.
const SILENCE: Duration = Duration::from_millis(200);
/// The stack size of a computation's thread in bytes; deeply nested formulas need more than the usual
/// size.
const STACK: usize = 32 << 20;
/// The maximum length of the name that identifies a page.
const ID: usize = 64;

const JSON: &str = "application/json";
const LINES: &str = "application/x-ndjson";

/// A call that a page sends to the server.
#[derive(Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum Call {
    /// Requests the setup (the scene and its changed values) that the page shows first, and the
    /// list of examples.
    Open {},
    /// Requests the setup of an example.
    Example { name: String },
    /// Requests that the branches of a setup are traced; the response is a stream of messages.
    Trace { page: String, turn: u64, setup: Box<Setup> },
    /// Stops the trace.
    Stop { page: String },
    /// Requests a sweep under the diagram of the last result; the response is a stream of messages.
    Sweep { page: String, turn: u64, sweep: Sweeping },
    /// Stops the sweep.
    StopSweep { page: String },
    /// Requests the attractors at a point of a diagram in two parameters; the response is a stream
    /// of messages.
    Attractors { page: String, turn: u64, place: Place },
    /// Requests the list of the settings that have an effect in a setup.
    Settings { setup: Box<Setup> },
    /// Requests the diagram of the last result, with other columns on its axes.
    Axes { page: String, x: Option<String>, y: Option<String> },
    /// Requests the details of a point in the last result.
    Point { page: String, at: Point },
    /// Requests a simulation from a state, for a duration, at the parameters of a point of the last
    /// result; the response is a stream of messages.
    Simulate { page: String, number: u64, at: Point, state: Vec<(String, f64)>, duration: f64 },
    /// Requests the vector field in a rectangle of the plane of two states, at the parameters of a
    /// point of the last result; the response is a stream of messages.
    Field { page: String, at: Point, states: [String; 2], ranges: [[f64; 2]; 2] },
    /// Requests the last result as a file.
    File { page: String, format: String },
    /// Requests a short response, which shows that the server is running.
    Alive {},
}

/// The state of the server that all connections share.
pub(super) struct Service {
    pub library: Library,
    pub opened: Option<Opened>,
    /// The traces of pages, with the last result of each page.
    pub traces: Tasks,
    pub sweeps: Tasks,
    pub attractors: Tasks,
}

impl Service {
    /// Answers a call.
    pub fn answer(self: &Arc<Self>, stream: &mut TcpStream, body: &[u8]) {
        let Ok(call) = serde_json::from_slice::<Call>(body) else {
            return http::refuse(stream, Refusal::Message);
        };
        let answered = match call {
            Call::Open {} => self.open(stream),
            Call::Example { name } => match example(&self.library, &name) {
                Some(setup) => json_of(stream, &json!({ "setup": setup })),
                None => json_of(stream, &trouble("there is no such example")),
            },
            Call::Trace { page, .. } | Call::Sweep { page, .. } | Call::Attractors { page, .. }
                if page.len() > ID =>
            {
                return http::refuse(stream, Refusal::Message);
            }
            Call::Trace { page, turn, setup } => self.trace(stream, &page, turn, *setup),
            Call::Stop { page } => {
                self.traces.pages.cancel(&page);
                json_of(stream, &json!({}))
            }
            Call::Sweep { page, turn, sweep } => {
                let work = move |kept: &Kept, token: &CancelToken, out: &Sender<Message>| {
                    sweeping::sweep(kept, &sweep, (token, out));
                };
                self.task(stream, (page, turn), |it| &it.sweeps, work)
            }
            Call::StopSweep { page } => {
                self.sweeps.pages.cancel(&page);
                json_of(stream, &json!({}))
            }
            Call::Attractors { page, turn, place } => {
                let work = move |kept: &Kept, token: &CancelToken, out: &Sender<Message>| {
                    attractors::attractors(kept, &place, (token, out));
                };
                self.task(stream, (page, turn), |it| &it.attractors, work)
            }
            Call::Settings { setup } => self.settings(stream, &setup),
            Call::Axes { page, x, y } => {
                let kept = self.traces.pages.turn_axes(&page, [x, y]);
                json_of_kept(stream, kept, |kept| json!({ "drawing": Drawing::of(kept) }))
            }
            Call::Point { page, at } => {
                json_of_kept(stream, self.traces.pages.kept(&page), |kept| {
                    match details(kept, at) {
                        Some(details) => json!({ "details": details }),
                        None => trouble(
                            "the selected point is not on the branches of the present result",
                        ),
                    }
                })
            }
            Call::Simulate { page, number, at, state, duration } => {
                self.simulate(stream, page, number, (at, state, duration))
            }
            Call::Field { page, at, states, ranges } => {
                self.message(stream, page, move |_, kept, _| {
                    Ok(json!({ "field": field(kept, at, (states, ranges))? }))
                })
            }
            Call::File { page, format } => self.file(stream, &page, &format),
            Call::Alive {} => json_of(stream, &json!({})),
        };
        // The page may have been closed.
        let _ = answered;
    }

    fn open(&self, stream: &mut TcpStream) -> std::io::Result<()> {
        let opened = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "setup": beginning(self.opened.as_ref()),
            "examples": self.library.examples(),
        });
        json_of(stream, &opened)
    }

    fn settings(&self, stream: &mut TcpStream, setup: &Setup) -> std::io::Result<()> {
        match settings(setup, &self.library) {
            Ok(settings) => json_of(stream, &json!({ "settings": settings })),
            Err(cause) => json_of(stream, &json!({ "trouble": Trouble::from(&cause) })),
        }
    }

    /// Sends the last result as a file.
    fn file(&self, stream: &mut TcpStream, page: &str, format: &str) -> std::io::Result<()> {
        let Some(kept) = self.traces.pages.kept(page) else {
            return json_of(stream, &trouble(NO_RESULT));
        };
        match rendered(&kept, format) {
            Ok((content_type, content)) => http::respond(stream, content_type, &content),
            Err(message) => json_of(stream, &trouble(message)),
        }
    }

    /// Traces the branches of a setup on a separate thread, and passes the messages of this
    /// computation to the page.
    fn trace(
        self: &Arc<Self>,
        stream: &mut TcpStream,
        page: &str,
        turn: u64,
        setup: Setup,
    ) -> std::io::Result<()> {
        let Some(cancel) = self.traces.pages.begin(page, turn) else {
            return json_of(stream, &json!({ "superseded": true }));
        };
        let (service, id) = (Arc::clone(self), page.to_string());
        stream_of(stream, (cancel, LONGEST), move |token, out| {
            let Some(_slot) = service.traces.slots.take(token) else { return };
            let (at, pages) = ((&service.library, service.opened.as_ref()), &service.traces.pages);
            if let Some(kept) = trace(&setup, at, (pages, &id), (token, out)) {
                pages.keep(&id, turn, kept);
            }
        })
    }

    /// Simulates from a state at the parameters of a point, and keeps the extremes of the history.
    fn simulate(
        self: &Arc<Self>,
        stream: &mut TcpStream,
        page: String,
        number: u64,
        (at, state, duration): (Point, Vec<(String, f64)>, f64),
    ) -> std::io::Result<()> {
        let id = page.clone();
        self.message(stream, page, move |service, kept, cancel| {
            let (simulated, history) = simulate(kept, at, (state, duration), cancel)?;
            let kept = service.traces.pages.add_history(&id, kept, (number, history));
            let bars = kept.map_or(Vec::new(), |kept| plane::bars(&kept));
            Ok(json!({ "simulated": simulated, "bars": bars }))
        })
    }

    /// Starts a computation, and cancels the earlier computation of the same kind: a page has at most one of each kind.
    fn task(
        self: &Arc<Self>,
        stream: &mut TcpStream,
        (page, turn): (String, u64),
        tasks: fn(&Service) -> &Tasks,
        work: impl FnOnce(&Kept, &CancelToken, &Sender<Message>) + Send + 'static,
    ) -> std::io::Result<()> {
        let Some(cancel) = tasks(self).pages.begin(&page, turn) else {
            return json_of(stream, &json!({ "superseded": true }));
        };
        self.on_kept(stream, (page, tasks), (cancel, LONGEST), move |_, kept, token, out| {
            work(kept, token, out);
        })
    }

    /// Computes one message from the last result of a page.
    fn message(
        self: &Arc<Self>,
        stream: &mut TcpStream,
        page: String,
        work: impl FnOnce(&Service, &Kept, &CancelToken) -> Result<Value, Trouble> + Send + 'static,
    ) -> std::io::Result<()> {
        let limits = (CancelToken::default(), plane::LONGEST);
        self.on_kept(stream, (page, |it| &it.traces), limits, move |service, kept, token, out| {
            let message = work(service, kept, token);
            let message = message.unwrap_or_else(|trouble| json!({ "failed": trouble }));
            // The page may have been closed.
            let _ = out.send(Message::of(&message));
        })
    }

    /// Runs a computation that uses the last result of a page on a separate thread, in a slot
    /// of the given tasks, and passes its messages to the page.
    fn on_kept(
        self: &Arc<Self>,
        stream: &mut TcpStream,
        (page, tasks): (String, fn(&Service) -> &Tasks),
        limits: (CancelToken, Duration),
        work: impl FnOnce(&Service, &Kept, &CancelToken, &Sender<Message>) + Send + 'static,
    ) -> std::io::Result<()> {
        let service = Arc::clone(self);
        stream_of(stream, limits, move |token, out| {
            let Some(_slot) = tasks(&service).slots.take(token) else { return };
            match service.traces.pages.kept(&page) {
                Some(kept) => work(&service, &kept, token, out),
                None => {
                    let none = json!({ "failed": Trouble::plain(NO_RESULT) });
                    let _ = out.send(Message::of(&none));
                }
            }
        })
    }
}

/// Answers with a stream of messages, which a separate thread computes; the computation is cancelled
/// after the time `longest`, or if the page closes the connection.
fn stream_of(
    stream: &mut TcpStream,
    (cancel, longest): (CancelToken, Duration),
    work: impl FnOnce(&CancelToken, &Sender<Message>) + Send + 'static,
) -> std::io::Result<()> {
    http::begin(stream, LINES)?;
    let ((out, messages), token) = (channel(), cancel.clone());
    let work = move || work(&token, &out);
    let thread = std::thread::Builder::new().stack_size(STACK).spawn(work)?;
    let passed = pass(stream, &messages, (&cancel, longest));
    if passed.is_err() {
        cancel.cancel();
        return passed;
    }
    // A result is kept before the page can ask for it.
    let end = match thread.join() {
        Ok(()) => json!({ "end": true }),
        Err(_) => {
            let trouble = Trouble::plain("the computation failed unexpectedly");
            json!({ "failed": trouble, "end": true })
        }
    };
    stream.write_all(Message::of(&end).line())
}

/// Passes messages to the page until the computation ends. The computation is cancelled if it takes
/// longer than the given time.
fn pass(
    stream: &mut TcpStream,
    messages: &Receiver<Message>,
    (cancel, longest): (&CancelToken, Duration),
) -> std::io::Result<()> {
    let begin = Instant::now();
    loop {
        match messages.recv_timeout(SILENCE) {
            Ok(message) => stream.write_all(message.line())?,
            // Blank lines show whether the page is still there.
            Err(RecvTimeoutError::Timeout) => stream.write_all(b"\n")?,
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
        if begin.elapsed() > longest {
            cancel.cancel();
        }
    }
}

fn trouble(message: impl Into<String>) -> Value {
    json!({ "trouble": Trouble::plain(message) })
}

fn json_of(stream: &mut TcpStream, value: &Value) -> std::io::Result<()> {
    http::respond(stream, JSON, value.to_string().as_bytes())
}

/// Sends a response that is made from the last result of a page.
fn json_of_kept(
    stream: &mut TcpStream,
    kept: Option<Arc<Kept>>,
    value: impl FnOnce(&Kept) -> Value,
) -> std::io::Result<()> {
    json_of(stream, &kept.map_or_else(|| trouble(NO_RESULT), |kept| value(&kept)))
}

/// The error of a request for the result of a page that has no result yet.
const NO_RESULT: &str = "the page has no result: trace the scene again";

/// Returns a result as a file, with the media type of the file's content.
fn rendered(kept: &Kept, format: &str) -> Result<(&'static str, Vec<u8>), String> {
    if format == "scene" {
        return Ok(("text/plain; charset=utf-8", (kept.scene.to_ron() + "\n").into_bytes()));
    }
    let (format, content_type) = match format {
        "svg" => (Format::Svg, "image/svg+xml"),
        "pdf" => (Format::Pdf, "application/pdf"),
        "html" => (Format::Html, "application/octet-stream"),
        "csv" => (Format::Csv, "text/csv; charset=utf-8"),
        "json" => (Format::Json, "application/octet-stream"),
        "ron" => (Format::Ron, "text/plain; charset=utf-8"),
        _ => return Err("there is no such format".into()),
    };
    let documents = [(kept.name.as_str(), &*kept.document)];
    let is_picture = matches!(format, Format::Svg | Format::Pdf | Format::Html);
    let [x, y] = [0, 1].map(|axis| kept.axes[axis].as_deref().filter(|_| is_picture));
    let results = Results { documents: &documents, x, y: y.as_slice(), ..Results::default() };
    let content = results.render(format).map_err(|cause| one_line(&cause))?;
    Ok((content_type, content))
}
