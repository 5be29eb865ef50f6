//! Memory that one layout leaves to the next.

use crate::memory::{Word, fitting, keep_larger};
use alloc::vec::Vec;
use core::mem::take;

/// The large buffer of a layout.
#[doc(hidden)]
#[derive(Default)]
pub struct Buffers {
    words: Vec<Word>,
    /// Whether what a hierarchy does not need is left to the next; else the words are cut to size behind it.
    pub(crate) keeps_rest: bool,
}

impl Buffers {
    /// What memory there is, to be lent.
    pub(crate) fn words(&mut self) -> &mut Vec<Word> {
        &mut self.words
    }

    /// The same, to be given away.
    pub(crate) fn take_words(&mut self) -> Vec<Word> {
        take(&mut self.words)
    }

    /// Empty memory for so many words.
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

    /// Takes over memory, if it is more.
    pub(crate) fn keep_words(&mut self, words: Vec<Word>) {
        keep_larger(&mut self.words, words);
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        self.words.capacity() * size_of::<Word>()
    }
}
