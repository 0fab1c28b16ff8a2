//! Members that do their work together: whoever has something to do waits until all others have, too.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Members with work of one kind, `W`, each in a thread of its own. One alone need not wait for anyone.
#[derive(Debug)]
pub struct Together<W> {
    seats: Mutex<Vec<Seat<W>>>,
    changed: Condvar,
}

#[derive(Debug)]
struct Seat<W> {
    work: W,
    state: State,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Busy with something of its own: the others wait.
    Away,
    /// Its work is to be done.
    Waiting,
    /// Its work was done.
    Done,
    /// Never comes back: nobody waits.
    Gone,
}

impl<W> Together<W> {
    /// A member for each work.
    pub fn new(works: Vec<W>) -> Self {
        let seats = works.into_iter().map(|work| Seat { work, state: State::Away }).collect();
        Self { seats: Mutex::new(seats), changed: Condvar::new() }
    }

    /// Makes a member's work ready, waits until that of all members is, has `run` do all of it at once, and looks at what has
    /// become of the member's. It is run by whoever was ready last, for whoever has not left, in the order of the members.
    pub fn meet<T>(
        &self,
        member: usize,
        prepare: impl FnOnce(&mut W),
        run: impl FnOnce(&mut [(usize, &mut W)]),
        look: impl FnOnce(&mut W) -> T,
    ) -> T {
        let (mut seats, mut run) = (self.seats(), Some(run));
        prepare(&mut seats[member].work);
        seats[member].state = State::Waiting;
        while seats[member].state != State::Done {
            let is_ready = |seat: &Seat<W>| matches!(seat.state, State::Waiting | State::Gone);
            match run.take_if(|_| seats.iter().all(is_ready)) {
                Some(run) => {
                    run_all(&mut seats, run);
                    self.changed.notify_all();
                }
                None => seats = self.changed.wait(seats).unwrap_or_else(PoisonError::into_inner),
            }
        }
        seats[member].state = State::Away;
        look(&mut seats[member].work)
    }

    /// The others need not wait for this member any more.
    pub fn leave(&self, member: usize) {
        self.seats()[member].state = State::Gone;
        self.changed.notify_all();
    }

    fn seats(&self) -> MutexGuard<'_, Vec<Seat<W>>> {
        self.seats.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn run_all<W>(seats: &mut [Seat<W>], run: impl FnOnce(&mut [(usize, &mut W)])) {
    let waiting = seats.iter_mut().enumerate().filter(|(_, seat)| seat.state == State::Waiting);
    let mut works: Vec<_> = waiting
        .map(|(member, seat)| {
            seat.state = State::Done;
            (member, &mut seat.work)
        })
        .collect();
    run(&mut works);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_done_for_all_who_are_there_at_once() {
        // Member k stays for k + 1 rounds.
        let together = Together::new(vec![Vec::new(); 4]);
        let attend = |member: usize| {
            for round in 0..=member {
                let run = |works: &mut [(usize, &mut Vec<Vec<usize>>)]| {
                    let members: Vec<_> = works.iter().map(|(member, _)| *member).collect();
                    works.iter_mut().for_each(|(_, work)| work.push(members.clone()));
                };
                let seen = together.meet(member, |work| assert_eq!(work.len(), round), run, |work| work.clone());
                assert_eq!(seen.len(), round + 1);
            }
            together.leave(member);
        };
        std::thread::scope(|scope| (0..4).for_each(|member| drop(scope.spawn(move || attend(member)))));
        let seats = together.seats();
        for (member, seat) in seats.iter().enumerate() {
            let expected: Vec<Vec<usize>> = (0..=member).map(|round| (round..4).collect()).collect();
            assert_eq!(seat.work, expected, "member {member}");
        }
    }
}
