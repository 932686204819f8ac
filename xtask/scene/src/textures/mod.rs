//! The textures of the scene, painted by formulas and encoded as PNG, one of them as JPEG.

mod masonry;
mod names;
mod ornament;
mod picture;
mod plants;

use crate::error::{Error, Result};
pub use names::Texture;
use picture::Picture;
pub use plants::SKY_HORIZON;
use std::sync::Mutex;

/// A picture and what it is for.
type Painted = (Texture, Picture);

/// Paints and encodes every texture; the order does not depend on the number of threads.
///
/// # Errors
/// [`Error::Encode`] when an encoder refuses a picture.
pub fn paint_all() -> Result<Vec<(Texture, Vec<u8>)>> {
    const JOBS: [fn() -> Vec<Painted>; 13] = [
        plants::sky,
        masonry::blocks,
        masonry::paving,
        masonry::cobbles,
        plants::earth,
        ornament::mosaic,
        masonry::roof,
        masonry::marble,
        masonry::plaster,
        plants::wood,
        plants::water,
        ornament::fabrics,
        plants::foliage,
    ];
    let next = Mutex::new(JOBS.iter());
    let files = Mutex::new(Vec::new());
    let workers = std::thread::available_parallelism().map_or(1, |count| count.get()).min(JOBS.len());
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                loop {
                    let job = next.lock().ok().and_then(|mut jobs| jobs.next());
                    let Some(job) = job else { break };
                    for (texture, picture) in job() {
                        let file = picture.encode(texture.is_jpeg());
                        if let Ok(mut files) = files.lock() {
                            files.push((texture, file));
                        }
                    }
                }
            });
        }
    });
    let mut files = files.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    files.sort_by_key(|(texture, _)| *texture);
    files
        .into_iter()
        .map(|(texture, file)| {
            let file = file.map_err(|source| Error::Encode { texture: texture.file_name(), source })?;
            Ok((texture, file))
        })
        .collect()
}
