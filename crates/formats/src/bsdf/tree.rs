//! Reader of tensor trees, which are nested braces; it also joins the trees of several spectra.

use std::ops::Range;

use papilio_goniometry::{TensorTree, TreeNode};

use super::BsdfProblem;
use super::text::Text;
use super::xml::Node;
use crate::error::FormatError;

/// Largest depth of a tree; deeper cells would be far smaller than the aperture of any instrument.
const DEEPEST: usize = 16;

/// Tree of one spectrum.
pub(super) struct Values {
    rank: usize,
    nodes: Vec<TreeNode>,
    values: Vec<f64>,
}

impl Values {
    pub(super) fn cells(&self) -> usize {
        self.values.len()
    }
}

/// Reads a block of at most `limit` cells.
pub(super) fn read(text: Text<'_>, node: Node<'_>, rank: usize, limit: usize) -> Result<Values, FormatError> {
    let end = node.place();
    let words = node.text_ranges().iter().flat_map(|range| text.words(range.clone()));
    let tokens = Tokens { bytes: text.bytes, rest: 0..0, words };
    let tree = Values { rank, nodes: vec![TreeNode::Grid { log2: 0, cell: 0 }], values: Vec::new() };
    let mut reader = Reader { text, tokens: tokens.peekable(), end, limit, tree };
    reader.open()?;
    reader.node(0, 0)?;
    match reader.tokens.next() {
        None => Ok(reader.tree),
        Some(stray) => Err(reader.unexpected(stray, "the end of the values")),
    }
}

/// Iterator over braces and numbers: words, split at braces.
struct Tokens<'a, W> {
    bytes: &'a [u8],
    rest: Range<usize>,
    words: W,
}

impl<W: Iterator<Item = Range<usize>>> Iterator for Tokens<'_, W> {
    type Item = Range<usize>;

    fn next(&mut self) -> Option<Range<usize>> {
        if self.rest.is_empty() {
            self.rest = self.words.next()?;
        }
        let word = &self.bytes[self.rest.clone()];
        let brace = word.iter().position(|b| b"{}".contains(b)).unwrap_or(word.len());
        let token = self.rest.start..self.rest.start + brace.max(1);
        self.rest.start = token.end;
        Some(token)
    }
}

struct Reader<'a, T: Iterator<Item = Range<usize>>> {
    text: Text<'a>,
    tokens: std::iter::Peekable<T>,
    /// Last token read.
    end: Range<usize>,
    limit: usize,
    tree: Values,
}

impl<T: Iterator<Item = Range<usize>>> Reader<'_, T> {
    fn next(&mut self) -> Result<Range<usize>, FormatError> {
        match self.tokens.next() {
            Some(token) => {
                self.end = token.clone();
                Ok(token)
            }
            None => Err(self.unexpected(self.end.clone(), "a closing brace `}` or more values after it")),
        }
    }

    fn unexpected(&self, at: Range<usize>, expected: &'static str) -> FormatError {
        self.text.error(at.clone(), BsdfProblem::Unexpected { found: self.text.quote(at), expected })
    }

    fn open(&mut self) -> Result<(), FormatError> {
        match self.next()? {
            token if self.text.is(&token, "{") => Ok(()),
            token => Err(self.unexpected(token, "`{`")),
        }
    }

    /// Reads a node from after its opening brace through its closing one.
    fn node(&mut self, at: usize, depth: usize) -> Result<(), FormatError> {
        if depth > DEEPEST {
            return Err(self.text.error(self.end.clone(), BsdfProblem::TooDeep { limit: DEEPEST }));
        }
        let first = self.tree.values.len() as u32;
        let has_children = self.tokens.peek().is_some_and(|token| self.text.is(token, "{"));
        if !has_children {
            let log2 = self.grid()?;
            self.tree.nodes[at] = TreeNode::Grid { log2, cell: first };
            return Ok(());
        }
        let children = self.tree.nodes.len();
        let count = 1 << self.tree.rank;
        self.tree.nodes.resize(children + count, TreeNode::Grid { log2: 0, cell: 0 });
        self.tree.nodes[at] = TreeNode::Branch { children: children as u32, cell: first };
        for child in 0..count {
            self.open()?;
            self.node(children + child, depth + 1)?;
        }
        match self.next()? {
            token if self.text.is(&token, "}") => Ok(()),
            token => Err(self.unexpected(token, "`}`, because a branch has 2^rank children")),
        }
    }

    /// Reads the values and the closing brace of a grid.
    fn grid(&mut self) -> Result<u8, FormatError> {
        let before = self.tree.values.len();
        loop {
            let token = self.next()?;
            if self.text.is(&token, "}") {
                break;
            }
            if self.tree.values.len() >= self.limit {
                return Err(self.text.error(token, BsdfProblem::TooManyCells { limit: super::MOST_CELLS }));
            }
            self.tree.values.push(self.text.value(token)?);
        }
        let found = self.tree.values.len() - before;
        let log2 = (0..=12).find(|log2| found == 1 << (self.tree.rank * log2));
        log2.map(|log2| log2 as u8).ok_or_else(|| {
            let expected = "a grid of 1, 2^rank, 4^rank, ... values";
            let found = format!("a grid of {found} values");
            self.text.error(self.end.clone(), BsdfProblem::Unexpected { found, expected })
        })
    }
}

