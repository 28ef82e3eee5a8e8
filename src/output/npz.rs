//! Archives of arrays for NumPy.

use npyz::WriterBuilder;
use std::io::{Cursor, Write};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// An archive that is being written.
pub(super) struct Npz(ZipWriter<Cursor<Vec<u8>>>);

impl Npz {
    pub fn new() -> Self {
        Npz(ZipWriter::new(Cursor::new(Vec::new())))
    }

    /// Adds an array of one axis.
    pub fn add<T: npyz::AutoSerialize>(
        &mut self,
        name: &str,
        values: impl Iterator<Item = T>,
    ) -> Result<(), String> {
        let array = || -> std::io::Result<Vec<u8>> {
            let mut bytes = Vec::new();
            let options = npyz::WriteOptions::new().default_dtype();
            let mut writer = options.writer(Cursor::new(&mut bytes)).begin_1d()?;
            writer.extend(values)?;
            writer.finish()?;
            Ok(bytes)
        };
        let bytes = array().map_err(|error| error.to_string())?;
        let options = SimpleFileOptions::default().large_file(bytes.len() > u32::MAX as usize / 2);
        self.0.start_file(format!("{name}.npy"), options).map_err(|error| error.to_string())?;
        self.0.write_all(&bytes).map_err(|error| error.to_string())
    }

    /// The bytes of the archive.
    pub fn finish(self) -> Result<Vec<u8>, String> {
        Ok(self.0.finish().map_err(|error| error.to_string())?.into_inner())
    }
}
