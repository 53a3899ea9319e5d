//! Exact solution of the transport problem by the network simplex method.
//!
//! Every source may send to every sink. The basis is a spanning tree about an artificial root; it is kept strongly
//! feasible (Cunningham 1976, "A network simplex method"), so that the method ends, and masses are integers, so that
//! ties are exact. See Ahuja, Magnanti, Orlin (1993), "Network Flows", chapter 11.

/// Cost of an arc to or from the root: more than half of the largest cost, so that no flow stays on one.
const ARTIFICIAL: f64 = 4.0;
/// Largest cost that the root's arcs allow.
pub const MAX_COST: f64 = 2.0 * ARTIFICIAL - 1.0;
/// A reduced cost above this is none.
const TOLERANCE: f64 = 1e-12;
const NONE: usize = usize::MAX;

/// Least total of mass times cost by which `supply` becomes `demand`; both are positive and sum to the same.
///
/// `costs` are listed source by source, 0 to [`MAX_COST`]. `pairs` are sources and sinks that likely exchange mass;
/// each source and each sink is in one pair at most. They only make it faster.
pub fn transport_cost(supply: &[u64], demand: &[u64], costs: &[f64], pairs: &[(usize, usize)]) -> f64 {
    let mut basis = Basis::new(supply, demand, costs, pairs);
    basis.solve();
    basis.cost()
}

/// The flows (source, sink, mass) of that least total; those that are not listed are 0.
pub fn transport_plan(supply: &[u64], demand: &[u64], costs: &[f64]) -> Vec<(usize, usize, u64)> {
    let mut basis = Basis::new(supply, demand, costs, &[]);
    basis.solve();
    basis.flows().filter(|&(_, _, flow)| flow > 0).collect()
}

/// Least of a − b, in lanes that the processor can work on together.
fn least_difference(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 8;
    let mut least = [f64::INFINITY; LANES];
    let (a, b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest = a.remainder().iter().zip(b.remainder());
    let rest = rest.fold(f64::INFINITY, |least, (a, b)| least.min(a - b));
    for (a, b) in a.zip(b) {
        for lane in 0..LANES {
            let value = a[lane] - b[lane];
            least[lane] = if value < least[lane] { value } else { least[lane] };
        }
    }
    least.into_iter().fold(rest, f64::min)
}

/// A flow to begin with: first between pairs, then from each source in turn to the nearest sinks that can still take. Each
/// part uses up a source or a sink, so that there are no cycles.
fn first_flow(supply: &[u64], demand: &[u64], costs: &[f64], pairs: &[(usize, usize)]) -> Vec<(usize, usize, u64)> {
    let (mut left, mut open) = (supply.to_vec(), demand.to_vec());
    let mut flows = Vec::with_capacity(supply.len() + demand.len());
    let mut send = |i: usize, j: usize, left: &mut [u64], open: &mut [u64]| {
        let flow = left[i].min(open[j]);
        left[i] -= flow;
        open[j] -= flow;
        flows.push((i, j, flow));
    };
    for &(i, j) in pairs {
        send(i, j, &mut left, &mut open);
    }
    let mut sinks: Vec<usize> = (0..demand.len()).filter(|&j| open[j] > 0).collect();
    for i in 0..supply.len() {
        let row = &costs[i * demand.len()..(i + 1) * demand.len()];
        while left[i] > 0 {
            let nearest = (0..sinks.len()).min_by(|&a, &b| row[sinks[a]].total_cmp(&row[sinks[b]]));
            let place = nearest.expect("supply and demand sum to the same");
            let j = sinks[place];
            send(i, j, &mut left, &mut open);
            if open[j] == 0 {
                sinks.swap_remove(place);
            }
        }
    }
    flows
}

/// Spanning tree: sources, then sinks, then the root.
struct Basis<'a> {
    sources: usize,
    sinks: usize,
    costs: &'a [f64],
    parent: Vec<usize>,
    /// Flow between a node and its parent.
    flow: Vec<u64>,
    depth: Vec<u32>,
    potential: Vec<f64>,
    first_child: Vec<usize>,
    next: Vec<usize>,
    previous: Vec<usize>,
    /// Where the search for an entering arc goes on.
    row: usize,
    stack: Vec<usize>,
}

