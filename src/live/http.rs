//! HTTP/1.1 requests and responses: each connection carries one request, and is closed after the
//! response.

use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// The maximum size in bytes of the request line and the headers of a request.
const HEAD: usize = 16 << 10;
/// The maximum number of headers of a request.
const HEADERS: usize = 64;
/// The maximum size in bytes of the body of a request.
const BODY: usize = 4 << 20;
/// The time within which a client must send its request.
const ARRIVAL: Duration = Duration::from_secs(10);
/// The time within which a client must read its response.
const DEPARTURE: Duration = Duration::from_secs(20);
/// The maximum number of bytes, and the maximum time, for which the server reads the rest of a
/// refused request, so that the client sees the response.
const REST: (usize, Duration) = (1 << 20, Duration::from_millis(200));

/// A request.
#[derive(Debug, Default)]
pub(super) struct Incoming {
    pub method: String,
    pub path: String,
    pub host: Option<String>,
    pub origin: Option<String>,
    pub content_type: Option<String>,
    pub body: Vec<u8>,
}

/// The reason why a request is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum Refusal {
    #[error("the connection is closed")]
    Closed,
    #[error("the request is not complete")]
    Late,
    #[error("the request is not HTTP/1.1")]
    Malformed,
    #[error("the headers are too long")]
    LongHead,
    #[error("the body of the request is longer than 4 MB, or its length is not given")]
    LongBody,
    #[error("the requested page does not exist: open the address that the program printed")]
    Unknown,
    #[error("requests come only from the page of this program")]
    Foreign,
    #[error("the method of the request must be GET or POST")]
    Method,
    #[error("the message is not understood")]
    Message,
    #[error("too many connections")]
    Busy,
}

impl Refusal {
    /// Returns the HTTP status of the response to the refused request.
    pub fn status(self) -> &'static str {
        match self {
            Refusal::Closed | Refusal::Malformed | Refusal::Message => "400 Bad Request",
            Refusal::Late => "408 Request Timeout",
            Refusal::LongHead => "431 Request Header Fields Too Large",
            Refusal::LongBody => "413 Content Too Large",
            Refusal::Unknown => "404 Not Found",
            Refusal::Foreign => "403 Forbidden",
            Refusal::Method => "405 Method Not Allowed",
            Refusal::Busy => "503 Service Unavailable",
        }
    }
}

/// Reads a request.
pub(super) fn read(stream: &mut TcpStream) -> Result<Incoming, Refusal> {
    let deadline = Instant::now() + ARRIVAL;
    let mut bytes = Vec::new();
    let (mut incoming, begin, length) = loop {
        if let Some(head) = head(&bytes)? {
            break head;
        }
        if bytes.len() >= HEAD {
            return Err(Refusal::LongHead);
        }
        more(stream, &mut bytes, HEAD, deadline)?;
    };
    if length > BODY {
        return Err(Refusal::LongBody);
    }
    while bytes.len() < begin + length {
        more(stream, &mut bytes, begin + length, deadline)?;
    }
    incoming.body = bytes[begin..begin + length].to_vec();
    Ok(incoming)
}

/// Returns the request without its body, the position at which the body begins, and the length of
/// the body; `None` if the headers are not complete.
fn head(bytes: &[u8]) -> Result<Option<(Incoming, usize, usize)>, Refusal> {
    let mut headers = [httparse::EMPTY_HEADER; HEADERS];
    let mut request = httparse::Request::new(&mut headers);
    let begin = match request.parse(bytes) {
        Ok(httparse::Status::Complete(begin)) => begin,
        Ok(httparse::Status::Partial) => return Ok(None),
        Err(httparse::Error::TooManyHeaders) => return Err(Refusal::LongHead),
        Err(_) => return Err(Refusal::Malformed),
    };
    let (Some(method), Some(path)) = (request.method, request.path) else {
        return Err(Refusal::Malformed);
    };
    let mut incoming = Incoming { method: method.into(), path: path.into(), ..Incoming::default() };
    let mut length = None;
    for header in request.headers.iter() {
        let value = std::str::from_utf8(header.value).map_err(|_| Refusal::Malformed)?;
        let place = match header.name.to_ascii_lowercase().as_str() {
            "host" => &mut incoming.host,
            "origin" => &mut incoming.origin,
            "content-type" => &mut incoming.content_type,
            "content-length" => &mut length,
            // The length must be known before the body arrives.
            "transfer-encoding" => return Err(Refusal::LongBody),
            _ => continue,
        };
        // A header that is given twice has no clear meaning.
        if place.replace(value.to_string()).is_some() {
            return Err(Refusal::Malformed);
        }
    }
    let is_number = |text: &&str| text.bytes().all(|byte| byte.is_ascii_digit());
    let length = match length.as_deref() {
        None => 0,
        Some(text) => {
            let digits = Some(text).filter(is_number).ok_or(Refusal::Malformed)?;
            digits.parse().map_err(|_| Refusal::LongBody)?
        }
    };
    Ok(Some((incoming, begin, length)))
}

