//! Numbers in the lanes of a vector register, written like plain ones.
//!
//! Every lane does what a single number would do, without fused operations, so that results are the same on every
//! processor and however rays are put together.

#![allow(clippy::inline_always)] // Code for a processor's own instructions must be inlined where those are switched on.

use std::ops::{Add, BitAnd, Div, Mul, Neg, Not, Sub};

use pulp::Simd;

/// Numbers, one a lane.
#[derive(Clone, Copy)]
pub struct Lanes<S: Simd> {
    simd: S,
    value: S::f64s,
}

/// Yes or no, one a lane.
#[derive(Clone, Copy)]
pub struct Mask<S: Simd> {
    simd: S,
    value: S::m64s,
}

impl<S: Simd> Lanes<S> {
    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(simd: S, value: f64) -> Self {
        Self {
            simd,
            value: simd.splat_f64s(value),
        }
    }

    /// The first numbers of a slice that is at least as long as there are lanes.
    #[inline(always)]
    pub fn load(simd: S, from: &[f64]) -> Self {
        Self {
            simd,
            value: S::as_simd_f64s(from).0[0],
        }
    }

    /// Into the first numbers of a slice that is at least as long as there are lanes.
    #[inline(always)]
    pub fn store(self, to: &mut [f64]) {
        S::as_mut_simd_f64s(to).0[0] = self.value;
    }

    /// Another number, the same in every lane.
    #[inline(always)]
    pub fn same(self, value: f64) -> Self {
        Self::splat(self.simd, value)
    }

    #[inline(always)]
    fn with(self, value: S::f64s) -> Self {
        Self { value, ..self }
    }

    #[inline(always)]
    pub fn sqrt(self) -> Self {
        self.with(self.simd.sqrt_f64s(self.value))
    }

    #[inline(always)]
    pub fn abs(self) -> Self {
        self.with(self.simd.abs_f64s(self.value))
    }

    /// The greater one; `other` where this is not a number.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        self.gt(other).select(self, other)
    }

    /// The lesser one; `other` where this is not a number.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        self.lt(other).select(self, other)
    }

    /// 1 with the sign of each lane.
    #[inline(always)]
    pub fn sign(self) -> Self {
        let simd = self.simd;
        let bits = simd.and_f64s(simd.splat_f64s(-0.0), self.value);
        self.with(simd.or_f64s(simd.splat_f64s(1.0), bits))
    }

    /// The greatest whole number that is not above, for all that count (below 2^51).
    #[inline(always)]
    pub fn floor(self) -> Self {
        let shift = Self::splat(self.simd, 6_755_399_441_055_744.0);
        let nearest = self + shift - shift;
        nearest
            - nearest
                .gt(self)
                .select(Self::splat(self.simd, 1.0), Self::splat(self.simd, 0.0))
    }

    /// The least whole number that is not below.
    #[inline(always)]
    pub fn ceil(self) -> Self {
        -(-self).floor()
    }

    #[inline(always)]
    pub fn lt(self, other: Self) -> Mask<S> {
        self.mask(self.simd.less_than_f64s(self.value, other.value))
    }

    #[inline(always)]
    pub fn le(self, other: Self) -> Mask<S> {
        self.mask(self.simd.less_than_or_equal_f64s(self.value, other.value))
    }

    #[inline(always)]
    pub fn gt(self, other: Self) -> Mask<S> {
        other.lt(self)
    }

    #[inline(always)]
    pub fn eq(self, other: Self) -> Mask<S> {
        self.mask(self.simd.equal_f64s(self.value, other.value))
    }

    #[inline(always)]
    fn mask(self, value: S::m64s) -> Mask<S> {
        Mask { simd: self.simd, value }
    }
}

impl<S: Simd> Mask<S> {
    /// One or the other number in each lane.
    #[inline(always)]
    pub fn select(self, yes: Lanes<S>, no: Lanes<S>) -> Lanes<S> {
        yes.with(self.simd.select_f64s(self.value, yes.value, no.value))
    }

    /// Some lane says yes.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.simd.first_true_m64s(self.value) < S::F64_LANES
    }
}

impl<S: Simd> BitAnd for Mask<S> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self {
            value: self.simd.and_m64s(self.value, other.value),
            ..self
        }
    }
}

impl<S: Simd> Not for Mask<S> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self {
            value: self.simd.not_m64s(self.value),
            ..self
        }
    }
}

macro_rules! arithmetic {
    ($($name:ident $call:ident $simd:ident),*) => {$(
        impl<S: Simd> $name for Lanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $call(self, other: Self) -> Self {
                self.with(self.simd.$simd(self.value, other.value))
            }
        }
    )*};
}

arithmetic!(Add add add_f64s, Sub sub sub_f64s, Mul mul mul_f64s, Div div div_f64s);

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.with(self.simd.neg_f64s(self.value))
    }
}
