//! The order in which polygons stand in MuJoCo: that of the table in which its compiler gathers triangles, an `unordered_map` of the C++ library libc++
//! with pairs of numbers for keys.

use std::collections::HashMap;

/// What a pair of numbers is found by.
type Key = [f64; 2];

/// Keys in the table's order. A new one stands before all others of its bucket, or before all if it is the first there; when buckets become more, those
/// of one come together.
#[derive(Debug, Default)]
pub(super) struct Table {
    buckets: u64,
    /// Numbers of keys, and their hashes.
    order: Vec<(usize, u64)>,
}

impl Table {
    /// Adds a key that is not there yet.
    pub fn add(&mut self, number: usize, key: Key) {
        let hash = hash(key);
        let count = self.order.len() as u64 + 1;
        if count > self.buckets {
            let is_odd = self.buckets <= 2 || !self.buckets.is_power_of_two();
            self.spread((2 * self.buckets + u64::from(is_odd)).max(count));
        }
        let bucket = self.bucket(hash);
        let first = self.order.iter().position(|&(_, other)| self.bucket(other) == bucket);
        self.order.insert(first.unwrap_or(0), (number, hash));
    }

    /// Numbers of keys in order.
    pub fn numbers(&self) -> impl Iterator<Item = usize> + '_ {
        self.order.iter().map(|&(number, _)| number)
    }

    fn bucket(&self, hash: u64) -> u64 {
        if self.buckets.is_power_of_two() { hash & (self.buckets - 1) } else { hash % self.buckets }
    }

    /// Takes as many buckets, or some more.
    fn spread(&mut self, buckets: u64) {
        let buckets = if buckets.is_power_of_two() { buckets.max(2) } else { prime_from(buckets) };
        if buckets <= self.buckets {
            return;
        }
        self.buckets = buckets;
        // Each key that begins a bucket stays where it is; others of this bucket follow what stands before that.
        let mut before: HashMap<u64, Option<usize>> = HashMap::new();
        let mut spread: Vec<(usize, u64)> = vec![];
        let mut last = None;
        for entry in std::mem::take(&mut self.order) {
            let bucket = self.bucket(entry.1);
            match before.get(&bucket) {
                Some(_) if last == Some(bucket) => spread.push(entry),
                Some(&head) => {
                    let place = head.and_then(|head| spread.iter().position(|&(number, _)| number == head));
                    spread.insert(place.map_or(0, |place| place + 1), entry);
                }
                None => {
                    before.insert(bucket, spread.last().map(|&(number, _)| number));
                    spread.push(entry);
                    last = Some(bucket);
                }
            }
        }
        self.order = spread;
    }
}

fn hash([first, second]: Key) -> u64 {
    let bits = |x: f64| if x == 0.0 { 0 } else { x.to_bits() };
    let (a, b) = (bits(first), bits(second));
    a ^ b.wrapping_add(0x9e37_79b9).wrapping_add(a << 6).wrapping_add(a >> 2)
}

/// The least prime that is no less.
fn prime_from(number: u64) -> u64 {
    let is_prime = |&n: &u64| (3..).step_by(2).take_while(|p| p * p <= n).all(|p| n % p != 0);
    if number <= 2 { 2 } else { ((number | 1)..).step_by(2).find(is_prime).unwrap_or(number) }
}
