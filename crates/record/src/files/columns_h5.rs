//! Groups of columns of numbers: measured series and their tables, written and read as HDF5.

use super::hdf::{Array, ArrayLayout, Attribute, HdfReader, HdfWriter};
use crate::RunError;
use std::path::Path;

/// A column of numbers with its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColumnH5<'a> {
    /// Name of the array.
    pub name: &'a str,
    /// Unit, an attribute of the array; empty for pure numbers.
    pub unit: &'a str,
    /// The numbers; NaN is what is not known, and the attribute `not_finite` of the array says so.
    pub values: &'a [f64],
}

/// An attribute of a group.
#[derive(Debug, Clone, PartialEq)]
pub enum FactH5 {
    /// Text.
    Text(String),
    /// A number.
    Real(f64),
}

/// A group of columns with its attributes.
#[derive(Debug, Clone, PartialEq)]
pub struct GroupH5<'a> {
    /// Its name.
    pub path: String,
    /// Its attributes by name.
    pub facts: Vec<(&'a str, FactH5)>,
    /// Its columns.
    pub columns: Vec<ColumnH5<'a>>,
    /// Its columns of words by name.
    pub texts: Vec<(&'a str, Vec<&'a str>)>,
}

/// Writes a file of groups; `facts` are the attributes of the file itself. The file takes its place only
/// when it is complete.
///
/// # Errors
/// A file that cannot be written.
pub fn write_columns_h5(
    path: &Path,
    facts: &[(&str, FactH5)],
    groups: &[GroupH5<'_>],
) -> Result<(), RunError> {
    let writer = HdfWriter::create(path)?;
    writer.root(&attributes(facts))?;
    for group in groups {
        writer.group(&group.path, &attributes(&group.facts))?;
        for column in &group.columns {
            let mut about = vec![("unit", Attribute::text(column.unit))];
            if column.values.iter().any(|value| value.is_nan()) {
                about.push(("not_finite", Attribute::text("NaN: not known")));
            }
            let array = format!("{}/{}", group.path, column.name);
            writer.array(&array, Array::F64(column.values), ArrayLayout::Rows, &about)?;
        }
        for (name, words) in &group.texts {
            let array = format!("{}/{name}", group.path);
            writer.array(&array, Array::Text(words), ArrayLayout::Rows, &[])?;
        }
    }
    writer.finish()
}

fn attributes<'a>(facts: &[(&'a str, FactH5)]) -> Vec<(&'a str, Attribute)> {
    facts
        .iter()
        .map(|(name, fact)| match fact {
            FactH5::Text(text) => (*name, Attribute::text(text.clone())),
            FactH5::Real(value) => (*name, Attribute::Real(*value)),
        })
        .collect()
}

/// Most values of an array that are read unless more are allowed: a quarter of an hour at 20 kHz.
pub const MOST_VALUES: u64 = 20_000_000;

/// The one-dimensional arrays of numbers in the group `group` of a file that any program has written:
/// name and values. Arrays of other shapes, and those that cannot be read as numbers, are left out.
///
/// # Errors
/// A file that cannot be read, no such group, an array of more than [`MOST_VALUES`].
pub fn read_columns_h5(path: &Path, group: &str) -> Result<Vec<(String, Vec<f64>)>, RunError> {
    read_named_columns_h5(path, group, &|_| Wanted::IfNumbers, MOST_VALUES)
}

/// Whether an array is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wanted {
    /// It has to be.
    Yes,
    /// Its name is listed with no values.
    NameOnly,
    /// If it holds numbers.
    IfNumbers,
}

