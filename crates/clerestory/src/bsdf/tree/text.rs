//! Tensor trees as text: the brace expression that BSDF files hold.
//!
//! A node is `{…}` about its 2^rank children, or about the values of a grid of 2^L cells an axis. The two are listed in
//! different orders: children with axis 0 fastest, grids with axis 0 slowest.

use std::io::Write;

use super::{BRANCH, Entry, MAX_DEPTH, Rank, Tree, decode};
use crate::error::{Error, Result};
use crate::io::number::Numbers;

/// Negative values of a text that were read as zero.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Clamped {
    /// How many.
    pub negatives: usize,
    /// The least of them; 0 without any.
    pub least: f64,
}

/// A tree from its text. The place of an error is the offset in bytes.
pub fn parse(rank: Rank, text: &[u8]) -> Result<(Tree, Clamped)> {
    let mut parser = Parser {
        rank,
        numbers: Numbers::new(text),
        clamped: Clamped::default(),
        entries: Vec::new(),
        grid: Vec::new(),
        open: Vec::new(),
        depth: 0,
    };
    let root = parser.root()?;
    let tree = Tree::assembled(rank, root, parser.entries, parser.depth);
    Ok((tree, parser.clamped))
}

struct Parser<'a> {
    rank: Rank,
    numbers: Numbers<'a>,
    clamped: Clamped,
    entries: Vec<u32>,
    /// Values of the grid that is being read.
    grid: Vec<f32>,
    /// Branches that are not closed yet: first entry, children read so far.
    open: Vec<(usize, usize)>,
    /// Deepest level so far.
    depth: u32,
}

