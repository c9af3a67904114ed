//! Work on many things at once, a thread each, with the results in order.

use std::{
    collections::BTreeMap,
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
    thread,
};

use anyhow::Context;

/// Results that may wait for an earlier one, a thread: more lets threads run on while one thing
/// takes long, and takes memory.
const WAITING: usize = 2;

/// What is done and what is to be done.
struct Board<T> {
    /// The next thing that somebody takes up.
    next: usize,
    /// The next result that is asked for.
    asked: usize,
    done: BTreeMap<usize, anyhow::Result<T>>,
    is_over: bool,
}

/// Does `work` of each number below `count` on `threads` threads, and gives the results to `take`
/// in their order, on this thread. The first error, in this order, ends it.
///
/// Each thread works alone: what its work would spread over threads stays on it. No more than
/// a few results a thread are in memory.
pub(crate) fn in_order<T: Send>(
    count: usize,
    threads: usize,
    work: impl Fn(usize) -> anyhow::Result<T> + Sync,
    mut take: impl FnMut(usize, T) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let board = Mutex::new(Board {
        next: 0,
        asked: 0,
        done: BTreeMap::new(),
        is_over: false,
    });
    let changed = Condvar::new();
    let room = WAITING * threads;
    let worker = || {
        // On this thread itself, which is gone with the pool.
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .use_current_thread();
        let pool = pool.build().context("cannot start the threads");
        loop {
            let mut held = lock(&board);
            while !held.is_over && held.next < count && held.next >= held.asked + room {
                held = changed.wait(held).unwrap_or_else(PoisonError::into_inner);
            }
            if held.is_over || held.next >= count {
                return;
            }
            let number = held.next;
            held.next += 1;
            drop(held);
            let result = match &pool {
                Ok(pool) => pool.install(|| work(number)),
                Err(error) => Err(anyhow::anyhow!("{error:#}")),
            };
            lock(&board).done.insert(number, result);
            changed.notify_all();
        }
    };
    thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(worker);
        }
        // However this ends, nobody waits on.
        let _over = Over {
            board: &board,
            changed: &changed,
        };
        for number in 0..count {
            let mut held = lock(&board);
            let result = loop {
                if let Some(result) = held.done.remove(&number) {
                    break result;
                }
                held = changed.wait(held).unwrap_or_else(PoisonError::into_inner);
            };
            held.asked = number + 1;
            drop(held);
            changed.notify_all();
            take(number, result?)?;
        }
        Ok(())
    })
}

/// Sends the workers home.
struct Over<'a, T> {
    board: &'a Mutex<Board<T>>,
    changed: &'a Condvar,
}

impl<T> Drop for Over<'_, T> {
    fn drop(&mut self) {
        lock(self.board).is_over = true;
        self.changed.notify_all();
    }
}

fn lock<T>(board: &Mutex<Board<T>>) -> MutexGuard<'_, Board<T>> {
    board.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use anyhow::bail;

    use super::*;

    #[test]
    fn results_come_in_their_order_and_few_wait() {
        let taken = AtomicUsize::new(0);
        let most_ahead = AtomicUsize::new(0);
        let mut seen = Vec::new();
        let work = |number: usize| {
            let ahead = number - taken.load(Ordering::SeqCst).min(number);
            most_ahead.fetch_max(ahead, Ordering::SeqCst);
            Ok(number * number)
        };
        let take = |number: usize, square: usize| {
            taken.store(number, Ordering::SeqCst);
            seen.push(square);
            Ok(())
        };
        in_order(100, 3, work, take).unwrap();
        assert_eq!(
            seen,
            (0..100).map(|number| number * number).collect::<Vec<_>>()
        );
        assert!(most_ahead.load(Ordering::SeqCst) <= 3 * WAITING + 3);
    }

    #[test]
    fn the_first_error_in_order_is_told() {
        let work = |number: usize| match number {
            7 | 9 => bail!("{number} is wrong"),
            _ => Ok(number),
        };
        let mut last = 0;
        let error = in_order(1000, 4, work, |number, _| {
            last = number;
            Ok(())
        });
        assert_eq!(error.unwrap_err().to_string(), "7 is wrong");
        assert_eq!(last, 6);
        let error = in_order(1000, 2, Ok, |_, _| bail!("enough"));
        assert_eq!(error.unwrap_err().to_string(), "enough");
    }
}
