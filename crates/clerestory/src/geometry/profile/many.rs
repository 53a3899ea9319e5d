//! Rays against many parts: a hierarchy of boxes, several of them or several parts at a time, in the lanes of vector registers.

#![allow(clippy::inline_always)] // Code for a processor's own instructions must be inlined where those are switched on.

use pulp::{Simd, WithSimd};

use super::few::{Block, FARTHEST};
use super::lanes::{Lanes, Mask};
use super::part::Part;

/// Boxes of a node; as many as the widest registers have lanes.
const WIDTH: usize = 8;
/// Parts of a leaf at most; there is room for as many as the widest registers have lanes.
const FULL: usize = 4;
/// Marks a leaf among children.
const LEAF: u32 = 1 << 31;

type Eight = [f64; WIDTH];

/// Limits along z and y.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    low: [f64; 2],
    high: [f64; 2],
}

impl Bounds {
    const NONE: Self = Self {
        low: [f64::INFINITY; 2],
        high: [f64::NEG_INFINITY; 2],
    };

    fn of(parts: &[(u32, Self)]) -> Self {
        parts.iter().fold(Self::NONE, |all, (_, b)| Self {
            low: [all.low[0].min(b.low[0]), all.low[1].min(b.low[1])],
            high: [all.high[0].max(b.high[0]), all.high[1].max(b.high[1])],
        })
    }

    /// What rays from everywhere see of it.
    fn size(&self) -> f64 {
        self.high[0] - self.low[0] + self.high[1] - self.low[1]
    }

    fn middle(&self, axis: usize) -> f64 {
        self.low[axis] + self.high[axis]
    }
}

/// Eight boxes and what is in them; what is not used is infinitely far away.
#[derive(Debug, Clone)]
struct Node {
    z_low: Eight,
    z_high: Eight,
    y_low: Eight,
    y_high: Eight,
    children: [u32; WIDTH],
}

/// A few parts; what is not used has a negative length.
#[derive(Debug, Clone)]
struct Leaf {
    z: Eight,
    y: Eight,
    normal_z: Eight,
    normal_y: Eight,
    half: Eight,
    curvature: Eight,
    radius: Eight,
    number: Eight,
    /// None of them is an arc.
    straight: bool,
}

/// A hierarchy of parts.
#[derive(Debug, Clone)]
pub struct Tree {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    bounds: Bounds,
    period: f64,
}

impl Tree {
    /// Of the parts from number `first` on, if there are any.
    pub fn new(parts: &[Part], first: usize, period: f64) -> Option<Self> {
        let mut boxes: Vec<(u32, Bounds)> = (first..parts.len())
            .map(|k| {
                let part = &parts[k];
                // Rounding must not make a ray miss the box of what it meets.
                let margin = 1e-12 * (period + part.z[0].abs() + part.z[1].abs() + part.y[0].abs() + part.y[1].abs());
                let bounds = Bounds {
                    low: [part.z[0] - margin, part.y[0] - margin],
                    high: [part.z[1] + margin, part.y[1] + margin],
                };
                (k as u32, bounds)
            })
            .collect();
        if boxes.is_empty() {
            return None;
        }
        let mut tree = Self {
            nodes: Vec::new(),
            leaves: Vec::new(),
            bounds: Bounds::of(&boxes),
            period,
        };
        tree.build(&mut boxes, parts);
        Some(tree)
    }

