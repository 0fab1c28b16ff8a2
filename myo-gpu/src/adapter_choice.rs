//! Which adapter to open.

use crate::adapter::{Adapter, AdapterKind};
use crate::error::GpuError;

/// Which adapter to open.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub enum AdapterChoice {
    /// The best one, but no software.
    #[default]
    Hardware,
    /// The best one, software if there is nothing else.
    Any,
    /// By its number in [`adapters`](crate::adapters), or, if this is no number, by its name or a part of it that no other
    /// adapter's name has, in upper or lower case. Of several cards of one name, the first.
    Named(String),
}

impl AdapterChoice {
    /// Index of the adapter to open, among adapters listed best first.
    pub(crate) fn choose(&self, adapters: &[&Adapter]) -> Result<usize, GpuError> {
        if adapters.is_empty() {
            return Err(GpuError::NoAdapter);
        }
        match self {
            Self::Any => Ok(0),
            Self::Hardware if adapters[0].kind == AdapterKind::Software => {
                Err(GpuError::OnlySoftware { found: adapters.iter().map(|a| a.name.clone()).collect() })
            }
            Self::Hardware => Ok(0),
            Self::Named(name) => named(name, adapters),
        }
    }
}

fn named(name: &str, adapters: &[&Adapter]) -> Result<usize, GpuError> {
    let wanted = name.trim().to_lowercase();
    let numbered = |i: &usize| format!("{i}: {}", adapters[*i].name);
    let all = || (0..adapters.len()).map(|i| numbered(&i)).collect();
    // A number is never looked for in names: cards are called `RTX 2080`.
    if !wanted.is_empty() && wanted.bytes().all(|byte| byte.is_ascii_digit()) {
        let number = wanted.parse().ok().filter(|&i: &usize| i < adapters.len());
        return number.ok_or_else(|| GpuError::NoSuchNumber { wanted, found: all() });
    }
    let fitting = |fits: &dyn Fn(&str) -> bool| -> Vec<usize> {
        (0..adapters.len()).filter(|&i| fits(&adapters[i].name.to_lowercase())).collect()
    };
    let whole = fitting(&|name| name == wanted);
    let part = if wanted.is_empty() { Vec::new() } else { fitting(&|name| name.contains(&wanted)) };
    match if whole.is_empty() { &part[..] } else { &whole[..] } {
        // Twins do the same, and a run that began on one goes on on any.
        [first, others @ ..] if others.iter().all(|&i| adapters[i].name == adapters[*first].name) => Ok(*first),
        [] => Err(GpuError::NoSuchAdapter { wanted: name.to_owned(), found: all() }),
        several => {
            Err(GpuError::SeveralAdapters { wanted: name.to_owned(), found: several.iter().map(numbered).collect() })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn adapter(name: &str, kind: AdapterKind) -> Adapter {
        Adapter { name: name.to_owned(), kind, ..Adapter::default() }
    }

    #[test]
    fn each_choice_has_its_adapter_or_its_reason() {
        let [card, chip, soft] =
            [("Card", AdapterKind::Discrete), ("Chip 2", AdapterKind::Integrated), ("llvmpipe", AdapterKind::Software)]
                .map(|(name, kind)| adapter(name, kind));
        let all = [&card, &chip, &soft];
        let named = |name: &str| AdapterChoice::Named(name.to_owned()).choose(&all);
        assert_eq!(AdapterChoice::Hardware.choose(&all), Ok(0));
        assert_eq!([named("LLVM"), named(" 1 "), named("2")], [Ok(2), Ok(1), Ok(2)]);
        assert_eq!(named("7").unwrap_err().to_string(), "there is no GPU 7; there is 0: Card, 1: Chip 2, 2: llvmpipe");
        assert_eq!(AdapterChoice::Any.choose(&[&soft]), Ok(0));
        let message = AdapterChoice::Hardware.choose(&[&soft]).unwrap_err().to_string();
        assert!(message.contains("only software that imitates one: llvmpipe"), "{message}");
        let message = AdapterChoice::Any.choose(&[]).unwrap_err().to_string();
        assert!(message.contains("mesa-vulkan-drivers"), "{message}");
    }

    #[test]
    fn a_number_is_never_part_of_a_name() {
        let [card, chip] = [adapter("Card", AdapterKind::Discrete), adapter("Chip 2", AdapterKind::Integrated)];
        let named = |name: &str| {
            AdapterChoice::Named(name.to_owned()).choose(&[&card, &chip]).map_err(|error| error.to_string())
        };
        assert_eq!(named("2"), Err("there is no GPU 2; there is 0: Card, 1: Chip 2".into()));
        assert_eq!(named("chip 2"), Ok(1));
    }

    #[test]
    fn a_name_that_fits_several_is_refused_with_all_of_them() {
        let [first, second, other] = ["Card A", "card B", "Chip"].map(|name| adapter(name, AdapterKind::Discrete));
        let named = |name: &str| {
            AdapterChoice::Named(name.to_owned()).choose(&[&first, &second, &other]).map_err(|e| e.to_string())
        };
        let both =
            "\"card\" is part of the name of several GPUs, 0: Card A, 1: card B; take a number or more of the name";
        assert_eq!(named("card"), Err(both.into()));
        assert_eq!(named("card b"), Ok(1));
        // A whole name is meant, even where it is part of another one.
        let longer = adapter("Chip Pro", AdapterKind::Discrete);
        assert_eq!(AdapterChoice::Named("chip".into()).choose(&[&longer, &other]), Ok(1));
    }

    #[test]
    fn of_twins_a_name_means_the_first_and_a_number_each() {
        let [chip, twin] = ["Chip", "Card H"].map(|name| adapter(name, AdapterKind::Discrete));
        let all = [&chip, &twin, &twin, &twin];
        let named = |name: &str| AdapterChoice::Named(name.into()).choose(&all);
        assert_eq!([named("card h"), named("card"), named("3")], [Ok(1), Ok(1), Ok(3)]);
    }

    #[test]
    fn an_empty_name_is_no_name() {
        assert!(AdapterChoice::Named(" ".to_owned()).choose(&[&adapter("Card", AdapterKind::Discrete)]).is_err());
    }
}
