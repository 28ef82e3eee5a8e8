//! Archives of NumPy arrays.

use super::npy::{Element, to_npy};
use std::io::{Cursor, Write};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// An archive that is being written.
pub(super) struct Npz(ZipWriter<Cursor<Vec<u8>>>);

impl Npz {
    pub fn new() -> Self {
        Npz(ZipWriter::new(Cursor::new(Vec::new())))
    }

    /// Adds a one-dimensional array to the archive.
    pub fn add<T: Element>(
        &mut self,
        name: &str,
        values: impl Iterator<Item = T>,
    ) -> Result<(), String> {
        self.add_file(&format!("{name}.npy"), &to_npy(values))
    }

    fn add_file(&mut self, name: &str, bytes: &[u8]) -> Result<(), String> {
        let options = SimpleFileOptions::default().large_file(bytes.len() > u32::MAX as usize / 2);
        self.0.start_file(name, options).map_err(|error| error.to_string())?;
        self.0.write_all(bytes).map_err(|error| error.to_string())
    }

    /// Returns all bytes of the finished archive.
    pub fn finish(self) -> Result<Vec<u8>, String> {
        Ok(self.0.finish().map_err(|error| error.to_string())?.into_inner())
    }
}
