//! Uniform blocks: from the struct of a shader to a Rust struct with the same layout.
//!
//! A field is a scalar, a vector or an array of four-component vectors. Everything else is refused, as is a
//! field without a comment: the shader is the only place that says what it means and in which unit.

use naga::{ArraySize, Handle, Module, Scalar, Type, TypeInner};
use std::fmt::Write as _;

/// A uniform block, as its shader declares it.
#[derive(Debug, PartialEq)]
pub struct Block {
    fields: Vec<Field>,
    /// Bytes.
    pub size: u32,
}

/// A field of a block, or a gap that keeps the next one aligned.
#[derive(Debug, PartialEq)]
struct Field {
    name: String,
    /// Lines of its comment, each with its slashes.
    comment: Vec<String>,
    /// Its type in Rust.
    rust: String,
    /// Bytes from the start of the block.
    offset: u32,
}

impl Block {
    /// The block whose type is the struct `ty`; the module must have been parsed with its comments.
    ///
    /// # Errors
    /// A sentence that names the field, when it has a type that is not supported or no comment.
    pub fn read(module: &Module, ty: Handle<Type>) -> Result<Self, String> {
        let TypeInner::Struct { members, span } = &module.types[ty].inner else {
            return Err("the uniform at binding 1 is not a struct".into());
        };
        let (mut fields, mut end) = (Vec::new(), 0);
        for (index, member) in members.iter().enumerate() {
            let name = member.name.clone().unwrap_or_default();
            let (rust, size) = rust_type(module, member.ty).ok_or_else(|| {
                format!(
                    "uniform `{name}`: only f32, i32, u32, vectors of them and arrays of vec4 are supported"
                )
            })?;
            let comments = module.doc_comments.as_ref().and_then(|d| d.struct_members.get(&(ty, index)));
            let comment = comments.cloned().unwrap_or_default();
            if comment.is_empty() {
                return Err(format!("uniform `{name}` has no `///` comment"));
            }
            fill_gap(&mut fields, end, member.offset);
            fields.push(Field { name, comment, rust, offset: member.offset });
            end = member.offset + size;
        }
        fill_gap(&mut fields, end, *span);
        Ok(Self { fields, size: *span })
    }

    /// The struct `Params`, with a check by the compiler that it lies in memory as the shader has it.
    pub fn rust(&self, shader: &str) -> String {
        let mut text = format!(
            "/// Uniform block of `{shader}`.\n#[repr(C)]\n\
             #[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]\n\
             pub struct Params {{\n"
        );
        for field in &self.fields {
            for line in &field.comment {
                let _ = writeln!(text, "    {line}");
            }
            let _ = writeln!(text, "    pub {}: {},", field.name, field.rust);
        }
        let _ = writeln!(text, "}}\nconst _: () = assert!(size_of::<Params>() == {});", self.size);
        for Field { name, offset, .. } in &self.fields {
            let _ =
                writeln!(text, "const _: () = assert!(std::mem::offset_of!(Params, {name}) == {offset});");
        }
        text
    }
}

/// Adds a field for the bytes from `end` to `next`, if there are any.
fn fill_gap(fields: &mut Vec<Field>, end: u32, next: u32) {
    if next == end {
        return;
    }
    let earlier = fields.iter().filter(|f| f.name.starts_with("padding")).count();
    fields.push(Field {
        name: if earlier == 0 { "padding".into() } else { format!("padding_{}", earlier + 1) },
        comment: vec!["/// Not used; `Default::default()`.".into()],
        rust: format!("[u32; {}]", (next - end) / 4),
        offset: end,
    });
}

/// The type in Rust that lies in memory as this one does in a uniform block, and its size in bytes.
fn rust_type(module: &Module, ty: Handle<Type>) -> Option<(String, u32)> {
    match module.types[ty].inner {
        TypeInner::Scalar(of) => Some((scalar(of)?.into(), 4)),
        TypeInner::Vector { size, scalar: of } => {
            let components = size as u32;
            Some((format!("[{}; {components}]", scalar(of)?), 4 * components))
        }
        TypeInner::Array { base, size: ArraySize::Constant(count), stride } => {
            let (element, size) = rust_type(module, base)?;
            // Elements with space between them would need a type of their own.
            (size == stride).then(|| (format!("[{element}; {count}]"), size * count.get()))
        }
        _ => None,
    }
}

fn scalar(of: Scalar) -> Option<&'static str> {
    match of {
        Scalar::F32 => Some("f32"),
        Scalar::I32 => Some("i32"),
        Scalar::U32 => Some("u32"),
        _ => None,
    }
}
