//! The table of what a snapshot holds for each particle: name, unit, meaning and
//! access, once for all file formats and for whoever hands the numbers on.

use sphcut_sph::Snapshot;
use sphcut_sph::setup::Vector;

/// One quantity of the particles.
pub struct SnapshotField {
    /// Identifier, e.g. `plastic_strain`.
    pub name: &'static str,
    /// SI unit; empty for numbers without one.
    pub unit: &'static str,
    /// One line for people.
    pub meaning: &'static str,
    pub(crate) access: Access,
}

/// Reading and writing access to a column of a snapshot.
pub(crate) enum Access {
    Real(fn(&Snapshot) -> &Vec<f64>, fn(&mut Snapshot) -> &mut Vec<f64>),
    Vector(fn(&Snapshot) -> &Vec<Vector>, fn(&mut Snapshot) -> &mut Vec<Vector>),
    Tensor(fn(&Snapshot) -> &Vec<[f64; 6]>, fn(&mut Snapshot) -> &mut Vec<[f64; 6]>),
    Long(fn(&Snapshot) -> &Vec<u64>, fn(&mut Snapshot) -> &mut Vec<u64>),
    Short(fn(&Snapshot) -> &Vec<u32>, fn(&mut Snapshot) -> &mut Vec<u32>),
}

/// The values of a column, flattened.
pub enum Column<'a> {
    /// Real numbers, those of a vector or tensor one after the other.
    Reals(&'a [f64]),
    /// Long whole numbers.
    Longs(&'a [u64]),
    /// Short whole numbers.
    Shorts(&'a [u32]),
}

impl SnapshotField {
    /// Numbers per particle.
    #[must_use]
    pub fn width(&self) -> usize {
        match self.access {
            Access::Vector(..) => 3,
            Access::Tensor(..) => 6,
            Access::Real(..) | Access::Long(..) | Access::Short(..) => 1,
        }
    }

    /// Whether the values are whole numbers.
    pub(crate) fn is_integer(&self) -> bool {
        matches!(self.access, Access::Long(..) | Access::Short(..))
    }

    /// The values of `snapshot`.
    #[must_use]
    pub fn column<'a>(&self, snapshot: &'a Snapshot) -> Column<'a> {
        match self.access {
            Access::Real(get, _) => Column::Reals(get(snapshot)),
            Access::Vector(get, _) => Column::Reals(get(snapshot).as_flattened()),
            Access::Tensor(get, _) => Column::Reals(get(snapshot).as_flattened()),
            Access::Long(get, _) => Column::Longs(get(snapshot)),
            Access::Short(get, _) => Column::Shorts(get(snapshot)),
        }
    }

    /// Sets the real values of `snapshot`; `None` if this field has none or the number does not fit.
    pub(crate) fn set_reals(&self, snapshot: &mut Snapshot, values: Vec<f64>) -> Option<()> {
        match self.access {
            Access::Real(_, set) => *set(snapshot) = values,
            Access::Vector(_, set) => *set(snapshot) = chunked(&values)?,
            Access::Tensor(_, set) => *set(snapshot) = chunked(&values)?,
            Access::Long(..) | Access::Short(..) => return None,
        }
        Some(())
    }

    /// Sets the whole-numbered values of `snapshot`; `None` if this field has none.
    pub(crate) fn set_integers(&self, snapshot: &mut Snapshot, values: Vec<u64>) -> Option<()> {
        match self.access {
            Access::Long(_, set) => *set(snapshot) = values,
            Access::Short(_, set) => {
                let short = values.into_iter().map(|value| u32::try_from(value).ok());
                *set(snapshot) = short.collect::<Option<_>>()?;
            }
            Access::Real(..) | Access::Vector(..) | Access::Tensor(..) => return None,
        }
        Some(())
    }
}

/// Whether all quantities of the particles are there for every particle, and the mesh of the tool is whole.
pub(crate) fn is_complete(snapshot: &Snapshot) -> bool {
    let count = |field: &SnapshotField| match field.column(snapshot) {
        Column::Reals(values) => values.len() / field.width(),
        Column::Longs(values) => values.len(),
        Column::Shorts(values) => values.len(),
    };
    let nodes = snapshot.tool_nodes.len();
    let mesh = snapshot.tool_temperature.len() == nodes
        && snapshot.tool_elements.len().is_multiple_of(3)
        && snapshot.tool_elements.iter().all(|node| (*node as usize) < nodes);
    mesh && PARTICLE_FIELDS.iter().all(|field| count(field) == snapshot.id.len())
}

