//! The open connections: at the limit of their number, a connection that sent no request is closed.

use std::net::{Shutdown, TcpStream};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The maximum number of connections.
const MOST: usize = 64;

/// The open connections, in the order of their arrival.
#[derive(Clone, Default)]
pub(super) struct Connections(Arc<Mutex<Open>>);

#[derive(Default)]
struct Open {
    last: u64,
    connections: Vec<Listed>,
}

struct Listed {
    number: u64,
    stream: TcpStream,
    /// Whether the request has arrived.
    has_request: bool,
}

/// An accepted connection, which leaves the list when this value is dropped.
pub(super) struct Connection {
    all: Connections,
    number: u64,
}

impl Connections {
    fn open(&self) -> MutexGuard<'_, Open> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Accepts a connection. At the limit, the oldest connection without a request is closed;
    /// `None` if all connections have requests.
    pub fn accept(&self, stream: &TcpStream) -> Option<Connection> {
        let copy = stream.try_clone().ok()?;
        let mut open = self.open();
        if open.connections.len() >= MOST {
            let idle = open.connections.iter().position(|it| !it.has_request)?;
            let idle = open.connections.remove(idle);
            let _ = idle.stream.shutdown(Shutdown::Both);
        }
        open.last += 1;
        let number = open.last;
        open.connections.push(Listed { number, stream: copy, has_request: false });
        Some(Connection { all: self.clone(), number })
    }
}

impl Connection {
    /// Records that the request has arrived.
    pub fn received(&self) {
        let mut open = self.all.open();
        let own = open.connections.iter_mut().find(|it| it.number == self.number);
        own.into_iter().for_each(|it| it.has_request = true);
    }
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.all.open().connections.retain(|it| it.number != self.number);
    }
}
