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

/// Appearance of a material. Colours are linear; a texture, where there is one, multiplies them.
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

impl Definition {
    /// White, not metallic, rather rough; a look to begin with.
    const fn new(name: &'static str) -> Self {
        Self {
            name,
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
        }
    }

    const fn color(self, red: f32, green: f32, blue: f32) -> Self {
        Self { color: [red, green, blue], ..self }
    }

    const fn rough(self, roughness: f32) -> Self {
        Self { roughness, ..self }
    }

    const fn metal(self) -> Self {
        Self { metallic: 1.0, ..self }
    }

    const fn texture(self, texture: Texture) -> Self {
        Self { texture: Some(texture), ..self }
    }

    /// One repetition of all textures covers so many metres.
    const fn tile(self, metres: f32) -> Self {
        Self { tile: Some(metres), ..self }
    }

    const fn normal(self, texture: Texture, strength: f32) -> Self {
        Self { normal: Some((texture, strength)), ..self }
    }

    const fn surface(self, texture: Texture) -> Self {
        Self { surface: Some(texture), ..self }
    }

    const fn emissive(self, color: [f32; 3], strength: f32) -> Self {
        Self { emissive: Some((color, strength)), ..self }
    }

    const fn double_sided(self) -> Self {
        Self { double_sided: true, ..self }
    }

    const fn unlit(self) -> Self {
        Self { unlit: true, ..self }
    }
}

fn plaster(name: &'static str) -> Definition {
    Definition::new(name).rough(0.92).tile(4.0).texture(Texture::Plaster)
}

fn blocks(name: &'static str) -> Definition {
    let look = Definition::new(name).rough(1.0).texture(Texture::Blocks);
    look.normal(Texture::BlocksNormal, 1.0).surface(Texture::BlocksSurface)
}

fn wood(name: &'static str) -> Definition {
    Definition::new(name).tile(1.6).texture(Texture::Wood)
}

fn leaves(name: &'static str, texture: Texture) -> Definition {
    Definition { alpha_mask: true, ..Definition::new(name).texture(texture).double_sided() }
}

impl Material {
    /// The material's look.
    pub fn definition(self) -> Definition {
        let look = Definition::new;
        match self {
            Self::Marble => {
                look("marble").color(0.80, 0.75, 0.67).rough(0.55).tile(3.0).texture(Texture::Marble)
            }
            Self::MarbleBlocks => blocks("marble blocks").color(0.88, 0.82, 0.73).tile(2.4),
            Self::Ashlar => blocks("ashlar").color(0.80, 0.66, 0.47).tile(3.2),
            Self::Paving => {
                let look = look("paving").color(0.74, 0.67, 0.57).rough(0.85).tile(5.0);
                look.texture(Texture::Paving).normal(Texture::PavingNormal, 0.8)
            }
            Self::Cobbles => {
                let look = look("cobbles").color(0.72, 0.66, 0.58).tile(2.6);
                look.texture(Texture::Cobbles).normal(Texture::CobblesNormal, 1.0)
            }
            Self::Mosaic => look("mosaic").rough(0.45).texture(Texture::Mosaic),
            Self::Earth => look("earth").rough(1.0).tile(5.0).texture(Texture::Earth),
            Self::PlasterWhite => plaster("white plaster").color(0.78, 0.71, 0.60),
            Self::PlasterOchre => plaster("ochre plaster").color(0.80, 0.55, 0.26),
            Self::PlasterRose => plaster("rose plaster").color(0.76, 0.47, 0.36),
            Self::PlasterRed => plaster("red paint").color(0.44, 0.095, 0.06),
            Self::PlasterBlue => plaster("blue paint").color(0.07, 0.16, 0.36),
            Self::RoofTiles => look("roof tiles").tile(3.2).texture(Texture::Terracotta),
            Self::RoofFar => {
                look("roof tiles, far").tile(3.2).texture(Texture::Tiles).normal(Texture::TilesNormal, 1.0)
            }
            Self::Wood => wood("wood").color(0.52, 0.36, 0.23),
            Self::PaintedWood => wood("painted wood").color(0.12, 0.34, 0.36),
            Self::Bronze => look("bronze").color(0.62, 0.40, 0.20).metal().rough(0.38),
            Self::Gold => look("gilding").color(0.95, 0.70, 0.28).metal().rough(0.32),
            Self::Dark => look("darkness").color(0.015, 0.013, 0.012).rough(1.0),
            Self::Water => {
                look("water").color(0.05, 0.22, 0.25).rough(0.12).tile(1.8).normal(Texture::WaterNormal, 0.5)
            }
            Self::Spray => look("running water").color(0.62, 0.74, 0.76).rough(0.25),
            Self::Broadleaf => leaves("broad leaves", Texture::Leaves),
            Self::Cypress => leaves("cypress", Texture::Needles),
            Self::Bark => wood("bark").color(0.42, 0.33, 0.25).texture(Texture::Bark),
            Self::StripedCloth => look("striped cloth").rough(0.95).texture(Texture::Stripes).double_sided(),
            Self::Pennant => look("pennant").rough(0.9).texture(Texture::Pennant).double_sided(),
            Self::Terracotta => look("terracotta").color(0.55, 0.23, 0.12).rough(0.7),
            Self::PaintedVase => look("painted vase").rough(0.4).texture(Texture::Vase),
            Self::Produce => look("produce").rough(0.6),
            Self::Flame => look("flame").color(0.2, 0.05, 0.01).emissive([1.0, 0.38, 0.06], 1.6),
            Self::Charcoal => look("embers").color(0.02, 0.02, 0.02).emissive([0.8, 0.12, 0.01], 1.0),
            Self::Hills => look("hills").unlit(),
            Self::Sky => look("sky").texture(Texture::Sky).unlit(),
            Self::Plumage => look("plumage").double_sided(),
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
