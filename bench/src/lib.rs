//! What the benches measure: streams, and those who take them apart.

pub mod contenders;
pub mod streams;
