//! Typed reading of glTF accessors with every range checked: a file that lies about its lengths yields an
//! error, never a panic. All component types are read, so quantized meshes need no code of their own.

use gltf::accessor::{Accessor, DataType, Dimensions};
use gltf::buffer::View;

/// Reads accessors from loaded buffers.
pub struct Accessors<'a> {
    /// Bytes of each buffer.
    pub buffers: &'a [Vec<u8>],
}

/// Elements allowed in an accessor that is all zeros and so is not bounded by the size of any file.
const MOST_ZEROS: usize = 1 << 24;

/// What an accessor holds, as plain numbers.
#[derive(Debug, PartialEq)]
pub struct Floats {
    /// Numbers per element.
    pub width: usize,
    /// `count * width` numbers.
    pub values: Vec<f32>,
}

impl Floats {
    /// Elements as arrays of `N` numbers: surplus numbers are dropped, missing ones taken from `fill`.
    pub fn arrays<const N: usize>(&self, fill: [f32; N]) -> Vec<[f32; N]> {
        self.values
            .chunks_exact(self.width)
            .map(|element| {
                let mut out = fill;
                for (o, v) in out.iter_mut().zip(element) {
                    *o = *v;
                }
                out
            })
            .collect()
    }
}

impl Accessors<'_> {
    /// Reads numbers, mapping normalized integers to [0, 1] or [-1, 1]. `widths` lists the numbers per
    /// element that make sense here.
    ///
    /// # Errors
    /// A clause naming the accessor and what is wrong with it.
    pub fn floats(&self, accessor: &Accessor, widths: &[usize]) -> Result<Floats, String> {
        let width = accessor.dimensions().multiplicity();
        if !widths.contains(&width) {
            return Err(format!(
                "accessor {} has {width} numbers per element, not {widths:?}",
                accessor.index()
            ));
        }
        let normalized = accessor.normalized();
        let mut values = Vec::new();
        self.visit(accessor, |kind, bytes, at| {
            let value = number(kind, normalized, bytes)?;
            if at < values.len() {
                values[at] = value;
            } else {
                values.push(value);
            }
            Some(())
        })?;
        Ok(Floats { width, values })
    }

    /// Reads whole numbers: vertex indices and joint indices.
    ///
    /// # Errors
    /// As [`Accessors::floats`]; also for signed and floating-point accessors.
    pub fn integers(&self, accessor: &Accessor, width: usize) -> Result<Vec<u32>, String> {
        if accessor.dimensions().multiplicity() != width {
            return Err(format!("accessor {} does not have {width} numbers per element", accessor.index()));
        }
        let mut values = Vec::new();
        self.visit(accessor, |kind, bytes, at| {
            let value = match (kind, bytes) {
                (DataType::U8, [a, ..]) => u32::from(*a),
                (DataType::U16, [a, b, ..]) => u32::from(u16::from_le_bytes([*a, *b])),
                (DataType::U32, [a, b, c, d, ..]) => u32::from_le_bytes([*a, *b, *c, *d]),
                _ => return None,
            };
            if at < values.len() {
                values[at] = value;
            } else {
                values.push(value);
            }
            Some(())
        })?;
        Ok(values)
    }

    /// Hands every component to `put` with its place in the flat result: first all of the dense part in
    /// order, then the sparse replacements.
    fn visit(
        &self,
        accessor: &Accessor,
        mut put: impl FnMut(DataType, &[u8], usize) -> Option<()>,
    ) -> Result<(), String> {
        let name = accessor.index();
        let (kind, width, count) =
            (accessor.data_type(), accessor.dimensions().multiplicity(), accessor.count());
        let layout = Layout::of(kind, accessor.dimensions());
        let wrong_type = || format!("accessor {name} has an unsuitable component type");
        match accessor.view() {
            Some(view) => {
                let bytes = self
                    .range(&view, accessor.offset(), count, layout.size)
                    .ok_or_else(|| format!("accessor {name} reaches beyond the end of its buffer"))?;
                let stride = view.stride().unwrap_or(layout.size);
                for element in 0..count {
                    for component in 0..width {
                        let start = element * stride + layout.offset(component);
                        put(kind, &bytes[start..], element * width + component).ok_or_else(wrong_type)?;
                    }
                }
            }
            None if count <= MOST_ZEROS => {
                for at in 0..count * width {
                    put(kind, &[0; 4], at).ok_or_else(wrong_type)?;
                }
            }
            None => return Err(format!("accessor {name} claims {count} elements but names no data")),
        }
        let Some(sparse) = accessor.sparse() else { return Ok(()) };
        let beyond = || format!("the sparse part of accessor {name} reaches beyond its buffer");
        let (indices, values) = (sparse.indices(), sparse.values());
        let index_size = indices.index_type().size();
        let index_bytes =
            self.range(&indices.view(), indices.offset(), sparse.count(), index_size).ok_or_else(beyond)?;
        let index_stride = indices.view().stride().unwrap_or(index_size);
        let value_bytes =
            self.range(&values.view(), values.offset(), sparse.count(), layout.size).ok_or_else(beyond)?;
        let value_stride = values.view().stride().unwrap_or(layout.size);
        for entry in 0..sparse.count() {
            let raw = &index_bytes[entry * index_stride..][..index_size];
            let target = raw.iter().rev().fold(0usize, |sum, byte| sum << 8 | usize::from(*byte));
            if target >= count {
                return Err(format!("the sparse part of accessor {name} names element {target} of {count}"));
            }
            for component in 0..width {
                let start = entry * value_stride + layout.offset(component);
                put(kind, &value_bytes[start..], target * width + component).ok_or_else(wrong_type)?;
            }
        }
        Ok(())
    }

    /// The bytes of `count` elements of a view; `None` when they are not all there.
    fn range(&self, view: &View, offset: usize, count: usize, size: usize) -> Option<&[u8]> {
        let view_bytes = self.view(view)?;
        let stride = view.stride().unwrap_or(size);
        if stride < size {
            return None;
        }
        let needed = match count {
            0 => 0,
            _ => stride.checked_mul(count - 1)?.checked_add(size)?,
        };
        view_bytes.get(offset..offset.checked_add(needed)?)
    }

    /// The bytes of a buffer view; `None` when its buffer is too short.
    pub fn view(&self, view: &View) -> Option<&[u8]> {
        let buffer = self.buffers.get(view.buffer().index())?;
        buffer.get(view.offset()..view.offset().checked_add(view.length())?)
    }
}

