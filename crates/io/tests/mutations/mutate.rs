//! Mutations of the bytes of a file: single bytes, numbers, words, lines, and ranges.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::SplitMix64;

/// Random choices that are the same in every run.
pub(crate) struct Random(SplitMix64);

impl Random {
    pub(crate) fn new(seed: u64, number: u64) -> Self {
        Self(SplitMix64::seed_from_u64(seed.wrapping_mul(0xd6e8_feb8_6659_fd93) ^ number))
    }

    /// Returns a number below `n`, and zero if `n` is zero.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        self.0.random_range(0..n.max(1))
    }

    fn pick<'a, T: ?Sized>(&mut self, items: &[&'a T]) -> &'a T {
        items[self.below(items.len())]
    }
}

/// Texts that replace numbers.
const NUMBERS: [&str; 24] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "2",
    "3",
    "7",
    "0.5",
    "1e-300",
    "1e300",
    "-1e300",
    "1e9",
    "1e-9",
    "nan",
    "inf",
    "-inf",
    "2147483647",
    "-2147483648",
    "4294967296",
    "9223372036854775807",
    "18446744073709551615",
    "0x7fffffff",
    "1e",
    "99999999999999999999999",
];
/// Texts that replace words, or are put between them.
const WORDS: [&str; 20] = [
    "", "\"", "'", "[", "]", "{", "}", "=", ",", ".", "#", "\n", "$End", "true", "\"\"", "\u{0}", "\u{feff}", "é",
    "((((((((", "^-",
];
/// Whole numbers that replace bytes.
const INTEGERS: [u64; 10] = [0, 1, 2, 255, 1 << 15, (1 << 31) - 1, 1 << 31, u32::MAX as u64, 1 << 40, u64::MAX];

/// Returns a mutated file.
pub(crate) fn mutated(seeds: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let mut bytes = seeds[random.below(seeds.len())].clone();
    for _ in 0..=random.below(4) {
        once(&mut bytes, seeds, random);
    }
    bytes
}

fn once(bytes: &mut Vec<u8>, seeds: &[Vec<u8>], random: &mut Random) {
    let at = random.below(bytes.len());
    match random.below(14) {
        0 if !bytes.is_empty() => bytes[at] ^= 1 << random.below(8),
        1 if !bytes.is_empty() => bytes[at] = random.below(256) as u8,
        2 => bytes.truncate(at),
        3 => drop(bytes.splice(range(bytes.len(), random), [])),
        4 => {
            let copy = bytes[range(bytes.len(), random)].to_vec();
            bytes.splice(at..at, copy);
        }
        5 => {
            let other = &seeds[random.below(seeds.len())];
            let part = other[range(other.len(), random)].to_vec();
            bytes.splice(range(bytes.len(), random), part);
        }
        6 => {
            let n = [1, 2, 4, 8][random.below(4)].min(bytes.len() - at);
            let mut integer = INTEGERS[random.below(INTEGERS.len())].to_le_bytes();
            if random.below(4) == 0 {
                integer[..n].reverse();
            }
            bytes[at..at + n].copy_from_slice(&integer[..n]);
        }
        7 => drop(bytes.splice(at..at, random.pick(&WORDS).bytes())),
        8 | 9 => lines(bytes, random),
        _ => {
            let is_number = random.below(4) > 0;
            let words = words(bytes, |byte| match is_number {
                true => byte.is_ascii_digit() || b"+-.eE".contains(byte),
                false => byte.is_ascii_alphanumeric() || b"_-".contains(byte),
            });
            let Some(word) = words.get(random.below(words.len())).cloned() else { return };
            let by = match random.below(4) {
                0 => bytes[words[random.below(words.len())].clone()].to_vec(),
                1 if !is_number => random.pick(&WORDS).as_bytes().to_vec(),
                _ => random.pick(&NUMBERS).as_bytes().to_vec(),
            };
            bytes.splice(word, by);
        }
    }
}

/// Returns a range, mostly a short one.
fn range(length: usize, random: &mut Random) -> std::ops::Range<usize> {
    let begin = random.below(length);
    let most = if random.below(4) == 0 { length - begin } else { 32.min(length - begin) };
    begin..begin + random.below(most + 1)
}

/// Returns the ranges of words of some bytes.
fn words(bytes: &[u8], is_part: impl Fn(&u8) -> bool) -> Vec<std::ops::Range<usize>> {
    let mut words = Vec::new();
    let mut at = 0;
    while let Some(begin) = bytes[at..].iter().position(&is_part).map(|k| at + k) {
        at = bytes[begin..].iter().position(|byte| !is_part(byte)).map_or(bytes.len(), |k| begin + k);
        words.push(begin..at);
    }
    words
}

/// Removes, repeats or exchanges lines.
fn lines(bytes: &mut Vec<u8>, random: &mut Random) {
    let mut lines: Vec<&[u8]> = bytes.split_inclusive(|byte| *byte == b'\n').collect();
    if lines.is_empty() {
        return;
    }
    let [a, b] = [random.below(lines.len()), random.below(lines.len())];
    match random.below(3) {
        0 => drop(lines.remove(a)),
        1 => lines.insert(a, lines[b]),
        _ => lines.swap(a, b),
    }
    *bytes = lines.concat();
}
