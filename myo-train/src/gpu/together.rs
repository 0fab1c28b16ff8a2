//! Members that do their work together: whoever has something to do waits until all others have, too.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// What members do together, in the order in which it is done: those who look at their policies go on with an update next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Work {
    /// Some steps of an evaluation.
    Look,
    /// An update.
    Update,
}

/// Members, each in a thread of its own. One alone need not wait for anyone.
#[derive(Debug)]
pub struct Together {
    members: Mutex<Vec<State>>,
    changed: Condvar,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Busy with something of its own: the others wait.
    Away,
    /// Has work to do.
    Waiting(Work),
    /// Its work was done.
    Done,
    /// Never comes back: nobody waits.
    Gone,
}

impl Together {
    /// So many members.
    pub fn new(members: usize) -> Self {
        Self { members: Mutex::new(vec![State::Away; members]), changed: Condvar::new() }
    }

    /// How many they were in the beginning.
    pub fn len(&self) -> usize {
        self.members().len()
    }

    /// Waits until no member is busy with something else, and until this work of all who wait for it was done: by `run`, of one
    /// of them, which is told who they are.
    pub fn meet(&self, member: usize, work: Work, run: impl FnOnce(&[usize])) {
        let (mut members, mut run) = (self.members(), Some(run));
        members[member] = State::Waiting(work);
        let mut arrived = true;
        while members[member] != State::Done {
            let next = next(&members);
            if next != Some(work) {
                // Those who wait for other work may have slept since before this member came.
                if std::mem::take(&mut arrived) && next.is_some() {
                    self.changed.notify_all();
                }
            } else if let Some(run) = run.take() {
                run(&take(&mut members, work));
                self.changed.notify_all();
                continue;
            }
            members = self.changed.wait(members).unwrap_or_else(PoisonError::into_inner);
        }
        members[member] = State::Away;
    }

    /// The others need not wait for this member any more.
    pub fn leave(&self, member: usize) {
        self.members()[member] = State::Gone;
        self.changed.notify_all();
    }

    fn members(&self) -> MutexGuard<'_, Vec<State>> {
        self.members.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// What is to be done next, if nobody is busy with something else.
fn next(members: &[State]) -> Option<Work> {
    let mut first = None;
    for member in members {
        match *member {
            State::Away | State::Done => return None,
            State::Waiting(work) => first = Some(first.map_or(work, |first: Work| first.min(work))),
            State::Gone => {}
        }
    }
    first
}

/// Who waits for this work, which is done from now on.
fn take(members: &mut [State], work: Work) -> Vec<usize> {
    let waiting = members.iter_mut().enumerate().filter(|(_, state)| **state == State::Waiting(work));
    waiting
        .map(|(member, state)| {
            *state = State::Done;
            member
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_done_for_all_who_wait_for_it_and_looks_come_before_updates() {
        // Member k stays for k + 1 updates, and looks k times after the first.
        let (together, done) = (Together::new(4), Mutex::new(Vec::new()));
        let meet = |member, work| together.meet(member, work, |all| done.lock().unwrap().push((work, all.to_vec())));
        let attend = |member: usize| {
            meet(member, Work::Update);
            (0..member).for_each(|_| meet(member, Work::Look));
            (0..member).for_each(|_| meet(member, Work::Update));
            together.leave(member);
        };
        std::thread::scope(|scope| (0..4).for_each(|member| drop(scope.spawn(move || attend(member)))));
        let expected = [
            (Work::Update, vec![0, 1, 2, 3]),
            (Work::Look, vec![1, 2, 3]),
            (Work::Look, vec![2, 3]),
            (Work::Look, vec![3]),
            (Work::Update, vec![1, 2, 3]),
            (Work::Update, vec![2, 3]),
            (Work::Update, vec![3]),
        ];
        assert_eq!(*done.lock().unwrap(), expected);
    }
}