    fn build(&mut self, boxes: &mut [(u32, Bounds)], parts: &[Part]) -> u32 {
        // The group that costs most is split until there are eight.
        let mut groups = vec![boxes];
        while groups.len() < WIDTH {
            let cost = |g: &[(u32, Bounds)]| Bounds::of(g).size() * g.len() as f64;
            let worst = (0..groups.len())
                .filter(|&k| groups[k].len() > FULL)
                .max_by(|&a, &b| cost(groups[a]).total_cmp(&cost(groups[b])));
            let Some(worst) = worst else { break };
            let [a, b] = split(groups.swap_remove(worst));
            groups.push(a);
            groups.push(b);
        }
        let index = self.nodes.len();
        self.nodes.push(Node {
            z_low: [f64::INFINITY; WIDTH],
            z_high: [f64::INFINITY; WIDTH],
            y_low: [f64::INFINITY; WIDTH],
            y_high: [f64::INFINITY; WIDTH],
            children: [0; WIDTH],
        });
        for (k, group) in groups.into_iter().enumerate() {
            let bounds = Bounds::of(group);
            let child = if group.len() <= FULL {
                self.leaves.push(leaf(group, parts));
                (self.leaves.len() - 1) as u32 | LEAF
            } else {
                self.build(group, parts)
            };
            let node = &mut self.nodes[index];
            (node.z_low[k], node.z_high[k]) = (bounds.low[0], bounds.high[0]);
            (node.y_low[k], node.y_high[k]) = (bounds.low[1], bounds.high[1]);
            node.children[k] = child;
        }
        index as u32
    }
}

fn leaf(group: &[(u32, Bounds)], parts: &[Part]) -> Leaf {
    let field = |other: f64, of: fn(&Part) -> f64| {
        std::array::from_fn(|k| group.get(k).map_or(other, |(number, _)| of(&parts[*number as usize])))
    };
    Leaf {
        z: field(0.0, |p| p.middle[0]),
        y: field(0.0, |p| p.middle[1]),
        normal_z: field(1.0, |p| p.normal[0]),
        normal_y: field(0.0, |p| p.normal[1]),
        half: field(-1.0, |p| p.half * (1.0 + 1e-14)),
        curvature: field(0.0, |p| p.curvature),
        radius: field(1.0, |p| 1.0 / p.curvature),
        straight: group.iter().all(|(number, _)| parts[*number as usize].curvature == 0.0),
        number: std::array::from_fn(|k| group.get(k).map_or(-2.0, |(number, _)| f64::from(*number))),
    }
}

/// In two, where rays need the fewest tests (the surface area heuristic, in the plane).
fn split(group: &mut [(u32, Bounds)]) -> [&mut [(u32, Bounds)]; 2] {
    let mut best = (f64::INFINITY, 0, 0);
    for axis in 0..2 {
        sort(group, axis);
        let mut from_end: Vec<f64> = Vec::with_capacity(group.len());
        let mut all = Bounds::NONE;
        let grow = |all: &mut Bounds, b: &Bounds| *all = Bounds::of(&[(0, *all), (0, *b)]);
        for (_, b) in group.iter().rev() {
            grow(&mut all, b);
            from_end.push(all.size());
        }
        let mut all = Bounds::NONE;
        for k in 1..group.len() {
            grow(&mut all, &group[k - 1].1);
            let cost = all.size() * k as f64 + from_end[group.len() - k - 1] * (group.len() - k) as f64;
            if cost < best.0 {
                best = (cost, axis, k);
            }
        }
    }
    let (_, axis, at) = best;
    sort(group, axis);
    let (a, b) = group.split_at_mut(at.max(1));
    [a, b]
}

fn sort(group: &mut [(u32, Bounds)], axis: usize) {
    group.sort_by(|a, b| a.1.middle(axis).total_cmp(&b.1.middle(axis)).then(a.0.cmp(&b.0)));
}

/// The work on one block, of which each ray's nearest hit with other parts is known.
pub struct Many<'a, const B: usize> {
    /// Parts.
    pub tree: &'a Tree,
    /// Rays.
    pub block: &'a mut Block<B>,
    /// How many of them count.
    pub count: usize,
}

