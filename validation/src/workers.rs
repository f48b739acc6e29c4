//! Independent runs, as many at a time as there are threads.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

use crate::outcome::Failure;

/// Runs `work` on every item and calls `finish` with each result. The runs share the threads of rayon equally: the
/// problems are small, so that two runs with one thread each end sooner than one after the other with two. `finish` is
/// called on this thread and in the order of the items, as soon as a result and those before it are there.
///
/// # Errors
/// The first error of `work`, in the order of the items, or of `finish`; runs that have not begun are left out.
pub(crate) fn for_each<T: Sync, R: Send>(
    items: &[T],
    work: impl Fn(&T) -> Result<R, Failure> + Sync,
    mut finish: impl FnMut(&T, R) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let threads = rayon::current_num_threads();
    let workers = threads.min(items.len()).max(1);
    let pool = || rayon::ThreadPoolBuilder::new().num_threads(threads / workers).build();
    let pools = (0..workers).map(|_| pool()).collect::<Result<Vec<_>, _>>()?;
    let next = AtomicUsize::new(0);
    let (sender, results) = mpsc::channel();
    std::thread::scope(|scope| {
        for pool in &pools {
            let (sender, work, next) = (sender.clone(), &work, &next);
            scope.spawn(move || {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(item) = items.get(index) else { break };
                    // It fails only if the receiver has ended with an error.
                    let _ = sender.send((index, pool.install(|| work(item))));
                }
            });
        }
        drop(sender);
        let mut early = BTreeMap::new();
        let mut n_finished = 0;
        for (index, result) in results {
            early.insert(index, result);
            while let Some(result) = early.remove(&n_finished) {
                let item = &items[n_finished];
                n_finished += 1;
                if let Err(error) = result.and_then(|result| finish(item, result)) {
                    next.store(items.len(), Ordering::Relaxed);
                    return Err(error);
                }
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;
    use std::time::Duration;

    use super::*;

    #[test]
    fn results_come_in_the_order_of_the_items() {
        let items: Vec<u64> = (0..40).rev().collect();
        let seen = RefCell::new(Vec::new());
        let work = |&item: &u64| {
            std::thread::sleep(Duration::from_micros(100 * (item % 7)));
            Ok(2 * item)
        };
        for_each(&items, work, |&item, result| {
            seen.borrow_mut().push((item, result));
            Ok(())
        })
        .unwrap();
        assert_eq!(seen.into_inner(), items.iter().map(|&item| (item, 2 * item)).collect::<Vec<_>>());
        for_each(&[0; 0], |_| Ok(()), |_, ()| Ok(())).unwrap();
    }

    #[test]
    fn the_first_error_ends_the_runs() {
        let begun = AtomicUsize::new(0);
        let items: Vec<usize> = (0..1000).collect();
        let work = |&item: &usize| {
            begun.fetch_add(1, Ordering::Relaxed);
            std::thread::sleep(Duration::from_millis(1));
            if item == 3 { Err("the third".into()) } else { Ok(item) }
        };
        let mut n_finished = 0;
        let error = for_each(&items, work, |_, _| {
            n_finished += 1;
            Ok(())
        });
        assert_eq!((error.unwrap_err().to_string().as_str(), n_finished), ("the third", 3));
        assert!(begun.into_inner() < 500);
    }
}
