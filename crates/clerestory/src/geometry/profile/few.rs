//! Rays against few parts: every part, several rays at a time, one in each lane of a vector register.
//!
//! In the section a ray is a line. Of a straight part's copies, a period apart, the one that is met first follows from two
//! divisions, however many periods the ray crosses. Copies of an arc are tried one after the other, from where the ray
//! enters its height to where a nearer hit is known.

#![allow(clippy::inline_always)] // Code for a processor's own instructions must be inlined where those are switched on.

use pulp::{Simd, WithSimd};

use super::lanes::{Lanes, Mask};
use super::part::Part;

/// Rays that are handled together: enough to hide the latency of the arithmetic, few enough for the first level of cache.
pub const BLOCK: usize = 64;

/// Periods that a ray may cross before it is given up.
pub const FARTHEST: u32 = 1 << 20;
/// Periods up to which copies have numbers.
const COUNTED: f64 = (1_u64 << 40) as f64;

/// Rays in the section, and what they meet.
pub struct Block<const B: usize> {
    /// Origin (metres).
    pub z: [f64; B],
    /// Origin (metres).
    pub y: [f64; B],
    /// Direction, of length 1 in space.
    pub dz: [f64; B],
    /// Direction, of length 1 in space.
    pub dy: [f64; B],
    /// The part that the ray leaves from; negative for none.
    pub own: [f64; B],
    /// The part that it meets; negative for none.
    pub part: [f64; B],
    /// Way to there in space (metres).
    pub distance: [f64; B],
    /// Place on the part, along its chord from its middle (metres).
    pub along: [f64; B],
    /// Place on the part, along its normal from its middle (metres).
    pub across: [f64; B],
}

impl<const B: usize> Block<B> {
    /// Empty.
    pub fn new() -> Self {
        Self {
            z: [0.0; B],
            y: [0.0; B],
            dz: [1.0; B],
            dy: [0.0; B],
            own: [-1.0; B],
            part: [-1.0; B],
            distance: [0.0; B],
            along: [0.0; B],
            across: [0.0; B],
        }
    }
}

/// A part with what its intersection needs.
#[derive(Debug, Clone, Copy)]
pub struct Target {
    middle: [f64; 2],
    normal: [f64; 2],
    /// A little more than half of the chord, so that ends that join leave no gap.
    half: f64,
    /// Normal's share of a period (metres), and one over it.
    step: f64,
    steps: f64,
    curvature: f64,
    radius: f64,
    z: [f64; 2],
    y_middle: f64,
    /// Half of the height over the period, and a little.
    reach: f64,
}

impl Target {
    /// Of a part in a section of a period.
    pub fn new(part: &Part, period: f64) -> Self {
        let step = part.normal[1] * period;
        Self {
            middle: part.middle,
            normal: part.normal,
            half: part.half * (1.0 + 1e-14),
            step,
            steps: 1.0 / step,
            curvature: part.curvature,
            radius: 1.0 / part.curvature,
            z: part.z,
            y_middle: 0.5 * (part.y[0] + part.y[1]),
            reach: 0.5 * (part.y[1] - part.y[0]) / period + 1e-9,
        }
    }
}

/// The work on one block.
pub struct Few<'a, const B: usize> {
    /// Parts.
    pub targets: &'a [Target],
    /// Of the section (metres).
    pub period: f64,
    /// Rays.
    pub block: &'a mut Block<B>,
    /// How many of them count.
    pub count: usize,
}

impl<const B: usize> WithSimd for Few<'_, B> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let mut first = 0;
        while first < self.count {
            let block = &mut *self.block;
            let load = |from: &[f64; B]| Lanes::load(simd, &from[first..]);
            let rays = Rays::new(
                [load(&block.z), load(&block.y)],
                [load(&block.dz), load(&block.dy)],
                load(&block.own),
                self.period,
            );
            let best = rays.meet(simd, self.targets);
            best.part.store(&mut block.part[first..]);
            (best.way / rays.length).store(&mut block.distance[first..]);
            best.along.store(&mut block.along[first..]);
            best.across.store(&mut block.across[first..]);
            first += S::F64_LANES;
        }
    }
}

