//! Gmsh MSH 2.2 and 4.1 in ASCII, as the manual of Gmsh describes the formats.
//!
//! Read are `$Nodes` and `$Elements`; of the elements points and volumes are passed over, lines,
//! triangles and quadrangles of first order are kept. Every other section is passed over.

use super::error::{MeshError, Name};
use super::{Facet, Line, MOST_FACETS, Mesh};
use std::collections::HashMap;

/// Whether the file says that it is one of Gmsh.
pub(super) fn is_gmsh(bytes: &[u8]) -> bool {
    let start = bytes.trim_ascii_start();
    start.starts_with(b"$MeshFormat") || start.starts_with(b"$Comments")
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Version {
    Two,
    Four,
}

pub(super) fn read(bytes: &[u8]) -> Result<Mesh, MeshError> {
    let text = String::from_utf8_lossy(bytes);
    let mut reader = Reader { lines: Lines { rest: text.lines(), number: 0 }, ..Reader::default() };
    let mut version = None;
    while let Some(line) = reader.lines.next() {
        match (line, version) {
            ("$MeshFormat", _) => version = Some(reader.version()?),
            ("$Nodes", Some(Version::Two)) => reader.nodes_2()?,
            ("$Nodes", Some(Version::Four)) => reader.nodes_4()?,
            ("$Elements", Some(Version::Two)) => reader.elements_2()?,
            ("$Elements", Some(Version::Four)) => reader.elements_4()?,
            (section, _) if section.starts_with('$') => {
                reader.pass(&section.replacen('$', "$End", 1))?;
                continue;
            }
            _ => return Err(reader.lines.expected("a section such as $Nodes")),
        }
        reader.end(line)?;
    }
    Ok(reader.mesh)
}

/// Lines with their numbers, empty ones left out.
#[derive(Clone)]
struct Lines<'t> {
    rest: std::str::Lines<'t>,
    number: usize,
}

impl Default for Lines<'_> {
    fn default() -> Self {
        Self { rest: "".lines(), number: 0 }
    }
}

impl<'t> Lines<'t> {
    fn next(&mut self) -> Option<&'t str> {
        loop {
            let line = self.rest.next()?.trim();
            self.number += 1;
            if !line.is_empty() {
                return Some(line);
            }
        }
    }

    fn expected(&self, expected: &'static str) -> MeshError {
        MeshError::Line { line: self.number, expected }
    }

    /// The whole numbers of the next line.
    fn integers(&mut self, expected: &'static str) -> Result<Vec<u64>, MeshError> {
        let line = self.next().ok_or(MeshError::Ended { expected })?;
        let numbers = line.split_ascii_whitespace().map(str::parse);
        numbers.collect::<Result<_, _>>().map_err(|_| self.expected(expected))
    }

    /// The next line as exactly `N` whole numbers, which may be negative.
    fn header<const N: usize>(&mut self, expected: &'static str) -> Result<[i64; N], MeshError> {
        let line = self.next().ok_or(MeshError::Ended { expected })?;
        let numbers: Option<Vec<i64>> =
            line.split_ascii_whitespace().map(|word| word.parse().ok()).collect();
        numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| self.expected(expected))
    }
}

#[derive(Default)]
struct Reader<'t> {
    lines: Lines<'t>,
    mesh: Mesh,
    places: HashMap<u64, usize>,
}

