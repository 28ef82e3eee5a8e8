//! Arrays in NumPy's file format (`.npy`), each with one column of numbers.
//!
//! A file begins with `\x93NUMPY`, two bytes for the version, the length of the header (two bytes
//! in version 1, four from version 2 on, little-endian), and the header itself. The header is a
//! Python dictionary, such as `{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }`, followed
//! by blanks and a line break, so that the numbers begin at a multiple of 64 bytes (R. Kern, *NumPy
//! Enhancement Proposal 1*, 2007; `numpy.lib.format`). Files are written in version 1 of the
//! format.

const MAGIC: &[u8] = b"\x93NUMPY";

/// The position in the file of the first number of a column is a multiple of this number of bytes.
const ALIGNMENT: usize = 64;

/// A type of the numbers in a column.
pub(super) trait Element: Sized {
    /// The name of this type of numbers in NumPy.
    const TYPE: &str;
    /// The number of bytes of one number.
    const SIZE: usize;
    /// Appends the bytes of the number to a file's content.
    fn write(self, bytes: &mut Vec<u8>);
    /// Returns the number with the given [`SIZE`](Self::SIZE) bytes.
    fn read(bytes: &[u8]) -> Self;
}

impl Element for u8 {
    const TYPE: &str = "|u1";
    const SIZE: usize = 1;

    fn write(self, bytes: &mut Vec<u8>) {
        bytes.push(self);
    }

    fn read(bytes: &[u8]) -> Self {
        bytes.first().copied().unwrap_or_default()
    }
}

impl Element for f64 {
    const TYPE: &str = "<f8";
    const SIZE: usize = 8;

    fn write(self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }

    fn read(bytes: &[u8]) -> Self {
        bytes.first_chunk().map_or(f64::NAN, |bytes| f64::from_le_bytes(*bytes))
    }
}

/// The error of a file that does not contain a column of numbers of the required type.
#[derive(Debug, miette::Diagnostic, thiserror::Error)]
pub(super) enum ColumnError {
    #[error("the entry of the archive is not an array in NumPy's format")]
    Format,
    #[error("the header of the array has no readable field `{0}`")]
    Header(&'static str),
    #[error(
        "the array contains numbers of the type `{found}`, but a column must contain `{wanted}`"
    )]
    Type { found: String, wanted: &'static str },
    #[error(
        "a column must have one axis, but this array has {} axes", if *.0 == 0 { "no" } else { "several" }
    )]
    Axes(usize),
    #[error("the header states {stated} numbers of {size} bytes, but {bytes} bytes follow")]
    Length { stated: usize, size: usize, bytes: usize },
}

/// Returns the content of a file that stores a column of numbers.
pub(super) fn to_npy<T: Element>(values: impl Iterator<Item = T>) -> Vec<u8> {
    let mut numbers = Vec::new();
    values.for_each(|value| value.write(&mut numbers));
    let length = numbers.len() / T::SIZE;
    let header =
        format!("{{'descr': '{}', 'fortran_order': False, 'shape': ({length},), }}", T::TYPE);
    let start = (MAGIC.len() + 4 + header.len() + 1).next_multiple_of(ALIGNMENT);
    let padded = start - MAGIC.len() - 4;
    let mut bytes = [MAGIC, &[1, 0], &(padded as u16).to_le_bytes()].concat();
    bytes.extend(format!("{header:<width$}\n", width = padded - 1).bytes());
    bytes.extend(numbers);
    bytes
}

/// Returns the numbers of a column from the content of its file.
///
/// # Errors
/// [`ColumnError`] if the file is not a complete one-dimensional array of numbers of this type.
pub(super) fn from_npy<T: Element>(bytes: &[u8]) -> Result<Vec<T>, ColumnError> {
    let (header, numbers) = parts(bytes).ok_or(ColumnError::Format)?;
    let found = value(header, "descr").and_then(|text| text.strip_prefix('\''));
    let found =
        found.and_then(|text| text.split('\'').next()).ok_or(ColumnError::Header("descr"))?;
    if found != T::TYPE {
        return Err(ColumnError::Type { found: found.chars().take(20).collect(), wanted: T::TYPE });
    }
    let shape = value(header, "shape").and_then(|text| text.strip_prefix('('));
    let (shape, _) = shape.and_then(|s| s.split_once(')')).ok_or(ColumnError::Header("shape"))?;
    let lengths: Vec<&str> = shape.split(',').map(str::trim).filter(|l| !l.is_empty()).collect();
    let [length] = lengths[..] else { return Err(ColumnError::Axes(lengths.len())) };
    let stated: usize = length.parse().map_err(|_| ColumnError::Header("shape"))?;
    if stated.checked_mul(T::SIZE) != Some(numbers.len()) {
        return Err(ColumnError::Length { stated, size: T::SIZE, bytes: numbers.len() });
    }
    Ok(numbers.chunks_exact(T::SIZE).map(T::read).collect())
}

/// Returns the header of a file, and the bytes after the header.
fn parts(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let rest = bytes.strip_prefix(MAGIC)?;
    let (version, rest) = rest.split_at_checked(2)?;
    let (length, rest) = match version[0] {
        1 => (usize::from(u16::from_le_bytes(*rest.first_chunk()?)), &rest[2..]),
        _ => (u32::from_le_bytes(*rest.first_chunk()?) as usize, &rest[4..]),
    };
    let (header, numbers) = rest.split_at_checked(length)?;
    Some((std::str::from_utf8(header).ok()?, numbers))
}

/// Returns the text of the entry with a given key in the header of a file.
fn value<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let (_, rest) = header.split_once(&format!("'{key}'"))?;
    Some(rest.trim_start().strip_prefix(':')?.trim_start())
}
