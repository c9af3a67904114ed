//! Ranges of frames as they are written on a command line.

use std::{fmt, str::FromStr};

use super::{FrameRangeError, RetargetError};

/// A place in a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    Frame(usize),
    /// Microseconds from the first frame.
    Micros(u64),
}

/// `FRAME`, `FIRST:END` or `FIRST:END:STEP`, counted from 0, without the frame `END`; an empty
/// `FIRST` is 0, an empty `END` the number of frames. A number with an `s` is in seconds from the
/// first frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameRange {
    first: Place,
    end: Option<Place>,
    step: Place,
    is_single: bool,
}

/// How many samples of a motion there may be.
const MOST_SAMPLES: f64 = 1e7;

impl FrameRange {
    /// All frames of a motion.
    pub const ALL: Self = Self {
        first: Place::Frame(0),
        end: None,
        step: Place::Frame(1),
        is_single: false,
    };

    /// Every `step`th frame from the first one on; all for a step of 0.
    pub const fn every(step: usize) -> Self {
        Self {
            step: Place::Frame(if step == 0 { 1 } else { step }),
            ..Self::ALL
        }
    }

    /// The range of one frame.
    pub const fn single(frame: usize) -> Self {
        Self {
            first: Place::Frame(frame),
            end: None,
            step: Place::Frame(1),
            is_single: true,
        }
    }

    /// Whether it is one frame, and not a range that may hold several.
    pub const fn is_single(self) -> bool {
        self.is_single
    }

    /// The first frame; none if it is told in seconds.
    pub const fn first(self) -> Option<usize> {
        match self.first {
            Place::Frame(frame) => Some(frame),
            Place::Micros(_) => None,
        }
    }

    /// The frames of the range in a clip of `num_frames` that follow each other by `frame_time`
    /// seconds, if that is known.
    ///
    /// # Errors
    ///
    /// [`RetargetError::FrameOutOfRange`] for a single frame or a first or last one that is not
    /// there, [`RetargetError::NoFrames`] for a range that holds none,
    /// [`RetargetError::NoFrameTime`] for seconds in a clip that does not tell its own.
    pub fn of(
        self,
        num_frames: usize,
        frame_time: Option<f64>,
    ) -> Result<Vec<usize>, RetargetError> {
        let out_of_range = |frame| RetargetError::FrameOutOfRange { frame, num_frames };
        let frames_in = |place: Place| -> Result<f64, RetargetError> {
            Ok(match place {
                Place::Frame(frame) => frame as f64,
                Place::Micros(micros) => 1e-6 * micros as f64 / self.seconds_of(frame_time)?,
            })
        };
        let first = frames_in(self.first)?.round() as usize;
        if self.is_single {
            if first >= num_frames {
                return Err(out_of_range(first));
            }
            return Ok(vec![first]);
        }
        let end = match self.end {
            Some(end) => (frames_in(end)? - 1e-3).ceil().max(0.0) as usize,
            None => num_frames,
        };
        let step = (frames_in(self.step)?.round() as usize).max(1);
        if end > num_frames {
            let last = first + (end - 1).saturating_sub(first) / step * step;
            return Err(out_of_range(if last < num_frames { end - 1 } else { last }));
        }
        let frames: Vec<usize> = (first..end).step_by(step).collect();
        if frames.is_empty() {
            return Err(RetargetError::NoFrames {
                range: self.to_string(),
                num_frames,
            });
        }
        Ok(frames)
    }

    /// The places of the range, in frames from the first one, of a clip that is played anew with
    /// `fps` frames a second.
    ///
    /// # Errors
    ///
    /// Those of [`FrameRange::of`], and [`RetargetError::StepOfSamples`] for a range with a step.
    pub fn samples(
        self,
        num_frames: usize,
        frame_time: Option<f64>,
        fps: f64,
    ) -> Result<Vec<f64>, RetargetError> {
        let frames = self.of(num_frames, frame_time)?;
        let seconds = self.seconds_of(frame_time)?;
        if self.step != Place::Frame(1) {
            return Err(RetargetError::StepOfSamples {
                range: self.to_string(),
            });
        }
        let (first, last) = (frames[0] as f64, frames[frames.len() - 1] as f64);
        let start = match self.first {
            Place::Micros(micros) => (1e-6 * micros as f64 / seconds).min(last),
            Place::Frame(_) => first,
        };
        if self.is_single {
            return Ok(vec![start]);
        }
        let step = 1.0 / (fps * seconds);
        let count = ((last - start) / step + 1e-6).floor() + 1.0;
        if !(1.0..=MOST_SAMPLES).contains(&count) {
            return Err(RetargetError::NoFrames {
                range: self.to_string(),
                num_frames,
            });
        }
        let places = (0..count as usize).map(|number| start + number as f64 * step);
        Ok(places.map(|place| place.min(last)).collect())
    }

    /// Seconds from frame to frame, which must be known.
    fn seconds_of(self, frame_time: Option<f64>) -> Result<f64, RetargetError> {
        let known = frame_time.filter(|time| time.is_finite() && *time > 0.0);
        known.ok_or_else(|| RetargetError::NoFrameTime {
            range: self.to_string(),
        })
    }
}

