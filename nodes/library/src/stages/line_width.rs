//! Widths of lines on the grid of pixels: none is narrower than a pixel, and one that is to be narrower is fainter instead,
//! by the share of the pixel that it would cover, down to a least darkness: small pictures show all lines of large ones.

/// Standard deviation of the narrower Gaussian across a line one pixel wide, pixels: half the width.
const LEAST_SIGMA: f32 = 0.5;

/// Darkness of the faintest line against that of one as wide as a pixel.
const LEAST_DARKNESS: f32 = 0.3;

/// Strength by which a break that lies askew draws a line a pixel wide as one that lies straight draws a wide one.
const MOST_STRENGTH: f32 = 1.7;

/// Narrowest guided line, against the widest one of the picture, that keeps all of its strength.
const LEAST_SHARE: f32 = 0.3;

/// Darkness of a line so many pixels wide: the share of a pixel that it covers, 1 from a pixel on.
pub(crate) fn darkness(width: f32) -> f32 {
    width.clamp(LEAST_DARKNESS, 1.0)
}

/// Share of the paper that shows through lines of a standard deviation, pixels.
pub(crate) fn faintness(sigma: f32) -> f32 {
    1.0 - darkness(sigma / LEAST_SIGMA)
}

/// The standard deviation, pixels, at which lines of `sigma` are drawn.
pub(crate) fn drawable(sigma: f32) -> f32 {
    sigma.max(LEAST_SIGMA)
}

/// Strength of a kind of guided lines of standard deviation `sigma` beside the `widest` of the picture, by whose width all
/// are faint. Where that is below a pixel, breaks count more, since the response to them falls off, above all on diagonals;
/// kinds that are next to nothing beside the widest, or beside a pixel, fade.
pub(crate) fn strength(sigma: f32, widest: f32) -> f32 {
    if sigma >= LEAST_SIGMA {
        return 1.0;
    }
    let widest = widest.clamp(1e-6, LEAST_SIGMA);
    (LEAST_SIGMA / widest).min(MOST_STRENGTH) * (sigma / (LEAST_SHARE * widest)).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_a_pixel_and_more_are_as_they_were() {
        for sigma in [0.5, 0.7, 1.0, 20.0] {
            assert_eq!((drawable(sigma), faintness(sigma)), (sigma, 0.0));
            assert_eq!(strength(sigma, 160.0), 1.0);
        }
        assert_eq!((darkness(1.0), darkness(1.6)), (1.0, 1.0));
    }

    #[test]
    fn narrower_lines_are_a_pixel_wide_and_fainter() {
        let mut last = 0.0;
        for sigma in [0.45, 0.3, 0.2, 0.1, 0.01] {
            assert_eq!(drawable(sigma), LEAST_SIGMA);
            let found = faintness(sigma);
            assert!(found > last || found == 1.0 - LEAST_DARKNESS, "{sigma}: {found}");
            last = found;
        }
        // The share of a pixel, exactly.
        assert_eq!(darkness(0.625), 0.625);
        assert_eq!((strength(0.1, 0.1), strength(0.04, 0.1), strength(0.0, 0.1)), (1.7, 1.7, 0.0));
        assert!(strength(0.01, 0.1) < 1.0 && (strength(0.499, 0.499) - 1.0).abs() < 0.01);
        // No kind of lines is stronger than a wider one beside it.
        assert_eq!((strength(0.3, 1.0), strength(0.15, 1.0)), (1.0, 1.0));
        assert!(strength(0.1, 1.0) < 0.7);
    }
}
