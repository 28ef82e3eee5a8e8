//! A standard output that tolerates a closed pipe.

use std::io::{ErrorKind, Result, Write};

/// A wrapper of a stream that discards further output after the reader of the stream, for example
/// `head`, has closed the pipe.
pub struct Leavable<W> {
    inner: W,
    left: bool,
}

impl<W: Write> Leavable<W> {
    pub fn new(inner: W) -> Self {
        Leavable { inner, left: false }
    }

    /// Returns the result of a write operation, or `instead` if the reader has closed the pipe.
    fn unless_left<T>(&mut self, instead: T, run: impl FnOnce(&mut W) -> Result<T>) -> Result<T> {
        if self.left {
            return Ok(instead);
        }
        match run(&mut self.inner) {
            Err(cause) if cause.kind() == ErrorKind::BrokenPipe => {
                self.left = true;
                Ok(instead)
            }
            outcome => outcome,
        }
    }
}

impl<W: Write> Write for Leavable<W> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        self.unless_left(bytes.len(), |inner| inner.write(bytes))
    }

    fn flush(&mut self) -> Result<()> {
        self.unless_left((), W::flush)
    }
}
