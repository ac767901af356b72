//! What the fuzz targets hold against any bytes: the laws that the codec's tests hold against the seeds.

#[path = "../../codec/tests/laws/mod.rs"]
mod laws;

/// Panics where `data` breaks the law of `target`.
///
/// # Panics
/// So it does for a target without a law.
pub fn check(target: &str, data: &[u8]) {
    let law = laws::ALL.iter().find(|(name, _)| *name == target);
    let (_, law) = law.unwrap_or_else(|| panic!("{target} has no law"));
    law(data);
}