fn chunked<const N: usize>(values: &[f64]) -> Option<Vec<[f64; N]>> {
    let (chunks, rest) = values.as_chunks::<N>();
    rest.is_empty().then(|| chunks.to_vec())
}

macro_rules! fields {
    ($($kind:ident $name:ident $unit:literal $meaning:literal;)*) => {
        &[$(SnapshotField {
            name: stringify!($name),
            unit: $unit,
            meaning: $meaning,
            access: Access::$kind(|snapshot| &snapshot.$name, |snapshot| &mut snapshot.$name),
        }),*]
    };
}

/// What every particle has.
pub const PARTICLE_FIELDS: &[SnapshotField] = fields! {
    Long id "" "identifier, unique over the run";
    Short body "" "index of the body";
    Vector position "m" "position";
    Vector velocity "m/s" "velocity";
    Tensor stress "Pa" "Cauchy stress xx, yy, zz, xy, yz, xz, tension positive";
    Real von_mises_stress "Pa" "von Mises stress";
    Real pressure "Pa" "pressure, compression positive";
    Real density "kg/m^3" "density";
    Real plastic_strain "" "equivalent plastic strain";
    Real plastic_strain_rate "1/s" "equivalent plastic strain rate, smoothed over about a hundred steps";
    Real temperature "K" "temperature";
    Vector contact_force "N" "force of the tool on the particle (per metre of width in a plane run)";
    Real friction_use "" "friction over the most that the friction law allows: 1 slides, less sticks, 0 without contact";
    Real shear_friction_factor "" "shear stress over the shear strength sigma_y / sqrt(3) of the particle, 0 without contact";
    Real contact_area "m^2" "share of the tool's surface (m, per metre of width, in a plane run), 0 without contact";
    Real relative_spacing "" "spacing of the lattice where the particle is, over the particle spacing of the run: above 1 where a graded lattice is coarser";
    Real half_thickness "m" "from the particle to the point of its material that the tool touches; where the tool has not been near, half its cell of the lattice across the machined surface";
    Short neighbours "" "number of neighbours";
};

/// Quantities that records made before they existed do not hold: not a number there.
pub(crate) const LATER: &[&str] = &[
    "friction_use",
    "shear_friction_factor",
    "contact_area",
    "relative_spacing",
    "half_thickness",
];

/// Outline and heat of the tool: fields with their own numbers of entries.
pub const TOOL_FIELDS: &[SnapshotField] = fields! {
    Vector tool "m" "outline of the tool: closed polygon (2D) or vertices of its triangles, three by three (3D)";
    Vector tool_nodes "m" "nodes of the tool's mesh, where it conducts heat";
    Short tool_elements "" "nodes of the triangles of that mesh (3D: of its surface), three by three";
    Real tool_temperature "K" "temperature of its nodes";
};

/// All columns of a snapshot.
pub(crate) fn all_fields() -> impl Iterator<Item = &'static SnapshotField> {
    PARTICLE_FIELDS.iter().chain(TOOL_FIELDS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_description_of_the_layout_names_every_field() {
        let description = include_str!("../../../../docs/run_h5.md");
        for field in all_fields() {
            assert!(description.contains(&format!("`{}`", field.name)), "{}", field.name);
        }
    }

    #[test]
    fn a_particle_without_a_temperature_is_noticed() {
        let mut snapshot = Snapshot { id: vec![1, 2], body: vec![0, 0], ..Snapshot::default() };
        assert!(!is_complete(&snapshot));
        for field in PARTICLE_FIELDS.iter().filter(|field| !field.is_integer()) {
            field.set_reals(&mut snapshot, vec![0.0; 2 * field.width()]).unwrap();
        }
        snapshot.neighbours = vec![28, 28];
        assert!(is_complete(&snapshot));
        snapshot.temperature.pop();
        assert!(!is_complete(&snapshot));
    }

    #[test]
    fn a_column_of_the_wrong_form_is_refused() {
        let field = |name: &str| all_fields().find(|field| field.name == name).unwrap();
        let mut snapshot = Snapshot::default();
        assert_eq!(field("position").set_reals(&mut snapshot, vec![0.0; 4]), None);
        assert_eq!(field("body").set_integers(&mut snapshot, vec![1 << 40]), None);
        assert_eq!(field("body").set_reals(&mut snapshot, vec![1.0]), None);
        assert_eq!(field("stress").set_reals(&mut snapshot, vec![0.5; 12]), Some(()));
        assert_eq!(snapshot.stress, [[0.5; 6]; 2]);
    }
}
