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
    /// The numbers.
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
            let unit = [("unit", Attribute::text(column.unit))];
            let array = format!("{}/{}", group.path, column.name);
            writer.array(&array, Array::F64(column.values), ArrayLayout::Rows, &unit)?;
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

/// The one-dimensional arrays of numbers in the group `group` of a file that any program has written:
/// name and values. Arrays of texts and of other shapes are left out.
///
/// # Errors
/// A file that cannot be read, or no such group.
pub fn read_columns_h5(path: &Path, group: &str) -> Result<Vec<(String, Vec<f64>)>, RunError> {
    let reader = HdfReader::open(path, "recordings")?;
    let group = group.trim_matches('/');
    let inside = if group.is_empty() { "/" } else { group };
    let mut columns = Vec::new();
    for name in reader.arrays(inside)? {
        let array = if group.is_empty() { name.clone() } else { format!("{group}/{name}") };
        if reader.shape(&array)?.len() == 1
            && let Ok(values) = reader.reals(&array)
        {
            columns.push((name, values));
        }
    }
    Ok(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

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
        std::fs::write(&path, "no").unwrap();
        assert!(read_columns_h5(&path, "/").is_err());
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
