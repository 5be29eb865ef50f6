//! Memory that one layout leaves to the next.

use crate::memory::{Word, fitting, keep_larger};
use alloc::boxed::Box;
use alloc::vec::Vec;
use core::any::Any;
use core::mem::take;

/// The large buffers of a layout.
#[doc(hidden)]
#[derive(Default)]
pub struct Buffers {
    words: Vec<Word>,
    /// Whether the words were left by an earlier hierarchy; else they are new, and cut to size behind the one that is made in them.
    pub(crate) is_reused: bool,
    /// A vector, of what depends on the layout's width.
    weights: Option<Box<dyn Any + Send + Sync>>,
    weights_bytes: usize,
}

impl Buffers {
    /// What memory there is for blocks.
    pub(crate) fn take_words(&mut self) -> Vec<Word> {
        take(&mut self.words)
    }

    /// Empty memory for so many words.
    pub(super) fn words_for(&mut self, len: usize) -> Vec<Word> {
        if self.is_reused {
            return fitting(&mut self.words, len);
        }
        let words = self.take_words();
        if words.capacity() >= len {
            return words;
        }
        drop(words);
        Vec::with_capacity(len)
    }

    /// Takes over the memory of blocks, if it is more.
    pub(crate) fn keep_words(&mut self, words: Vec<Word>) {
        keep_larger(&mut self.words, words);
    }

    /// Memory for weights, empty.
    pub(super) fn weights<W: Send + Sync + 'static>(&mut self) -> Vec<W> {
        self.weights_bytes = 0;
        let weights = self.weights.take().and_then(|weights| weights.downcast().ok());
        weights.map_or_else(Vec::new, |weights| *weights)
    }

    /// Takes it over.
    pub(super) fn keep_weights<W: Send + Sync + 'static>(&mut self, mut weights: Vec<W>) {
        weights.clear();
        self.weights_bytes = weights.capacity() * size_of::<W>();
        self.weights = Some(Box::new(weights));
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        self.words.capacity() * size_of::<Word>() + self.weights_bytes
    }
}
