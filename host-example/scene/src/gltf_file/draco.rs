//! Geometry that is compressed by KHR_draco_mesh_compression. The decoder is a crate that the feature `compressed`
//! brings; without it, such geometry is refused where a file demands it, and read from accessors where it does not.

use gltf::accessor::{Accessor, DataType};
use serde_json::Value;

use super::accessors::{Accessors, Floats, Pick, number, whole};
#[cfg(feature = "compressed")]
use crate::guarded::guarded;

/// The extension.
const EXTENSION: &str = "KHR_draco_mesh_compression";

/// Decoded triangles of a primitive, and what their vertices have.
pub struct Geometry {
    /// Corners of triangles.
    pub indices: Vec<u32>,
    /// Number of vertices.
    pub count: usize,
    attributes: Vec<Attribute>,
}

/// An attribute of all vertices.
struct Attribute {
    /// Name in the primitive.
    name: String,
    kind: DataType,
    /// Numbers per vertex.
    width: usize,
    bytes: Vec<u8>,
}

/// Decodes the geometry of a primitive; `None` where it is not compressed so.
///
/// # Errors
/// A clause saying what is wrong with the data.
pub fn read(
    document: &gltf::Document,
    source: &gltf::Primitive,
    accessors: &Accessors,
) -> Result<Option<Geometry>, String> {
    let Some(extension) = source.extension_value(EXTENSION).filter(|_| cfg!(feature = "compressed")) else {
        return Ok(None);
    };
    let problem = |problem: &str| format!("its Draco compression: {problem}");
    let view =
        extension["bufferView"].as_u64().and_then(|view| document.views().nth(usize::try_from(view).ok()?));
    let view = view.ok_or_else(|| problem("it names a buffer view that does not exist"))?;
    let bytes =
        accessors.view(&view).ok_or_else(|| problem("its bytes reach beyond the end of its buffer"))?;
    let Value::Object(ids) = &extension["attributes"] else { return Err(problem("it has no attributes")) };
    let ids: Vec<(&str, u32)> =
        ids.iter().filter_map(|(name, id)| Some((name.as_str(), id.as_u64()?.try_into().ok()?))).collect();
    decode(bytes, &ids, accessors).map(Some).map_err(|e| problem(&e))
}

/// Decodes triangles and the attributes of these names and numbers.
#[cfg(feature = "compressed")]
fn decode(bytes: &[u8], ids: &[(&str, u32)], accessors: &Accessors) -> Result<Geometry, String> {
    use draco_core::{DecodeLimits, DecoderBuffer, ErrorKind, Mesh, MeshDecoder};
    let budget = accessors.budget;
    // While it decodes, a face takes about so many bytes, and an attribute twice its own.
    let limits = DecodeLimits::default()
        .with_max_faces(budget.left() / 256)
        .with_max_points(budget.left() / 256)
        .with_max_decoded_bytes(budget.left() / 2);
    let mesh = guarded(|| {
        let mut mesh = Mesh::new();
        let mut buffer = DecoderBuffer::new(bytes).with_limits(limits);
        match MeshDecoder::new().decode(&mut buffer, &mut mesh) {
            Ok(()) => Ok(mesh),
            Err(e) if e.kind() == ErrorKind::LimitExceeded => budget.take(usize::MAX, 1).map(|()| mesh),
            Err(e) => Err(format!("its data cannot be decoded: {e}")),
        }
    })?;
    let held = |id: i32| mesh.try_attribute(id).map_or(0, |attribute| attribute.buffer().data_size());
    budget.take((0..mesh.num_attributes()).map(held).sum(), 1)?;
    let count = mesh.num_points();
    budget.take(mesh.num_faces(), 3 * size_of::<u32>())?;
    let indices = mesh.faces().iter().flat_map(|face| face.map(|point| point.0)).collect();
    let mut attributes = Vec::new();
    for (name, id) in ids {
        let attribute = mesh.attribute_by_unique_id(*id);
        let attribute =
            attribute.ok_or_else(|| format!("it has no attribute {id}, which {name} should be"))?;
        attributes.push(expanded(name, attribute, count, accessors)?);
    }
    Ok(Geometry { indices, count, attributes })
}

