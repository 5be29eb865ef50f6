//! Memory that one layout leaves to the next.

use crate::memory::{Word, keep_larger};
use alloc::boxed::Box;
use alloc::vec::Vec;
use core::any::Any;

/// The large buffers of a layout.
#[doc(hidden)]
#[derive(Default)]
pub struct Buffers {
    words: Vec<Word>,
    /// A vector, of what depends on the layout's width.
    weights: Option<Box<dyn Any + Send + Sync>>,
    weights_bytes: usize,
}

impl Buffers {
    /// Memory for blocks.
    pub(crate) fn words(&mut self) -> &mut Vec<Word> {
        &mut self.words
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
