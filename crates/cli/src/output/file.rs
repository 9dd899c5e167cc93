//! Files that appear under their name only when they are complete.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::fault::unwritable;
use crate::finding::Finding;
use crate::speech::Speech;

/// A file being written beside its final name. Dropped without [`WholeFile::finish`], it leaves nothing behind.
#[derive(Debug)]
pub(crate) struct WholeFile {
    target: PathBuf,
    /// The name it has until it is complete; `None` for a device, which is written as it is.
    temporary: Option<PathBuf>,
    file: File,
    speech: Speech,
}

impl WholeFile {
    /// Begins a file.
    pub(crate) fn create(target: &Path, speech: Speech) -> Result<Self, Finding> {
        Self::begin(target, speech).map_err(|error| unwritable(&target.display().to_string(), &error, speech))
    }

    fn begin(target: &Path, speech: Speech) -> io::Result<Self> {
        let target = target.to_path_buf();
        match fs::metadata(&target) {
            Ok(metadata) if metadata.is_dir() => Err(io::Error::from(io::ErrorKind::IsADirectory)),
            Ok(metadata) if !metadata.is_file() => {
                let file = File::options().write(true).open(&target)?;
                Ok(Self { target, temporary: None, file, speech })
            }
            _ => {
                let name = target.file_name().ok_or(io::ErrorKind::InvalidInput)?;
                let mut hidden = OsString::from(".");
                hidden.push(name);
                hidden.push(format!(".{}.part", std::process::id()));
                let temporary = target.with_file_name(hidden);
                let file = File::create(&temporary)?;
                Ok(Self { target, temporary: Some(temporary), file, speech })
            }
        }
    }

    /// Puts the complete file under its name.
    pub(crate) fn finish(mut self) -> Result<(), Finding> {
        self.commit().map_err(|error| self.fault(&error))
    }

    fn commit(&mut self) -> io::Result<()> {
        self.file.flush()?;
        if let Some(temporary) = &self.temporary {
            // The name must not be there before the bytes are.
            self.file.sync_data()?;
            fs::rename(temporary, &self.target)?;
            self.temporary = None;
        }
        Ok(())
    }

    /// Writes a complete file at once.
    pub(crate) fn write(target: &Path, bytes: &[u8], speech: Speech) -> Result<(), Finding> {
        let mut file = Self::create(target, speech)?;
        file.append(bytes)?;
        file.finish()
    }

    /// Adds bytes.
    pub(crate) fn append(&mut self, bytes: &[u8]) -> Result<(), Finding> {
        self.file.write_all(bytes).map_err(|error| self.fault(&error))
    }

    fn fault(&self, error: &io::Error) -> Finding {
        unwritable(&self.target.display().to_string(), error, self.speech)
    }
}

impl Drop for WholeFile {
    fn drop(&mut self) {
        if let Some(temporary) = &self.temporary {
            // Nobody could do anything about a failure here.
            let _ = fs::remove_file(temporary);
        }
    }
}