/// Rays in the section, one a lane; directions are of length 1 there.
struct Rays<S: Simd> {
    z: Lanes<S>,
    y: Lanes<S>,
    dz: Lanes<S>,
    dy: Lanes<S>,
    own: Lanes<S>,
    /// Share of a direction's length that lies in the section.
    length: Lanes<S>,
    period: Lanes<S>,
    /// Periods a metre.
    frequency: Lanes<S>,
    /// One over dz.
    per_dz: Lanes<S>,
}

/// The nearest hits so far.
struct Best<S: Simd> {
    part: Lanes<S>,
    way: Lanes<S>,
    along: Lanes<S>,
    across: Lanes<S>,
}

impl<S: Simd> Best<S> {
    #[inline(always)]
    fn update(&mut self, ok: Mask<S>, part: Lanes<S>, way: Lanes<S>, along: Lanes<S>, across: Lanes<S>) {
        self.part = ok.select(part, self.part);
        self.way = ok.select(way, self.way);
        self.along = ok.select(along, self.along);
        self.across = ok.select(across, self.across);
    }
}

impl<S: Simd> Rays<S> {
    #[inline(always)]
    fn new([z, y]: [Lanes<S>; 2], [dz, dy]: [Lanes<S>; 2], own: Lanes<S>, period: f64) -> Self {
        let splat = |v| own.same(v);
        let length = (dz * dz + dy * dy).sqrt();
        let dy = dy / length;
        let dz = dz / length;
        // A ray exactly in the sample's plane is treated as one that ascends beyond all measure.
        let tiny = splat(1e-290);
        let dz = dz.abs().lt(tiny).select(tiny, dz);
        Self {
            z,
            y,
            dz,
            dy,
            own,
            length,
            period: splat(period),
            frequency: splat(1.0 / period),
            per_dz: splat(1.0) / dz,
        }
    }

    #[inline(always)]
    fn meet(&self, simd: S, targets: &[Target]) -> Best<S> {
        let splat = |v| Lanes::splat(simd, v);
        let mut best = Best {
            part: splat(-1.0),
            way: splat(f64::INFINITY),
            along: splat(0.0),
            across: splat(0.0),
        };
        for (k, target) in targets.iter().enumerate() {
            let number = splat(k as f64);
            if target.curvature != 0.0 {
                self.arc(target, number, &mut best);
            } else if target.normal[1] == 0.0 {
                self.upright(target, number, &mut best);
            } else {
                self.straight(target, number, &mut best);
            }
        }
        best
    }

    /// A straight part that lies in the sample's plane: all copies are at one distance.
    #[inline(always)]
    fn upright(&self, target: &Target, number: Lanes<S>, best: &mut Best<S>) {
        let splat = |v| self.z.same(v);
        let way = (splat(target.middle[0]) - self.z) * self.per_dz;
        // Height of the hit, and the copy whose middle is nearest.
        let y = self.y + way * self.dy - splat(target.middle[1]);
        let copy = (y * self.frequency + splat(0.5)).floor();
        let y = y - copy * self.period;
        let ok = y.abs().le(splat(target.half))
            & copy.abs().lt(splat(COUNTED))
            & splat(0.0).lt(way)
            & way.lt(best.way)
            & !self.own.eq(number);
        // The chord's way is along y or against it.
        best.update(ok, number, way, y * splat(-target.normal[0]), splat(0.0));
    }

