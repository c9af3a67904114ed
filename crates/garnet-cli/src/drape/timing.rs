//! How long the stages take.

use std::time::{Duration, Instant};

use serde::Serialize;

/// Does something and tells how long it took, in seconds.
pub(crate) fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let result = work();
    (result, start.elapsed().as_secs_f64())
}

/// Median and 95th percentile of repeated times, in seconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct Repeated {
    pub(crate) median: f64,
    pub(crate) p95: f64,
}

impl Repeated {
    /// Of at least one time; nothing of none.
    pub(crate) fn of(mut seconds: Vec<f64>) -> Option<Self> {
        seconds.sort_unstable_by(f64::total_cmp);
        let last = seconds.len().checked_sub(1)?;
        let middle = f64::midpoint(seconds[last / 2], seconds[last.div_ceil(2)]);
        Some(Self {
            median: middle,
            p95: seconds[(95 * last).div_ceil(100)],
        })
    }
}

/// A time as people read it.
pub(crate) fn readable(seconds: f64) -> String {
    let duration = Duration::try_from_secs_f64(seconds).unwrap_or_default();
    match duration.as_secs() {
        0 => format!("{:.1} ms", 1e3 * seconds),
        1..60 => format!("{seconds:.2} s"),
        whole => format!("{} min {} s", whole / 60, whole % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_in_the_middle() {
        let repeated = Repeated::of(vec![3.0, 1.0, 2.0, 10.0]).unwrap();
        assert_eq!((repeated.median, repeated.p95), (2.5, 10.0));
        assert_eq!(Repeated::of(Vec::new()), None);
    }

    #[test]
    fn times_are_readable() {
        assert_eq!(readable(0.0123), "12.3 ms");
        assert_eq!(readable(1.5), "1.50 s");
        assert_eq!(readable(125.0), "2 min 5 s");
    }
}
