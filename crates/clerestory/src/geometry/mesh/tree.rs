//! The bounding hierarchy: boxes in 32 bits, what is in them in 64.
#![allow(
    clippy::inline_always,
    reason = "what runs on vector instructions must be made with them"
)]

use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use super::lanes::{Four, Lanes, Line, Node};
use super::shape::Shape;
use super::triangle::Sheared;
use crate::geometry::Vec3;

/// The boxes' frame is the cell, stretched along each axis to this length, so that all sizes keep the same digits.
const SIZE: f64 = 1024.0;
/// Boxes are widened by this much in their frame, twice what rounding positions, directions and reciprocals to 32 bits can
/// do over the way through the cell.
const WIDER: f64 = 2e-3;
/// Axes are stretched no more than this beyond the longest one: a flat scene has no depth.
const STRETCH: f64 = 1024.0;
/// Components of directions that are smaller than this share of the greatest one are taken for this share: over the way
/// through the cell it makes less than the widening.
const LEAST: f64 = 1e-7;

/// What is in a box: a node, or with this bit a packet.
const PACKET: u32 = 1 << 31;
/// Shapes in a packet.
const PACKED: usize = 4;
const NOTHING: u32 = u32::MAX;

/// Up to four shapes.
#[derive(Debug, Clone)]
struct Packet {
    triangles: Four,
    /// Numbers of their copies.
    copies: [u32; PACKED],
    /// Numbers of curved shapes, or [`NOTHING`].
    curved: [u32; PACKED],
    has_curved: bool,
}

/// Shapes by place.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    packets: Vec<Packet>,
    curved: Vec<Shape>,
    root: u32,
    centre: Vec3,
    scale: Vec3,
}

/// What a ray starts from: a copy, and how long ago.
#[derive(Debug, Clone, Copy)]
pub(super) struct Start {
    /// Number of the copy, or [`NO_PIECE`](crate::geometry::NO_PIECE).
    pub copy: u32,
    /// Way since then (metres).
    pub ago: f64,
}

/// Boxes that a ray has still to look into, and where it comes into them.
pub(super) type Stack = Vec<(f32, u32)>;

impl Tree {
    /// From copies and their boxes, all within the limits `low` to `high`.
    pub fn new(copies: &[Shape], boxes: &[[Vec3; 2]], [low, high]: [Vec3; 2]) -> Self {
        let centre = (low + high) * 0.5;
        let size = high - low;
        let longest = size.x.max(size.y).max(size.z);
        let stretch = |length: f64| SIZE / length.max(longest / STRETCH);
        let scale = Vec3::new(stretch(size.x), stretch(size.y), stretch(size.z));
        let framed = |p: Vec3, scale: Vec3, wider: f64| {
            let p = p - centre;
            [p.x * scale.x + wider, p.y * scale.y + wider, p.z * scale.z + wider].map(|x| x as f32)
        };
        // What is near to what, and what costs time, is told by true lengths.
        let even = SIZE / longest;
        let even = Vec3::new(even, even, even);
        let mut aabbs: Vec<Aabb> = boxes
            .iter()
            .map(|[low, high]| Aabb {
                min: framed(*low, even, 0.0).into(),
                max: framed(*high, even, 0.0).into(),
            })
            .collect();
        // The builder orders by place within the bounds of all, each axis for itself. Two corners of a cube, which hold
        // nothing, keep the axes alike: in a flat scene depth would else count as much as width.
        for corner in [-0.5, 0.5] {
            let corner = [(corner * SIZE) as f32; 3];
            aabbs.push(Aabb {
                min: corner.into(),
                max: corner.into(),
            });
        }
        let boxes: Vec<Bounds> = boxes
            .iter()
            .map(|[low, high]| [framed(*low, scale, -WIDER), framed(*high, scale, WIDER)])
            .collect();
        let mut tree = Self {
            nodes: Vec::new(),
            packets: Vec::new(),
            curved: Vec::new(),
            root: 0,
            centre,
            scale,
        };
        let indices = (0..aabbs.len() as u32).collect();
        // Far neighbours are looked at from the first level on: what is next in the order along the curve is often on another
        // slat.
        let (distance, from_level) = (PlocSearchDistance::High, 0);
        let builder = &mut PlocBuilder::with_capacity(aabbs.len());
        let mut binary = builder.build(distance, &aabbs, indices, SortPrecision::U64, from_level);
        // Moving parts about for a better order takes longer than it saves where there are very many.
        let moved = if aabbs.len() < 1 << 18 { 0.25 } else { 0.02 };
        ReinsertionOptimizer::default().run(&mut binary, moved, None);
        tree.widen(&binary, &boxes, copies);
        tree
    }

