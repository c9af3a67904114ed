//! Ranges of frames as they are written on a command line.

use std::{fmt, str::FromStr};

use super::{FrameRangeError, RetargetError};

/// `FRAME`, `FIRST:END` or `FIRST:END:STEP`, counted from 0, without the frame `END`; an empty
/// `FIRST` is 0, an empty `END` the number of frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameRange {
    first: usize,
    end: Option<usize>,
    step: usize,
    is_single: bool,
}

impl FrameRange {
    /// All frames.
    pub const ALL: Self = Self {
        first: 0,
        end: None,
        step: 1,
        is_single: false,
    };

    /// Every `step`th frame from the first one on; all for a step of 0.
    pub const fn every(step: usize) -> Self {
        Self {
            step: if step == 0 { 1 } else { step },
            ..Self::ALL
        }
    }

    /// One frame.
    pub const fn single(frame: usize) -> Self {
        Self {
            first: frame,
            end: None,
            step: 1,
            is_single: true,
        }
    }

    /// Whether it is one frame, and not a range that may hold several.
    pub const fn is_single(self) -> bool {
        self.is_single
    }

    /// The first frame.
    pub const fn first(self) -> usize {
        self.first
    }

    /// The frames of the range in a clip of `num_frames`.
    ///
    /// # Errors
    ///
    /// [`RetargetError::FrameOutOfRange`] for a single frame or a first or last one that is not
    /// there, [`RetargetError::NoFrames`] for a range that holds none.
    pub fn of(self, num_frames: usize) -> Result<Vec<usize>, RetargetError> {
        let out_of_range = |frame| RetargetError::FrameOutOfRange { frame, num_frames };
        if self.is_single {
            if self.first >= num_frames {
                return Err(out_of_range(self.first));
            }
            return Ok(vec![self.first]);
        }
        let end = self.end.unwrap_or(num_frames);
        if end > num_frames {
            return Err(out_of_range(end - 1));
        }
        let frames: Vec<usize> = (self.first..end).step_by(self.step).collect();
        if frames.is_empty() {
            return Err(RetargetError::NoFrames {
                range: self.to_string(),
                num_frames,
            });
        }
        Ok(frames)
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
        let number = |part: &str| {
            part.trim()
                .parse::<usize>()
                .map_err(|_not_a_number| wrong())
        };
        let or = |part: &str, default: usize| match part.trim() {
            "" => Ok(default),
            part => number(part),
        };
        let parts: Vec<&str> = text.split(':').collect();
        let (first, end, step) = match *parts.as_slice() {
            [frame] => return Ok(Self::single(number(frame)?)),
            [first, end] => (first, end, "1"),
            [first, end, step] => (first, end, step),
            _ => return Err(wrong()),
        };
        let end = match end.trim() {
            "" => None,
            end => Some(number(end)?),
        };
        let step = or(step, 1)?;
        if step == 0 {
            return Err(wrong());
        }
        let first = or(first, 0)?;
        if end.is_some_and(|end| end <= first) {
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
        text.parse::<FrameRange>().unwrap().of(num_frames).unwrap()
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
    fn what_is_no_range_or_holds_nothing_is_refused() {
        for text in ["", "a", "1:2:0", "1:2:3:4", "-1", "1.5", "5:3", "5:5"] {
            let error = text.parse::<FrameRange>().unwrap_err();
            assert_eq!(error.text, text);
        }
        let of = |text: &str| text.parse::<FrameRange>().unwrap().of(9);
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
