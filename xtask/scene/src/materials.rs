//! The materials of the scene: one table that the glTF and the OBJ writer both read.

use super::mesh::Mesh;
use super::textures::Texture;
use glam::{Mat4, Vec3};
use std::collections::BTreeMap;

/// Every material, named for what it is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Material {
    Marble,
    MarbleBlocks,
    Ashlar,
    Paving,
    Cobbles,
    Mosaic,
    Earth,
    PlasterWhite,
    PlasterOchre,
    PlasterRose,
    PlasterRed,
    PlasterBlue,
    RoofTiles,
    RoofFar,
    Wood,
    PaintedWood,
    Bronze,
    Gold,
    Dark,
    Water,
    Spray,
    Broadleaf,
    Cypress,
    Bark,
    StripedCloth,
    Pennant,
    Terracotta,
    PaintedVase,
    Produce,
    Flame,
    Charcoal,
    Hills,
    Sky,
    Plumage,
}

/// How a material looks. Colours are linear; a texture, where there is one, multiplies them.
pub struct Definition {
    pub name: &'static str,
    pub color: [f32; 3],
    pub metallic: f32,
    pub roughness: f32,
    /// Metres that one repetition of the texture covers; `None` where texture coordinates are
    /// already in [0, 1].
    pub tile: Option<f32>,
    pub texture: Option<Texture>,
    /// Normal map and its strength.
    pub normal: Option<(Texture, f32)>,
    /// Occlusion in red, roughness in green, metalness in blue.
    pub surface: Option<Texture>,
    /// Emitted colour and its strength (`KHR_materials_emissive_strength`).
    pub emissive: Option<([f32; 3], f32)>,
    pub alpha_mask: bool,
    pub double_sided: bool,
    pub unlit: bool,
}

const PLAIN: Definition = Definition {
    name: "",
    color: [1.0; 3],
    metallic: 0.0,
    roughness: 0.8,
    tile: None,
    texture: None,
    normal: None,
    surface: None,
    emissive: None,
    alpha_mask: false,
    double_sided: false,
    unlit: false,
};