/// No decoder is there.
#[cfg(not(feature = "compressed"))]
fn decode(_: &[u8], _: &[(&str, u32)], _: &Accessors) -> Result<Geometry, String> {
    Err("this program cannot decode it".into())
}

/// An attribute with a value of its own for each vertex.
#[cfg(feature = "compressed")]
fn expanded(
    name: &str,
    attribute: &draco_core::PointAttribute,
    count: usize,
    accessors: &Accessors,
) -> Result<Attribute, String> {
    let kind = match attribute.data_type() {
        draco_core::DataType::Int8 => DataType::I8,
        draco_core::DataType::Uint8 => DataType::U8,
        draco_core::DataType::Int16 => DataType::I16,
        draco_core::DataType::Uint16 => DataType::U16,
        draco_core::DataType::Uint32 => DataType::U32,
        draco_core::DataType::Float32 => DataType::F32,
        other => return Err(format!("{name} is of {other:?}, which glTF does not have")),
    };
    let width = usize::from(attribute.num_components());
    let size = width * kind.size();
    accessors.budget.take(count, size)?;
    let data = attribute.buffer().data();
    let mut bytes = Vec::with_capacity(count * size);
    for point in 0..count {
        let value = attribute.mapped_index(draco_core::PointIndex(point as u32)).0 as usize;
        let range = value.checked_mul(size).and_then(|start| data.get(start..start.checked_add(size)?));
        bytes.extend_from_slice(range.ok_or_else(|| format!("{name} has no value for vertex {point}"))?);
    }
    Ok(Attribute { name: name.to_owned(), kind, width, bytes })
}

impl Geometry {
    /// Reads numbers as [`Accessors::floats`] does; `None` where there is no such attribute.
    ///
    /// # Errors
    /// As [`Accessors::floats`].
    pub fn floats(
        &self,
        name: &str,
        accessor: &Accessor,
        widths: &[usize],
        accessors: &Accessors,
        pick: Pick,
    ) -> Result<Option<Floats>, String> {
        let Some(attribute) = self.attributes.iter().find(|attribute| attribute.name == name) else {
            return Ok(None);
        };
        let width = attribute.width;
        if !widths.contains(&width) {
            return Err(format!("{name} has {width} numbers per vertex, not {widths:?}"));
        }
        let normalized = accessor.normalized();
        let values =
            attribute.values(self.count, accessors, pick, |kind, bytes| number(kind, normalized, bytes))?;
        Ok(Some(Floats { width, values }))
    }

    /// Reads whole numbers as [`Accessors::integers`] does; `None` where there is no such attribute.
    ///
    /// # Errors
    /// As [`Accessors::integers`].
    pub fn integers(
        &self,
        name: &str,
        width: usize,
        accessors: &Accessors,
        pick: Pick,
    ) -> Result<Option<Vec<u32>>, String> {
        let Some(attribute) = self.attributes.iter().find(|attribute| attribute.name == name) else {
            return Ok(None);
        };
        if attribute.width != width {
            return Err(format!("{name} does not have {width} numbers per vertex"));
        }
        attribute.values(self.count, accessors, pick, whole).map(Some)
    }
}

impl Attribute {
    fn values<T>(
        &self,
        count: usize,
        accessors: &Accessors,
        pick: Pick,
        convert: impl Fn(DataType, &[u8]) -> Option<T>,
    ) -> Result<Vec<T>, String> {
        let (component, name) = (self.kind.size(), &self.name);
        let picked = pick.count(count);
        accessors.budget.take(picked, self.width * size_of::<T>())?;
        let mut values = Vec::with_capacity(picked * self.width);
        for place in 0..picked {
            let start = pick.element(place) * self.width * component;
            for bytes in self.bytes[start..start + self.width * component].chunks_exact(component) {
                let value = convert(self.kind, bytes);
                values.push(value.ok_or_else(|| format!("{name} has an unsuitable component type"))?);
            }
        }
        Ok(values)
    }
}