impl Parser<'_> {
    fn error(&self, what: impl Into<String>, remedy: &str) -> Error {
        Error::format(self.numbers.position().to_string(), what, remedy)
    }

    fn cut_short(&self) -> Error {
        self.error(
            "the tensor tree ends before all of its braces are closed",
            "the file is cut short or a brace is missing",
        )
    }

    /// Reads all of the text; the root's entry.
    fn root(&mut self) -> Result<u32> {
        match self.numbers.peek() {
            Some(b'{') => self.numbers.skip(),
            Some(_) => {
                return Err(self.error(
                    "a tensor tree begins with an opening brace",
                    "write the values between { and }",
                ));
            }
            None => {
                return Err(self.error("the tensor tree is empty", "write the values between { and }"));
            }
        }
        let size = self.rank.children();
        loop {
            // Behind an opening brace.
            let mut done = match self.numbers.peek() {
                Some(b'{') => {
                    self.numbers.skip();
                    self.branch()?;
                    continue;
                }
                Some(_) => self.leaf()?,
                None => return Err(self.cut_short()),
            };
            // Behind a closing brace.
            loop {
                let Some((first, children)) = self.open.last_mut() else {
                    return match self.numbers.peek() {
                        None => Ok(done),
                        Some(_) => Err(self.error(
                            "there is text after the tensor tree's last closing brace",
                            "braces are unbalanced or two trees were joined",
                        )),
                    };
                };
                self.entries[*first + *children] = done;
                *children += 1;
                let (first, children) = (*first, *children);
                match self.numbers.peek() {
                    Some(b'{') if children < size => {
                        self.numbers.skip();
                        break;
                    }
                    Some(b'}') if children == size => {
                        self.numbers.skip();
                        self.open.pop();
                        done = BRANCH | (first / size) as u32;
                    }
                    Some(b'{') => {
                        return Err(self.error(
                            format!("a branch of the tensor tree has more than {size} children"),
                            &format!(
                                "a tree of rank {} has {size} children a branch; is the rank right?",
                                self.rank.axes()
                            ),
                        ));
                    }
                    Some(b'}') => {
                        return Err(self.error(
                            format!("a branch of the tensor tree has {children} instead of {size} children"),
                            &format!(
                                "a tree of rank {} has {size} children a branch; is the rank right?",
                                self.rank.axes()
                            ),
                        ));
                    }
                    Some(_) => {
                        return Err(self.error(
                            "something that is no branch stands between the branches of the tensor tree",
                            "a node holds either nodes in braces or numbers",
                        ));
                    }
                    None => return Err(self.cut_short()),
                }
            }
        }
    }

    fn too_deep(&self) -> Error {
        self.error(
            format!("the tensor tree is deeper than {MAX_DEPTH} levels"),
            "no instrument resolves so much; are the braces right?",
        )
    }

    fn branch(&mut self) -> Result<()> {
        if self.open.len() >= MAX_DEPTH as usize {
            return Err(self.too_deep());
        }
        let first = self.entries.len();
        self.entries.resize(first + self.rank.children(), 0);
        self.open.push((first, 0));
        Ok(())
    }

    /// Reads numbers up to the closing brace; the entry of the grid that they are.
    fn leaf(&mut self) -> Result<u32> {
        // A copy: the position of one that is not borrowed stays in a register.
        let mut numbers = self.numbers;
        self.grid.clear();
        let mut single = None;
        while let Some(c) = numbers.peek() {
            if c == b'}' {
                numbers.skip();
                self.numbers = numbers;
                return match single {
                    Some(value) => {
                        self.depth = self.depth.max(self.open.len() as u32);
                        Ok(f32::to_bits(value))
                    }
                    None => self.store_grid(),
                };
            }
            let at = numbers.position();
            let value = match numbers.number(c) {
                Ok(value) => value,
                Err(e) => {
                    self.numbers = numbers;
                    return Err(self.no_number(c).unwrap_or(e));
                }
            };
            let short = if value < 0.0 { self.clamp(value) } else { value as f32 };
            if short.is_infinite() {
                return Err(Error::format(
                    at.to_string(),
                    format!("the value {value:e} is too large for a BSDF"),
                    "values are in 1/sr",
                ));
            }
            // + 0.0 clears the sign of -0.
            let short = short + 0.0;
            single = if self.grid.is_empty() { Some(short) } else { None };
            self.grid.push(short);
        }
        self.numbers = numbers;
        Err(self.cut_short())
    }

    /// What stands where a number should, if it has an error of its own.
    fn no_number(&self, c: u8) -> Option<Error> {
        match c {
            b'{' => Some(self.error(
                "a node of the tensor tree holds both numbers and branches",
                "a node holds either nodes in braces or numbers",
            )),
            b',' => Some(self.error(
                "two commas follow each other in the tensor tree",
                "a value is missing, or write one comma",
            )),
            _ => None,
        }
    }

    #[cold]
    fn clamp(&mut self, value: f64) -> f32 {
        self.clamped.negatives += 1;
        self.clamped.least = self.clamped.least.min(value);
        0.0
    }

    fn store_grid(&mut self) -> Result<u32> {
        let (axes, count) = (self.rank.axes(), self.grid.len());
        let levels = count.checked_ilog2().unwrap_or(0) / axes;
        if count != 1 << (levels * axes) {
            return Err(self.error(
                format!("a leaf of the tensor tree holds {count} values"),
                &format!(
                    "a leaf of rank {axes} holds 1, {}, {}, … values",
                    1 << axes,
                    1 << (2 * axes)
                ),
            ));
        }
        let depth = self.open.len() as u32 + levels;
        if depth > MAX_DEPTH {
            return Err(self.too_deep());
        }
        self.depth = self.depth.max(depth);
        Ok(self.store_cells(0, levels, levels))
    }

    /// Blocks for the part of the grid (2^levels cells an axis) that begins at cell `origin` and is 2^level wide.
    fn store_cells(&mut self, origin: usize, level: u32, levels: u32) -> u32 {
        if level == 0 {
            return self.grid[origin].to_bits();
        }
        let (first, size) = (self.entries.len(), self.rank.children());
        if level == 1 {
            let (rank, grid) = (self.rank, &self.grid);
            let values = (0..size).map(|child| grid[origin + offset(rank, child, 0, levels)].to_bits());
            self.entries.extend(values);
            return BRANCH | (first / size) as u32;
        }
        self.entries.resize(first + size, 0);
        for child in 0..size {
            let cell = origin + offset(self.rank, child, level - 1, levels);
            self.entries[first + child] = self.store_cells(cell, level - 1, levels);
        }
        BRANCH | (first / size) as u32
    }
}

/// Distance in a grid of 2^levels cells an axis from a block's first cell to its child's; the child is 2^level wide.
fn offset(rank: Rank, child: usize, level: u32, levels: u32) -> usize {
    let last = rank.axes() - 1;
    (0..=last)
        .map(|axis| (child >> axis & 1) << (level + levels * (last - axis)))
        .sum()
}

/// Widest line that is written.
const WIDTH: usize = 100;