/// Where the components of an element lie: the columns of matrices start at multiples of four bytes.
struct Layout {
    component: usize,
    rows: usize,
    column_stride: usize,
    size: usize,
}

impl Layout {
    fn of(kind: DataType, dimensions: Dimensions) -> Self {
        let component = kind.size();
        let (rows, columns) = match dimensions {
            Dimensions::Mat2 => (2, 2),
            Dimensions::Mat3 => (3, 3),
            Dimensions::Mat4 => (4, 4),
            other => (other.multiplicity(), 1),
        };
        let column = component * rows;
        let column_stride = if columns > 1 { column.next_multiple_of(4) } else { column };
        Self { component, rows, column_stride, size: column_stride * columns }
    }

    fn offset(&self, component: usize) -> usize {
        component / self.rows * self.column_stride + component % self.rows * self.component
    }
}

fn number(kind: DataType, normalized: bool, bytes: &[u8]) -> Option<f32> {
    let scaled = |value: f32, most: f32| if normalized { (value / most).max(-1.0) } else { value };
    Some(match (kind, bytes) {
        (DataType::I8, [a, ..]) => scaled(f32::from(i8::from_le_bytes([*a])), 127.0),
        (DataType::U8, [a, ..]) => scaled(f32::from(*a), 255.0),
        (DataType::I16, [a, b, ..]) => scaled(f32::from(i16::from_le_bytes([*a, *b])), 32767.0),
        (DataType::U16, [a, b, ..]) => scaled(f32::from(u16::from_le_bytes([*a, *b])), 65535.0),
        (DataType::U32, [a, b, c, d, ..]) => u32::from_le_bytes([*a, *b, *c, *d]) as f32,
        (DataType::F32, [a, b, c, d, ..]) => f32::from_le_bytes([*a, *b, *c, *d]),
        _ => return None,
    })
}