    /// Any other straight part. Copy k's line is met at way (k·step − v)/c and at place (k·period·dz − q)/c along it, with v
    /// the origin's height over the line, c its rate of change, and q the line of sight's moment about the middle.
    #[inline(always)]
    fn straight(&self, target: &Target, number: Lanes<S>, best: &mut Best<S>) {
        let splat = |v| self.z.same(v);
        let [nz, ny] = target.normal.map(splat);
        let (oz, oy) = (self.z - splat(target.middle[0]), self.y - splat(target.middle[1]));
        let v = nz * oz + ny * oy;
        let v = self.own.eq(number).select(splat(0.0), v);
        let c = nz * self.dz + ny * self.dy;
        let q = self.dz * oy - self.dy * oz;
        // Copies in the order in which they are met.
        let order = (splat(target.step) * c).sign();
        let behind = v * splat(target.steps) * order;
        let copies = self.per_dz * self.frequency;
        let middle = q * copies * order;
        let reach = splat(target.half) * (c * copies).abs();
        let copy = (behind.floor() + splat(1.0)).max((middle - reach).ceil());
        let far = copy.le(middle + reach) & copy.abs().lt(splat(COUNTED));
        let copy = copy * order;
        let per_c = splat(1.0) / c;
        let way = (copy * splat(target.step) - v) * per_c;
        let along = (copy * self.period * self.dz - q) * per_c;
        let ok = far & splat(0.0).lt(way) & way.lt(best.way);
        best.update(ok, number, way, along, splat(0.0));
    }

    /// An arc. With t the way from the point of the ray that is nearest to the middle, κ t²/2 − c t + κ q²/2 − q m = 0.
    #[inline(always)]
    fn arc(&self, target: &Target, number: Lanes<S>, best: &mut Best<S>) {
        let splat = |v| self.z.same(v);
        let zero = splat(0.0);
        let (dz, dy) = (self.dz, self.dy);
        let (oz, oy) = (self.z - splat(target.middle[0]), self.y - splat(target.middle[1]));
        // Copies at the heights that the ray has within the arc's depth, in the order in which it reaches them.
        let order = dy.sign();
        let [a, b] = target.z.map(|z| (splat(z) - self.z) * self.per_dz);
        let (enters, leaves) = (a.min(b).max(zero), a.max(b));
        let height = (self.y - splat(target.y_middle)) * self.frequency * order;
        let slope = dy.abs().max(splat(1e-290)) * self.frequency;
        let reach = splat(target.reach);
        let mut copy = (height + enters * slope - reach).ceil();
        let last = height + leaves * slope + reach;
        if !(copy.le(last) & zero.le(leaves)).any() {
            return;
        }
        let last = zero.le(leaves).select(last, splat(-1e300));
        let [nz, ny] = target.normal.map(splat);
        let (curvature, radius, half) = (splat(target.curvature), splat(target.radius), splat(target.half));
        let c = nz * dz + ny * dy;
        let m = ny * dz - nz * dy;
        let q0 = dz * oy - dy * oz;
        let nearest0 = -(oz * dz + oy * dy);
        let (two_m, two_c_radius) = (m + m, (c + c) * radius);
        let c_sign = c.sign();
        let own = self.own.eq(number);
        for _ in 0..FARTHEST {
            // The ray comes to a copy's height where it is nearer than the best hit.
            let active = copy.le(last) & (copy - reach - height).le(best.way * slope);
            if !active.any() {
                return;
            }
            let up = copy * order * self.period;
            let q = q0 - up * dz;
            let nearest = nearest0 + up * dy;
            let kq = curvature * q;
            let root = (c * c + kq * (two_m - kq)).sqrt();
            let sum = c + root * c_sign;
            // The ray starts on its own circle: that intersection is not one.
            let itself = own & copy.eq(zero);
            let ways = [
                itself.select(two_c_radius + nearest, sum * radius),
                itself.select(splat(f64::NEG_INFINITY), q * (kq - two_m) / sum),
            ];
            for t in ways {
                let way = nearest + t;
                let along = t * m - q * c;
                let across = q * m + t * c;
                let ok = active
                    & zero.lt(way)
                    & way.lt(best.way)
                    & along.abs().le(half)
                    & (curvature * across).lt(splat(1.0));
                best.update(ok, number, way, along, across);
            }
            copy = copy + splat(1.0);
        }
    }
}