    /// Takes over a binary hierarchy, eight boxes a node.
    fn widen(&mut self, binary: &Bvh2, boxes: &[Bounds], copies: &[Shape]) {
        let measures = measures(binary, boxes);
        let is_packet = |node: usize| measures[node].0 as usize <= PACKED;
        // Nodes of the binary hierarchy that are still to be made, with the place that waits for their number.
        let mut waiting = vec![(0_usize, usize::MAX, 0_usize)];
        while let Some((top, parent, place)) = waiting.pop() {
            let number = if is_packet(top) {
                let packet = self.packet(binary, top, copies);
                self.packets.push(packet);
                PACKET | (self.packets.len() as u32 - 1)
            } else {
                let number = self.nodes.len();
                let inside = opened(binary, top, is_packet);
                let mut node = Node {
                    bounds: [[f32::INFINITY; 8]; 6],
                    children: [NOTHING; 8],
                };
                for far in &mut node.bounds[3..] {
                    *far = [f32::NEG_INFINITY; 8];
                }
                for (k, &child) in inside.iter().enumerate() {
                    let [min, max] = measures[child].1;
                    for axis in 0..3 {
                        node.bounds[axis][k] = min[axis];
                        node.bounds[axis + 3][k] = max[axis];
                    }
                    waiting.push((child, number, k));
                }
                self.nodes.push(node);
                number as u32
            };
            match self.nodes.get_mut(parent) {
                Some(node) => node.children[place] = number,
                None => self.root = number,
            }
        }
    }

    fn packet(&mut self, binary: &Bvh2, top: usize, copies: &[Shape]) -> Packet {
        let mut packet = Packet {
            triangles: Four {
                corners: [[[f64::NAN; PACKED]; 3]; 3],
            },
            copies: [NOTHING; PACKED],
            curved: [NOTHING; PACKED],
            has_curved: false,
        };
        for (k, copy) in primitives(binary, top).into_iter().enumerate() {
            let Some(&shape) = copies.get(copy as usize) else {
                continue;
            };
            packet.copies[k] = copy;
            if let Shape::Triangle(corners) = shape {
                for (c, corner) in corners.into_iter().enumerate() {
                    for (axis, x) in corner.array().into_iter().enumerate() {
                        packet.triangles.corners[c][axis][k] = x;
                    }
                }
            } else {
                packet.curved[k] = self.curved.len() as u32;
                packet.has_curved = true;
                self.curved.push(shape);
            }
        }
        packet
    }

    /// The nearest copy that a ray meets within a reach, and how far away.
    #[inline(always)]
    pub fn meet<L: Lanes>(
        &self,
        lanes: L,
        origin: Vec3,
        direction: Vec3,
        reach: f64,
        start: Start,
        stack: &mut Stack,
    ) -> Option<(f64, u32)> {
        let (line, slack) = self.line(origin, direction);
        // Distances among boxes are metres, too.
        let far = |t: f64| (t * (1.0 + 1e-6)) as f32 + slack;
        let sheared = Sheared::new(direction.array());
        let from = origin.array();
        // Without a period a reach has no end, but what is not met is as far.
        let (mut nearest, mut met) = (reach.min(f64::MAX), NOTHING);
        let mut limit = far(reach);
        let mut next = self.root;
        stack.clear();
        loop {
            if next & PACKET == 0 {
                let node = &self.nodes[next as usize];
                let (mut passed, enters) = lanes.boxes(node, &line, limit);
                if passed != 0 {
                    let k = passed.trailing_zeros() as usize;
                    passed &= passed - 1;
                    let mut first = (enters[k], node.children[k]);
                    while passed != 0 {
                        let k = passed.trailing_zeros() as usize;
                        passed &= passed - 1;
                        let mut other = (enters[k], node.children[k]);
                        if other.0 < first.0 {
                            std::mem::swap(&mut first, &mut other);
                        }
                        stack.push(other);
                    }
                    next = first.1;
                    continue;
                }
            } else {
                let packet = &self.packets[(next & !PACKET) as usize];
                let (mut hits, t) = lanes.triangles(&packet.triangles, &sheared, &from, nearest);
                while hits != 0 {
                    let k = hits.trailing_zeros() as usize;
                    hits &= hits - 1;
                    if t[k] <= nearest && packet.copies[k] != start.copy {
                        (nearest, met) = (t[k], packet.copies[k]);
                    }
                }
                if packet.has_curved {
                    self.meet_curved(packet, origin, direction, start, &mut nearest, &mut met);
                }
                limit = limit.min(far(nearest));
            }
            loop {
                match stack.pop() {
                    None => return (met != NOTHING).then_some((nearest, met)),
                    Some((enters, inside)) if enters <= limit => {
                        next = inside;
                        break;
                    }
                    Some(_) => {}
                }
            }
        }
    }