impl<const B: usize> WithSimd for Many<'_, B> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let block = self.block;
        let mut stack = Vec::with_capacity(64);
        for k in 0..self.count {
            let length = (block.dz[k] * block.dz[k] + block.dy[k] * block.dy[k]).sqrt();
            let mut best = Best {
                way: if block.part[k] < 0.0 {
                    f64::INFINITY
                } else {
                    block.distance[k] * length
                },
                part: -1.0,
                along: 0.0,
                across: 0.0,
            };
            let ray = Line {
                z: block.z[k],
                y: block.y[k],
                dz: beyond_zero(block.dz[k] / length),
                dy: beyond_zero(block.dy[k] / length),
                own: block.own[k],
            };
            self.tree.meet(simd, &ray, &mut best, &mut stack);
            if best.part >= 0.0 {
                block.part[k] = best.part;
                block.distance[k] = best.way / length;
                block.along[k] = best.along;
                block.across[k] = best.across;
            }
        }
    }
}

/// Never so small that one over it is not finite.
#[inline(always)]
fn beyond_zero(d: f64) -> f64 {
    if d.abs() < 1e-290 { 1e-290 } else { d }
}

struct Best {
    way: f64,
    part: f64,
    along: f64,
    across: f64,
}

/// A ray in the section; its direction is of length 1 there.
struct Line {
    z: f64,
    y: f64,
    dz: f64,
    dy: f64,
    own: f64,
}

impl Tree {
    /// The nearest hit, if it is nearer than the best one so far.
    #[inline(always)]
    fn meet<S: Simd>(&self, simd: S, ray: &Line, best: &mut Best, stack: &mut Vec<(f64, u32)>) {
        let (per_dz, per_dy) = (1.0 / ray.dz, 1.0 / ray.dy);
        let (a, b) = (
            (self.bounds.low[0] - ray.z) * per_dz,
            (self.bounds.high[0] - ray.z) * per_dz,
        );
        let (enters, leaves) = (a.min(b).max(0.0), a.max(b));
        let crosses = enters <= leaves; // Not so where something is not a number.
        if !crosses {
            return;
        }
        // Periods in the order in which the ray reaches them.
        let order = 1.0_f64.copysign(ray.dy);
        let middle = 0.5 * self.bounds.middle(1);
        let reach = 0.5 * (self.bounds.high[1] - self.bounds.low[1]) / self.period + 1e-9;
        let height = (ray.y - middle) / self.period * order;
        let slope = ray.dy.abs() / self.period;
        let mut copy = (height + enters * slope - reach).ceil();
        let last = height + leaves * slope + reach;
        for _ in 0..FARTHEST {
            let reaches = copy <= last && copy - reach - height <= best.way * slope;
            if !reaches {
                return;
            }
            let k = copy * order;
            let shifted = Line {
                y: ray.y - k * self.period,
                own: if k == 0.0 { ray.own } else { -1.0 },
                ..*ray
            };
            self.meet_copy(simd, &shifted, [per_dz, per_dy], best, stack);
            copy += 1.0;
        }
    }

    #[inline(always)]
    fn meet_copy<S: Simd>(
        &self,
        simd: S,
        ray: &Line,
        [per_dz, per_dy]: [f64; 2],
        best: &mut Best,
        stack: &mut Vec<(f64, u32)>,
    ) {
        let splat = |v| Lanes::splat(simd, v);
        let (z, y, per_dz, per_dy) = (splat(ray.z), splat(ray.y), splat(per_dz), splat(per_dy));
        stack.clear();
        stack.push((0.0, 0));
        while let Some((enters, child)) = stack.pop() {
            if enters > best.way {
                continue;
            }
            if child & LEAF != 0 {
                self.leaves[(child & !LEAF) as usize].meet(simd, ray, best);
                continue;
            }
            let node = &self.nodes[child as usize];
            let first = stack.len();
            let mut ways = [f64::INFINITY; WIDTH];
            for k in (0..WIDTH).step_by(S::F64_LANES) {
                let load = |from: &Eight| Lanes::load(simd, &from[k..]);
                let (z0, z1) = ((load(&node.z_low) - z) * per_dz, (load(&node.z_high) - z) * per_dz);
                let (y0, y1) = ((load(&node.y_low) - y) * per_dy, (load(&node.y_high) - y) * per_dy);
                let enters = z0.min(z1).max(y0.min(y1)).max(splat(0.0));
                let leaves = z0.max(z1).min(y0.max(y1)).min(splat(best.way));
                enters
                    .le(leaves)
                    .select(enters, splat(f64::INFINITY))
                    .store(&mut ways[k..]);
            }
            // The nearest comes off first.
            for (&way, &child) in ways.iter().zip(&node.children) {
                if way < f64::INFINITY {
                    stack.push((way, child));
                    let mut at = stack.len() - 1;
                    while at > first && stack[at - 1].0 < way {
                        stack.swap(at - 1, at);
                        at -= 1;
                    }
                }
            }
        }
    }
}

