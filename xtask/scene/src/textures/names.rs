//! Every texture and the name of its file.

/// Every texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Texture {
    Marble,
    Blocks,
    BlocksNormal,
    BlocksSurface,
    Paving,
    PavingNormal,
    Cobbles,
    CobblesNormal,
    Mosaic,
    Earth,
    Plaster,
    Terracotta,
    Tiles,
    TilesNormal,
    Wood,
    Bark,
    WaterNormal,
    Leaves,
    Needles,
    Stripes,
    Pennant,
    Vase,
    Sky,
}

impl Texture {
    /// The name of its file.
    pub fn file_name(self) -> &'static str {
        match self {
            Self::Marble => "marble.png",
            Self::Blocks => "blocks.png",
            Self::BlocksNormal => "blocks_normal.png",
            Self::BlocksSurface => "blocks_surface.png",
            Self::Paving => "paving.png",
            Self::PavingNormal => "paving_normal.png",
            Self::Cobbles => "cobbles.png",
            Self::CobblesNormal => "cobbles_normal.png",
            Self::Mosaic => "mosaic.png",
            Self::Earth => "earth.png",
            // The one that no edge or normal depends on is a JPEG, so that both decoders are used.
            Self::Plaster => "plaster.jpg",
            Self::Terracotta => "terracotta.png",
            Self::Tiles => "tiles.png",
            Self::TilesNormal => "tiles_normal.png",
            Self::Wood => "wood.png",
            Self::Bark => "bark.png",
            Self::WaterNormal => "water_normal.png",
            Self::Leaves => "leaves.png",
            Self::Needles => "needles.png",
            Self::Stripes => "stripes.png",
            Self::Pennant => "pennant.png",
            Self::Vase => "vase.png",
            Self::Sky => "sky.png",
        }
    }

    /// True where its file is a JPEG; the others are PNG.
    pub fn is_jpeg(self) -> bool {
        self.file_name().ends_with(".jpg")
    }
}
