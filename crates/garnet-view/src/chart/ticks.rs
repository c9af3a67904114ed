//! The ticks of an axis: 1, 2 and 5 times powers of ten, or their multiples.

use super::Scale;

/// Room beside the outermost values of a logarithmic axis, as a factor.
const ROOM: f64 = 1.25;

/// Ticks of a linear axis, about: more make a finer grid.
const NUM_TICKS: f64 = 8.0;

/// An axis between two ticks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Span {
    scale: Scale,
    pub(super) low: f64,
    pub(super) high: f64,
    /// Between ticks of a linear axis.
    step: f64,
}

impl Scale {
    /// Whether a value has a place on an axis.
    pub(super) fn shows(self, value: f64) -> bool {
        value.is_finite() && (self == Self::Linear || value > 0.0)
    }
}

impl Span {
    /// From the tick below the least value to the tick above the greatest; none without a value
    /// that the axis shows.
    pub(super) fn around(scale: Scale, values: impl Iterator<Item = f64>) -> Option<Self> {
        let values = values.filter(|&value| scale.shows(value));
        let ends = values.fold(None, |ends: Option<[f64; 2]>, value| {
            let [low, high] = ends.unwrap_or([value; 2]);
            Some([low.min(value), high.max(value)])
        });
        let [low, high] = ends?;
        if scale == Scale::Logarithmic {
            return Some(Self {
                scale,
                low: tick_below(low / ROOM),
                high: tick_above(high * ROOM),
                step: 0.0,
            });
        }
        let room = if high > low {
            high - low
        } else {
            low.abs().max(1.0)
        };
        let step = tick_above(room / NUM_TICKS);
        let whole = |steps: f64| rounded(steps * step, step);
        let low = (low / step + 1e-9).floor();
        let high = (high / step - 1e-9).ceil().max(low + 1.0);
        Some(Self {
            scale,
            low: whole(low),
            high: whole(high),
            step,
        })
    }

    /// Where a value is: 0 at the low end, 1 at the high end.
    pub(super) fn place(self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Logarithmic => (value / self.low).log10() / (self.high / self.low).log10(),
        }
    }

    /// The ticks, both ends included.
    pub(super) fn ticks(self) -> Vec<f64> {
        if self.scale == Scale::Linear {
            let count = ((self.high - self.low) / self.step).round() as usize;
            let tick = |number| rounded(self.low + number as f64 * self.step, self.step);
            return (0..=count).map(tick).collect();
        }
        let mut ticks = vec![self.low];
        while let Some(&last) = ticks.last().filter(|&&last| last < self.high * 0.999) {
            ticks.push(tick_above(last * 1.001));
        }
        ticks
    }
}

fn tick_below(value: f64) -> f64 {
    let decade = 10_f64.powf(value.log10().floor());
    let steps = [5.0, 2.0, 1.0].into_iter();
    let mut ticks = steps.map(|step| rounded(step * decade, decade));
    ticks
        .find(|&tick| tick <= value * (1.0 + 1e-9))
        .unwrap_or(decade)
}

fn tick_above(value: f64) -> f64 {
    let decade = 10_f64.powf(value.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].into_iter();
    let mut ticks = steps.map(|step| rounded(step * decade, decade));
    ticks
        .find(|&tick| tick >= value * (1.0 - 1e-9))
        .unwrap_or(10.0 * decade)
}

/// A multiple of a step without what powers of ten leave.
fn rounded(tick: f64, step: f64) -> f64 {
    let digits = (2.0 - step.log10()).ceil().clamp(0.0, 300.0);
    let scale = 10_f64.powf(digits);
    (tick * scale).round() / scale
}

/// A tick in words: `0.5`, `20`, `5 000`, `2e-5`.
pub(super) fn label(tick: f64) -> String {
    if tick != 0.0 && tick.abs() < 1e-3 {
        return format!("{tick:e}");
    }
    if tick.abs() < 1000.0 {
        return format!("{tick}");
    }
    let digits = format!("{:.0}", tick.abs());
    let mut text = String::from(if tick < 0.0 { "-" } else { "" });
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push('\u{a0}');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale, values: &[f64]) -> Vec<String> {
        let span = Span::around(scale, values.iter().copied()).unwrap();
        span.ticks().into_iter().map(label).collect()
    }

    #[test]
    fn ticks_are_one_two_five() {
        let found = labels(Scale::Logarithmic, &[0.3, 12.0]);
        assert_eq!(found, ["0.2", "0.5", "1", "2", "5", "10", "20"]);
        let found = labels(Scale::Linear, &[0.0, 3.0, 99.7]);
        assert_eq!(found, ["0", "20", "40", "60", "80", "100"]);
        let found = labels(Scale::Linear, &[-0.3, 0.5]);
        assert_eq!(
            found,
            [
                "-0.3", "-0.2", "-0.1", "0", "0.1", "0.2", "0.3", "0.4", "0.5"
            ]
        );
    }

    #[test]
    fn one_value_is_enough_and_none_are_not() {
        for scale in [Scale::Linear, Scale::Logarithmic] {
            let span = Span::around(scale, [5.0].into_iter()).unwrap();
            assert!(span.low < span.high && (0.0..=1.0).contains(&span.place(5.0)));
            assert_eq!(Span::around(scale, [f64::NAN].into_iter()), None);
        }
        let none = Span::around(Scale::Logarithmic, [0.0, -1.0].into_iter());
        assert_eq!(none, None);
    }

    #[test]
    fn thousands_are_set_apart_and_small_ticks_are_short() {
        assert_eq!(label(20_000.0), "20\u{a0}000");
        assert_eq!(label(-5000.0), "-5\u{a0}000");
        assert_eq!(label(500.0), "500");
        assert_eq!(label(2e-5), "2e-5");
    }
}
