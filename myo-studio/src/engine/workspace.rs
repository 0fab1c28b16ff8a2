//! The folder in which a studio works: task files in `tasks/`, runs in `runs/`, what was thrown away in `bin/`. Names come from a page, so
//! none of them may lead out of it.

use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use myo_tasks::Source;
use myo_train::write_whole;

use super::look;
use crate::protocol::{Refusal, TaskFile, TaskText};

/// Longest name of a task or a run.
const NAME_MAX: usize = 80;

/// Where a studio works.
#[derive(Clone, Debug)]
pub struct Workspace {
    folder: PathBuf,
}

/// What can be thrown away.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// A task file.
    Task,
    /// The folder of a run.
    Run,
}

impl Workspace {
    /// A folder, which need not exist yet.
    pub fn new(folder: PathBuf) -> Self {
        Self { folder }
    }

    /// The folder itself.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Where runs are.
    pub fn runs(&self) -> PathBuf {
        self.folder.join("runs")
    }

    fn tasks(&self) -> PathBuf {
        self.folder.join("tasks")
    }

    /// The folder of a run by its name, such as `pointing-1` or `pair/seed-3`.
    ///
    /// # Errors
    /// The name leads elsewhere.
    pub fn run(&self, name: &str) -> Result<PathBuf, Refusal> {
        let path = Path::new(name);
        let mut parts = path.components();
        let stays = !name.is_empty() && parts.all(|part| matches!(part, Component::Normal(_)));
        if !stays || name.contains(['\\', '\0']) {
            return Err(Refusal::sentence(format!("{name:?} is no name of a run: it leads out of the folder of runs")));
        }
        let folder = self.runs().join(path);
        // A link may lead out where the name does not.
        match (folder.canonicalize(), self.runs().canonicalize()) {
            (Ok(real), Ok(runs)) if !real.starts_with(&runs) => {
                Err(Refusal::sentence(format!("the run {name:?} is a link that leads out of the folder of runs")))
            }
            _ => Ok(folder),
        }
    }

    /// The name of a run by its folder.
    pub fn name_of(&self, folder: &Path) -> String {
        folder.strip_prefix(self.runs()).unwrap_or(folder).to_string_lossy().replace('\\', "/")
    }

    /// The file of a task by its name.
    ///
    /// # Errors
    /// The name is not one that a file can have everywhere.
    pub fn task(&self, name: &str) -> Result<PathBuf, Refusal> {
        check_name(name, "task")?;
        Ok(self.tasks().join(format!("{name}.yaml")))
    }

    /// Reads the text of a task as that of a file in the folder of tasks: a model file that it names is looked for there.
    ///
    /// # Errors
    /// What is wrong with it, each with its place.
    pub fn read(&self, text: &str) -> Result<Source, Refusal> {
        Ok(look::read(text)?.in_folder(&self.tasks()))
    }

    /// A model as a task names it, seen from the working directory.
    pub fn model(&self, name: &str) -> String {
        let beside = self.tasks().join(name);
        if beside.is_file() { beside.to_string_lossy().into_owned() } else { name.to_owned() }
    }

