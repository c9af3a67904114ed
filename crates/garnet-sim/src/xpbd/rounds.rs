//! Work on a few things over and over, so short that no thread can be woken for it.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Rounds in each of which some things are worked on once, by whichever thread is free. One thread
/// leads; others help while they look on, and may come late or never.
#[derive(Debug)]
pub(super) struct Rounds<'a, T> {
    things: &'a [Mutex<T>],
    /// The round, and in the low bits how many of its things have been taken.
    ticket: AtomicU64,
    /// How many of them are done.
    num_done: AtomicU64,
}

const TAKEN_BITS: u32 = 16;
const TAKEN: u64 = (1 << TAKEN_BITS) - 1;

/// The round after the last.
const OVER: u64 = u64::MAX >> TAKEN_BITS;

/// How often one looks before others may have the core: some ten microseconds.
const PATIENCE: u32 = 200;

impl<'a, T> Rounds<'a, T> {
    pub(super) fn new(things: &'a [Mutex<T>]) -> Self {
        Self {
            things,
            // The round before the first: all is taken.
            ticket: AtomicU64::new(TAKEN),
            num_done: AtomicU64::new(0),
        }
    }

    /// Leads round `number`, from 0: returns when `work` was done once on each thing.
    pub(super) fn lead(&self, number: u32, work: &impl Fn(u32, &mut T)) {
        self.num_done.store(0, Ordering::Relaxed);
        let round = u64::from(number) + 1;
        self.ticket.store(round << TAKEN_BITS, Ordering::Release);
        while self.take(work).is_some() {}
        let num_things = self.things.len() as u64;
        wait(|| self.num_done.load(Ordering::Acquire) == num_things);
    }

    /// What tells those who help that there are no more rounds, when it is dropped: even if the
    /// leader panics.
    pub(super) fn end(&self) -> impl Drop + '_ {
        End(&self.ticket)
    }

    /// Helps until the end.
    pub(super) fn help(&self, work: &impl Fn(u32, &mut T)) {
        let is_over = || self.ticket.load(Ordering::Acquire) >> TAKEN_BITS == OVER;
        while !is_over() {
            wait(|| self.take(work).is_some() || is_over());
        }
    }

    /// Works on what nobody has taken, if there is something.
    fn take(&self, work: &impl Fn(u32, &mut T)) -> Option<()> {
        let ticket = self.ticket.load(Ordering::Acquire);
        let (round, taken) = (ticket >> TAKEN_BITS, ticket & TAKEN);
        let thing = self.things.get(taken as usize).filter(|_| round != OVER)?;
        // Fails if another thread was faster, even if a new round has begun.
        (self.ticket)
            .compare_exchange(ticket, ticket + 1, Ordering::AcqRel, Ordering::Relaxed)
            .ok()?;
        let _done = Done(&self.num_done);
        work((round - 1) as u32, &mut locked(thing));
        Some(())
    }
}

struct End<'a>(&'a AtomicU64);

impl Drop for End<'_> {
    fn drop(&mut self) {
        self.0.store(OVER << TAKEN_BITS, Ordering::Release);
    }
}

/// Counts a thing as done, even if the work on it panics: the leader must not wait for ever.
struct Done<'a>(&'a AtomicU64);

impl Drop for Done<'_> {
    fn drop(&mut self) {
        self.0.fetch_add(1, Ordering::Release);
    }
}

/// A thing that nobody works on, or that nobody else does.
pub(super) fn locked<T>(thing: &Mutex<T>) -> MutexGuard<'_, T> {
    thing.lock().unwrap_or_else(PoisonError::into_inner)
}

fn wait(is_done: impl Fn() -> bool) {
    let mut looks = 0_u32;
    while !is_done() {
        looks += 1;
        if looks.is_multiple_of(PATIENCE) {
            std::thread::yield_now();
        } else {
            std::hint::spin_loop();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_thing_is_worked_on_once_a_round_whoever_helps() {
        for num_helpers in 0..3 {
            let things: Vec<Mutex<Vec<u32>>> = (0..5).map(|_| Mutex::default()).collect();
            let rounds = Rounds::new(&things);
            let work = |round: u32, thing: &mut Vec<u32>| thing.push(round);
            std::thread::scope(|scope| {
                for _ in 0..num_helpers {
                    scope.spawn(|| rounds.help(&work));
                }
                let end = rounds.end();
                (0..1000).for_each(|round| rounds.lead(round, &work));
                drop(end);
            });
            let all: Vec<u32> = (0..1000).collect();
            assert!(things.iter().all(|thing| *locked(thing) == all));
        }
    }

    #[test]
    fn nobody_waits_for_a_leader_or_a_helper_that_panics() {
        let things: Vec<Mutex<u32>> = (0..2).map(|_| Mutex::default()).collect();
        let rounds = Rounds::new(&things);
        let fails = |round: u32, _: &mut u32| assert!(round < 2, "as is to be tested");
        let work = std::panic::AssertUnwindSafe(|| {
            let lead = || {
                let _end = rounds.end();
                (0..9).for_each(|round| rounds.lead(round, &fails));
            };
            rayon::join(lead, || rounds.help(&fails));
        });
        assert!(std::panic::catch_unwind(work).is_err());
    }
}
