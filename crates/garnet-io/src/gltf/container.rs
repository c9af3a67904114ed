//! GLB chunks, and the buffers of a file.

use std::{fs, path::Path};

use garnet_mesh::{MOST_BYTES, read_bounded, stays_inside};
use gltf::json::Root;

use super::{GltfProblem, base64};
use crate::FileProblem;

/// How a GLB file starts.
pub(crate) const MAGIC: &[u8] = b"glTF";

/// The JSON of a GLB or glTF file, and the binary chunk of a GLB.
pub(super) fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), GltfProblem> {
    let Some(rest) = bytes.strip_prefix(MAGIC) else {
        return Ok((bytes, None));
    };
    let (version, rest) = number(rest)?;
    if version != 2 {
        return Err(GltfProblem::Version {
            found: version.to_string(),
        });
    }
    let (length, rest) = number(rest)?;
    let body = (length as usize).checked_sub(12);
    let body = body
        .and_then(|length| rest.get(..length))
        .ok_or(GltfProblem::Container {
            what: "it is shorter than its header says",
        })?;
    let (json, rest) = chunk(body)?;
    let ([b'J', b'S', b'O', b'N'], json) = json else {
        return Err(GltfProblem::Container {
            what: "its first chunk is not JSON",
        });
    };
    if rest.is_empty() {
        return Ok((json, None));
    }
    let ((kind, data), _) = chunk(rest)?;
    Ok((json, (kind == *b"BIN\0").then_some(data)))
}

fn number(bytes: &[u8]) -> Result<(u32, &[u8]), GltfProblem> {
    let (first, rest) = bytes.split_first_chunk().ok_or(GltfProblem::Container {
        what: "a header ends early",
    })?;
    Ok((u32::from_le_bytes(*first), rest))
}

type Chunk<'a> = ([u8; 4], &'a [u8]);

fn chunk(bytes: &[u8]) -> Result<(Chunk<'_>, &[u8]), GltfProblem> {
    let (length, rest) = number(bytes)?;
    let (kind, rest) = number(rest)?;
    let (data, rest) = rest
        .split_at_checked(length as usize)
        .ok_or(GltfProblem::Container {
            what: "a chunk is shorter than its header says",
        })?;
    Ok(((kind.to_le_bytes(), data), rest))
}

/// The bytes of every buffer: the binary chunk, `data:` URIs, files beside the glTF.
pub(super) fn buffers(
    root: &Root,
    binary: Option<&[u8]>,
    folder: &Path,
) -> Result<Vec<Vec<u8>>, FileProblem> {
    let mut buffers = Vec::new();
    let mut left = MOST_BYTES;
    for (index, buffer) in root.buffers.iter().enumerate() {
        let wrong = |what| GltfProblem::Buffer {
            buffer: index,
            what,
        };
        let bytes = match (&buffer.uri, binary) {
            (Some(uri), _) => from_uri(uri, folder, left, wrong)?,
            (None, Some(binary)) if index == 0 => binary.to_vec(),
            (None, _) => return Err(wrong("it has no URI and there is no binary chunk").into()),
        };
        left = (left.checked_sub(bytes.len() as u64)).ok_or_else(|| wrong(TOO_MUCH))?;
        if (bytes.len() as u64) < buffer.byte_length.0 {
            return Err(wrong("it has fewer bytes than it says").into());
        }
        buffers.push(bytes);
    }
    Ok(buffers)
}

const TOO_MUCH: &str = "with it, the buffers have more than 1 GiB";

fn from_uri(
    uri: &str,
    folder: &Path,
    left: u64,
    wrong: impl Fn(&'static str) -> GltfProblem,
) -> Result<Vec<u8>, FileProblem> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (_, text) = data
            .split_once(";base64,")
            .ok_or_else(|| wrong("its data URI is not base64"))?;
        return Ok(base64::decode(text).ok_or_else(|| wrong("its data URI is not base64"))?);
    }
    if uri.contains("://") {
        return Err(wrong("its URI is not a file").into());
    }
    let name = percent_decoded(uri).ok_or_else(|| wrong("its URI is not a file name"))?;
    if !stays_inside(&name) {
        return Err(wrong("its file is not beside the glTF, nor in a folder there").into());
    }
    let path = folder.join(name);
    if !path.is_file() {
        return Err(FileProblem::MissingFile {
            role: "the buffer",
            path,
        });
    }
    if fs::metadata(&path)?.len() > left {
        return Err(wrong(TOO_MUCH).into());
    }
    Ok(read_bounded(&path, left)?)
}

/// Replaces `%20` and the like; none if the result is no text.
fn percent_decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        let digits = tail.get(..2).and_then(|digits| str::from_utf8(digits).ok());
        let decoded = digits.and_then(|digits| u8::from_str_radix(digits, 16).ok());
        if let (b'%', Some(byte)) = (first, decoded) {
            bytes.push(byte);
            rest = &tail[2..];
        } else {
            bytes.push(first);
            rest = tail;
        }
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percent_signs_are_decoded_and_kept_where_they_stand_alone() {
        assert_eq!(percent_decoded("a%20b.bin").unwrap(), "a b.bin");
        assert_eq!(percent_decoded("100%.bin").unwrap(), "100%.bin");
        assert_eq!(percent_decoded("%ff"), None);
    }

    #[test]
    fn a_container_cut_anywhere_is_refused() {
        let mut glb = b"glTF\x02\0\0\0\x1c\0\0\0\x02\0\0\0JSON{}\x02\0\0\0BIN\0".to_vec();
        glb[8] = (glb.len() + 2) as u8;
        glb.extend([7, 8]);
        let (json, binary) = split(&glb).unwrap();
        assert_eq!((json, binary), (&b"{}"[..], Some(&[7_u8, 8][..])));
        for length in 4..glb.len() {
            assert!(split(&glb[..length]).is_err(), "cut at {length}");
        }
    }
}
