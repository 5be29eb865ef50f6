//! The definition of a vector type, as a list of its operations.

/// Defines a vector type and its mask type.
///
/// Each value holds the token, which proves that the processor has the
/// instructions of its operations.
macro_rules! vector {
    (
        $(#[$attribute:meta])*
        $lanes:ident($vector:ty), $mask:ident($flags:ty): $count:literal of $scalar:ty, $isa:ty;
        splat($splat_value:ident) = $splat:expr;
        load($load_from:ident) = $load:expr;
        load_bytes($bytes_from:ident) = $load_bytes:expr;
        store($store_a:ident, $store_to:ident) = $store:expr;
        add($add_a:ident, $add_b:ident) = $add:expr;
        sub($sub_a:ident, $sub_b:ident) = $sub:expr;
        mul($mul_a:ident, $mul_b:ident) = $mul:expr;
        div($div_a:ident, $div_b:ident) = $div:expr;
        mul_add($fma_a:ident, $fma_b:ident, $fma_c:ident) = $mul_add:expr;
        abs($abs_a:ident) = $abs:expr;
        sqrt($sqrt_a:ident) = $sqrt:expr;
        min($min_a:ident, $min_b:ident) = $min:expr;
        max($max_a:ident, $max_b:ident) = $max:expr;
        lt($lt_a:ident, $lt_b:ident) = $lt:expr;
        le($le_a:ident, $le_b:ident) = $le:expr;
        orders_by_bits = $orders_by_bits:literal;
        later($later_a:ident, $later_b:ident) = $later:expr;
        earlier($earlier_a:ident, $earlier_b:ident) = $earlier:expr;
        not_after($after_a:ident, $after_b:ident) = $not_after:expr;
        select($else_a:ident, $else_mask:ident, $else_b:ident) = $select:expr;
        and($and_a:ident, $and_b:ident) = $and:expr;
        or($or_a:ident, $or_b:ident) = $or:expr;
        not($not_a:ident) = $not:expr;
        bits($bits_mask:ident) = $bits:expr;
        $($more:item)*
    ) => {
        $(#[$attribute])*
        #[derive(Clone, Copy)]
        pub struct $lanes($vector, $isa);

        #[derive(Clone, Copy)]
        pub struct $mask($flags, $isa);

        crate::simd::vector::operators! {
            $lanes: Add::add($add_a, $add_b) = $add;
            $lanes: Sub::sub($sub_a, $sub_b) = $sub;
            $lanes: Mul::mul($mul_a, $mul_b) = $mul;
            $lanes: Div::div($div_a, $div_b) = $div;
            $mask: BitAnd::bitand($and_a, $and_b) = $and;
            $mask: BitOr::bitor($or_a, $or_b) = $or;
            $mask: Not::not($not_a) = $not;
        }

        impl crate::simd::Lanes<$scalar> for $lanes {
            const COUNT: usize = $count;
            type Mask = $mask;

            crate::simd::vector::methods! {
                min($min_a, $min_b) -> $lanes = $min;
                max($max_a, $max_b) -> $lanes = $max;
                abs($abs_a) -> $lanes = $abs;
                sqrt($sqrt_a) -> $lanes = $sqrt;
                lt($lt_a, $lt_b) -> $mask = $lt;
                le($le_a, $le_b) -> $mask = $le;
            }
            #[inline(always)]
            fn select(self, $else_mask: $mask, $else_b: Self) -> Self {
                let ($else_a, $else_mask, $else_b) = (self.0, $else_mask.0, $else_b.0);
                // SAFETY: the vector holds the token: the processor has the instructions.
                Self(unsafe { $select }, self.1)
            }
            #[inline(always)]
            fn bits($bits_mask: $mask) -> u32 {
                let $bits_mask = $bits_mask.0;
                // SAFETY: the mask holds the token: the processor has the instructions.
                unsafe { $bits }
            }
        }

        impl crate::simd::KernelLanes<$scalar> for $lanes {
            type Isa = $isa;
            type Flags = $mask;

            #[inline(always)]
            fn splat(isa: $isa, $splat_value: $scalar) -> Self {
                // SAFETY: the token proves that the processor has the instructions.
                Self(unsafe { $splat }, isa)
            }
            #[inline(always)]
            unsafe fn load(isa: $isa, $load_from: *const $scalar) -> Self {
                // SAFETY: the token proves the instructions; the caller promises `COUNT` scalars.
                Self(unsafe { $load }, isa)
            }
            #[inline(always)]
            unsafe fn load_bytes(isa: $isa, $bytes_from: *const u8) -> Self {
                // SAFETY: the token proves the instructions; the caller promises `COUNT` bytes.
                Self(unsafe { $load_bytes }, isa)
            }
            #[inline(always)]
            fn store(self, to: &mut [$scalar]) {
                let ($store_a, $store_to) = (self.0, to[..$count].as_mut_ptr());
                // SAFETY: the vector holds the token; the slice has `COUNT` scalars.
                unsafe { $store }
            }
            #[inline(always)]
            fn lane(self, lane: usize) -> $scalar {
                let mut scalars = [0.0; $count];
                self.store(&mut scalars);
                scalars[lane]
            }
            #[inline(always)]
            fn orders_by_bits(_: $isa) -> bool {
                $orders_by_bits
            }
            #[inline(always)]
            fn isa(self) -> $isa {
                self.1
            }
            crate::simd::vector::methods! {
                mul_add($fma_a, $fma_b, $fma_c) -> $lanes = $mul_add;
                later($later_a, $later_b) -> $lanes = $later;
                earlier($earlier_a, $earlier_b) -> $lanes = $earlier;
                not_after($after_a, $after_b) -> $mask = $not_after;
            }
            $($more)*
        }
    };
}

/// Methods of vectors.
macro_rules! methods {
    ($($method:ident($a:ident $(, $other:ident)*) -> $result:ident = $value:expr;)*) => {
        $(#[inline(always)]
        fn $method(self $(, $other: Self)*) -> $result {
            let ($a, $($other,)*) = (self.0, $($other.0,)*);
            // SAFETY: the value holds the token: the processor has the instructions.
            $result(unsafe { $value }, self.1)
        })*
    };
}

/// Operators of vectors and masks.
macro_rules! operators {
    ($($type:ident: $operator:ident::$method:ident($a:ident $(, $other:ident)?) = $value:expr;)*) => {
        $(impl core::ops::$operator for $type {
            type Output = Self;
            crate::simd::vector::methods! { $method($a $(, $other)?) -> $type = $value; }
        })*
    };
}

pub(super) use {methods, operators, vector};