/// A part of one of several trees: a node, or a block of a grid.
#[derive(Clone, Copy)]
struct Piece {
    node: usize,
    /// For a grid: its first corner in cells, and the base-2 logarithm of its cells per side.
    corner: [usize; 4],
    log2: u8,
}

/// Joins trees over the same directions into one tree that is as fine as each of them, with values
/// `[tree][cell]`. Returns `None` for more than `limit` values.
pub(super) fn join(trees: &[Values], limit: usize) -> Option<(TensorTree, Vec<f64>)> {
    let rank = trees.first()?.rank;
    let pieces: Vec<Piece> = trees.iter().map(|tree| tree.piece(0)).collect();
    let mut joint = Joint {
        trees,
        nodes: vec![TreeNode::Grid { log2: 0, cell: 0 }],
        values: vec![Vec::new(); trees.len()],
        limit: limit / trees.len(),
    };
    joint.node(0, &pieces)?;
    Some((TensorTree::new(rank, joint.nodes)?, joint.values.concat()))
}

impl Values {
    fn piece(&self, node: usize) -> Piece {
        let log2 = match self.nodes[node] {
            TreeNode::Grid { log2, .. } => log2,
            TreeNode::Branch { .. } => 0,
        };
        Piece { node, corner: [0; 4], log2 }
    }

    /// Returns a child of a piece: for a grid, the block of the corresponding half of each side.
    fn child(&self, piece: Piece, child: usize) -> Piece {
        match self.nodes[piece.node] {
            TreeNode::Branch { children, .. } => self.piece(children as usize + child),
            TreeNode::Grid { .. } if piece.log2 == 0 => piece,
            TreeNode::Grid { .. } => {
                let half = 1 << (piece.log2 - 1);
                let corner = std::array::from_fn(|k| piece.corner[k] + half * (child >> k & 1));
                Piece { corner, log2: piece.log2 - 1, ..piece }
            }
        }
    }

    /// Returns the value of a grid's piece at a cell of a finer grid with 2^`log2` cells per side.
    fn value(&self, piece: Piece, log2: u8, cell: [usize; 4]) -> f64 {
        let TreeNode::Grid { log2: whole, cell: first } = self.nodes[piece.node] else { return f64::NAN };
        let finer = log2 - piece.log2;
        let number =
            (0..self.rank).fold(0, |number, k| (number << whole) + piece.corner[k] + (cell[k] >> finer));
        self.values[first as usize + number]
    }
}

struct Joint<'a> {
    trees: &'a [Values],
    nodes: Vec<TreeNode>,
    values: Vec<Vec<f64>>,
    limit: usize,
}

impl Joint<'_> {
    fn node(&mut self, at: usize, pieces: &[Piece]) -> Option<()> {
        let rank = self.trees[0].rank;
        let first = u32::try_from(self.values[0].len()).ok()?;
        let trees = self.trees;
        let has_branch = pieces
            .iter()
            .zip(trees)
            .any(|(piece, tree)| matches!(tree.nodes[piece.node], TreeNode::Branch { .. }));
        if !has_branch {
            let log2 = pieces.iter().map(|piece| piece.log2).max()?;
            let count = 1_usize << (rank * usize::from(log2));
            if self.values[0].len() + count > self.limit {
                return None;
            }
            self.nodes[at] = TreeNode::Grid { log2, cell: first };
            for ((values, tree), piece) in self.values.iter_mut().zip(trees).zip(pieces) {
                let side = (1 << log2) - 1;
                let cell = |number: usize| {
                    std::array::from_fn(|k| match rank.checked_sub(k + 1) {
                        Some(behind) => number >> (behind * usize::from(log2)) & side,
                        None => 0,
                    })
                };
                values.extend((0..count).map(|number| tree.value(*piece, log2, cell(number))));
            }
            return Some(());
        }
        let children = self.nodes.len();
        self.nodes.resize(children + (1 << rank), TreeNode::Grid { log2: 0, cell: 0 });
        self.nodes[at] = TreeNode::Branch { children: u32::try_from(children).ok()?, cell: first };
        for child in 0..1 << rank {
            let below: Vec<Piece> =
                pieces.iter().zip(trees).map(|(piece, tree)| tree.child(*piece, child)).collect();
            self.node(children + child, &below)?;
        }
        Some(())
    }
}
