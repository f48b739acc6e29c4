//! Independent runs, as many at a time as there are threads.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

use crate::outcome::Failure;

/// Runs `work` on every item and calls `finish` with each result, on this thread, when the run ends. The runs share the
/// threads of rayon equally. Most problems are small: on two threads, two runs with one thread each end sooner than one
/// after the other with two.
///
/// After an error no more runs begin. Those that have begun go on to their ends, and `finish` receives their results.
///
/// # Errors
/// The first error of `work` or `finish`, or a panic of `work`, whose message is printed; with the `name` of the item.
pub(crate) fn for_each<T: Sync, R: Send>(
    items: &[T],
    name: impl Fn(&T) -> String,
    work: impl Fn(&T) -> Result<R, Failure> + Sync,
    mut finish: impl FnMut(&T, R) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let threads = rayon::current_num_threads();
    let workers = threads.min(items.len()).max(1);
    let share = |worker: usize| threads / workers + usize::from(worker < threads % workers);
    let pool = |worker| rayon::ThreadPoolBuilder::new().num_threads(share(worker)).build();
    let pools = (0..workers).map(pool).collect::<Result<Vec<_>, _>>()?;
    let next = AtomicUsize::new(0);
    let (sender, results) = mpsc::channel();
    std::thread::scope(|scope| {
        for pool in &pools {
            let (sender, work, next) = (sender.clone(), &work, &next);
            scope.spawn(move || {
                while let Some(item) = items.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let outcome = catch_unwind(AssertUnwindSafe(|| pool.install(|| work(item))));
                    // The receiver ends after all senders.
                    let _ = sender.send((item, outcome.unwrap_or_else(|_| Err("the program panicked".into()))));
                }
            });
        }
        drop(sender);
        let mut outcome = Ok(());
        for (item, result) in results {
            if let Err(error) = result.and_then(|result| finish(item, result)) {
                next.store(items.len(), Ordering::Relaxed);
                outcome = outcome.and_then(|()| Err(RunFailed { name: name(item), source: error }.into()));
            }
        }
        outcome
    })
}

/// Runs a function on one thread of rayon.
///
/// # Errors
/// The thread cannot be created.
pub(crate) fn on_one_thread<R: Send>(run: impl FnOnce() -> R + Send) -> Result<R, Failure> {
    Ok(rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(run))
}

/// A run that failed, with its cause.
#[derive(Debug, thiserror::Error)]
#[error("{name} failed")]
struct RunFailed {
    name: String,
    source: Failure,
}

#[cfg(test)]
mod tests {
    use std::sync::Barrier;

    use super::*;

    fn in_threads<R: Send>(threads: usize, run: impl FnOnce() -> R + Send) -> R {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool").install(run)
    }

    #[test]
    fn every_result_arrives_once() {
        let items: Vec<u64> = (0..40).collect();
        let mut seen = Vec::new();
        let finish = |&item: &u64, result| {
            seen.push((item, result));
            Ok(())
        };
        for_each(&items, u64::to_string, |&item| Ok(2 * item), finish).unwrap();
        seen.sort_unstable();
        assert_eq!(seen, items.iter().map(|&item| (item, 2 * item)).collect::<Vec<_>>());
        for_each(&[0_u64; 0], u64::to_string, |_| Ok(()), |_, ()| Ok(())).unwrap();
    }

    #[test]
    fn runs_take_place_at_the_same_time_and_share_the_threads() {
        let mut threads = Vec::new();
        in_threads(5, || {
            let barrier = Barrier::new(2);
            let work = |_: &u64| {
                // The other run must have begun.
                barrier.wait();
                Ok(rayon::current_num_threads())
            };
            let finish = |_: &u64, n| {
                threads.push(n);
                Ok(())
            };
            for_each(&[0, 1], u64::to_string, work, finish).unwrap();
        });
        threads.sort_unstable();
        assert_eq!(threads, [2, 3]);
    }

    #[test]
    fn after_an_error_or_a_panic_runs_end_and_none_begins() {
        for panics in [false, true] {
            let barrier = Barrier::new(2);
            let mut finished = Vec::new();
            let error = in_threads(2, || {
                let work = |&item: &u64| {
                    match item {
                        0 => {
                            // Run 1 has begun, and ends after the error.
                            barrier.wait();
                            assert!(!panics, "no such state");
                            return Err("no such state".into());
                        }
                        1 => {
                            barrier.wait();
                            std::thread::sleep(std::time::Duration::from_millis(200));
                        }
                        _ => {}
                    }
                    Ok(item)
                };
                let finish = |_: &u64, item| {
                    finished.push(item);
                    Ok(())
                };
                let items: Vec<u64> = (0..1000).collect();
                for_each(&items, |item| format!("run {item}"), work, finish).unwrap_err()
            });
            let cause = if panics { "the program panicked" } else { "no such state" };
            assert_eq!([error.to_string(), error.source().unwrap().to_string()], ["run 0 failed", cause]);
            assert!(finished.contains(&1) && finished.len() < 1000, "{}", finished.len());
        }
    }
}
