//! LabVIEW measurement files (`.lvm`, text).

use super::csv::{DecimalMark, number_of};
use super::{FormatError, at, quoted};
use crate::{RawColumn, RawTable};

const END_OF_HEADER: &str = "***End_of_Header***";

/// What the headers of a file say.
struct Header {
    separator: char,
    decimal: DecimalMark,
    /// `X0` and `Delta_X` of each channel.
    start: Vec<f64>,
    interval: Vec<f64>,
}

/// Reads a file with one segment. The channels have the clock that its header states; the column
/// `X_Value`, where it is there, can be used as time stamps instead.
///
/// # Errors
/// A text that is no such file, a second segment, a line that does not fit.
pub fn read_lvm(text: &str) -> Result<RawTable, FormatError> {
    let mut lines = text
        .trim_start_matches('\u{feff}')
        .lines()
        .enumerate()
        .map(|(k, line)| (k + 1, line.trim_end_matches('\r')));
    match lines.next() {
        Some((_, first)) if first.trim_start().starts_with("LabVIEW Measurement") => {}
        _ => return Err(at(1, "this does not begin with `LabVIEW Measurement`")),
    }
    let mut header = Header {
        separator: '\t',
        decimal: DecimalMark::Point,
        start: Vec::new(),
        interval: Vec::new(),
    };
    // The header of the file, then that of its segment.
    let mut ends = 0;
    while ends < 2 {
        let Some((number, line)) = lines.next() else {
            return Err(at(1, "the file ends within its headers"));
        };
        if line.trim_start().starts_with(END_OF_HEADER) {
            ends += 1;
        } else {
            read_entry(&mut header, number, line)?;
        }
    }
    let Some((_, names)) = lines.find(|(_, line)| !line.trim().is_empty()) else {
        return Err(at(1, "no line of channel names follows the headers"));
    };
    let mut columns = columns(names, &header);
    for (number, line) in lines {
        if line.trim().is_empty() {
            continue;
        }
        if line.contains(END_OF_HEADER) || line.trim_start().starts_with("Channels") {
            return Err(at(number, "a second segment begins: split the file into one per cut"));
        }
        let mut cells = line.split(header.separator);
        for (name, column) in &mut columns {
            let cell = cells.next().unwrap_or("");
            let Some(column) = column else { continue };
            let value = number_of(cell, header.decimal).ok_or_else(|| {
                let (name, cell) = (quoted(name), quoted(cell.trim()));
                at(number, format!("channel `{name}`: `{cell}` is not a number"))
            })?;
            column.values.push(value);
        }
    }
    Ok(RawTable { columns: columns.into_iter().filter_map(|(_, column)| column).collect() })
}

/// One line of a header: a key and values.
fn read_entry(header: &mut Header, number: usize, line: &str) -> Result<(), FormatError> {
    // The separator itself is stated with a separator: a tabulator or a comma.
    let mut cells = line.split(['\t', header.separator]);
    let key = cells.next().unwrap_or("").trim();
    let mut numbers = |decimal: DecimalMark| -> Result<Vec<f64>, FormatError> {
        cells
            .by_ref()
            .filter(|cell| !cell.trim().is_empty())
            .map(|cell| {
                number_of(cell, decimal).ok_or_else(|| {
                    at(number, format!("{key}: `{}` is not a number", quoted(cell.trim())))
                })
            })
            .collect()
    };
    match key {
        "X0" => header.start = numbers(header.decimal)?,
        "Delta_X" => header.interval = numbers(header.decimal)?,
        "Separator" if cells.next().is_some_and(|word| word.trim() == "Comma") => {
            header.separator = ',';
        }
        "Decimal_Separator" => {
            // With commas between cells the mark itself splits into empty cells.
            let comma = line.trim_start_matches("Decimal_Separator").contains(',');
            let point = line.trim_start_matches("Decimal_Separator").contains('.');
            if comma && !point && header.separator != ',' {
                header.decimal = DecimalMark::Comma;
            }
        }
        _ => {}
    }
    Ok(())
}

/// Columns by name; comments are not columns. With one column of times for each channel the second
/// and later ones have no name of their own and are left out.
fn columns(names: &str, header: &Header) -> Vec<(String, Option<RawColumn>)> {
    let mut channel = 0;
    let mut seen: Vec<String> = Vec::new();
    names
        .split(header.separator)
        .map(|cell| {
            let name = cell.trim().trim_matches('"').to_owned();
            let again = seen.contains(&name);
            seen.push(name.clone());
            if name.is_empty() || name == "Comment" || again {
                return (name, None);
            }
            let mut column = RawColumn { name: name.clone(), ..RawColumn::default() };
            if name != "X_Value" {
                let start = header.start.get(channel).copied();
                column.clock = header.interval.get(channel).map(|d| (start.unwrap_or(0.0), *d));
                channel += 1;
            }
            (name, Some(column))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(crate) const EXAMPLE: &str = "LabVIEW Measurement\t\r\nWriter_Version\t2\r\nSeparator\tTab\r\n\
        Decimal_Separator\t.\r\nMulti_Headings\tNo\r\nX_Columns\tOne\r\n***End_of_Header***\t\r\n\t\r\n\
        Channels\t2\t\t\r\nSamples\t3\t3\t\r\nX_Dimension\tTime\tTime\t\r\nX0\t0.0E+0\t0.0E+0\t\r\n\
        Delta_X\t0.001\t0.001\t\r\n***End_of_Header***\t\t\t\r\nX_Value\tFx\tFy\tComment\r\n\
        0.000\t1.5\t-2\t\r\n0.001\t2.5\t\tstart\r\n0.002\t3.5\t-4\r\n";

    #[test]
    fn a_file_of_labview_is_read() {
        let table = read_lvm(EXAMPLE).unwrap();
        let names: Vec<&str> = table.columns.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["X_Value", "Fx", "Fy"]);
        assert_eq!(table.columns[1].values, [1.5, 2.5, 3.5]);
        assert_eq!(table.columns[2].clock, Some((0.0, 0.001)));
        assert!(table.columns[2].values[1].is_nan());
        let german = EXAMPLE.replace("Separator\t.", "Separator\t,").replace("1.5", "1,5");
        let german = german.replace('.', ",");
        assert_eq!(read_lvm(&german).unwrap().columns[1].values, [1.5, 2.5, 3.5]);
    }

    #[test]
    fn what_is_no_such_file_is_told() {
        let read = |text: &str| read_lvm(text).unwrap_err().to_string();
        assert!(read("t,Fx\n").contains("line 1"));
        assert!(read("LabVIEW Measurement\nX0\t1\n").contains("ends within its headers"));
        assert!(read(&EXAMPLE.replace("2.5", "2;5")).contains("line 17: channel `Fx`: `2;5`"));
        let twice = format!("{EXAMPLE}\r\nChannels\t2\r\n***End_of_Header***\r\n");
        assert!(read(&twice).contains("a second segment"), "{}", read(&twice));
    }
}
