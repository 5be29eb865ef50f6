//! Memory that one layout leaves to the next.

use crate::memory::{Word, fitting, keep_larger};
use alloc::vec::Vec;
use core::mem::take;

/// The large buffer of a layout, kept between builds.
#[doc(hidden)]
#[derive(Default)]
pub struct Buffers {
    words: Vec<Word>,
    /// Whether unused memory is kept for the next hierarchy.
    ///
    /// If not, the build shrinks the layout to its size.
    pub(crate) keeps_rest: bool,
}

impl Buffers {
    /// Returns the buffer, for temporary use.
    pub(crate) fn words(&mut self) -> &mut Vec<Word> {
        &mut self.words
    }

    /// Takes the buffer, and leaves an empty one.
    pub(crate) fn take_words(&mut self) -> Vec<Word> {
        take(&mut self.words)
    }

    /// Returns an empty buffer with room for `len` words.
    pub(super) fn words_for(&mut self, len: usize) -> Vec<Word> {
        if self.keeps_rest {
            return fitting(&mut self.words, len);
        }
        let words = self.take_words();
        if words.capacity() >= len {
            return words;
        }
        drop(words);
        Vec::with_capacity(len)
    }

    /// Keeps `words` if it is larger than the kept buffer.
    pub(crate) fn keep_words(&mut self, words: Vec<Word>) {
        keep_larger(&mut self.words, words);
    }

    /// Returns the size of the buffer, in bytes.
    pub fn bytes(&self) -> usize {
        self.words.capacity() * size_of::<Word>()
    }
}
