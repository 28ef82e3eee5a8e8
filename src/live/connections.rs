//! The open connections of the server: if their number has reached the limit, a connection that has
//! not sent a request is closed.

use std::net::{Shutdown, TcpStream};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The maximum number of open connections.
const MOST: usize = 64;

/// The open connections, in the order in which they were accepted.
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
    /// Whether the connection has sent its request.
    has_request: bool,
}

/// An accepted connection to the server, which is removed from the list of open connections when
/// this value is dropped.
pub(super) struct Connection {
    all: Connections,
    number: u64,
}

impl Connections {
    fn open(&self) -> MutexGuard<'_, Open> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Accepts a connection. If the number of open connections has reached the limit, closes the
    /// oldest connection that has not sent a request; returns `None` if all connections have sent
    /// requests.
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
    /// Records that the connection has sent its request.
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
