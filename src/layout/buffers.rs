//! Memory that one layout leaves to the next.

use super::blocks::Blocks;
use alloc::boxed::Box;
use alloc::vec::Vec;
use core::any::Any;
use core::mem::take;

/// The large buffers of a layout.
#[doc(hidden)]
#[derive(Debug, Default)]
pub struct Buffers {
    blocks: Blocks,
    /// A vector, of what depends on the layout's width.
    weights: Option<Box<dyn Any + Send>>,
    weights_bytes: usize,
}

impl Buffers {
    /// Memory for blocks.
    pub(super) fn blocks(&mut self) -> Blocks {
        take(&mut self.blocks)
    }

    /// Takes over the memory of blocks, if it is more.
    pub(super) fn keep_blocks(&mut self, blocks: Blocks) {
        if blocks.bytes() > self.blocks.bytes() {
            self.blocks = blocks;
        }
    }

    /// Memory for weights, empty.
    pub(super) fn weights<W: Send + 'static>(&mut self) -> Vec<W> {
        self.weights_bytes = 0;
        let weights = self.weights.take().and_then(|weights| weights.downcast().ok());
        weights.map_or_else(Vec::new, |weights| *weights)
    }

    /// Takes it over.
    pub(super) fn keep_weights<W: Send + 'static>(&mut self, mut weights: Vec<W>) {
        weights.clear();
        self.weights_bytes = weights.capacity() * size_of::<W>();
        self.weights = Some(Box::new(weights));
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        self.blocks.bytes() + self.weights_bytes
    }
}