    /// A ray in the boxes' frame, and what distances may be wrong by.
    #[inline(always)]
    fn line(&self, origin: Vec3, direction: Vec3) -> (Line, f32) {
        let from = origin - self.centre;
        let from = [from.x * self.scale.x, from.y * self.scale.y, from.z * self.scale.z];
        let along = [
            direction.x * self.scale.x,
            direction.y * self.scale.y,
            direction.z * self.scale.z,
        ];
        let greatest = along[0].abs().max(along[1].abs()).max(along[2].abs());
        let least = LEAST * greatest;
        let inverse = along.map(|d| 1.0 / d.abs().max(least).copysign(d) as f32);
        let side = |axis: usize| {
            // As the inverse's sign has it: −0 counts as negative.
            if along[axis].is_sign_negative() {
                (axis + 3, axis)
            } else {
                (axis, axis + 3)
            }
        };
        let [x, y, z] = [side(0), side(1), side(2)];
        let line = Line {
            origin: from.map(|x| x as f32),
            inverse,
            near: [x.0, y.0, z.0],
            far: [x.1, y.1, z.1],
        };
        (line, (WIDER / greatest) as f32)
    }

    #[inline(never)]
    fn meet_curved(
        &self,
        packet: &Packet,
        origin: Vec3,
        direction: Vec3,
        start: Start,
        nearest: &mut f64,
        met: &mut u32,
    ) {
        for (&curved, &copy) in packet.curved.iter().zip(&packet.copies) {
            let Some(shape) = self.curved.get(curved as usize) else {
                continue;
            };
            let t = if copy == start.copy {
                shape.meet(origin - direction * start.ago, direction, true) - start.ago
            } else {
                shape.meet(origin, direction, false)
            };
            if t > 0.0 && t <= *nearest {
                (*nearest, *met) = (t, copy);
            }
        }
    }
}

/// Least and greatest coordinates in the boxes' frame.
type Bounds = [[f32; 3]; 2];

/// How many shapes are in each node of a binary hierarchy, and within which bounds.
fn measures(binary: &Bvh2, boxes: &[Bounds]) -> Vec<(u32, Bounds)> {
    let nothing = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    let joined = |a: Bounds, b: Bounds| {
        [
            std::array::from_fn(|k| a[0][k].min(b[0][k])),
            std::array::from_fn(|k| a[1][k].max(b[1][k])),
        ]
    };
    let mut measures = vec![(0, nothing); binary.nodes.len()];
    let mut waiting = vec![(0_usize, false)];
    while let Some((number, ready)) = waiting.pop() {
        let node = &binary.nodes[number];
        let first = node.first_index as usize;
        if node.is_leaf() {
            let held = &binary.primitive_indices[first..first + node.prim_count as usize];
            let bounds = held
                .iter()
                .filter_map(|&k| boxes.get(k as usize).copied())
                .fold(nothing, joined);
            measures[number] = (node.prim_count, bounds);
        } else if ready {
            let (a, b) = (measures[first], measures[first + 1]);
            measures[number] = (a.0 + b.0, joined(a.1, b.1));
        } else {
            waiting.extend([(number, true), (first, false), (first + 1, false)]);
        }
    }
    measures
}

/// Up to eight nodes that together hold what one does: the largest ones are opened first.
fn opened(binary: &Bvh2, top: usize, is_packet: impl Fn(usize) -> bool) -> Vec<usize> {
    let first = binary.nodes[top].first_index as usize;
    let mut inside = vec![first, first + 1];
    while inside.len() < 8 {
        let area = |k: usize| binary.nodes[inside[k]].aabb().half_area();
        let closed = (0..inside.len()).filter(|&k| !is_packet(inside[k]));
        let Some(largest) = closed.max_by(|&a, &b| area(a).total_cmp(&area(b))) else {
            break;
        };
        let first = binary.nodes[inside[largest]].first_index as usize;
        inside[largest] = first;
        inside.push(first + 1);
    }
    inside
}

/// The shapes in a node.
fn primitives(binary: &Bvh2, top: usize) -> Vec<u32> {
    let mut all = Vec::with_capacity(PACKED);
    let mut waiting = vec![top];
    while let Some(number) = waiting.pop() {
        let node = &binary.nodes[number];
        let first = node.first_index as usize;
        if node.is_leaf() {
            all.extend(&binary.primitive_indices[first..first + node.prim_count as usize]);
        } else {
            waiting.extend([first, first + 1]);
        }
    }
    all
}