impl<'a> Basis<'a> {
    fn new(supply: &[u64], demand: &[u64], costs: &'a [f64], pairs: &[(usize, usize)]) -> Self {
        let (sources, sinks) = (supply.len(), demand.len());
        let root = sources + sinks;
        let mut basis = Self {
            sources,
            sinks,
            costs,
            parent: vec![root; root],
            flow: vec![0; root],
            depth: vec![0; root + 1],
            potential: vec![0.0; root + 1],
            first_child: vec![NONE; root + 1],
            next: vec![NONE; root],
            previous: vec![NONE; root],
            row: 0,
            stack: Vec::new(),
        };
        let mut neighbours: Vec<Vec<(usize, u64)>> = vec![Vec::new(); root];
        for (i, j, flow) in first_flow(supply, demand, costs, pairs) {
            neighbours[i].push((sources + j, flow));
            neighbours[sources + j].push((i, flow));
        }
        // Each connected part hangs on the root by one of its sources, with no flow between.
        for top in 0..sources {
            if basis.depth[top] > 0 {
                continue;
            }
            basis.depth[top] = 1;
            basis.potential[top] = -ARTIFICIAL;
            basis.attach(top, root);
            basis.stack.push(top);
            while let Some(node) = basis.stack.pop() {
                for &(other, flow) in &neighbours[node] {
                    if basis.depth[other] > 0 {
                        continue;
                    }
                    basis.depth[other] = basis.depth[node] + 1;
                    basis.flow[other] = flow;
                    basis.potential[other] = if basis.upward(node) {
                        basis.potential[node] + basis.arc_cost(node, other)
                    } else {
                        basis.potential[node] - basis.arc_cost(other, node)
                    };
                    basis.attach(other, node);
                    basis.stack.push(other);
                }
            }
        }
        basis
    }

    fn solve(&mut self) {
        while let Some((source, sink)) = self.entering() {
            self.pivot(source, sink);
        }
    }

    fn root(&self) -> usize {
        self.sources + self.sinks
    }

    fn arc_cost(&self, source: usize, sink: usize) -> f64 {
        self.costs[source * self.sinks + sink - self.sources]
    }

    /// Whether flow goes from the node to its parent: sources only send, sinks only take.
    fn upward(&self, node: usize) -> bool {
        node < self.sources
    }

    fn attach(&mut self, node: usize, parent: usize) {
        let head = self.first_child[parent];
        self.parent[node] = parent;
        self.next[node] = head;
        self.previous[node] = NONE;
        if head != NONE {
            self.previous[head] = node;
        }
        self.first_child[parent] = node;
    }

    fn detach(&mut self, node: usize) {
        let (previous, next) = (self.previous[node], self.next[node]);
        if previous == NONE {
            self.first_child[self.parent[node]] = next;
        } else {
            self.next[previous] = next;
        }
        if next != NONE {
            self.previous[next] = previous;
        }
    }

    /// The arc of least reduced cost among the next few sources' that have a negative one.
    fn entering(&mut self) -> Option<(usize, usize)> {
        const BLOCK: usize = 1024;
        let mut best = (-TOLERANCE, NONE, NONE);
        let mut scanned = 0;
        for _ in 0..self.sources {
            let i = self.row;
            self.row = if i + 1 == self.sources { 0 } else { i + 1 };
            let from = self.potential[i];
            let costs = &self.costs[i * self.sinks..(i + 1) * self.sinks];
            let to = &self.potential[self.sources..self.sources + self.sinks];
            let least = least_difference(costs, to);
            if least + from < best.0 {
                let place = costs.iter().zip(to).position(|(cost, to)| cost - to == least);
                best = (least + from, i, place.unwrap_or(NONE));
            }
            scanned += self.sinks;
            if scanned >= BLOCK && best.1 != NONE {
                break;
            }
        }
        (best.1 != NONE).then(|| (best.1, self.sources + best.2))
    }

    /// Brings an arc into the tree; the arc that its cycle empties leaves.
    fn pivot(&mut self, source: usize, sink: usize) {
        let reduced = self.arc_cost(source, sink) + self.potential[source] - self.potential[sink];
        // The flow on the cycle: source to sink, then up to where both meet, then down to the source. Among the arcs that
        // empty first the last one of that walk leaves, which keeps the tree strongly feasible.
        let (mut u, mut v) = (source, sink);
        let (mut delta, mut leaving, mut below_source) = (u64::MAX, NONE, true);
        let mut least_of_sink = (u64::MAX, NONE);
        while u != v {
            if self.depth[u] >= self.depth[v] {
                if self.upward(u) && self.flow[u] < delta {
                    (delta, leaving) = (self.flow[u], u);
                }
                u = self.parent[u];
            } else {
                if !self.upward(v) && self.flow[v] <= least_of_sink.0 {
                    least_of_sink = (self.flow[v], v);
                }
                v = self.parent[v];
            }
        }
        let meeting = u;
        if least_of_sink.0 <= delta {
            (delta, leaving) = least_of_sink;
            below_source = false;
        }
        let (mut u, mut v) = (source, sink);
        while u != meeting {
            self.flow[u] = if self.upward(u) {
                self.flow[u] - delta
            } else {
                self.flow[u] + delta
            };
            u = self.parent[u];
        }
        while v != meeting {
            self.flow[v] = if self.upward(v) {
                self.flow[v] + delta
            } else {
                self.flow[v] - delta
            };
            v = self.parent[v];
        }
        // The part that the leaving arc cuts off hangs itself up by the entering one.
        let (mut node, mut parent, shift) = if below_source {
            (source, sink, -reduced)
        } else {
            (sink, source, reduced)
        };
        let top = node;
        let mut flow = delta;
        loop {
            let above = self.parent[node];
            self.detach(node);
            self.attach(node, parent);
            std::mem::swap(&mut self.flow[node], &mut flow);
            if node == leaving {
                break;
            }
            parent = node;
            node = above;
        }
        self.stack.push(top);
        while let Some(node) = self.stack.pop() {
            self.potential[node] += shift;
            self.depth[node] = self.depth[self.parent[node]] + 1;
            let mut child = self.first_child[node];
            while child != NONE {
                self.stack.push(child);
                child = self.next[child];
            }
        }
    }