/// Reads bytes from the connection until the given total number of bytes has been read.
fn more(
    stream: &mut TcpStream,
    bytes: &mut Vec<u8>,
    most: usize,
    deadline: Instant,
) -> Result<(), Refusal> {
    let left = deadline.saturating_duration_since(Instant::now());
    if left.is_zero() || stream.set_read_timeout(Some(left)).is_err() {
        return Err(Refusal::Late);
    }
    let mut part = [0; 16 << 10];
    let room = part.len().min(most - bytes.len());
    match stream.read(&mut part[..room]) {
        Ok(0) => Err(Refusal::Closed),
        Ok(count) => {
            bytes.extend_from_slice(&part[..count]);
            Ok(())
        }
        Err(error) if error.kind() == ErrorKind::Interrupted => Ok(()),
        Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
            Err(Refusal::Late)
        }
        Err(_) => Err(Refusal::Closed),
    }
}

/// The headers of every response: the browser must not store the response, show it in a frame, or
/// load resources from other servers.
const RULES: &str = "Cache-Control: no-store\r\n\
    Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; \
    img-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n\
    Cross-Origin-Resource-Policy: same-origin\r\n\
    Referrer-Policy: no-referrer\r\n\
    X-Content-Type-Options: nosniff\r\n\
    Connection: close\r\n";

/// Begins a response of unknown length, which ends when the connection is closed.
pub(super) fn begin(stream: &mut TcpStream, content_type: &str) -> std::io::Result<()> {
    stream.set_write_timeout(Some(DEPARTURE))?;
    stream.set_nodelay(true)?;
    write!(stream, "HTTP/1.1 200 OK\r\nContent-Type: {content_type}\r\n{RULES}\r\n")
}

/// Sends a response with the given content.
pub(super) fn respond(
    stream: &mut TcpStream,
    content_type: &str,
    content: &[u8],
) -> std::io::Result<()> {
    answer(stream, "200 OK", content_type, content)
}

/// Refuses a request.
pub(super) fn refuse(stream: &mut TcpStream, refusal: Refusal) {
    let text = format!("{refusal}\n");
    let answered = answer(stream, refusal.status(), "text/plain; charset=utf-8", text.as_bytes());
    if answered.is_ok() {
        let _ = stream.shutdown(std::net::Shutdown::Write);
        leave(stream);
    }
}

/// Reads the rest of a refused request for a short time, so that the client sees the response.
fn leave(stream: &mut TcpStream) {
    let (most, time) = REST;
    let deadline = Instant::now() + time;
    let (mut bytes, mut count) = (Vec::new(), 0);
    while count < most && more(stream, &mut bytes, 1 << 16, deadline).is_ok() {
        count += bytes.len();
        bytes.clear();
    }
}

fn answer(
    stream: &mut TcpStream,
    status: &str,
    content_type: &str,
    content: &[u8],
) -> std::io::Result<()> {
    stream.set_write_timeout(Some(DEPARTURE))?;
    stream.set_nodelay(true)?;
    let length = content.len();
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {content_type}\r\nContent-Length: {length}\r\n{RULES}\r\n"
    );
    stream.write_all(&[head.as_bytes(), content].concat())
}