impl Place {
    /// Whether this is known to be no later than another.
    fn is_before(self, other: Self) -> bool {
        match (self, other) {
            (Self::Frame(this), Self::Frame(other)) => this <= other,
            (Self::Micros(this), Self::Micros(other)) => this <= other,
            (Self::Frame(_), Self::Micros(_)) | (Self::Micros(_), Self::Frame(_)) => false,
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Frame(frame) => write!(formatter, "{frame}"),
            Self::Micros(micros) => write!(formatter, "{}s", 1e-6 * *micros as f64),
        }
    }
}

impl FromStr for Place {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        let text = text.trim();
        let Some(seconds) = text.strip_suffix('s') else {
            return text.parse().map(Self::Frame).map_err(|_not_a_number| ());
        };
        let seconds: f64 = seconds.trim().parse().map_err(|_not_a_number| ())?;
        // Beyond a year nothing is a motion.
        let is_time = (0.0..=3e7).contains(&seconds);
        is_time
            .then(|| Self::Micros((1e6 * seconds).round() as u64))
            .ok_or(())
    }
}

impl fmt::Display for FrameRange {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_single {
            return write!(formatter, "{}", self.first);
        }
        write!(formatter, "{}:", self.first)?;
        if let Some(end) = self.end {
            write!(formatter, "{end}")?;
        }
        write!(formatter, ":{}", self.step)
    }
}

impl FromStr for FrameRange {
    type Err = FrameRangeError;

    fn from_str(text: &str) -> Result<Self, FrameRangeError> {
        let wrong = || FrameRangeError {
            text: text.to_owned(),
        };
        let number = |part: &str| part.parse::<Place>().map_err(|()| wrong());
        let or = |part: &str, default: usize| match part.trim() {
            "" => Ok(Place::Frame(default)),
            part => number(part),
        };
        let parts: Vec<&str> = text.split(':').collect();
        let (first, end, step) = match *parts.as_slice() {
            [frame] => {
                return Ok(Self {
                    first: number(frame)?,
                    is_single: true,
                    ..Self::ALL
                });
            }
            [first, end] => (first, end, "1"),
            [first, end, step] => (first, end, step),
            _ => return Err(wrong()),
        };
        let end = match end.trim() {
            "" => None,
            end => Some(number(end)?),
        };
        let step = or(step, 1)?;
        if matches!(step, Place::Frame(0) | Place::Micros(0)) {
            return Err(wrong());
        }
        let first = or(first, 0)?;
        if end.is_some_and(|end| end.is_before(first)) {
            return Err(wrong());
        }
        Ok(Self {
            first,
            end,
            step,
            is_single: false,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frames(text: &str, num_frames: usize) -> Vec<usize> {
        text.parse::<FrameRange>()
            .unwrap()
            .of(num_frames, Some(0.01))
            .unwrap()
    }

    #[test]
    fn ranges_leave_their_end_out_and_step() {
        assert_eq!(frames("7", 9), [7]);
        assert_eq!(frames("2:9:3", 9), [2, 5, 8]);
        assert_eq!(frames(":3", 9), [0, 1, 2]);
        assert_eq!(frames("7:", 9), [7, 8]);
        assert_eq!(frames("::4", 9), [0, 4, 8]);
    }

    #[test]
    fn seconds_are_frames_of_the_clip() {
        assert_eq!(frames("0.03s", 9), [3]);
        assert_eq!(frames("0.02s:0.05s", 9), [2, 3, 4]);
        assert_eq!(frames("1:0.08s:0.03s", 9), [1, 4, 7]);
        let range: FrameRange = "0.5s:".parse().unwrap();
        assert_eq!(range.to_string(), "0.5s::1");
        assert!(matches!(
            range.of(9, None),
            Err(RetargetError::NoFrameTime { .. })
        ));
    }

    #[test]
    fn samples_are_as_far_apart_as_asked_for() {
        let samples = |text: &str, fps: f64| {
            text.parse::<FrameRange>()
                .unwrap()
                .samples(101, Some(0.01), fps)
                .unwrap()
        };
        let found = samples(":", 30.0);
        assert_eq!(found.len(), 31);
        for (number, place) in found.iter().enumerate() {
            assert!((place - number as f64 / 0.3).abs() < 1e-6);
        }
        assert_eq!(samples("0.1s:0.2s", 200.0).len(), 19);
        let stepped: FrameRange = "0:9:2".parse().unwrap();
        let error = stepped.samples(101, Some(0.01), 30.0);
        assert!(matches!(error, Err(RetargetError::StepOfSamples { .. })));
    }

    #[test]
    fn what_is_no_range_or_holds_nothing_is_refused() {
        for text in ["", "a", "1:2:0", "1:2:3:4", "-1", "1.5", "5:3", "5:5"] {
            let error = text.parse::<FrameRange>().unwrap_err();
            assert_eq!(error.text, text);
        }
        let of = |text: &str| text.parse::<FrameRange>().unwrap().of(9, None);
        assert!(matches!(
            of("9"),
            Err(RetargetError::FrameOutOfRange {
                frame: 9,
                num_frames: 9
            })
        ));
        assert!(matches!(
            of("3:12"),
            Err(RetargetError::FrameOutOfRange { frame: 11, .. })
        ));
        assert!(matches!(of("9:"), Err(RetargetError::NoFrames { .. })));
    }
}