impl Material {
    /// The material's look.
    pub fn definition(self) -> Definition {
        let plaster = |name, color| Definition {
            name,
            color,
            roughness: 0.92,
            tile: Some(4.0),
            texture: Some(Texture::Plaster),
            ..PLAIN
        };
        let wood =
            |name, color| Definition { name, color, tile: Some(1.6), texture: Some(Texture::Wood), ..PLAIN };
        let leaves = |name, color, texture| Definition {
            name,
            color,
            texture: Some(texture),
            alpha_mask: true,
            double_sided: true,
            ..PLAIN
        };
        let blocks = |name, color, tile| Definition {
            name,
            color,
            tile: Some(tile),
            texture: Some(Texture::Blocks),
            normal: Some((Texture::BlocksNormal, 1.0)),
            surface: Some(Texture::BlocksSurface),
            roughness: 1.0,
            ..PLAIN
        };
        let plain = |name, color, roughness| Definition { name, color, roughness, ..PLAIN };
        match self {
            Self::Marble => Definition {
                name: "marble",
                color: [0.80, 0.75, 0.67],
                roughness: 0.55,
                tile: Some(3.0),
                texture: Some(Texture::Marble),
                ..PLAIN
            },
            Self::MarbleBlocks => blocks("marble blocks", [0.88, 0.82, 0.73], 2.4),
            Self::Ashlar => blocks("ashlar", [0.80, 0.66, 0.47], 3.2),
            Self::Paving => Definition {
                name: "paving",
                color: [0.74, 0.67, 0.57],
                roughness: 0.85,
                tile: Some(5.0),
                texture: Some(Texture::Paving),
                normal: Some((Texture::PavingNormal, 0.8)),
                ..PLAIN
            },
            Self::Cobbles => Definition {
                name: "cobbles",
                color: [0.72, 0.66, 0.58],
                tile: Some(2.6),
                texture: Some(Texture::Cobbles),
                normal: Some((Texture::CobblesNormal, 1.0)),
                ..PLAIN
            },
            Self::Mosaic => {
                Definition { name: "mosaic", roughness: 0.45, texture: Some(Texture::Mosaic), ..PLAIN }
            }
            Self::Earth => Definition {
                name: "earth",
                roughness: 1.0,
                tile: Some(5.0),
                texture: Some(Texture::Earth),
                ..PLAIN
            },
            Self::PlasterWhite => plaster("white plaster", [0.78, 0.71, 0.60]),
            Self::PlasterOchre => plaster("ochre plaster", [0.80, 0.55, 0.26]),
            Self::PlasterRose => plaster("rose plaster", [0.76, 0.47, 0.36]),
            Self::PlasterRed => plaster("red paint", [0.44, 0.095, 0.06]),
            Self::PlasterBlue => plaster("blue paint", [0.07, 0.16, 0.36]),
            Self::RoofTiles => Definition {
                name: "roof tiles",
                tile: Some(3.2),
                texture: Some(Texture::Terracotta),
                ..PLAIN
            },
            Self::RoofFar => Definition {
                name: "roof tiles, far",
                tile: Some(3.2),
                texture: Some(Texture::Tiles),
                normal: Some((Texture::TilesNormal, 1.0)),
                ..PLAIN
            },
            Self::Wood => wood("wood", [0.52, 0.36, 0.23]),
            Self::PaintedWood => wood("painted wood", [0.12, 0.34, 0.36]),
            Self::Bronze => Definition {
                name: "bronze",
                color: [0.62, 0.40, 0.20],
                metallic: 1.0,
                roughness: 0.38,
                ..PLAIN
            },
            Self::Gold => Definition {
                name: "gilding",
                color: [0.95, 0.70, 0.28],
                metallic: 1.0,
                roughness: 0.32,
                ..PLAIN
            },
            Self::Dark => plain("darkness", [0.015, 0.013, 0.012], 1.0),
            Self::Water => Definition {
                name: "water",
                color: [0.05, 0.22, 0.25],
                roughness: 0.12,
                tile: Some(1.8),
                normal: Some((Texture::WaterNormal, 0.5)),
                ..PLAIN
            },
            Self::Spray => plain("running water", [0.62, 0.74, 0.76], 0.25),
            Self::Broadleaf => leaves("broad leaves", [1.0; 3], Texture::Leaves),
            Self::Cypress => leaves("cypress", [1.0; 3], Texture::Needles),
            Self::Bark => {
                Definition { name: "bark", texture: Some(Texture::Bark), ..wood("", [0.42, 0.33, 0.25]) }
            }
            Self::StripedCloth => Definition {
                name: "striped cloth",
                roughness: 0.95,
                texture: Some(Texture::Stripes),
                double_sided: true,
                ..PLAIN
            },
            Self::Pennant => Definition {
                name: "pennant",
                roughness: 0.9,
                texture: Some(Texture::Pennant),
                double_sided: true,
                ..PLAIN
            },
            Self::Terracotta => plain("terracotta", [0.55, 0.23, 0.12], 0.7),
            Self::PaintedVase => {
                Definition { name: "painted vase", roughness: 0.4, texture: Some(Texture::Vase), ..PLAIN }
            }
            Self::Produce => plain("produce", [1.0; 3], 0.6),
            Self::Flame => Definition {
                name: "flame",
                color: [0.2, 0.05, 0.01],
                emissive: Some(([1.0, 0.38, 0.06], 1.6)),
                ..PLAIN
            },
            Self::Charcoal => Definition {
                name: "embers",
                color: [0.02, 0.02, 0.02],
                emissive: Some(([0.8, 0.12, 0.01], 1.0)),
                ..PLAIN
            },
            Self::Hills => Definition { name: "hills", unlit: true, ..PLAIN },
            Self::Sky => Definition { name: "sky", texture: Some(Texture::Sky), unlit: true, ..PLAIN },
            Self::Plumage => Definition { name: "plumage", double_sided: true, ..PLAIN },
        }
    }
}

/// A thing made of several materials: one mesh of each.
#[derive(Clone, Default)]
pub struct Model {
    pub parts: BTreeMap<Material, Mesh>,
}

impl Model {
    /// The part of a material, begun when it is not there yet.
    pub fn part(&mut self, material: Material) -> &mut Mesh {
        self.parts.entry(material).or_default()
    }

    /// Adds a copy of another model under a transform.
    pub fn append(&mut self, other: &Self, transform: Mat4) -> &mut Self {
        for (&material, mesh) in &other.parts {
            self.part(material).append(mesh, transform);
        }
        self
    }

    /// Adds a copy of another model, turned by `degrees` about the vertical and moved.
    pub fn place(&mut self, other: &Self, position: Vec3, degrees: f32) -> &mut Self {
        self.append(other, Mat4::from_translation(position) * Mat4::from_rotation_y(degrees.to_radians()))
    }
}
