//! Which adapter to open.

use crate::adapter::{Adapter, Kind};
use crate::error::GpuError;

/// Which adapter to open.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub enum Want {
    /// The best one, but no software.
    #[default]
    Hardware,
    /// The best one, software if there is nothing else.
    Any,
    /// By its number in [`adapters`](crate::adapters), or the first whose name contains this, in upper or lower case.
    Named(String),
}

impl Want {
    /// Index of the adapter to open, among adapters listed best first.
    pub(crate) fn choose(&self, adapters: &[&Adapter]) -> Result<usize, GpuError> {
        if adapters.is_empty() {
            return Err(GpuError::NoAdapter);
        }
        match self {
            Self::Any => Ok(0),
            Self::Hardware if adapters[0].kind == Kind::Software => {
                Err(GpuError::OnlySoftware { found: adapters.iter().map(|a| a.name.clone()).collect() })
            }
            Self::Hardware => Ok(0),
            Self::Named(name) => named(name, adapters),
        }
    }
}

fn named(name: &str, adapters: &[&Adapter]) -> Result<usize, GpuError> {
    let number = name.trim().parse().ok().filter(|&i: &usize| i < adapters.len());
    let lower = name.trim().to_lowercase();
    number.or_else(|| adapters.iter().position(|a| a.name.to_lowercase().contains(&lower))).ok_or_else(|| {
        let found = adapters.iter().enumerate().map(|(i, a)| format!("{i}: {}", a.name)).collect();
        GpuError::NoSuchAdapter { wanted: name.to_owned(), found }
    })
}