/// As [`read_columns_h5`], but `wanted` says of each name whether its values are read. An array of more than
/// `most_values` is refused before memory is asked for.
///
/// # Errors
/// As there, and a wanted array that cannot be read.
pub fn read_named_columns_h5(
    path: &Path,
    group: &str,
    wanted: &dyn Fn(&str) -> Wanted,
    most_values: u64,
) -> Result<Vec<(String, Vec<f64>)>, RunError> {
    let reader = HdfReader::open(path, "recordings")?;
    let group = group.trim_matches('/');
    let inside = if group.is_empty() { "/" } else { group };
    let mut columns = Vec::new();
    for name in reader.arrays(inside)? {
        let array = if group.is_empty() { name.clone() } else { format!("{group}/{name}") };
        let wanted = wanted(&name);
        if wanted == Wanted::NameOnly {
            columns.push((name, Vec::new()));
            continue;
        }
        match (reader.series(&array, most_values), wanted) {
            (Ok(Some(values)), _) => columns.push((name, values)),
            (Ok(None), Wanted::Yes) => {
                let reason = format!("`{array}` is no one-dimensional array of numbers");
                return Err(RunError::Foreign {
                    path: path.to_owned(),
                    expected: "recordings",
                    reason,
                });
            }
            (Ok(None), _) => {}
            (Err(error @ RunError::TooLarge { .. }), _) | (Err(error), Wanted::Yes) => {
                return Err(error);
            }
            (Err(error), _) if reader.has_checksums() => return Err(error),
            (Err(_), _) => {}
        }
    }
    Ok(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A small file that says it holds 2^40 values, and one whose single chunk does.
    #[test]
    fn no_memory_is_asked_for_what_a_file_only_says() {
        let path = std::env::temp_dir().join(format!("sphcut-huge-{}.h5", std::process::id()));
        let file = hdf5_pure::File::create(&path).unwrap();
        let create = file.root().create_dataset("Fx", |dataset| {
            let extent = [hdf5_pure::MaxExtent::Unlimited];
            dataset.with_f64_data(&[0.0; 64]).with_shape(&[64]).with_maxshape(&extent);
            dataset.with_chunks(&[64]).with_deflate(1);
        });
        create.unwrap();
        file.close().unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let wanted = |_: &str| Wanted::Yes;
        assert!(read_named_columns_h5(&path, "/", &wanted, 64).is_ok());
        let error = read_named_columns_h5(&path, "/", &wanted, 63).unwrap_err().to_string();
        assert!(error.contains("64 values, more than 63"), "{error}");
        // Bits of its lengths: whatever they say, little memory is asked for and nothing is silent.
        let mut refused = 0;
        for place in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[place] ^= 0x55;
            std::fs::write(&path, changed).unwrap();
            refused += usize::from(read_named_columns_h5(&path, "/", &wanted, 64).is_err());
        }
        std::fs::remove_file(&path).unwrap();
        assert!(refused > 100, "{refused}");
    }

    #[test]
    fn what_is_written_is_read_back() {
        let folder = std::env::temp_dir().join(format!("sphcut_columns_{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("columns.h5");
        let values: Vec<f64> = (0..2000).map(f64::from).collect();
        let column = |name| ColumnH5 { name, unit: "N", values: &values };
        let group = GroupH5 {
            path: "cut_one".to_owned(),
            facts: vec![
                ("name", FactH5::Text("one \u{b5}".to_owned())),
                ("rate", FactH5::Real(5.0)),
            ],
            columns: vec![column("F_c"), column("F_f")],
            texts: vec![("state", vec!["good", "", "na\u{ef}ve"])],
        };
        write_columns_h5(&path, &[("title", FactH5::Text("t".to_owned()))], &[group]).unwrap();
        let read = read_columns_h5(&path, "/cut_one/").unwrap();
        assert_eq!(read.len(), 2);
        assert_eq!(read[0], ("F_c".to_owned(), values.clone()));
        assert!(read_columns_h5(&path, "/").unwrap().is_empty());
        assert!(read_columns_h5(&path, "nowhere").is_err());
        let named = |most| {
            let wanted = |name: &str| if name == "F_f" { Wanted::Yes } else { Wanted::NameOnly };
            read_named_columns_h5(&path, "cut_one", &wanted, most)
        };
        let all = named(2000).unwrap();
        let of = |name: &str| all.iter().find(|(n, _)| n == name).map(|(_, values)| values.len());
        assert_eq!((of("F_c"), of("F_f")), (Some(0), Some(2000)));
        let error = named(1999).unwrap_err().to_string();
        assert!(error.contains("`cut_one/F_f` has 2000 values, more than 1999"), "{error}");
        std::fs::write(&path, "no").unwrap();
        assert!(read_columns_h5(&path, "/").is_err());
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
