//! Runs the fuzz targets on their corpus (fuzz/corpus) and on random bytes: nothing may panic.
#[path = "../../fuzz/harness/mod.rs"]
mod harness;

use std::path::Path;

fn corpus(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus").join(target);
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    assert!(!paths.is_empty());
    paths.iter().map(|path| std::fs::read(path).unwrap()).collect()
}

/// Random bytes from a linear congruential generator.
fn noise(seed: u64, length: usize) -> Vec<u8> {
    let mut state = seed.wrapping_mul(2862933555777941757).wrapping_add(3037000493);
    let mut next = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 56) as u8
    };
    (0..length).map(|_| next()).collect()
}

#[test]
fn no_linear_complementarity_problem_panics() {
    corpus("lemke").iter().for_each(|data| harness::linear_complementarity(data));
    (0..2000).for_each(|seed| harness::linear_complementarity(&noise(seed, 90)));
}

#[test]
fn no_contact_problem_panics() {
    corpus("contact").iter().for_each(|data| harness::contact(data));
    (0..300).for_each(|seed| harness::contact(&noise(seed, 200)));
}
