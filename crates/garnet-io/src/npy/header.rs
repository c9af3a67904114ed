//! Headers of arrays, which are Python dictionaries.

use super::{ArrayProblem, problem::not_an_array};

/// The header text and the data behind it.
pub(super) fn split_header(bytes: &[u8]) -> Result<(&str, &[u8]), ArrayProblem> {
    let rest = bytes
        .strip_prefix(b"\x93NUMPY")
        .ok_or(not_an_array("the magic number is missing"))?;
    let (length, start) = match *rest {
        [1, _, a, b, ..] => (u64::from(u16::from_le_bytes([a, b])), 4),
        [2 | 3, _, a, b, c, d, ..] => (u64::from(u32::from_le_bytes([a, b, c, d])), 6),
        _ => return Err(not_an_array("its version is not 1, 2 or 3")),
    };
    let rest = &rest[start..];
    let length = usize::try_from(length).unwrap_or(usize::MAX);
    let (header, data) = rest
        .split_at_checked(length)
        .ok_or(not_an_array("its header is cut off"))?;
    let header =
        str::from_utf8(header).map_err(|_invalid| not_an_array("its header is not text"))?;
    Ok((header, data))
}

/// What stands behind `'key':` in the header, a Python dictionary.
pub(super) fn value_after<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let (_, rest) = header
        .split_once(&format!("'{key}'"))
        .or_else(|| header.split_once(&format!("\"{key}\"")))?;
    Some(rest.trim_start().strip_prefix(':')?.trim_start())
}

pub(super) fn quoted_after<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let value = value_after(header, key)?;
    let quote = value.chars().next()?;
    if quote != '\'' && quote != '"' {
        // A list describes records; it is shown as it is and refused as an element type.
        return value.split_terminator('}').next();
    }
    value[1..].split(quote).next()
}

pub(super) fn shape(header: &str) -> Result<Vec<usize>, ArrayProblem> {
    let value = value_after(header, "shape").ok_or(not_an_array("there is no `shape`"))?;
    let inner = value
        .strip_prefix('(')
        .and_then(|value| value.split_once(')'))
        .ok_or(not_an_array("its `shape` is no tuple"))?
        .0;
    let axes = inner
        .split(',')
        .map(str::trim)
        .filter(|axis| !axis.is_empty());
    let axes = axes.map(|axis| axis.trim_end_matches('L').parse());
    axes.collect::<Result<_, _>>()
        .map_err(|_invalid| not_an_array("its `shape` is not made of counts"))
}
