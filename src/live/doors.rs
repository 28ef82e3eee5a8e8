//! The open connections: at the limit of their number, a connection that sent no request is closed.

use std::net::{Shutdown, TcpStream};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The maximum number of connections.
const MOST: usize = 64;

/// The open connections, in the order in which they came.
#[derive(Clone, Default)]
pub(super) struct Doors(Arc<Mutex<Open>>);

#[derive(Default)]
struct Open {
    last: u64,
    connections: Vec<Connection>,
}

struct Connection {
    number: u64,
    stream: TcpStream,
    /// Whether the request has arrived.
    has_asked: bool,
}

/// A connection that is let in; it leaves when this value is dropped.
pub(super) struct Guest {
    doors: Doors,
    number: u64,
}

impl Doors {
    fn open(&self) -> MutexGuard<'_, Open> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets a connection in. If there are too many, the oldest one without a request is closed;
    /// `None` if all have requests.
    pub fn admit(&self, stream: &TcpStream) -> Option<Guest> {
        let copy = stream.try_clone().ok()?;
        let mut open = self.open();
        if open.connections.len() >= MOST {
            let idle = open.connections.iter().position(|it| !it.has_asked)?;
            let idle = open.connections.remove(idle);
            let _ = idle.stream.shutdown(Shutdown::Both);
        }
        open.last += 1;
        let number = open.last;
        open.connections.push(Connection { number, stream: copy, has_asked: false });
        Some(Guest { doors: self.clone(), number })
    }
}

impl Guest {
    /// Records that the request has arrived.
    pub fn has_asked(&self) {
        let mut open = self.doors.open();
        let own = open.connections.iter_mut().find(|it| it.number == self.number);
        own.into_iter().for_each(|it| it.has_asked = true);
    }
}

impl Drop for Guest {
    fn drop(&mut self) {
        self.doors.open().connections.retain(|it| it.number != self.number);
    }
}
