//! `<include>`: another file's elements in its place.

use crate::document::{Loader, Node, read_text};
use crate::error::MjcfError;
use crate::files::{FileError, folder_of, join};
use crate::limits::too_much;
use crate::table::unknown_attribute;

impl Loader<'_> {
    pub(crate) fn include(
        &mut self,
        include: &Node,
        is_empty: bool,
        path: &str,
        depth: usize,
        includes: usize,
        parent: usize,
    ) -> Result<(), MjcfError> {
        if !is_empty {
            return Err(include.misplaced("an include has no elements of its own"));
        }
        if let Some(other) = include.attributes.iter().find(|attribute| &*attribute.name != "file") {
            return Err(unknown_attribute(include, &other.name, &["file"]));
        }
        let named = include.get("file").ok_or_else(|| MjcfError::Missing { at: include.at(), attribute: "file" })?;
        self.budget.includes += 1;
        let limits = &self.budget.limits;
        if self.budget.includes > limits.includes {
            return Err(too_much(include.spot(), "included files", limits.includes as u64));
        }
        if includes >= limits.include_depth {
            return Err(too_much(include.spot(), "files that include each other", limits.include_depth as u64));
        }
        let (found, text) = self.find(include, named, folder_of(path))?;
        self.seen.insert(found.clone());
        self.add_file(&found, &text, depth, includes + 1, Some(parent))
    }

    /// MuJoCo looks in the folder of the main file first, then in that of the file with the include.
    fn find(&mut self, include: &Node, named: &str, folder: &str) -> Result<(String, String), MjcfError> {
        let failed = |why| MjcfError::File { at: include.at_attribute("file"), path: named.to_owned(), why };
        let mut why = FileError::Missing;
        for folder in [&*self.main_folder, folder] {
            let Some(path) = join(folder, named) else {
                why = FileError::Outside;
                continue;
            };
            if self.seen.contains(&path) {
                return Err(MjcfError::IncludedTwice { at: include.at_attribute("file"), path });
            }
            match read_text(self.files, &path, self.budget) {
                Ok(text) => return Ok((path, text)),
                Err(FileError::Missing) => {}
                Err(why) => return Err(failed(why)),
            }
        }
        Err(failed(why))
    }
}