impl Tree {
    /// Writes the tree as text, with the fewest digits that give the same 32-bit values again.
    pub fn write_text(&self, out: &mut Vec<u8>) {
        let mut levels = vec![MIXED; self.entries.len() / self.rank.children()];
        self.full_levels(self.root, &mut levels);
        let mut writer = Writer {
            tree: self,
            levels: &levels,
            line: out.len(),
            out,
            grid: Vec::new(),
        };
        writer.node(self.root);
        writer.out.push(b'\n');
    }

    /// For each block the number of its levels if all leaves are at the last one, else [`MIXED`].
    fn full_levels(&self, entry: u32, levels: &mut [u8]) -> u8 {
        let Entry::Block(block) = decode(entry) else { return 0 };
        let mut below = None;
        for &child in self.block(block) {
            let level = self.full_levels(child, levels);
            if *below.get_or_insert(level) != level {
                below = Some(MIXED);
            }
        }
        let level = below.filter(|&l| l != MIXED).map_or(MIXED, |l| l + 1);
        levels[block] = level;
        level
    }
}

/// No level: leaves of several sizes.
const MIXED: u8 = u8::MAX;

struct Writer<'a> {
    tree: &'a Tree,
    levels: &'a [u8],
    out: &'a mut Vec<u8>,
    /// Where the current line begins.
    line: usize,
    grid: Vec<u32>,
}

impl Writer<'_> {
    fn node(&mut self, entry: u32) {
        // Grids of at most 2^16 values, so that the buffer stays small.
        let largest = (16 / self.tree.rank.axes()) as u8;
        self.open();
        match decode(entry) {
            Entry::Value(value) => self.number(value),
            Entry::Block(block) if self.levels[block] <= largest => self.grid(entry, self.levels[block]),
            Entry::Block(block) => {
                for &child in self.tree.block(block) {
                    self.node(child);
                }
            }
        }
        self.out.push(b'}');
    }

    fn grid(&mut self, entry: u32, levels: u8) {
        let levels = u32::from(levels);
        let mut grid = std::mem::take(&mut self.grid);
        grid.clear();
        grid.resize(1 << (levels * self.tree.rank.axes()), 0);
        self.tree.fill(entry, 0, levels, levels, &mut grid);
        for &bits in &grid {
            self.number(f32::from_bits(bits));
        }
        self.grid = grid;
    }

    fn open(&mut self) {
        if self.out.len() > self.line {
            self.separate(12);
        }
        self.out.push(b'{');
    }

    /// A line end if the next `length` characters may not fit.
    fn separate(&mut self, length: usize) {
        if self.out.len() + length > self.line + WIDTH {
            self.out.push(b'\n');
            self.line = self.out.len();
        }
    }

    fn number(&mut self, value: f32) {
        if self.out.last() != Some(&b'{') {
            let before = self.out.len();
            self.separate(14);
            if self.out.len() == before {
                self.out.push(b' ');
            }
        }
        let written = if value == 0.0 || (1e-4..1e7).contains(&value) {
            write!(self.out, "{value}")
        } else {
            write!(self.out, "{value:e}")
        };
        written.expect("a vector takes all that is written");
    }
}

