//! Primaries of pictures in linear light, and the matrices between them.
//!
//! Source: SMPTE RP 177 (matrices from chromaticities) and Lam 1985 (Bradford adaptation).

/// Red, green, blue, white: x and y of each.
pub type Chromaticities = [f32; 8];

/// ACEScg: AP1 with the white of ACES.
pub const AP1: Chromaticities = [0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767];
/// ACES2065-1: AP0 with the white of ACES.
pub const AP0: Chromaticities = [0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.0770, 0.32168, 0.33767];
/// P3 with white D65.
pub const P3: Chromaticities = [0.680, 0.320, 0.265, 0.690, 0.150, 0.060, 0.3127, 0.3290];
/// ITU-R BT.2020.
pub const REC2020: Chromaticities = [0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290];
/// Adobe RGB (1998).
pub const ADOBE: Chromaticities = [0.64, 0.33, 0.21, 0.71, 0.15, 0.06, 0.3127, 0.3290];

/// Chromaticities that differ by less are the same; files write them with a few digits.
const SAME: f32 = 2e-3;

type Matrix = [[f64; 3]; 3];

/// A change of primaries of linear light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change([[f32; 3]; 3]);

impl Change {
    /// From light of some primaries to light of others, adapted to the other white by the Bradford method;
    /// nothing for primaries that span no colours.
    pub fn new(from: Chromaticities, to: Chromaticities) -> Option<Self> {
        let (into, out) = (xyz_from_rgb(from)?, inverse(&xyz_from_rgb(to)?)?);
        let adapt = adaptation(apply(&into, [1.0; 3]), apply(&xyz_from_rgb(to)?, [1.0; 3]))?;
        let matrix = product(&out, &product(&adapt, &into));
        matrix.iter().flatten().all(|v| v.is_finite()).then(|| Self(matrix.map(|row| row.map(|v| v as f32))))
    }

    /// One colour.
    pub fn apply(&self, [r, g, b]: [f32; 3]) -> [f32; 3] {
        self.0.map(|row| row[0] * r + row[1] * g + row[2] * b)
    }
}

/// True where two sets of primaries are the same but for rounding.
pub fn same(a: Chromaticities, b: Chromaticities) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < SAME)
}

/// ITU-R BT.709, also what an EXR file without chromaticities means.
pub const REC709: Chromaticities = [0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290];

/// Primaries of a device whose red, green and blue are these CIE XYZ beside a white of D50, and are shown beside `white`;
/// nothing where they span no colours.
pub fn of_colorants(colorants: [[f64; 3]; 3], white: [f64; 3]) -> Option<Chromaticities> {
    let matrix = [0, 1, 2].map(|row: usize| colorants.map(|colorant| colorant[row]));
    let adapt = adaptation(apply(&matrix, [1.0; 3]), white)?;
    let point = |rgb: [f64; 3]| {
        let xyz = apply(&adapt, apply(&matrix, rgb));
        let sum: f64 = xyz.iter().sum();
        [(xyz[0] / sum) as f32, (xyz[1] / sum) as f32]
    };
    let [[rx, ry], [gx, gy], [bx, by]] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(point);
    let [white_x, white_y] = point([1.0; 3]);
    let found = [rx, ry, gx, gy, bx, by, white_x, white_y];
    Change::new(found, REC709).map(|_| found)
}

/// Bradford's change from CIE XYZ beside one white to those beside another.
fn adaptation(from: [f64; 3], to: [f64; 3]) -> Option<Matrix> {
    const BRADFORD: Matrix =
        [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];
    let (old, new) = (apply(&BRADFORD, from), apply(&BRADFORD, to));
    let scaled = [0, 1, 2].map(|r: usize| BRADFORD[r].map(|v| v * new[r] / old[r]));
    Some(product(&inverse(&BRADFORD)?, &scaled))
}

/// Weights of red, green and blue in luminance.
pub fn luminance(chromaticities: Option<Chromaticities>) -> [f32; 3] {
    let matrix = xyz_from_rgb(chromaticities.unwrap_or(REC709)).or_else(|| xyz_from_rgb(REC709));
    matrix.map_or([0.2126, 0.7152, 0.0722], |m| m[1].map(|v| v as f32))
}

