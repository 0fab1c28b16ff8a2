//! Scalars for TensorBoard.
//!
//! An event file is a sequence of records: length (u64), masked CRC-32C of the length, data, masked CRC-32C of the data,
//! little endian. The data is a protocol buffer `Event { 1: wall_time double, 2: step int64, 3: file_version string,
//! 5: summary { 1: value { 1: tag string, 2: simple_value float } } }`, written by hand here: three kinds of field.

use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use crc32c::crc32c;

use crate::files::IoError;

/// An event file open for appending.
#[derive(Debug)]
pub struct EventFile {
    path: PathBuf,
    file: File,
}

impl EventFile {
    /// Starts a file in `folder`.
    pub fn create(folder: &Path) -> Result<Self, IoError> {
        let path = folder.join(format!("events.out.tfevents.{:010}.myo", now_s() as u64));
        let error = |source| IoError::new("create", &path, source);
        fs::create_dir_all(folder).map_err(error)?;
        let file = OpenOptions::new().create_new(true).append(true).open(&path).map_err(error)?;
        Self { path, file }.with_version()
    }

    /// Goes on with the file in `folder` after the events of `step`; later ones are cut off, as is a torn end.
    pub fn resume(folder: &Path, step: u64) -> Result<Self, IoError> {
        let Some(path) = find(folder)? else { return Self::create(folder) };
        let error = |source| IoError::new("continue", &path, source);
        let bytes = fs::read(&path).map_err(error)?;
        let keep: usize = records(&bytes).take_while(|data| event_step(data) <= step).map(|data| data.len() + 16).sum();
        let file = OpenOptions::new().append(true).open(&path).map_err(error)?;
        file.set_len(keep as u64).map_err(error)?;
        let events = Self { path, file };
        if keep == 0 { events.with_version() } else { Ok(events) }
    }

    /// Writes the event that every file begins with.
    fn with_version(mut self) -> Result<Self, IoError> {
        let mut event = wall_time();
        bytes_field(&mut event, 3, b"brain.Event:2");
        self.append(&event)?;
        Ok(self)
    }

    fn append(&mut self, event: &[u8]) -> Result<(), IoError> {
        self.file.write_all(&record(event)).map_err(|source| IoError::new("append to", &self.path, source))
    }

    /// Appends scalars at a step in one write; NaN ones are left out.
    pub fn write<'a>(&mut self, step: u64, scalars: impl Iterator<Item = (&'a str, f64)>) -> Result<(), IoError> {
        let mut summary = Vec::new();
        for (tag, x) in scalars.filter(|(_, x)| !x.is_nan()) {
            let mut value = Vec::new();
            bytes_field(&mut value, 1, tag.as_bytes());
            value.push(2 << 3 | 5);
            value.extend((x as f32).to_le_bytes());
            bytes_field(&mut summary, 1, &value);
        }
        let mut event = wall_time();
        event.push(2 << 3);
        varint(&mut event, step);
        bytes_field(&mut event, 5, &summary);
        self.append(&event)
    }
}

/// The event file that this program wrote in a folder; the last one by name where there are several.
fn find(folder: &Path) -> Result<Option<PathBuf>, IoError> {
    let error = |source| IoError::new("read", folder, source);
    let entries = match fs::read_dir(folder) {
        Err(source) if source.kind() == ErrorKind::NotFound => return Ok(None),
        entries => entries.map_err(error)?,
    };
    let mut paths = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>, _>>().map_err(error)?;
    let is_ours = |name: &str| name.starts_with("events.out.tfevents.") && name.ends_with(".myo");
    paths.retain(|path| path.file_name().is_some_and(|name| is_ours(&name.to_string_lossy())));
    paths.sort();
    Ok(paths.pop())
}

fn now_s() -> f64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |time| time.as_secs_f64())
}

/// The beginning of every event.
fn wall_time() -> Vec<u8> {
    let mut event = vec![1 << 3 | 1];
    event.extend(now_s().to_le_bytes());
    event
}

fn varint(out: &mut Vec<u8>, mut x: u64) {
    while x >= 0x80 {
        out.push(x as u8 | 0x80);
        x >>= 7;
    }
    out.push(x as u8);
}

fn bytes_field(out: &mut Vec<u8>, field: u8, bytes: &[u8]) {
    out.push(field << 3 | 2);
    varint(out, bytes.len() as u64);
    out.extend(bytes);
}

/// The format masks its checksums, so that a checksum of data that holds checksums stays useful.
fn masked_crc(bytes: &[u8]) -> [u8; 4] {
    crc32c(bytes).rotate_right(15).wrapping_add(0xA282_EAD8).to_le_bytes()
}