    /// All flow that does not pass the root: source, sink, mass.
    fn flows(&self) -> impl Iterator<Item = (usize, usize, u64)> + '_ {
        let root = self.root();
        (0..root).filter(move |&node| self.parent[node] != root).map(|node| {
            let parent = self.parent[node];
            let (source, sink) = if self.upward(node) {
                (node, parent)
            } else {
                (parent, node)
            };
            (source, sink - self.sources, self.flow[node])
        })
    }

    fn cost(&self) -> f64 {
        self.flows()
            .map(|(i, j, flow)| flow as f64 * self.costs[i * self.sinks + j])
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::uniform;

    /// Masses and costs from a stream of random numbers.
    fn problem(seed: u64, sources: usize, sinks: usize, scale: f64) -> (Vec<u64>, Vec<u64>, Vec<f64>) {
        let mut k = 0;
        let mut draw = || {
            k += 1;
            uniform(seed, k)
        };
        let mut supply: Vec<u64> = (0..sources).map(|_| 1 + (draw() * scale) as u64).collect();
        let mut demand: Vec<u64> = (0..sinks).map(|_| 1 + (draw() * scale) as u64).collect();
        let (a, b): (u64, u64) = (supply.iter().sum(), demand.iter().sum());
        if a < b {
            supply[0] += b - a;
        } else {
            demand[0] += a - b;
        }
        let costs = (0..sources * sinks).map(|_| 3.0 * draw()).collect();
        (supply, demand, costs)
    }

    /// Every way to send unit masses: the least cost over all permutations.
    fn by_permutations(n: usize, costs: &[f64]) -> f64 {
        fn least(row: usize, used: u32, n: usize, costs: &[f64]) -> f64 {
            if row == n {
                return 0.0;
            }
            (0..n)
                .filter(|j| used & (1 << j) == 0)
                .map(|j| costs[row * n + j] + least(row + 1, used | 1 << j, n, costs))
                .fold(f64::INFINITY, f64::min)
        }
        least(0, 0, n, costs)
    }

    #[test]
    fn unit_masses_match_an_exhaustive_search() {
        for seed in 0..200 {
            let n = 1 + seed as usize % 7;
            let (_, _, costs) = problem(seed, n, n, 1.0);
            let ones = vec![1; n];
            let pairs: Vec<(usize, usize)> = (0..n).filter(|k| k % 2 == 0).map(|k| (k, n - 1 - k)).collect();
            let expected = by_permutations(n, &costs);
            for pairs in [&[][..], &pairs] {
                let cost = transport_cost(&ones, &ones, &costs, pairs);
                assert!((cost - expected).abs() < 1e-9, "{seed}: {cost} {expected}");
            }
        }
    }

    /// At the end the potentials prove that nothing is cheaper: all reduced costs are 0 or more, and 0 where flow goes.
    #[test]
    fn larger_problems_end_with_a_proof_of_optimality() {
        for (seed, sources, sinks, scale) in [(1, 40, 60, 1e12), (2, 60, 40, 3.0), (3, 1, 9, 5.0), (4, 80, 80, 2.0)] {
            let (supply, demand, costs) = problem(seed, sources, sinks, scale);
            let mut basis = Basis::new(&supply, &demand, &costs, &[]);
            while let Some((i, j)) = basis.entering() {
                basis.pivot(i, j);
            }
            let (mut sent, mut taken) = (vec![0; sources], vec![0; sinks]);
            for node in 0..basis.root() {
                let parent = basis.parent[node];
                if parent == basis.root() {
                    assert_eq!(basis.flow[node], 0);
                    continue;
                }
                let (i, j) = if basis.upward(node) {
                    (node, parent)
                } else {
                    (parent, node)
                };
                sent[i] += basis.flow[node];
                taken[j - sources] += basis.flow[node];
                let reduced = basis.arc_cost(i, j) + basis.potential[i] - basis.potential[j];
                assert!(reduced.abs() < 1e-10, "{reduced}");
            }
            assert_eq!(sent, supply);
            assert_eq!(taken, demand);
            for i in 0..sources {
                for j in sources..sources + sinks {
                    let reduced = basis.arc_cost(i, j) + basis.potential[i] - basis.potential[j];
                    assert!(reduced > -1e-10);
                }
            }
        }
    }
}