    /// Task files that were kept, by name.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn list_tasks(&self) -> Result<Vec<TaskFile>, Refusal> {
        let entries = match fs::read_dir(self.tasks()) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(vec![]),
            entries => entries.map_err(|error| io_refusal("read", &self.tasks(), &error))?,
        };
        let file = |path: PathBuf| {
            let name = path.file_name()?.to_str()?.strip_suffix(".yaml")?.to_owned();
            check_name(&name, "task").ok()?;
            Some(TaskFile { name, changed_s: changed_s(&path)? })
        };
        let mut files: Vec<TaskFile> = entries.filter_map(|entry| file(entry.ok()?.path())).collect();
        files.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(files)
    }

    /// The text of a task.
    ///
    /// # Errors
    /// There is no such task, or it cannot be read.
    pub fn open_task(&self, name: &str) -> Result<TaskText, Refusal> {
        let path = self.task(name)?;
        let text = fs::read_to_string(&path).map_err(|error| io_refusal("read", &path, &error))?;
        Ok(TaskText { name: name.to_owned(), text })
    }

    /// Keeps the text of a task: the file is replaced as a whole or not at all.
    ///
    /// # Errors
    /// The name cannot be that of a file, or it cannot be written.
    pub fn save_task(&self, name: &str, text: &str) -> Result<TaskFile, Refusal> {
        let path = self.task(name)?;
        fs::create_dir_all(self.tasks()).map_err(|error| io_refusal("make", &self.tasks(), &error))?;
        write_whole(&path, text.as_bytes())?;
        Ok(TaskFile { name: name.to_owned(), changed_s: changed_s(&path).unwrap_or_default() })
    }

    /// Puts something into the bin, where it stays until somebody empties it.
    ///
    /// # Errors
    /// There is no such thing, or it cannot be moved.
    pub fn discard(&self, kind: Kind, name: &str) -> Result<(), Refusal> {
        let path = match kind {
            Kind::Task => self.task(name)?,
            Kind::Run => self.run(name)?,
        };
        if !path.exists() {
            return Err(Refusal::sentence(format!("there is no {} any more", path.display())));
        }
        let bin = self.folder.join("bin");
        fs::create_dir_all(&bin).map_err(|error| io_refusal("make", &bin, &error))?;
        let own = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let place = free(&bin, &own);
        fs::rename(&path, &place).map_err(|error| io_refusal("move", &path, &error))
    }

    /// Gives a run another name beside its own; what it is called then.
    ///
    /// # Errors
    /// The name is taken or cannot be that of a folder, or the run cannot be moved.
    pub fn rename_run(&self, name: &str, to: &str) -> Result<String, Refusal> {
        check_name(to, "run")?;
        let path = self.run(name)?;
        let place = path.with_file_name(to);
        if place.exists() {
            return Err(Refusal::sentence(format!("there is a run named {to} already; take another name")));
        }
        fs::rename(&path, &place).map_err(|error| io_refusal("rename", &path, &error))?;
        Ok(name.rsplit_once('/').map_or_else(|| to.to_owned(), |(group, _)| format!("{group}/{to}")))
    }

    /// The folder for one studio alone, as long as what is returned lives.
    ///
    /// # Errors
    /// Another studio works there, or nothing can be written there.
    pub fn lock(&self) -> Result<fs::File, Refusal> {
        let path = self.folder.join("studio.lock");
        fs::create_dir_all(&self.folder).map_err(|error| io_refusal("make", &self.folder, &error))?;
        let file = fs::File::create(&path).map_err(|error| io_refusal("write", &path, &error))?;
        match file.try_lock() {
            Err(fs::TryLockError::WouldBlock) => Err(Refusal::sentence(format!(
                "another studio works in {}; use that one, or give this one another --folder",
                self.folder.display()
            ))),
            // Where nothing can be locked nobody knows.
            _ => Ok(file),
        }
    }

    /// The first of `NAME-1`, `NAME-2`, ... that no run has.
    pub fn free_run(&self, name: &str) -> String {
        let runs = self.runs();
        let numbered = (1u32..).map(|number| format!("{name}-{number}")).find(|name| !runs.join(name).exists());
        numbered.unwrap_or_else(|| name.to_owned())
    }
}

/// A place in a folder that nothing has yet.
fn free(folder: &Path, name: &str) -> PathBuf {
    let first = folder.join(name);
    if !first.exists() {
        return first;
    }
    (2u32..).map(|number| folder.join(format!("{name}.{number}"))).find(|path| !path.exists()).unwrap_or(first)
}

/// Refuses what no file can be called on some system, or what would be hidden.
fn check_name(name: &str, what: &str) -> Result<(), Refusal> {
    let problem = if name.is_empty() || name.len() > NAME_MAX {
        format!("must have from 1 to {NAME_MAX} letters")
    } else if name.starts_with(['.', '-']) || name.trim() != name || name.ends_with('.') {
        "must not begin with a dot or a dash, nor with or end in a blank".to_owned()
    } else if let Some(bad) = name.chars().find(|c| c.is_control() || "/\\:*?\"<>|".contains(*c)) {
        format!("must not contain {bad:?}")
    } else {
        return Ok(());
    };
    Err(Refusal::sentence(format!("the name of a {what} {problem}: {name:?}")))
}

/// When a file was last written (s since 1970).
pub fn changed_s(path: &Path) -> Option<f64> {
    Some(seconds(fs::metadata(path).ok()?.modified().ok()?))
}

/// Seconds since 1970.
pub fn seconds(time: SystemTime) -> f64 {
    time.duration_since(UNIX_EPOCH).map_or(0.0, |time| time.as_secs_f64())
}

fn io_refusal(what: &str, path: &Path, error: &io::Error) -> Refusal {
    Refusal::sentence(format!("cannot {what} {}: {error}", path.display()))
}