fn record(data: &[u8]) -> Vec<u8> {
    let length = (data.len() as u64).to_le_bytes();
    [&length, &masked_crc(&length)[..], data, &masked_crc(data)].concat()
}

/// Data of the records of a file, up to the first that is torn or damaged.
fn records(mut bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    std::iter::from_fn(move || {
        let (header, rest) = bytes.split_first_chunk::<12>()?;
        let length = u64::from_le_bytes(*header.first_chunk()?);
        let (data, rest) = rest.split_at_checked(usize::try_from(length).ok()?)?;
        let (checksum, rest) = rest.split_first_chunk::<4>()?;
        bytes = rest;
        (header[8..] == masked_crc(&header[..8]) && *checksum == masked_crc(data)).then_some(data)
    })
}

/// Step of an event written here: after the tag and the 8 bytes of the wall time comes the step, or something else.
fn event_step(data: &[u8]) -> u64 {
    if data.get(9) != Some(&(2 << 3)) {
        return 0;
    }
    let digits = data[10..].iter().take(10).enumerate();
    let mut step = 0;
    for (index, byte) in digits {
        step |= u64::from(byte & 0x7f) << (7 * index);
        if byte & 0x80 == 0 {
            break;
        }
    }
    step
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_varint(bytes: &mut &[u8]) -> u64 {
        let mut x = 0;
        for shift in (0..).step_by(7) {
            let byte = bytes[0];
            *bytes = &bytes[1..];
            x |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                break;
            }
        }
        x
    }

    /// Number and contents of every field of a message; those of a varint are its eight bytes.
    fn fields(mut message: &[u8]) -> Vec<(u64, Vec<u8>)> {
        let mut out = Vec::new();
        while !message.is_empty() {
            let tag = read_varint(&mut message);
            let length = match tag & 7 {
                0 => {
                    out.push((tag >> 3, read_varint(&mut message).to_le_bytes().to_vec()));
                    continue;
                }
                1 => 8,
                2 => read_varint(&mut message) as usize,
                5 => 4,
                kind => panic!("field of kind {kind}"),
            };
            out.push((tag >> 3, message[..length].to_vec()));
            message = &message[length..];
        }
        out
    }

    /// Tag and value of every scalar of an event.
    fn scalars(event: &[u8]) -> Vec<(String, f32)> {
        let summary = fields(event).into_iter().find(|(number, _)| *number == 5).map_or(Vec::new(), |(_, bytes)| bytes);
        let scalar = |value: &[u8]| {
            let value = fields(value);
            assert_eq!([value[0].0, value[1].0], [1, 2]);
            (String::from_utf8(value[0].1.clone()).unwrap(), f32::from_le_bytes(*value[1].1.first_chunk().unwrap()))
        };
        fields(&summary).iter().map(|(_, value)| scalar(value)).collect()
    }

    fn read(folder: &Path) -> Vec<(u64, Vec<(String, f32)>)> {
        let bytes = fs::read(find(folder).unwrap().unwrap()).unwrap();
        let events: Vec<_> = records(&bytes).map(|data| (event_step(data), scalars(data))).collect();
        let total: usize = records(&bytes).map(|data| data.len() + 16).sum();
        assert_eq!(total, bytes.len(), "every record is whole");
        events
    }

    #[test]
    fn events_come_back_as_they_were_written() {
        let folder = tempfile::tempdir().unwrap();
        let mut file = EventFile::create(folder.path()).unwrap();
        for step in [1, 300, 5_000_000_000] {
            let scalars = [("return", step as f64), ("nothing", f64::NAN), ("kl", 0.25)];
            file.write(step, scalars.into_iter()).unwrap();
        }
        let events = read(folder.path());
        assert_eq!(events.len(), 4);
        assert_eq!(events[2].1, [("return".to_owned(), 300.0), ("kl".to_owned(), 0.25)]);
        assert_eq!(events[3].0, 5_000_000_000);
    }

    #[test]
    fn resuming_cuts_later_events_and_a_torn_end() {
        let folder = tempfile::tempdir().unwrap();
        let mut file = EventFile::create(folder.path()).unwrap();
        (1..=5).for_each(|step| file.write(step * 1000, [("x", step as f64)].into_iter()).unwrap());
        file.file.write_all(&[30, 0, 0]).unwrap();
        let mut file = EventFile::resume(folder.path(), 3000).unwrap();
        file.write(4000, [("x", 40.0)].into_iter()).unwrap();
        let steps: Vec<u64> = read(folder.path()).iter().map(|event| event.0).collect();
        assert_eq!(steps, [0, 1000, 2000, 3000, 4000]);
        assert_eq!(read(folder.path())[4].1[0].1, 40.0);
    }
}
