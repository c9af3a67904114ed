//! Edits of files.

use proptest::prelude::*;
use proptest::sample::Index;

/// One change of a file; places are shares of its length.
#[derive(Debug, Clone)]
pub(crate) enum Edit {
    /// Other bytes over those that are there.
    Over(Index, Vec<u8>),
    /// Bytes between those that are there.
    Between(Index, Vec<u8>),
    /// A block is gone.
    Remove(Index, usize),
    /// A block is there so many times more.
    Repeat(Index, usize, usize),
    /// A block is somewhere else, too.
    Copy(Index, usize, Index),
    /// A number of the text is another one.
    Number(Index, &'static str),
    /// A line is gone, or there twice.
    Line(Index, bool),
    /// The file ends here.
    End(Index),
}

/// No edited file is longer.
const MOST: usize = 16 << 20;

/// What numbers become.
const NUMBERS: [&str; 16] = [
    "0",
    "-1",
    "1",
    "nan",
    "inf",
    "-inf",
    "1e39",
    "-1e308",
    "1e-320",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "18446744073709551616",
    "0x10",
    "",
    "99999999999999999999999999999999999999999999",
];

/// What bytes become: limits of integers and floats in both orders, and marks of texts.
const BYTES: [&[u8]; 14] = [
    b"\x00",
    b"\xff",
    b"\xff\xff\xff\xff",
    b"\x00\x00\x00\x80",
    b"\x80\x00\x00\x00",
    b"\x00\x00\xc0\x7f",
    b"\x00\x00\x80\x7f",
    b"\xff\xff\xff\xff\xff\xff\xff\x7f",
    b"\n",
    b"\"",
    b"{",
    b"]",
    b"\\\n",
    b"\xef\xbb\xbf",
];

/// One to six edits.
pub(crate) fn edits() -> impl Strategy<Value = Vec<Edit>> {
    let at = any::<Index>;
    let bytes = || {
        prop_oneof![
            prop::sample::select(&BYTES[..]).prop_map(<[u8]>::to_vec),
            prop::collection::vec(any::<u8>(), 1..9),
        ]
    };
    let length = || prop_oneof![4 => 1_usize..64, 1 => 64_usize..65536];
    let edit = prop_oneof![
        3 => (at(), bytes()).prop_map(|(at, bytes)| Edit::Over(at, bytes)),
        2 => (at(), bytes()).prop_map(|(at, bytes)| Edit::Between(at, bytes)),
        2 => (at(), length()).prop_map(|(at, length)| Edit::Remove(at, length)),
        1 => (at(), length(), 1_usize..200).prop_map(|(at, length, times)| {
            Edit::Repeat(at, length, times)
        }),
        1 => (at(), length(), at()).prop_map(|(at, length, to)| Edit::Copy(at, length, to)),
        4 => (at(), prop::sample::select(&NUMBERS[..])).prop_map(|(at, number)| {
            Edit::Number(at, number)
        }),
        2 => (at(), any::<bool>()).prop_map(|(at, twice)| Edit::Line(at, twice)),
        1 => at().prop_map(Edit::End),
    ];
    prop::collection::vec(edit, 1..7)
}

/// The file with all edits, one after the other.
pub(crate) fn edited(bytes: &[u8], edits: &[Edit]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for edit in edits {
        if bytes.is_empty() {
            break;
        }
        apply(edit, &mut bytes);
        bytes.truncate(MOST);
    }
    bytes
}

fn apply(edit: &Edit, bytes: &mut Vec<u8>) {
    let length = bytes.len();
    let block = |at: &Index, asked: usize| {
        let start = at.index(length);
        start..(start + asked).min(length)
    };
    match edit {
        Edit::Over(at, new) => {
            let range = block(at, new.len());
            bytes.splice(range, new.iter().copied());
        }
        Edit::Between(at, new) => {
            let at = at.index(length);
            bytes.splice(at..at, new.iter().copied());
        }
        Edit::Remove(at, asked) => drop(bytes.drain(block(at, *asked))),
        Edit::Repeat(at, asked, times) => {
            let range = block(at, *asked);
            let more = bytes[range.clone()].repeat((*times).min(MOST / range.len().max(1)));
            bytes.splice(range.end..range.end, more);
        }
        Edit::Copy(from, asked, to) => {
            let copy = bytes[block(from, *asked)].to_vec();
            let to = to.index(length);
            bytes.splice(to..to, copy);
        }
        Edit::Number(at, new) => {
            if let Some(range) = number_near(bytes, at.index(length)) {
                bytes.splice(range, new.bytes());
            }
        }
        Edit::Line(at, is_twice) => {
            let range = line_at(bytes, at.index(length));
            if *is_twice {
                let copy = bytes[range.clone()].to_vec();
                bytes.splice(range.end..range.end, copy);
            } else {
                bytes.drain(range);
            }
        }
        Edit::End(at) => bytes.truncate(at.index(length)),
    }
}

/// The first number of the text at or after a place.
fn number_near(bytes: &[u8], at: usize) -> Option<std::ops::Range<usize>> {
    let is_of_number = |byte: &u8| byte.is_ascii_digit() || matches!(byte, b'.' | b'-' | b'e');
    let start = at + bytes[at..].iter().position(u8::is_ascii_digit)?;
    let before = bytes[..start].iter().rev();
    let start = start - before.take_while(|&byte| is_of_number(byte)).count();
    let length = bytes[start..].iter().take_while(|&byte| is_of_number(byte));
    Some(start..start + length.count())
}

/// The line of a place, its end included.
fn line_at(bytes: &[u8], at: usize) -> std::ops::Range<usize> {
    let start = bytes[..at].iter().rposition(|&byte| byte == b'\n');
    let start = start.map_or(0, |end| end + 1);
    let end = bytes[start..].iter().position(|&byte| byte == b'\n');
    start..end.map_or(bytes.len(), |end| start + end + 1)
}

#[test]
fn edits_change_what_they_name() {
    let text = b"v 1.5 2\nv 3 4\n";
    assert_eq!(number_near(text, 0), Some(2..5));
    assert_eq!(number_near(text, 3), Some(2..5));
    assert_eq!(number_near(text, 13), None);
    assert_eq!(line_at(text, 9), 8..14);
    assert_eq!(line_at(text, 0), 0..8);
    let all = proptest::test_runner::TestRunner::deterministic().run(&edits(), |edits| {
        let found = edited(text, &edits);
        prop_assert!(found.len() <= MOST);
        prop_assert_eq!(edited(&[], &edits), Vec::<u8>::new());
        Ok(())
    });
    assert!(all.is_ok(), "{all:?}");
}
