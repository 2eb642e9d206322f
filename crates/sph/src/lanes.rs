//! Four numbers at a time, with the instructions that the processor has.
//!
//! Every operation is the IEEE operation on each of the four numbers and none is fused, so that a sweep written
//! with them has the same bits on every processor.

/// An instruction set.
pub(crate) trait Lanes: Copy + Send + Sync {
    /// Four numbers.
    type Four: Copy;

    /// Runs `task` compiled for this instruction set; `task` has to be marked `#[inline(always)]`.
    fn run<R>(self, task: impl FnOnce() -> R) -> R;
    /// The four numbers from `place` on.
    fn load(self, values: &[f64], place: usize) -> Self::Four;
    fn four(self, values: [f64; 4]) -> Self::Four;
    fn values(self, a: Self::Four) -> [f64; 4];
    fn add(self, a: Self::Four, b: Self::Four) -> Self::Four;
    fn sub(self, a: Self::Four, b: Self::Four) -> Self::Four;
    fn mul(self, a: Self::Four, b: Self::Four) -> Self::Four;
    /// Number k of the result is number `(ORDER >> 2 k) & 3` of `a`; [`order`] makes it.
    fn pick<const ORDER: i32>(self, a: Self::Four) -> Self::Four;

    /// Bit k tells whether number k is below `limit`.
    fn below(self, a: Self::Four, limit: f64) -> u32;

    /// Four times the same.
    #[inline(always)]
    fn all(self, value: f64) -> Self::Four {
        self.four([value; 4])
    }
}

/// What [`Lanes::pick`] takes for the numbers `from` in this order.
pub(crate) const fn order(from: [i32; 4]) -> i32 {
    from[0] | from[1] << 2 | from[2] << 4 | from[3] << 6
}

/// Runs `$body` with `$lanes` as the best instruction set of this processor.
macro_rules! with_lanes {
    ($lanes:ident => $body:expr) => {{
        #[cfg(target_arch = "x86_64")]
        {
            if let Some($lanes) = pulp::x86::V3::try_new() {
                $body
            } else {
                let $lanes = crate::lanes::Plain;
                $body
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            let $lanes = crate::lanes::Plain;
            $body
        }
    }};
}
pub(crate) use with_lanes;

/// What every processor has.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plain;

impl Lanes for Plain {
    type Four = [f64; 4];

    #[inline(always)]
    fn run<R>(self, task: impl FnOnce() -> R) -> R {
        task()
    }

    #[inline(always)]
    fn load(self, values: &[f64], place: usize) -> [f64; 4] {
        *values[place..].first_chunk().expect("four numbers")
    }

    #[inline(always)]
    fn four(self, values: [f64; 4]) -> [f64; 4] {
        values
    }

    #[inline(always)]
    fn values(self, a: [f64; 4]) -> [f64; 4] {
        a
    }

    #[inline(always)]
    fn add(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        std::array::from_fn(|k| a[k] + b[k])
    }

    #[inline(always)]
    fn sub(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        std::array::from_fn(|k| a[k] - b[k])
    }

    #[inline(always)]
    fn mul(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        std::array::from_fn(|k| a[k] * b[k])
    }

    #[inline(always)]
    fn pick<const ORDER: i32>(self, a: [f64; 4]) -> [f64; 4] {
        std::array::from_fn(|k| a[((ORDER >> (2 * k)) & 3) as usize])
    }

    #[inline(always)]
    fn below(self, a: [f64; 4], limit: f64) -> u32 {
        a.iter().rev().fold(0, |bits, number| bits << 1 | u32::from(*number < limit))
    }
}

#[cfg(target_arch = "x86_64")]
impl Lanes for pulp::x86::V3 {
    type Four = pulp::f64x4;

    #[inline(always)]
    fn run<R>(self, task: impl FnOnce() -> R) -> R {
        pulp::Simd::vectorize(self, Task(task))
    }

    #[inline(always)]
    fn load(self, values: &[f64], place: usize) -> pulp::f64x4 {
        let four: &[f64; 4] = values[place..].first_chunk().expect("four numbers");
        *pulp::bytemuck::cast_ref(four)
    }

    #[inline(always)]
    fn four(self, values: [f64; 4]) -> pulp::f64x4 {
        pulp::f64x4(values[0], values[1], values[2], values[3])
    }

    #[inline(always)]
    fn values(self, a: pulp::f64x4) -> [f64; 4] {
        [a.0, a.1, a.2, a.3]
    }

    #[inline(always)]
    fn add(self, a: pulp::f64x4, b: pulp::f64x4) -> pulp::f64x4 {
        self.add_f64x4(a, b)
    }

    #[inline(always)]
    fn sub(self, a: pulp::f64x4, b: pulp::f64x4) -> pulp::f64x4 {
        self.sub_f64x4(a, b)
    }

    #[inline(always)]
    fn mul(self, a: pulp::f64x4, b: pulp::f64x4) -> pulp::f64x4 {
        self.mul_f64x4(a, b)
    }

    #[inline(always)]
    fn pick<const ORDER: i32>(self, a: pulp::f64x4) -> pulp::f64x4 {
        pulp::cast(self.avx2._mm256_permute4x64_pd::<ORDER>(pulp::cast(a)))
    }

    #[inline(always)]
    fn below(self, a: pulp::f64x4, limit: f64) -> u32 {
        let all = pulp::cast(pulp::f64x4(limit, limit, limit, limit));
        let is_below =
            self.avx._mm256_cmp_pd::<{ std::arch::x86_64::_CMP_LT_OQ }>(pulp::cast(a), all);
        self.avx._mm256_movemask_pd(is_below).cast_unsigned()
    }
}

/// A closure as pulp wants it.
#[cfg(target_arch = "x86_64")]
struct Task<F>(F);

#[cfg(target_arch = "x86_64")]
impl<R, F: FnOnce() -> R> pulp::WithSimd for Task<F> {
    type Output = R;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> R {
        (self.0)()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums, products and another order of numbers of all sizes.
    fn mixture<L: Lanes>(lanes: L) -> Vec<[u64; 4]> {
        let mut sum = lanes.all(0.1);
        let mut seen = Vec::new();
        for k in 0..200 {
            let wave = |shift: f64| (f64::from(k) * 0.7 + shift).sin() * 10_f64.powi(k % 40 - 20);
            let a = lanes.four([wave(0.0), wave(0.3), wave(1.1), wave(2.9)]);
            let turned = lanes.pick::<{ order([3, 0, 0, 2]) }>(a);
            sum = lanes.add(lanes.mul(sum, turned), lanes.sub(a, sum));
            seen.push(lanes.values(sum).map(f64::to_bits));
            seen.push([u64::from(lanes.below(sum, lanes.values(a)[0])), 0, 0, 0]);
        }
        seen
    }

    #[test]
    fn every_instruction_set_has_the_same_bits() {
        let plain = mixture(Plain);
        with_lanes!(lanes => assert_eq!(lanes.run(|| mixture(lanes)), plain));
    }
}
