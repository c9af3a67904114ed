//! A few out of many.

/// `count` of the values, evenly spread and in order; all if there are not so many.
///
/// ```
/// assert_eq!(garnet_train::chart::spread(&[0, 1, 2, 3, 4, 5], 2), [1, 4]);
/// ```
pub fn spread<T: Copy>(values: &[T], count: usize) -> Vec<T> {
    let count = count.min(values.len());
    let at = |number: usize| (2 * number + 1) * values.len() / (2 * count);
    (0..count).map(|number| values[at(number)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spread_is_even_and_without_repetition() {
        let values: Vec<usize> = (0..24).collect();
        for count in 0..30 {
            let found = spread(&values, count);
            assert_eq!(found.len(), count.min(24));
            let steps: Vec<usize> = found.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let ends = (steps.iter().min(), steps.iter().max());
            if let (Some(least), Some(most)) = ends {
                assert!(*least > 0 && most - least <= 1, "{count}: {found:?}");
            }
        }
    }
}
