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
    number
        .or_else(|| adapters.iter().position(|a| !lower.is_empty() && a.name.to_lowercase().contains(&lower)))
        .ok_or_else(|| {
            let found = adapters.iter().enumerate().map(|(i, a)| format!("{i}: {}", a.name)).collect();
            GpuError::NoSuchAdapter { wanted: name.to_owned(), found }
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn adapter(name: &str, kind: Kind) -> Adapter {
        Adapter { name: name.to_owned(), kind, ..Adapter::default() }
    }

    #[test]
    fn each_wish_has_its_adapter_or_its_reason() {
        let [card, chip, soft] = [("Card", Kind::Discrete), ("Chip 2", Kind::Integrated), ("llvmpipe", Kind::Software)]
            .map(|(name, kind)| adapter(name, kind));
        let all = [&card, &chip, &soft];
        let named = |name: &str| Want::Named(name.to_owned()).choose(&all);
        assert_eq!(Want::Hardware.choose(&all), Ok(0));
        assert_eq!([named("LLVM"), named(" 1 "), named("2")], [Ok(2), Ok(1), Ok(2)]);
        assert_eq!(
            named("7").unwrap_err().to_string(),
            "no GPU is called \"7\"; there is 0: Card, 1: Chip 2, 2: llvmpipe"
        );
        assert_eq!(Want::Any.choose(&[&soft]), Ok(0));
        let message = Want::Hardware.choose(&[&soft]).unwrap_err().to_string();
        assert!(message.contains("only software that imitates one: llvmpipe"), "{message}");
        let message = Want::Any.choose(&[]).unwrap_err().to_string();
        assert!(message.contains("mesa-vulkan-drivers"), "{message}");
    }

    #[test]
    fn an_empty_name_is_no_name() {
        assert!(Want::Named(" ".to_owned()).choose(&[&adapter("Card", Kind::Discrete)]).is_err());
    }
}