impl Leaf {
    /// As for arcs in [`super::few`], with a part in each lane; a straight part's second way is the one.
    #[inline(always)]
    fn meet<S: Simd>(&self, simd: S, ray: &Line, best: &mut Best) {
        let splat = |v| Lanes::splat(simd, v);
        let zero = splat(0.0);
        let (dz, dy) = (splat(ray.dz), splat(ray.dy));
        for k in (0..FULL).step_by(S::F64_LANES) {
            let load = |from: &Eight| Lanes::load(simd, &from[k..]);
            let (nz, ny) = (load(&self.normal_z), load(&self.normal_y));
            let (oz, oy) = (splat(ray.z) - load(&self.z), splat(ray.y) - load(&self.y));
            let half = load(&self.half);
            let c = nz * dz + ny * dy;
            let q = dz * oy - dy * oz;
            let itself = load(&self.number).eq(splat(ray.own));
            if self.straight {
                let per_c = splat(1.0) / c;
                let way = -(nz * oz + ny * oy) * per_c;
                let along = -q * per_c;
                let ok = zero.lt(way) & way.lt(splat(best.way)) & along.abs().le(half) & !itself;
                self.take(ok, k, way, along, zero, best);
                continue;
            }
            let (curvature, radius) = (load(&self.curvature), load(&self.radius));
            let m = ny * dz - nz * dy;
            let nearest = -(oz * dz + oy * dy);
            let two_m = m + m;
            let kq = curvature * q;
            let root = (c * c + kq * (two_m - kq)).sqrt();
            let sum = c + root * c.sign();
            let ways = [
                itself.select((c + c) * radius + nearest, sum * radius),
                itself.select(splat(f64::NEG_INFINITY), q * (kq - two_m) / sum),
            ];
            for t in ways {
                let way = nearest + t;
                let along = t * m - q * c;
                let across = q * m + t * c;
                let ok =
                    zero.lt(way) & way.lt(splat(best.way)) & along.abs().le(half) & (curvature * across).lt(splat(1.0));
                self.take(ok, k, way, along, across, best);
            }
        }
    }

    /// The nearest of the lanes that count.
    #[inline(always)]
    fn take<S: Simd>(
        &self,
        ok: Mask<S>,
        first: usize,
        way: Lanes<S>,
        along: Lanes<S>,
        across: Lanes<S>,
        best: &mut Best,
    ) {
        if !ok.any() {
            return;
        }
        let mut found = [[f64::INFINITY; WIDTH]; 3];
        ok.select(way, way.same(f64::INFINITY)).store(&mut found[0]);
        along.store(&mut found[1]);
        across.store(&mut found[2]);
        let [ways, alongs, acrosses] = found;
        for (lane, &way) in ways.iter().enumerate().take(S::F64_LANES) {
            if way < best.way {
                *best = Best {
                    way,
                    part: self.number[first + lane],
                    along: alongs[lane],
                    across: acrosses[lane],
                };
            }
        }
    }
}
