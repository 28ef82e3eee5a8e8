//! The web server: accepts connections, and sends the files of the page and the responses to calls.

use super::calls::Service;
use super::connections::Connections;
use super::http::{self, Incoming, Refusal};
use super::library::Library;
use super::opened::Opened;
use super::pages::Tasks;
use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::time::Duration;

/// The pause after a connection could not be accepted, for example because the process has no free
/// file descriptors.
const PAUSE: Duration = Duration::from_millis(50);

/// The files of the page, each with its name, its media type and its content.
const FILES: [(&str, &str, &str); 13] = [
    ("", "text/html; charset=utf-8", include_str!("../../assets/live/page.html")),
    ("page.css", "text/css; charset=utf-8", include_str!("../../assets/live/page.css")),
    ("page.js", SCRIPT, include_str!("../../assets/live/page.js")),
    ("server.js", SCRIPT, include_str!("../../assets/live/server.js")),
    ("state.js", SCRIPT, include_str!("../../assets/live/state.js")),
    ("controls.js", SCRIPT, include_str!("../../assets/live/controls.js")),
    ("request.js", SCRIPT, include_str!("../../assets/live/request.js")),
    ("figure.js", SCRIPT, include_str!("../../assets/live/figure.js")),
    ("key.js", SCRIPT, include_str!("../../assets/live/key.js")),
    ("plane.js", SCRIPT, include_str!("../../assets/live/plane.js")),
    ("sweep.js", SCRIPT, include_str!("../../assets/live/sweep.js")),
    ("attractors.js", SCRIPT, include_str!("../../assets/live/attractors.js")),
    ("results.js", SCRIPT, include_str!("../../assets/live/results.js")),
];

const SCRIPT: &str = "text/javascript; charset=utf-8";

/// A server on the loopback interface, whose address contains a random token.
pub struct Server {
    listener: TcpListener,
    at: SocketAddr,
    token: String,
    service: Arc<Service>,
}

impl Server {
    /// Creates a server on the given port, or on a free port for port 0; `opened` is the scene that
    /// pages show first. The server accepts connections from now on, and [`serve`](Self::serve)
    /// answers their requests.
    ///
    /// ```
    /// use tangency::live::{Server, Library};
    /// use tangency::{Catalogue, output::SizeLimit};
    /// let library = Library { catalogue: Catalogue::built_in(), folder: None, limit: SizeLimit::default() };
    /// let server = Server::new(library, None, 0)?;
    /// assert!(server.address().starts_with("http://127.0.0.1:"));
    /// # Ok::<(), std::io::Error>(())
    /// ```
    ///
    /// # Errors
    /// The error of the operating system if the port is in use, or if no random numbers are
    /// available for the token.
    pub fn new(library: Library, opened: Option<Opened>, port: u16) -> io::Result<Self> {
        let mut random = [0; 16];
        getrandom::fill(&mut random).map_err(io::Error::other)?;
        let token = random.iter().map(|byte| format!("{byte:02x}")).collect();
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        let at = listener.local_addr()?;
        let service = Arc::new(Service {
            library,
            opened,
            traces: Tasks::new(),
            sweeps: Tasks::new(),
            attractors: Tasks::new(),
        });
        Ok(Server { listener, at, token, service })
    }

    /// Returns the address of the page.
    pub fn address(&self) -> String {
        format!("http://{}/{}/", self.at, self.token)
    }

    /// Answers the requests of pages until the program ends.
    pub fn serve(self) -> ! {
        let connections = Connections::default();
        let Server { listener, at, token, service } = self;
        let access = Arc::new(Access { port: at.port(), token, service });
        loop {
            let Ok((mut stream, _)) = listener.accept() else {
                std::thread::sleep(PAUSE);
                continue;
            };
            let Some(connection) = connections.accept(&stream) else {
                http::refuse(&mut stream, Refusal::Busy);
                continue;
            };
            let access = Arc::clone(&access);
            let answer = move || {
                match http::read(&mut stream) {
                    Ok(incoming) => {
                        connection.received();
                        access.answer(&mut stream, &incoming);
                    }
                    Err(Refusal::Closed) => {}
                    Err(refusal) => http::refuse(&mut stream, refusal),
                }
                drop(connection);
            };
            // Without a thread, the connection closes.
            if std::thread::Builder::new().spawn(answer).is_err() {
                std::thread::sleep(PAUSE);
            }
        }
    }
}

/// Rejects every request that does not come from the page of this server.
struct Access {
    port: u16,
    token: String,
    service: Arc<Service>,
}

impl Access {
    fn answer(&self, stream: &mut TcpStream, incoming: &Incoming) {
        let sent = match self.file_or_call(incoming) {
            Ok(Some((content_type, content))) => {
                http::respond(stream, content_type, content.as_bytes())
            }
            Ok(None) => {
                self.service.answer(stream, &incoming.body);
                Ok(())
            }
            Err(refusal) => {
                http::refuse(stream, refusal);
                Ok(())
            }
        };
        // The page may have been closed.
        let _ = sent;
    }

    /// Returns the requested file of the page, or `None` if the request is a call of the page
    /// instead of a file.
    fn file_or_call(
        &self,
        incoming: &Incoming,
    ) -> Result<Option<(&'static str, &'static str)>, Refusal> {
        let hosts = ["127.0.0.1", "localhost"].map(|host| format!("{host}:{}", self.port));
        // A page of another server may use a name that leads to this one.
        if !incoming.host.as_ref().is_some_and(|host| hosts.contains(host)) {
            return Err(Refusal::Foreign);
        }
        let own = |origin: &String| hosts.iter().any(|host| *origin == format!("http://{host}"));
        if !incoming.origin.as_ref().is_none_or(own) {
            return Err(Refusal::Foreign);
        }
        let path = incoming.path.strip_prefix('/').unwrap_or_default();
        let (token, name) = path.split_once('/').ok_or(Refusal::Unknown)?;
        if !is_equal(token, &self.token) {
            return Err(Refusal::Unknown);
        }
        match (incoming.method.as_str(), name) {
            ("GET", name) => {
                let file = FILES.iter().find(|(known, ..)| *known == name);
                let (_, content_type, content) = file.ok_or(Refusal::Unknown)?;
                Ok(Some((content_type, content)))
            }
            ("POST", "call") => {
                let is_json = incoming.content_type.as_deref() == Some("application/json");
                match is_json && incoming.origin.is_some() {
                    true => Ok(None),
                    false => Err(Refusal::Foreign),
                }
            }
            ("POST", _) => Err(Refusal::Unknown),
            _ => Err(Refusal::Method),
        }
    }
}

/// Compares two tokens in a time that does not depend on the number of equal letters.
fn is_equal(given: &str, token: &str) -> bool {
    let differ = given.bytes().zip(token.bytes()).fold(0, |differ, (a, b)| differ | (a ^ b));
    given.len() == token.len() && differ == 0
}
