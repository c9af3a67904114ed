//! Lists of different lengths, stored one after the other.

use std::ops::Range;

/// Lists of different lengths, stored one after the other.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Lists {
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Lists {
    /// Puts pairs `(list, item)` into `num_lists` lists, each in the order of the pairs.
    pub(crate) fn from_pairs(
        num_lists: usize,
        pairs: impl Iterator<Item = (u32, u32)> + Clone,
    ) -> Self {
        let mut starts = vec![0_u32; num_lists + 1];
        for (list, _) in pairs.clone() {
            starts[list as usize + 1] += 1;
        }
        for list in 0..num_lists {
            starts[list + 1] += starts[list];
        }
        let mut items = vec![0; starts[num_lists] as usize];
        let mut ends = starts.clone();
        for (list, item) in pairs {
            let end = &mut ends[list as usize];
            items[*end as usize] = item;
            *end += 1;
        }
        Self { starts, items }
    }

    /// Takes lists that already stand one after the other.
    pub(crate) fn from_parts(starts: Vec<u32>, items: Vec<u32>) -> Self {
        Self { starts, items }
    }

    pub(crate) fn list(&self, list: usize) -> &[u32] {
        &self.items[self.range(list)]
    }

    fn range(&self, list: usize) -> Range<usize> {
        self.starts[list] as usize..self.starts[list + 1] as usize
    }
}
