//! Whether the adapter hears itself.

/// What is known of the adapter's echo. Learned from reads, whose reply never equals the request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Echo {
    Unknown,
    Absent,
    Present,
}
