//! Typed reading of glTF accessors with every range checked: a file that lies about its lengths yields an
//! error, never a panic. All component types are read, so quantized meshes need no code of their own.

use std::collections::HashMap;

use gltf::accessor::{Accessor, DataType, Dimensions};
use gltf::buffer::View;

use crate::budget::Budget;

/// Reads accessors from loaded buffers.
pub struct Accessors<'a> {
    /// Bytes of each buffer.
    pub buffers: &'a [Vec<u8>],
    /// Bytes of the views that are compressed, by their index.
    pub decoded: &'a HashMap<usize, Vec<u8>>,
    /// Counts what is read.
    pub budget: &'a Budget,
}

/// Elements of an accessor that are read.
#[derive(Clone, Copy)]
pub enum Pick<'a> {
    /// All of them.
    All,
    /// These, in ascending order. Many primitives may share one accessor and need little of it each.
    These(&'a [u32]),
}

impl Pick<'_> {
    /// Elements that are read of `count`.
    pub fn count(self, count: usize) -> usize {
        match self {
            Self::All => count,
            Self::These(elements) => elements.len(),
        }
    }

    /// Element of the accessor that ends up at `place`.
    pub fn element(self, place: usize) -> usize {
        match self {
            Self::All => place,
            Self::These(elements) => elements[place] as usize,
        }
    }

    /// Place that an element ends up at, if it is read.
    fn place(self, element: usize) -> Option<usize> {
        match self {
            Self::All => Some(element),
            Self::These(elements) => elements.binary_search_by(|e| (*e as usize).cmp(&element)).ok(),
        }
    }
}

/// Content of an accessor, as plain numbers.
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
    pub fn floats(&self, accessor: &Accessor, widths: &[usize], pick: Pick) -> Result<Floats, String> {
        let width = accessor.dimensions().multiplicity();
        if !widths.contains(&width) {
            return Err(format!(
                "accessor {} has {width} numbers per element, not {widths:?}",
                accessor.index()
            ));
        }
        let normalized = accessor.normalized();
        let values = self.read(accessor, pick, |kind, bytes| number(kind, normalized, bytes))?;
        Ok(Floats { width, values })
    }

    /// Reads whole numbers: vertex indices and joint indices.
    ///
    /// # Errors
    /// As [`Accessors::floats`]; also for signed and floating-point accessors.
    pub fn integers(&self, accessor: &Accessor, width: usize, pick: Pick) -> Result<Vec<u32>, String> {
        if accessor.dimensions().multiplicity() != width {
            return Err(format!("accessor {} does not have {width} numbers per element", accessor.index()));
        }
        self.read(accessor, pick, whole)
    }

    /// Reads the components of all picked elements, each by `convert`: first the dense part, then the sparse
    /// replacements. Picked elements lie within the accessor.
    fn read<T>(
        &self,
        accessor: &Accessor,
        pick: Pick,
        convert: impl Fn(DataType, &[u8]) -> Option<T>,
    ) -> Result<Vec<T>, String> {
        let name = accessor.index();
        let (kind, width, count) =
            (accessor.data_type(), accessor.dimensions().multiplicity(), accessor.count());
        let layout = Layout::of(kind, accessor.dimensions());
        let convert = |bytes: &[u8]| {
            convert(kind, bytes).ok_or_else(|| format!("accessor {name} has an unsuitable component type"))
        };
        let dense = match accessor.view() {
            Some(view) => {
                let bytes = self
                    .range(&view, accessor.offset(), count, layout.size)
                    .ok_or_else(|| format!("accessor {name} reaches beyond the end of its buffer"))?;
                Some((bytes, view.stride().unwrap_or(layout.size)))
            }
            None => None,
        };
        let picked = pick.count(count);
        self.budget
            .take(picked, width * size_of::<T>())
            .map_err(|problem| format!("accessor {name} of {count} elements {problem}"))?;
        let mut values = Vec::with_capacity(picked * width);
        for place in 0..picked {
            for component in 0..width {
                values.push(match dense {
                    Some((bytes, stride)) => {
                        convert(&bytes[pick.element(place) * stride + layout.offset(component)..])?
                    }
                    None => convert(&[0; 4])?,
                });
            }
        }
        self.replace(accessor, &layout, |element, bytes| {
            let Some(place) = pick.place(element) else { return Ok(()) };
            for component in 0..width {
                values[place * width + component] = convert(&bytes[layout.offset(component)..])?;
            }
            Ok(())
        })?;
        Ok(values)
    }

    /// Hands the number and the bytes of each element of the sparse part to `put`.
    fn replace(
        &self,
        accessor: &Accessor,
        layout: &Layout,
        mut put: impl FnMut(usize, &[u8]) -> Result<(), String>,
    ) -> Result<(), String> {
        let Some(sparse) = accessor.sparse() else { return Ok(()) };
        let (name, count) = (accessor.index(), accessor.count());
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
            put(target, &value_bytes[entry * value_stride..])?;
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
        if let Some(decoded) = self.decoded.get(&view.index()) {
            return Some(decoded);
        }
        let buffer = self.buffers.get(view.buffer().index())?;
        buffer.get(view.offset()..view.offset().checked_add(view.length())?)
    }
}

/// Places of the components of an element: the columns of matrices start at multiples of four bytes.
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

/// A whole number that is not negative by its type; `None` for others.
pub fn whole(kind: DataType, bytes: &[u8]) -> Option<u32> {
    Some(match (kind, bytes) {
        (DataType::U8, [a, ..]) => u32::from(*a),
        (DataType::U16, [a, b, ..]) => u32::from(u16::from_le_bytes([*a, *b])),
        (DataType::U32, [a, b, c, d, ..]) => u32::from_le_bytes([*a, *b, *c, *d]),
        _ => return None,
    })
}

/// A number of any type; normalized integers are mapped to [0, 1] or [-1, 1].
pub fn number(kind: DataType, normalized: bool, bytes: &[u8]) -> Option<f32> {
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
