//! Values of arguments, from text.

/// More threads than any machine has use for; the pool would fail on much larger numbers.
const MAX_THREADS: usize = 1024;

pub(crate) fn thread_count(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(count) if count <= MAX_THREADS => Ok(count),
        _ => Err(format!("expected a number from 0 to {MAX_THREADS}")),
    }
}

/// How many of something.
pub(crate) fn count(text: &str) -> Result<usize, String> {
    let count = text.parse().ok();
    count.ok_or_else(|| "expected a whole number, from 0".to_owned())
}

/// A length in millimetres, zero or more, as metres.
pub(crate) fn millimetres(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(length) if (0.0..=1000.0).contains(&length) => Ok(length * 1e-3),
        _ => Err("expected millimetres, from 0 to 1000".to_owned()),
    }
}

/// A length in millimetres, zero or more, as metres in double precision.
pub(crate) fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(length) if (0.0..=1000.0).contains(&length) => Ok(length * 1e-3),
        _ => Err("expected millimetres, from 0 to 1000".to_owned()),
    }
}

/// A time in milliseconds, above zero, as seconds.
pub(crate) fn milliseconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(time) if time > 0.0 && time <= 1e7 => Ok(time * 1e-3),
        _ => Err("expected milliseconds, above 0".to_owned()),
    }
}

/// Frames of a sixtieth of a second that cloth settles.
pub(crate) fn settle_frames(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(frames) if frames <= MAX_SETTLE_FRAMES => Ok(frames),
        _ => Err(format!(
            "expected a number of frames, from 0 to {MAX_SETTLE_FRAMES}"
        )),
    }
}

/// Ten seconds of cloth that rests after one: more is asked for by mistake.
const MAX_SETTLE_FRAMES: u32 = 600;

/// A number, 1 or more.
pub(crate) fn at_least_one(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(count) if count > 0 => Ok(count),
        _ => Err("expected a number, 1 or more".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_not_negative_and_finite() {
        assert_eq!(millimetres("2"), Ok(0.002));
        for text in ["-1", "nan", "inf", "2mm", "1e9", ""] {
            assert!(millimetres(text).is_err(), "{text}");
        }
    }

    #[test]
    fn counts_are_in_range() {
        assert_eq!(at_least_one("3"), Ok(3));
        for text in ["0", "-1", "", "x"] {
            assert!(at_least_one(text).is_err(), "{text}");
        }
    }
}