/// CIE XYZ of linear RGB; nothing for primaries on a line and the like.
fn xyz_from_rgb(c: Chromaticities) -> Option<Matrix> {
    let c = c.map(f64::from);
    let unit = |x: f64, y: f64| [x / y, 1.0, (1.0 - x - y) / y];
    // A primary may be without luminance, as two of CIE XYZ itself are. White is not.
    let column = |x: f64, y: f64| if y == 0.0 { [x, y, 1.0 - x - y] } else { unit(x, y) };
    let [r, g, b] = [0, 2, 4].map(|at: usize| column(c[at], c[at + 1]));
    let w = unit(c[6], c[7]);
    let primaries = [[r[0], g[0], b[0]], [r[1], g[1], b[1]], [r[2], g[2], b[2]]];
    let scale = apply(&inverse(&primaries)?, w);
    let matrix = primaries.map(|row| [row[0] * scale[0], row[1] * scale[1], row[2] * scale[2]]);
    matrix.iter().flatten().all(|v| v.is_finite()).then_some(matrix)
}

fn apply(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|row| [0, 1, 2].map(|c: usize| (0..3).map(|k| row[k] * b[k][c]).sum()))
}

fn inverse(m: &Matrix) -> Option<Matrix> {
    let cofactor = |r: usize, c: usize| {
        let at = |dr: usize, dc: usize| m[(r + dr) % 3][(c + dc) % 3];
        at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)
    };
    let determinant: f64 = (0..3).map(|c| m[0][c] * cofactor(0, c)).sum();
    let usable = determinant.is_finite() && determinant.abs() > 1e-9;
    usable.then(|| [0, 1, 2].map(|r| [0, 1, 2].map(|c| cofactor(c, r) / determinant)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_those_of_the_standards() {
        // ACEScg to Rec.709 as the ACES project prints it.
        let known =
            [[1.70505, -0.62179, -0.08326], [-0.13026, 1.14080, -0.01055], [-0.02400, -0.12897, 1.15297]];
        let change = Change::new(AP1, REC709).unwrap();
        for (row, known) in change.0.iter().zip(known) {
            for (value, known) in row.iter().zip(known) {
                assert!((value - known).abs() < 2e-4, "{value} {known}");
            }
        }
        for primaries in [P3, REC2020, AP1] {
            let white = Change::new(primaries, REC709).unwrap().apply([1.0; 3]);
            assert!(white.iter().all(|v| (v - 1.0).abs() < 1e-5), "{white:?}");
            let there = Change::new(primaries, REC709).unwrap().apply([0.2, 0.9, 0.4]);
            let back = Change::new(REC709, primaries).unwrap().apply(there);
            assert!(back.iter().zip([0.2, 0.9, 0.4]).all(|(a, b)| (a - b).abs() < 1e-5), "{back:?}");
        }
        assert_eq!(Change::new([0.3; 8], REC709), None);
    }

    #[test]
    fn primaries_may_be_those_of_xyz() {
        let xyz: Chromaticities = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0 / 3.0, 1.0 / 3.0];
        assert_eq!(luminance(Some(xyz)), [0.0, 1.0, 0.0]);
        let change = Change::new(xyz, REC709).unwrap();
        let white = change.apply([1.0; 3]);
        assert!(white.iter().all(|v| (v - 1.0).abs() < 1e-5), "{white:?}");
        let there = Change::new(REC709, xyz).unwrap().apply([0.2, 0.9, 0.4]);
        let back = change.apply(there);
        assert!(back.iter().zip([0.2, 0.9, 0.4]).all(|(a, b)| (a - b).abs() < 1e-5), "{back:?}");
        // White without luminance is none.
        assert_eq!(Change::new([0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3, 0.0], REC709), None);
    }

    #[test]
    fn luminance_is_that_of_the_standard() {
        for (weight, standard) in luminance(None).iter().zip([0.2126, 0.7152, 0.0722]) {
            assert!((weight - standard).abs() < 2e-4, "{weight} {standard}");
        }
        assert_eq!(luminance(Some([0.0; 8])), luminance(None));
    }
}
