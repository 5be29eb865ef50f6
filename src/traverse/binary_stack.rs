//! A stack of fixed size whose unused part is never written.

use core::mem::MaybeUninit;

/// A stack of at most `N` values, on the thread's stack.
///
/// It is not cleared first: at 1 KiB that would take as long as several steps of the traversal.
///
/// The memory is borrowed. If one local held both the length and the values, the length would be
/// kept in memory too, and each push would wait for the store of the last one.
pub(super) struct Stack<'m, T, const N: usize> {
    values: &'m mut [MaybeUninit<T>; N],
    /// `values[..len]` are initialised; only `push` and `pop` change it.
    len: usize,
}

impl<'m, T: Copy, const N: usize> Stack<'m, T, N> {
    /// Returns the memory that [`new`](Self::new) borrows.
    #[inline(always)]
    pub fn memory() -> [MaybeUninit<T>; N] {
        [const { MaybeUninit::uninit() }; N]
    }

    #[inline(always)]
    pub fn new(memory: &'m mut [MaybeUninit<T>; N]) -> Self {
        Self { values: memory, len: 0 }
    }

    /// Puts a value on top.
    ///
    /// # Panics
    ///
    /// Panics if the stack already holds `N` values.
    #[inline(always)]
    pub fn push(&mut self, value: T) {
        self.values[self.len].write(value);
        self.len += 1;
    }

    #[inline(always)]
    pub fn pop(&mut self) -> Option<T> {
        self.len = self.len.checked_sub(1)?;
        let value = self.values.get(self.len)?;
        // SAFETY: `push` has initialised `values[..len]`, and `value` was in it until `len`
        // was lowered above.
        Some(unsafe { value.assume_init() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn last_in_first_out() {
        let mut memory = Stack::memory();
        let mut stack = Stack::<u32, 3>::new(&mut memory);
        assert_eq!(stack.pop(), None);
        for value in [1, 2, 3] {
            stack.push(value);
        }
        assert_eq!([stack.pop(), stack.pop()], [Some(3), Some(2)]);
        stack.push(4);
        assert_eq!([stack.pop(), stack.pop(), stack.pop()], [Some(4), Some(1), None]);
    }
}
