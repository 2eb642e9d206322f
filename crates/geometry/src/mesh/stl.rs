//! STL, binary and ASCII.
//!
//! Binary: 80 bytes of header, the number of facets (u32), then 50 bytes for each facet: normal
//! and three corners (f32, little-endian) and two bytes without meaning here. ASCII: `facet normal`,
//! `outer loop`, three `vertex`, `endloop`, `endfacet` between `solid` and `endsolid`. The order of
//! the corners tells outside; a normal that is stated and contradicts it is a mistake.

use super::error::{MeshError, Name};
use super::vector::area_vector;
use super::{Facet, MOST_FACETS, Mesh, Welder};
use glam::DVec3;

const HEADER: usize = 84;
const FACET: usize = 50;

pub(super) fn read(bytes: &[u8]) -> Result<Mesh, MeshError> {
    let Some(header) = bytes.get(..HEADER) else {
        return if starts_with_solid(bytes) { ascii(bytes) } else { Err(MeshError::Unknown) };
    };
    let facets = u32::from_le_bytes([header[80], header[81], header[82], header[83]]);
    let needed = HEADER as u64 + u64::from(facets) * FACET as u64;
    // A binary header may begin with `solid` too: only the length tells.
    if needed == bytes.len() as u64 {
        return binary(&bytes[HEADER..]);
    }
    if starts_with_solid(bytes) {
        return ascii(bytes);
    }
    if std::str::from_utf8(bytes).is_ok_and(|text| !text.contains('\0')) {
        return Err(MeshError::Unknown);
    }
    Err(MeshError::Length { facets, needed, found: bytes.len() as u64 })
}

fn starts_with_solid(bytes: &[u8]) -> bool {
    bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

/// The facets of one file.
#[derive(Default)]
struct Facets {
    welder: Welder,
    facets: Vec<Facet>,
}

impl Facets {
    fn add(&mut self, normal: [f64; 3], corners: [[f64; 3]; 3]) -> Result<(), MeshError> {
        if self.facets.len() == MOST_FACETS {
            return Err(MeshError::TooMany { most: MOST_FACETS });
        }
        let name = Name { word: "facet", number: self.facets.len() as u64 + 1 };
        if corners.iter().flatten().any(|value| !value.is_finite()) {
            return Err(MeshError::NotFinite { name });
        }
        let (normal, area) = (DVec3::from(normal), area_vector(corners.map(DVec3::from)));
        // Many programs write no normal, or an inaccurate one of a thin facet.
        if normal.dot(area) < -0.5 * normal.length() * area.length() {
            return Err(MeshError::StatedNormal { name });
        }
        let corners = corners.map(|corner| self.welder.vertex(corner));
        self.facets.push(Facet { corners, name });
        Ok(())
    }

    fn mesh(self) -> Mesh {
        Mesh { vertices: self.welder.vertices, facets: self.facets, lines: Vec::new() }
    }
}

fn binary(facets: &[u8]) -> Result<Mesh, MeshError> {
    let mut read = Facets::default();
    for facet in facets.chunks_exact(FACET) {
        let number = |at: usize| {
            f64::from(f32::from_le_bytes([facet[at], facet[at + 1], facet[at + 2], facet[at + 3]]))
        };
        let vector = |at: usize| [number(at), number(at + 4), number(at + 8)];
        read.add(vector(0), [vector(12), vector(24), vector(36)])?;
    }
    Ok(read.mesh())
}

fn ascii(bytes: &[u8]) -> Result<Mesh, MeshError> {
    let text = String::from_utf8_lossy(bytes);
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line.trim()))
        .filter(|line| !line.1.is_empty());
    let mut read = Facets::default();
    let mut open = false;
    while let Some((line, text)) = lines.next() {
        let mut words = text.split_ascii_whitespace();
        let first = words.next().unwrap_or_default();
        if first.eq_ignore_ascii_case("solid") && !open {
            open = true;
        } else if first.eq_ignore_ascii_case("endsolid") && open {
            open = false;
        } else if first.eq_ignore_ascii_case("facet") && open {
            let expected = "`facet normal` and three numbers";
            let is_normal = words.next().is_some_and(|word| word.eq_ignore_ascii_case("normal"));
            let normal = numbers(words).filter(|_| is_normal);
            let normal = normal.ok_or(MeshError::Line { line, expected })?;
            read.add(normal, facet(&mut lines)?)?;
        } else {
            let expected = if open { "`facet` or `endsolid`" } else { "`solid`" };
            return Err(MeshError::Line { line, expected });
        }
    }
    if open {
        return Err(MeshError::Ended { expected: "`facet` or `endsolid`" });
    }
    Ok(read.mesh())
}

/// `outer loop`, three corners, `endloop`, `endfacet`.
fn facet<'t>(
    lines: &mut impl Iterator<Item = (usize, &'t str)>,
) -> Result<[[f64; 3]; 3], MeshError> {
    keywords(lines, &["outer", "loop"], "`outer loop`")?;
    let mut corners = [[0.0; 3]; 3];
    for corner in &mut corners {
        let expected = "`vertex` and three numbers";
        let (line, text) = lines.next().ok_or(MeshError::Ended { expected })?;
        let mut words = text.split_ascii_whitespace();
        let is_vertex = words.next().is_some_and(|word| word.eq_ignore_ascii_case("vertex"));
        *corner = numbers(words).filter(|_| is_vertex).ok_or(MeshError::Line { line, expected })?;
    }
    keywords(lines, &["endloop"], "`endloop`")?;
    keywords(lines, &["endfacet"], "`endfacet`")?;
    Ok(corners)
}

fn keywords<'t>(
    lines: &mut impl Iterator<Item = (usize, &'t str)>,
    words: &[&str],
    expected: &'static str,
) -> Result<(), MeshError> {
    let (line, text) = lines.next().ok_or(MeshError::Ended { expected })?;
    let found = text.split_ascii_whitespace().map(str::to_ascii_lowercase);
    if found.eq(words.iter().copied()) { Ok(()) } else { Err(MeshError::Line { line, expected }) }
}

/// Exactly three numbers; those that are not finite are told with their facet.
fn numbers<'t>(mut words: impl Iterator<Item = &'t str>) -> Option<[f64; 3]> {
    let mut number = || words.next()?.parse::<f64>().ok();
    let vector = [number()?, number()?, number()?];
    words.next().is_none().then_some(vector)
}
