//! The ticks of a logarithmic axis: 1, 2 and 5 times powers of ten.

/// Room beside the outermost values, as a factor.
const ROOM: f64 = 1.25;

/// A logarithmic axis between two ticks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Span {
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Span {
    /// From the tick below the least value to the tick above the greatest; none without a value
    /// above zero.
    pub(super) fn around(values: impl Iterator<Item = f64>) -> Option<Self> {
        let values = values.filter(|value| value.is_finite() && *value > 0.0);
        let ends = values.fold(None, |ends: Option<[f64; 2]>, value| {
            let [low, high] = ends.unwrap_or([value; 2]);
            Some([low.min(value), high.max(value)])
        });
        ends.map(|[low, high]| Self {
            low: tick_below(low / ROOM),
            high: tick_above(high * ROOM),
        })
    }

    /// Where a value is: 0 at the low end, 1 at the high end.
    pub(super) fn place(self, value: f64) -> f64 {
        (value / self.low).log10() / (self.high / self.low).log10()
    }

    /// The ticks, both ends included.
    pub(super) fn ticks(self) -> Vec<f64> {
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
    let mut ticks = steps.map(|step| rounded(step * decade));
    ticks
        .find(|&tick| tick <= value * (1.0 + 1e-9))
        .unwrap_or(decade)
}

fn tick_above(value: f64) -> f64 {
    let decade = 10_f64.powf(value.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].into_iter();
    let mut ticks = steps.map(|step| rounded(step * decade));
    ticks
        .find(|&tick| tick >= value * (1.0 - 1e-9))
        .unwrap_or(10.0 * decade)
}

/// Without what powers of ten leave.
fn rounded(tick: f64) -> f64 {
    let digits = (2.0 - tick.log10()).ceil().max(0.0);
    let scale = 10_f64.powf(digits.min(300.0));
    (tick * scale).round() / scale
}

/// A tick in words: `0.5`, `20`, `5 000`.
pub(super) fn label(tick: f64) -> String {
    if tick < 1000.0 {
        return format!("{tick}");
    }
    let digits = format!("{tick:.0}");
    let mut text = String::new();
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

    #[test]
    fn ticks_are_one_two_five() {
        let span = Span::around([0.3, 12.0].into_iter()).unwrap();
        let labels: Vec<String> = span.ticks().into_iter().map(label).collect();
        assert_eq!(labels, ["0.2", "0.5", "1", "2", "5", "10", "20"]);
    }

    #[test]
    fn one_value_is_enough_and_none_are_not() {
        let span = Span::around([5.0].into_iter()).unwrap();
        assert!(span.low < 5.0 && span.high > 5.0);
        assert!((0.2..0.8).contains(&span.place(5.0)));
        assert_eq!(Span::around([0.0, -1.0, f64::NAN].into_iter()), None);
    }

    #[test]
    fn thousands_are_set_apart() {
        assert_eq!(label(20_000.0), "20\u{a0}000");
        assert_eq!(label(500.0), "500");
    }
}