impl Reader<'_> {
    fn version(&mut self) -> Result<Version, MeshError> {
        let expected = "version, file type and data size";
        let line = self.lines.next().ok_or(MeshError::Ended { expected })?;
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let &[version, kind, _size] = words.as_slice() else {
            return Err(self.lines.expected(expected));
        };
        match (version, kind) {
            ("2.2", "0") => Ok(Version::Two),
            ("4.1", "0") => Ok(Version::Four),
            _ => {
                let version = crate::outline::shortened(version);
                let kind = if kind == "1" { ", binary" } else { "" };
                Err(MeshError::Gmsh { version: format!("{version}{kind}") })
            }
        }
    }

    /// The end of the section that `start` began.
    fn end(&mut self, start: &str) -> Result<(), MeshError> {
        let expected = "the end of the section";
        let line = self.lines.next().ok_or(MeshError::Ended { expected })?;
        if line.strip_prefix("$End") == start.strip_prefix('$') {
            return Ok(());
        }
        Err(self.lines.expected(expected))
    }

    /// Passes over the rest of a section.
    fn pass(&mut self, end: &str) -> Result<(), MeshError> {
        while let Some(line) = self.lines.next() {
            if line == end {
                return Ok(());
            }
        }
        Err(MeshError::Ended { expected: "the end of a section" })
    }

    fn node(&mut self, tag: u64, words: &str, exactly: bool) -> Result<(), MeshError> {
        let mut words = words.split_ascii_whitespace();
        let mut number = || words.next().and_then(|word| word.parse::<f64>().ok());
        let (Some(x), Some(y), Some(z)) = (number(), number(), number()) else {
            return Err(self.lines.expected("three coordinates of a node"));
        };
        if exactly && words.next().is_some() {
            return Err(self.lines.expected("three coordinates of a node and nothing more"));
        }
        if [x, y, z].iter().any(|value| !value.is_finite()) {
            return Err(MeshError::NotFinite { name: Name { word: "node", number: tag } });
        }
        if self.places.insert(tag, self.mesh.vertices.len()).is_some() {
            return Err(MeshError::SameNode { node: tag });
        }
        self.mesh.vertices.push([x, y, z].into());
        Ok(())
    }

    fn nodes_2(&mut self) -> Result<(), MeshError> {
        let [count] = self.lines.header("the number of nodes")?;
        for _ in 0..count {
            let expected = "a node: number, x, y, z";
            let line = self.lines.next().ok_or(MeshError::Ended { expected })?;
            let (tag, coordinates) =
                line.split_once(char::is_whitespace).ok_or(self.lines.expected(expected))?;
            let tag = tag.parse().map_err(|_| self.lines.expected(expected))?;
            self.node(tag, coordinates, true)?;
        }
        Ok(())
    }

    fn nodes_4(&mut self) -> Result<(), MeshError> {
        let [blocks, ..] = self.lines.header::<4>("the numbers of blocks and nodes")?;
        for _ in 0..blocks {
            let [_dimension, _entity, parametric, count] = self.lines.header("a block of nodes")?;
            // The memory of the tags is bounded by the lines that are there.
            let mut tags = Vec::new();
            for _ in 0..count {
                let expected = "the number of a node";
                let [tag] = self.lines.header(expected)?;
                tags.push(u64::try_from(tag).map_err(|_| self.lines.expected(expected))?);
            }
            for tag in tags {
                let expected = "three coordinates of a node";
                let line = self.lines.next().ok_or(MeshError::Ended { expected })?;
                self.node(tag, line, parametric == 0)?;
            }
        }
        Ok(())
    }

    fn elements_2(&mut self) -> Result<(), MeshError> {
        let [count] = self.lines.header("the number of elements")?;
        for _ in 0..count {
            let expected = "an element: number, type, tags, nodes";
            let numbers = self.lines.integers(expected)?;
            let &[number, kind, tags, ref rest @ ..] = numbers.as_slice() else {
                return Err(self.lines.expected(expected));
            };
            let nodes = usize::try_from(tags).ok().and_then(|tags| rest.get(tags..));
            let nodes = nodes.ok_or_else(|| self.lines.expected(expected))?;
            self.element(number, kind, nodes)?;
        }
        Ok(())
    }

    fn elements_4(&mut self) -> Result<(), MeshError> {
        let [blocks, ..] = self.lines.header::<4>("the numbers of blocks and elements")?;
        for _ in 0..blocks {
            let expected = "a block of elements";
            let [_dimension, _entity, kind, count] = self.lines.header(expected)?;
            let kind = u64::try_from(kind).map_err(|_| self.lines.expected(expected))?;
            for _ in 0..count {
                let numbers = self.lines.integers("an element: number, nodes")?;
                let (number, nodes) =
                    numbers.split_first().ok_or_else(|| self.lines.expected("an element"))?;
                self.element(*number, kind, nodes)?;
            }
        }
        Ok(())
    }

    fn element(&mut self, number: u64, kind: u64, nodes: &[u64]) -> Result<(), MeshError> {
        let name = Name { word: "element", number };
        let places = |wanted: usize| {
            if nodes.len() != wanted {
                return Err(self.lines.expected("as many nodes as the element has corners"));
            }
            let place = |node: &u64| {
                self.places.get(node).copied().ok_or(MeshError::NoSuchNode { name, node: *node })
            };
            nodes.iter().map(place).collect::<Result<Vec<usize>, _>>()
        };
        match kind {
            LINE => {
                let places = places(2)?;
                self.mesh.lines.push(Line { ends: [places[0], places[1]], name });
            }
            TRIANGLE => {
                let places = places(3)?;
                self.mesh.facets.push(Facet { corners: [places[0], places[1], places[2]], name });
            }
            QUADRANGLE => {
                let places = places(4)?;
                for corners in [[0, 1, 2], [0, 2, 3]] {
                    self.mesh.facets.push(Facet { corners: corners.map(|c| places[c]), name });
                }
            }
            _ if CURVED.contains(&kind) => return Err(MeshError::Curved { name }),
            _ => {}
        }
        if self.mesh.facets.len() > MOST_FACETS || self.mesh.lines.len() > MOST_FACETS {
            return Err(MeshError::TooMany { most: MOST_FACETS });
        }
        Ok(())
    }
}

// Element types by the numbers of the format.
const LINE: u64 = 1;
const TRIANGLE: u64 = 2;
const QUADRANGLE: u64 = 3;
/// Lines, triangles and quadrangles of higher order up to the fifth.
const CURVED: [u64; 14] = [8, 9, 10, 16, 20, 21, 22, 23, 24, 25, 26, 27, 28, 36];
