//! [`in_order`]: work on many frames at a time, with results in the order of the frames and few of them waiting.

use std::collections::BTreeMap;
use std::num::NonZero;
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{Builder, available_parallelism, scope};

use anyhow::{Context, Result};

/// The tables of a ranger are built on the stack before they go to the heap.
pub(crate) const STACK_BYTES: usize = 32 << 20;

/// So many frames for each worker are read but not yet taken.
const AHEAD: usize = 2;

/// One worker for each.
pub(crate) fn cores() -> usize {
    available_parallelism().map_or(1, NonZero::get)
}

/// Runs `work` on the inputs in so many threads, and `take` on this one, which gets the results in the order of the
/// inputs.
pub(crate) fn in_order<T, R: Send, O>(
    workers: usize,
    inputs: impl Iterator<Item = T> + Send,
    work: impl Fn(T) -> R + Sync,
    take: impl FnOnce(Results<R>) -> Result<O>,
) -> Result<O> {
    let (permits, permit) = channel();
    let (results, result) = channel();
    (0..workers * AHEAD).for_each(|_| permits.send(()).unwrap_or_default());
    let inputs = Mutex::new((permit, inputs.enumerate()));
    scope(|scope| {
        for _ in 0..workers {
            let (inputs, work, results) = (&inputs, &work, results.clone());
            let worker = move || {
                while let Some((index, input)) = next(inputs) {
                    if results.send((index, work(input))).is_err() {
                        return;
                    }
                }
            };
            Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, worker).context("starting a thread")?;
        }
        drop(results);
        take(Results { results: result, permits, waiting: BTreeMap::new(), next: 0 })
    })
}

/// The next input, once there is a permit for it.
fn next<I: Iterator>(inputs: &Mutex<(Receiver<()>, I)>) -> Option<I::Item> {
    // Another worker has panicked: the scope will say so.
    let mut inputs = inputs.lock().ok()?;
    inputs.0.recv().ok()?;
    inputs.1.next()
}

/// Results in the order of their inputs.
pub(crate) struct Results<R> {
    results: Receiver<(usize, R)>,
    permits: Sender<()>,
    waiting: BTreeMap<usize, R>,
    next: usize,
}

impl<R> Iterator for Results<R> {
    type Item = R;

    fn next(&mut self) -> Option<R> {
        loop {
            if let Some(result) = self.waiting.remove(&self.next) {
                self.next += 1;
                // Without inputs left, nobody takes it.
                self.permits.send(()).unwrap_or_default();
                return Some(result);
            }
            let (index, result) = self.results.recv().ok()?;
            self.waiting.insert(index, result);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::time::Duration;

    use anyhow::{Result, bail};

    use super::{AHEAD, in_order};

    /// Some inputs take much longer than those after them.
    #[test]
    fn ten_thousand_results_come_in_order_and_few_of_them_wait() {
        for workers in [1, 2, 7] {
            let (begun, taken, most) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicUsize::new(0));
            let inputs = (0..10_000_usize).inspect(|_| {
                let waiting = begun.fetch_add(1, Ordering::SeqCst) + 1 - taken.load(Ordering::SeqCst);
                most.fetch_max(waiting, Ordering::SeqCst);
            });
            let work = |input: usize| {
                if input.is_multiple_of(1000) {
                    std::thread::sleep(Duration::from_millis(2));
                }
                input * 2
            };
            let results = in_order(workers, inputs, work, |results| {
                let count = |result: usize| {
                    taken.fetch_add(1, Ordering::SeqCst);
                    result
                };
                Ok(results.map(count).collect::<Vec<_>>())
            });
            let expected: Vec<_> = (0..10_000).map(|input| input * 2).collect();
            assert_eq!(results.expect("no error"), expected);
            // One more may have been handed out before it is counted.
            let most = most.into_inner();
            assert!((1..=workers * AHEAD + 1).contains(&most), "{most} waiting for {workers} workers");
        }
    }

    #[test]
    fn whoever_stops_taking_stops_the_work() {
        let begun = AtomicUsize::new(0);
        let work = |_| begun.fetch_add(1, Ordering::SeqCst);
        let stopped: Result<()> = in_order(3, 0..1_000_000, work, |mut results| {
            assert!(results.next().is_some());
            bail!("enough")
        });
        assert_eq!(stopped.expect_err("an error").to_string(), "enough");
        assert!(begun.into_inner() < 100);
    }
}
