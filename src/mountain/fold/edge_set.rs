//! A set of the edges of a mesh.

use std::sync::Arc;

/// A set of edges, one bit each; clones share the bits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct EdgeSet {
    words: Arc<[u64]>,
}

impl EdgeSet {
    /// Edges per word.
    pub(super) const WORD: usize = u64::BITS as usize;

    /// A set of the bits of `words`, the first edge lowest.
    pub(super) fn of(words: Vec<u64>) -> Self {
        Self { words: words.into() }
    }

    /// True for a member; edges beyond the mesh are none.
    pub(super) fn contains(&self, edge: usize) -> bool {
        let word = self.words.get(edge / Self::WORD);
        word.is_some_and(|word| word >> (edge % Self::WORD) & 1 == 1)
    }

    /// Number of members.
    pub(super) fn len(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// The members, in order.
    pub(super) fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        self.words.iter().enumerate().flat_map(|(index, &word)| {
            std::iter::successors(Some(word), |&rest| Some(rest & rest.wrapping_sub(1)))
                .take_while(|&rest| rest != 0)
                .map(move |rest| index * Self::WORD + rest.trailing_zeros() as usize)
        })
    }

    /// The same with each edge of `changes` put in (true) or taken out (false), in order.
    pub(super) fn with(&self, changes: impl IntoIterator<Item = (usize, bool)>) -> Self {
        let mut words = self.words.to_vec();
        for (edge, member) in changes {
            let bit = 1 << (edge % Self::WORD);
            if member {
                words[edge / Self::WORD] |= bit;
            } else {
                words[edge / Self::WORD] &= !bit;
            }
        }
        Self::of(words)
    }
}

#[cfg(test)]
mod tests {
    use super::EdgeSet;

    #[test]
    fn lists_what_it_contains() {
        let members = [0, 5, 63, 64, 130, 191];
        let set = EdgeSet::of(vec![0; 3]).with(members.map(|edge| (edge, true)));
        assert_eq!(set.iter().collect::<Vec<_>>(), members);
        assert_eq!(set.len(), members.len());
        assert!((0..300).all(|edge| set.contains(edge) == members.contains(&edge)));
        let less = set.with([(64, false), (1, true)]);
        assert_eq!(less.iter().collect::<Vec<_>>(), [0, 1, 5, 63, 130, 191]);
    }
}
