//! Runs of a parser on many inputs, with limits of time and memory for each.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::mutate::{Random, mutated};

/// Longest time of an input in a short run, when other tests share the machine, and in a long one.
const TIMES: [Duration; 2] = [Duration::from_secs(60), Duration::from_secs(5)];
/// Largest memory of the program, pages of 4 KiB.
const MOST_PAGES: u64 = 3 << 18;

thread_local! {
    /// Message and place of the last panic of a thread.
    static PANIC: RefCell<String> = const { RefCell::new(String::new()) };
    /// Whether the thread reads an input, so that a panic is one of the parser.
    static READS: Cell<bool> = const { Cell::new(false) };
}

/// The input that is read now, with its number and the time at which it began.
type Present = Arc<Mutex<Option<(u64, Vec<u8>, Instant)>>>;

fn number(name: &str) -> Option<f64> {
    std::env::var(name).ok()?.parse().ok()
}

/// Runs a parser on mutations of its seeds, and checks that it returns for every one of them. The parser returns
/// whether it accepts an input. `inputs` is the number of inputs of a short run.
pub(crate) fn campaign(name: &'static str, inputs: u64, seeds: Vec<Vec<u8>>, parser: impl Fn(&[u8]) -> bool) {
    let minutes = number("MUTATION_MINUTES");
    let seed = number("MUTATION_SEED").unwrap_or(1.0) as u64;
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("mutations");
    std::fs::create_dir_all(&folder).expect("a directory");
    let kept = move |k: u64| folder.join(format!("{name}-{seed}-{k}"));
    let standard = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        let place = info.location().map(ToString::to_string).unwrap_or_default();
        match READS.get() {
            true => PANIC.set(format!("{place}: {info}")),
            false => standard(info),
        }
    }));
    for (k, good) in seeds.iter().enumerate() {
        assert!(parser(good), "seed {k} of {name} is refused");
    }
    let present: Present = Arc::default();
    watch(&present, TIMES[usize::from(minutes.is_some())], kept.clone());
    let begin = Instant::now();
    let (mut accepted, mut slowest) = (0_u64, Duration::ZERO);
    let mut failures: BTreeMap<String, (u64, PathBuf)> = BTreeMap::new();
    let mut k = 0;
    while minutes.map_or(k < inputs, |minutes| begin.elapsed().as_secs_f64() < 60.0 * minutes) {
        let input = mutated(&seeds, &mut Random::new(seed, k));
        let clock = Instant::now();
        *present.lock().unwrap_or_else(PoisonError::into_inner) = Some((k, input.clone(), clock));
        READS.set(true);
        let read = catch_unwind(AssertUnwindSafe(|| parser(&input)));
        READS.set(false);
        match read {
            Ok(is_accepted) => accepted += u64::from(is_accepted),
            Err(_) => {
                let entry = failures.entry(PANIC.take()).or_insert_with(|| (0, kept(k)));
                if entry.0 == 0 {
                    std::fs::write(&entry.1, &input).expect("a writable directory");
                }
                entry.0 += 1;
            }
        }
        slowest = slowest.max(clock.elapsed());
        k += 1;
    }
    *present.lock().unwrap_or_else(PoisonError::into_inner) = None;
    if minutes.is_some() {
        let seconds = begin.elapsed().as_secs();
        eprintln!(
            "{name}: seed {seed}, {k} inputs in {seconds} s, {accepted} accepted, slowest {slowest:.1?}, {} kinds of panics",
            failures.len()
        );
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

/// Ends the program if an input takes too long or too much memory, and keeps the input.
fn watch(present: &Present, most: Duration, kept: impl Fn(u64) -> PathBuf + Send + 'static) {
    let present = Arc::downgrade(present);
    let check = move || {
        while let Some(present) = present.upgrade() {
            let begun = present.lock().unwrap_or_else(PoisonError::into_inner).clone();
            if let Some((k, input, begin)) = begun {
                let is_large = pages() > MOST_PAGES;
                if is_large || begin.elapsed() > most {
                    let why = if is_large { "memory" } else { "time" };
                    let written = std::fs::write(kept(k), input);
                    eprintln!("input {k} takes too much {why}; it is kept as {} ({written:?})", kept(k).display());
                    std::process::abort();
                }
            }
            drop(present);
            std::thread::sleep(Duration::from_millis(100));
        }
    };
    // The thread ends with the campaign.
    drop(std::thread::spawn(check));
}

/// Returns the memory of the program, in pages; zero if it is not known.
fn pages() -> u64 {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    text.split_whitespace().nth(1).and_then(|pages| pages.parse().ok()).unwrap_or(0)
}