impl Tree {
    /// Values of a full subtree into a grid; the counterpart of the parser's `store_cells`.
    fn fill(&self, entry: u32, origin: usize, level: u32, levels: u32, grid: &mut [u32]) {
        match decode(entry) {
            Entry::Value(value) => grid[origin] = value.to_bits(),
            Entry::Block(block) => {
                for (child, &below) in self.block(block).iter().enumerate() {
                    let cell = origin + offset(self.rank, child, level - 1, levels);
                    self.fill(below, cell, level - 1, levels, grid);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::Scatterer;
    use crate::direction::{Direction, Side};

    fn tree(rank: Rank, text: &str) -> Tree {
        parse(rank, text.as_bytes()).unwrap().0
    }

    fn numbers(count: usize, value: impl Fn(usize) -> f64) -> String {
        let texts: Vec<String> = (0..count).map(|n| format!("{:.4}", value(n))).collect();
        texts.join(" ")
    }

    /// BSDF for directions (theta, phi in degrees from the room's normal) toward the source and along the light.
    fn look_up(tree: &Tree, incident: (f64, f64), outgoing: (f64, f64)) -> f64 {
        let direction = |(theta, phi): (f64, f64)| {
            let (t, p) = (theta.to_radians(), phi.to_radians());
            Direction::new(t.sin() * p.cos(), t.sin() * p.sin(), t.cos()).unwrap()
        };
        let i = direction(incident);
        assert_eq!(i.side(), Side::Exterior);
        tree.evaluate(i.incident_disk(), direction(outgoing).outgoing_disk())
    }

    #[test]
    fn branches_and_grids_have_their_own_orders() {
        let value = |n: usize| 0.01 * (n as f64 + 1.0);
        let branch: Vec<String> = (0..16).map(|n| format!("{{{:.4}}},\n", value(n))).collect();
        let branch = tree(Rank::Anisotropic, &format!("{{{}}}", branch.concat()));
        let grid = tree(Rank::Anisotropic, &format!("{{{}}}", numbers(16, value)));
        for (i, o, b, g) in [
            ((140.0, 20.0), (40.0, 200.0), 0.01, 0.01),
            ((140.0, 110.0), (40.0, 200.0), 0.02, 0.09),
            ((140.0, 200.0), (40.0, 20.0), 0.16, 0.16),
            ((140.0, 290.0), (50.0, 100.0), 0.11, 0.06),
            ((170.0, 10.0), (80.0, 300.0), 0.05, 0.03),
        ] {
            assert!((look_up(&branch, i, o) - b).abs() < 1e-7);
            assert!((look_up(&grid, i, o) - g).abs() < 1e-7);
        }
    }

    #[test]
    fn a_grid_of_four_cells_an_axis_is_read_row_by_row() {
        let text = format!("{{{}}}", numbers(64, |k| 0.002 * (k as f64 + 1.0)));
        let tree = tree(Rank::Isotropic, &text);
        assert_eq!((tree.depth(), tree.leaves()), (2, 64));
        for (i, o, f) in [
            ((173.0, 10.0), (20.0, 50.0), 0.044),
            ((152.0, 0.0), (33.0, 170.0), 0.060),
            ((152.0, 90.0), (33.0, 300.0), 0.062),
            ((110.0, 45.0), (60.0, 100.0), 0.002),
            ((100.0, 205.0), (12.0, 21.0), 0.020),
            ((133.0, 180.0), (47.0, 12.0), 0.030),
        ] {
            assert!((look_up(&tree, i, o) - f).abs() < 1e-7, "{i:?} {o:?}");
        }
    }

    #[test]
    fn negative_values_are_read_as_zero_and_counted() {
        let (tree, clamped) = parse(Rank::Isotropic, b"{1 -2 3 -0.5 5 6 7 -0}").unwrap();
        assert_eq!(
            clamped,
            Clamped {
                negatives: 2,
                least: -2.0
            }
        );
        assert_eq!(tree.entries()[7], 0.0_f32.to_bits());
        // Child 1 is the upper half of axis 0: value 4 of the grid.
        assert_eq!(tree.entries()[1], 5.0_f32.to_bits());
    }

    #[test]
    fn faulty_texts_are_refused_at_their_place() {
        for (text, place, word) in [
            ("", "0", "empty"),
            ("  ", "2", "empty"),
            ("1 2", "0", "opening brace"),
            ("{", "1", "cut short"),
            ("{}", "2", "holds 0 values"),
            ("{1 2 3}", "7", "holds 3 values"),
            ("{1", "2", "cut short"),
            ("{1} 2", "4", "after"),
            ("{1}}", "3", "after"),
            ("{1}{2}", "3", "after"),
            ("{1 {2}}", "3", "both"),
            ("{{1} 2}", "5", "between"),
            ("{{1}{2}}", "7", "2 instead of 8"),
            ("{{1}{1}{1}{1}{1}{1}{1}{1}{1}}", "25", "more than 8"),
            ("{{1}{1}{1}{1}{1}{1}{1}{1}", "25", "cut short"),
            ("{nan}", "1", "not a finite"),
            ("{1e39}", "1", "too large"),
            ("{1,,2}", "3", "two commas"),
        ] {
            let Err(Error::Format {
                place: at,
                what,
                remedy,
            }) = parse(Rank::Isotropic, text.as_bytes())
            else {
                panic!("{text:?} was not refused");
            };
            assert_eq!(at, place, "{text:?}: {what}");
            assert!(format!("{what} {remedy}").contains(word), "{text:?}: {what} ({remedy})");
        }
    }

    #[test]
    fn hostile_nesting_ends_in_an_error() {
        let deep = "{".repeat(1_000_000);
        let error = parse(Rank::Anisotropic, deep.as_bytes()).unwrap_err().to_string();
        assert!(error.contains("deeper than 16"), "{error}");
        // A grid of one more level than is left at the bottom of 16 branches.
        let bottom = format!("{}{{1 1 1 1 1 1 1 1}}", "{".repeat(16));
        let error = parse(Rank::Isotropic, bottom.as_bytes()).unwrap_err().to_string();
        assert!(error.contains("deeper than 16"), "{error}");
    }

    fn round_trip(tree: &Tree) -> String {
        let mut text = Vec::new();
        tree.write_text(&mut text);
        assert_eq!(parse(tree.rank(), &text).unwrap(), (tree.clone(), Clamped::default()));
        String::from_utf8(text).unwrap()
    }

    #[test]
    fn full_blocks_are_written_as_grids() {
        let children = "{0 1 4 5 16 17 20 21}{0}{8 9 12 13 24 25 28 29}{0}{2 3 6 7 18 19 22 23}{0}\
             {10 11 14 15 26 27 30 31}{0}";
        let text = round_trip(&tree(Rank::Isotropic, &format!("{{{children}}}")));
        assert_eq!(
            text.trim().replace('\n', " ").replace("} {", "}{"),
            format!("{{{children}}}")
        );
        // All children full: one grid, with axis 0 slowest.
        let text = format!("{{{}}}", numbers(64, |k| k as f64));
        let again = round_trip(&tree(Rank::Isotropic, &text));
        assert_eq!(
            again.split_whitespace().collect::<String>(),
            (0..64)
                .map(|k| k.to_string())
                .collect::<String>()
                .replacen('0', "{0", 1)
                + "}"
        );
    }

    #[test]
    fn lines_stay_short() {
        let tree = tree(
            Rank::Anisotropic,
            &format!("{{{}}}", numbers(65536, |k| (k as f64).sqrt() / 3.0)),
        );
        let text = round_trip(&tree);
        assert!(text.lines().all(|line| line.len() <= 120));
        assert!(text.len() < 65536 * 11);
    }

    #[test]
    fn extreme_values_survive_the_text() {
        let values = [0.0, 1e-45, f32::MIN_POSITIVE, 1e-4, 9.999e6, 1e7, f32::MAX, 0.1];
        let entries = values.iter().map(|v: &f32| v.to_bits()).collect();
        round_trip(&Tree::from_entries(Rank::Isotropic, BRANCH, entries).unwrap());
    }

    /// A tree grown from a stream of bytes: each one makes a branch or a value.
    fn grown(rank: Rank, bytes: &[u8]) -> Tree {
        fn node(rank: Rank, bytes: &mut impl Iterator<Item = u8>, depth: u32, entries: &mut Vec<u32>) -> u32 {
            match bytes.next() {
                Some(b) if b % 3 == 0 && depth < 5 => {
                    let (first, size) = (entries.len(), rank.children());
                    entries.resize(first + size, 0);
                    for child in 0..size {
                        entries[first + child] = node(rank, bytes, depth + 1, entries);
                    }
                    BRANCH | (first / size) as u32
                }
                Some(b) => (f32::from(b).powi(7) * 1e-9).to_bits(),
                None => 0.125_f32.to_bits(),
            }
        }
        let mut entries = Vec::new();
        let root = node(rank, &mut bytes.iter().copied(), 0, &mut entries);
        Tree::from_entries(rank, root, entries).unwrap()
    }

    proptest::proptest! {
        #![proptest_config(proptest::prelude::ProptestConfig::with_cases(64))]

        #[test]
        fn what_is_written_is_read_again(bytes in proptest::collection::vec(0_u8.., 0..3000)) {
            round_trip(&grown(Rank::Isotropic, &bytes));
            round_trip(&grown(Rank::Anisotropic, &bytes));
        }

        #[test]
        fn no_text_upsets_the_parser(text in "[{}{}{}01-9., e+-]{0,200}") {
            for rank in [Rank::Isotropic, Rank::Anisotropic] {
                if let Ok((tree, _)) = parse(rank, text.as_bytes()) {
                    round_trip(&tree);
                }
            }
        }
    }
}
