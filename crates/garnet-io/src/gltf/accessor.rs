//! Accessors: typed numbers in buffers.

use gltf::json::{
    Accessor, Root,
    accessor::{ComponentType, Type},
    validation::Checked,
};

use super::GltfProblem;

/// Numbers out of an accessor, `components` a row.
#[derive(Debug)]
pub(super) struct Rows {
    pub components: usize,
    pub values: Vec<f64>,
}

impl Rows {
    pub(super) fn num_rows(&self) -> usize {
        self.values.len() / self.components
    }

    pub(super) fn rows(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.values.chunks_exact(self.components)
    }
}

/// Whether integers stand for fractions of their largest value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fractions {
    /// As the accessor says.
    AsDeclared,
    /// Always, as in weights.
    Always,
}

/// A part of a buffer with numbers in it.
struct Span {
    view: usize,
    offset: u64,
    count: u64,
    components: usize,
    kind: ComponentType,
}

/// Reads an accessor of a type.
///
/// Every offset is checked against the buffer before anything is allocated.
pub(super) fn read(
    root: &Root,
    buffers: &[Vec<u8>],
    index: usize,
    expected: Type,
    fractions: Fractions,
) -> Result<Rows, GltfProblem> {
    read_or_zeros(root, buffers, index, expected, fractions, 0)
}

/// The same; an accessor that says nothing but what a few of its rows are is zero elsewhere, and
/// has `num_rows` rows.
pub(super) fn read_or_zeros(
    root: &Root,
    buffers: &[Vec<u8>],
    index: usize,
    expected: Type,
    fractions: Fractions,
    num_rows: usize,
) -> Result<Rows, GltfProblem> {
    let wrong = |what| GltfProblem::Accessor {
        accessor: index,
        what,
    };
    let accessor = root
        .accessors
        .get(index)
        .ok_or_else(|| GltfProblem::OutOfRange {
            user: "the skinned mesh".to_owned(),
            part: "accessor",
            index,
            count: root.accessors.len(),
        })?;
    let Checked::Valid(type_) = accessor.type_ else {
        return Err(wrong("its type is unknown"));
    };
    let Checked::Valid(component) = accessor.component_type else {
        return Err(wrong("its component type is unknown"));
    };
    if type_ != expected {
        return Err(wrong("it has another type than its use needs"));
    }
    let components = type_.multiplicity();
    let mut values = match accessor.buffer_view {
        Some(view) => {
            let span = Span {
                view: view.value(),
                offset: accessor.byte_offset.unwrap_or_default().0,
                count: accessor.count.0,
                components,
                kind: component.0,
            };
            span.read(root, buffers).map_err(wrong)?
        }
        None if num_rows > 0 && accessor.count.0 == num_rows as u64 => {
            vec![0.0; num_rows * components]
        }
        // Zeros, but for the values that follow.
        None if accessor.sparse.is_some() && accessor.count.0 <= MOST_SPARSE => {
            vec![0.0; accessor.count.0 as usize * components]
        }
        None => return Err(wrong("it has no data (no `bufferView`)")),
    };
    overlay_sparse(
        accessor,
        root,
        buffers,
        component.0,
        components,
        &mut values,
    )
    .map_err(wrong)?;
    if accessor.normalized || fractions == Fractions::Always {
        let largest = match component.0 {
            ComponentType::I8 => 127.0,
            ComponentType::U8 => 255.0,
            ComponentType::I16 => 32_767.0,
            ComponentType::U16 => 65_535.0,
            ComponentType::U32 | ComponentType::F32 => 1.0,
        };
        let is_float = component.0 == ComponentType::F32;
        for value in values.iter_mut().filter(|_| !is_float) {
            *value = (*value / largest).max(-1.0);
        }
    }
    Ok(Rows { components, values })
}

