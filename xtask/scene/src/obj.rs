//! Writes a model as Wavefront OBJ with its material library.

use super::materials::Model;
use glam::{Vec2, Vec3};
use std::fmt::Write;

/// An OBJ file and its material library.
pub struct Obj {
    pub geometry: String,
    pub materials: String,
}

/// Writes a model; `library` is the file name of its materials.
pub fn write(model: &Model, library: &str) -> Obj {
    let mut geometry = format!("# A house of the city. Metres, y up.\nmtllib {library}\no house\n");
    let mut materials = String::new();
    let mut first = 1;
    for (&material, mesh) in model.parts.iter().filter(|(_, mesh)| !mesh.indices.is_empty()) {
        let look = material.definition();
        let name = look.name.replace([' ', ','], "_");
        let [r, g, b] = look.color;
        let gloss = (1.0 - look.roughness) * 200.0;
        // Writing to a string cannot fail.
        let _ = writeln!(
            materials,
            "newmtl {name}\nKd {r:.4} {g:.4} {b:.4}\nKs 0 0 0\nNs {gloss:.1}\nd 1\nillum 1"
        );
        if let Some(texture) = look.texture {
            let _ = writeln!(materials, "map_Kd {}", texture.file_name());
        }
        materials.push('\n');
        let _ = writeln!(geometry, "usemtl {name}");
        for Vec3 { x, y, z } in &mesh.positions {
            let _ = writeln!(geometry, "v {x:.4} {y:.4} {z:.4}");
        }
        let tile = look.tile.unwrap_or(1.0);
        for Vec2 { x, y } in &mesh.uvs {
            // OBJ counts v upwards.
            let _ = writeln!(geometry, "vt {:.4} {:.4}", x / tile, 1.0 - y / tile);
        }
        for Vec3 { x, y, z } in &mesh.normals {
            let _ = writeln!(geometry, "vn {x:.4} {y:.4} {z:.4}");
        }
        for triangle in mesh.indices.chunks_exact(3) {
            geometry.push('f');
            for &index in triangle {
                let index = index as usize + first;
                let _ = write!(geometry, " {index}/{index}/{index}");
            }
            geometry.push('\n');
        }
        first += mesh.positions.len();
    }
    Obj { geometry, materials }
}
