//! Which value is in which register.

use crate::code::Value;
use crate::uses::Uses;

/// Registers of one class.
#[derive(Clone, Debug)]
pub struct Bank {
    /// What each holds.
    held: Vec<Option<Value>>,
    /// Those that the current instruction needs.
    locked: Vec<bool>,
    /// The first one's number.
    first: u8,
}

impl Bank {
    pub fn new(first: u8, count: usize) -> Self {
        Self { held: vec![None; count], locked: vec![false; count], first }
    }

    /// The register of a value.
    pub fn find(&self, value: Value) -> Option<u8> {
        self.held.iter().position(|&held| held == Some(value)).map(|k| k as u8 + self.first)
    }

    pub fn lock(&mut self, register: u8) {
        self.locked[(register - self.first) as usize] = true;
    }

    pub fn unlock_all(&mut self) {
        self.locked.fill(false);
    }

    pub fn hold(&mut self, register: u8, value: Value) {
        self.held[(register - self.first) as usize] = Some(value);
    }

    pub fn drop_value(&mut self, value: Value) {
        if let Some(register) = self.find(value) {
            self.held[(register - self.first) as usize] = None;
        }
    }

    pub fn clear(&mut self) {
        self.held.fill(None);
    }

    /// Keeps only what is in the same register in both.
    pub fn intersect(&mut self, other: &Self) {
        for (held, &before) in self.held.iter_mut().zip(&other.held) {
            if *held != before {
                *held = None;
            }
        }
    }

    /// Values in registers.
    pub fn values(&self) -> impl Iterator<Item = (u8, Value)> + '_ {
        self.held.iter().enumerate().filter_map(|(k, held)| held.map(|value| (k as u8 + self.first, value)))
    }

    /// A register to write to: an empty one, or that of the value that is read last of all after the instruction at `at`, which
    /// then has to be kept elsewhere (Belady 1966, <https://doi.org/10.1147/sj.52.0078>).
    pub fn choose(&self, uses: &mut Uses, at: usize) -> u8 {
        let free = (0..self.held.len()).filter(|&k| !self.locked[k]);
        let later =
            |k: &usize| self.held[*k].map_or(usize::MAX, |value| uses.next(value, at).unwrap_or(usize::MAX - 1));
        let mut chosen = free.map(later_of(later));
        let first = chosen.next().expect("an instruction needs fewer registers than there are");
        let (_, k) = chosen.fold(first, |best, next| if next.0 > best.0 { next } else { best });
        k as u8 + self.first
    }

    /// What a register holds.
    pub fn at(&self, register: u8) -> Option<Value> {
        self.held[(register - self.first) as usize]
    }
}

fn later_of(mut later: impl FnMut(&usize) -> usize) -> impl FnMut(usize) -> (usize, usize) {
    move |k| (later(&k), k)
}