fn overlay_sparse(
    accessor: &Accessor,
    root: &Root,
    buffers: &[Vec<u8>],
    kind: ComponentType,
    components: usize,
    values: &mut [f64],
) -> Result<(), &'static str> {
    let Some(sparse) = &accessor.sparse else {
        return Ok(());
    };
    let Checked::Valid(index_kind) = sparse.indices.component_type else {
        return Err("its sparse indices have an unknown type");
    };
    let count = sparse.count.0;
    let places = Span {
        view: sparse.indices.buffer_view.value(),
        offset: sparse.indices.byte_offset.0,
        count,
        components: 1,
        kind: index_kind.0,
    };
    let replacements = Span {
        view: sparse.values.buffer_view.value(),
        offset: sparse.values.byte_offset.0,
        count,
        components,
        kind,
    };
    let places = places.read(root, buffers)?;
    let replacements = replacements.read(root, buffers)?;
    for (place, row) in places.iter().zip(replacements.chunks_exact(components)) {
        let start = whole(*place).and_then(|place| place.checked_mul(components));
        let target = start.and_then(|start| values.get_mut(start..)?.get_mut(..components));
        target
            .ok_or("a sparse index is out of range")?
            .copy_from_slice(row);
    }
    Ok(())
}

impl Span {
    fn read(&self, root: &Root, buffers: &[Vec<u8>]) -> Result<Vec<f64>, &'static str> {
        let view = root
            .buffer_views
            .get(self.view)
            .ok_or("its buffer view does not exist")?;
        let buffer = buffers
            .get(view.buffer.value())
            .ok_or("its buffer does not exist")?;
        let start = view.byte_offset.unwrap_or_default().0;
        let end = start.checked_add(view.byte_length.0).ok_or(OUTSIDE)?;
        let range = usize::try_from(start).ok().zip(usize::try_from(end).ok());
        let bytes = range.and_then(|(start, end)| buffer.get(start..end));
        let bytes = bytes.ok_or("its buffer view ends outside the buffer")?;

        let size = self.kind.size();
        let row = size * self.components;
        let stride = view.byte_stride.map_or(row, |stride| stride.0);
        let stride = if stride == 0 { row } else { stride };
        if stride < row {
            return Err("its stride is shorter than one element");
        }
        let count = usize::try_from(self.count).map_err(|_too_many| OUTSIDE)?;
        let offset = usize::try_from(self.offset).map_err(|_too_far| OUTSIDE)?;
        let Some(last) = count.checked_sub(1) else {
            return Ok(Vec::new());
        };
        let end = last
            .checked_mul(stride)
            .and_then(|end| end.checked_add(row));
        let end = end.and_then(|end| end.checked_add(offset)).ok_or(OUTSIDE)?;
        let bytes = bytes.get(offset..end).ok_or(OUTSIDE)?;
        let mut values = Vec::with_capacity(count * self.components);
        for row_bytes in bytes.chunks(stride) {
            let items = row_bytes[..row].chunks_exact(size);
            values.extend(items.map(|item| number(self.kind, item)));
        }
        Ok(values)
    }
}

/// A number that counts something; none if it is negative, a fraction or not finite.
#[expect(clippy::cast_sign_loss, reason = "the range is checked")]
pub(super) fn whole(value: f64) -> Option<usize> {
    let is_count = (0.0..=f64::from(u32::MAX)).contains(&value) && value.fract() == 0.0;
    is_count.then_some(value as usize)
}

/// Accessors whose values are all told one by one have so many elements at most: nothing of the
/// file's size bounds them. More reads larger meshes, and takes more memory for damaged files.
const MOST_SPARSE: u64 = 4_000_000;

const OUTSIDE: &str = "it ends outside its buffer view";

fn number(kind: ComponentType, item: &[u8]) -> f64 {
    match (kind, item) {
        (ComponentType::I8, &[a]) => f64::from(i8::from_le_bytes([a])),
        (ComponentType::U8, &[a]) => f64::from(a),
        (ComponentType::I16, &[a, b]) => f64::from(i16::from_le_bytes([a, b])),
        (ComponentType::U16, &[a, b]) => f64::from(u16::from_le_bytes([a, b])),
        (ComponentType::U32, &[a, b, c, d]) => f64::from(u32::from_le_bytes([a, b, c, d])),
        (ComponentType::F32, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
        _ => f64::NAN,
    }
}
