//! Times of other programs for the like, beside which our times stand in the table of `--markdown`.
//!
//! Measured once, on two idle cores of an AMD EPYC of the third generation (Milan), 1920x1080, the
//! computation alone.

/// Milliseconds of another program.
#[derive(Debug)]
pub struct Peer {
    /// Node of ours that it is like, as it is given to `--node`.
    pub subject: &'static str,
    /// The other program.
    pub program: &'static str,
    /// Milliseconds.
    pub milliseconds: f64,
}

const fn peer(subject: &'static str, program: &'static str, milliseconds: f64) -> Peer {
    Peer { subject, program, milliseconds }
}

/// Size of the picture that all of them were measured on.
pub const SIZE: (u32, u32) = (1920, 1080);

/// All of them.
pub const PEERS: &[Peer] = &[
    peer("structure_tensor", "DIPlib", 37.0),
    peer("bilateral", "OpenCV, bilateralFilter", 78.0),
    peer("bilateral,iterations=1", "OpenCV, bilateralFilter", 78.0),
    peer("oriented_bilateral,iterations=1", "OpenCV, bilateralFilter", 78.0),
    peer("line_integral_convolution", "G'MIC, smooth", 1222.0),
    peer("difference_of_gaussians", "OpenCV, by hand", 9.6),
    peer("kuwahara", "pykuwahara", 122.0),
    peer("anisotropic_kuwahara", "Blender", 4255.0),
    peer("mean_curvature_flow", "GEGL", 1285.0),
    peer("anisotropic_diffusion", "OpenCV, ximgproc (Perona-Malik)", 101.0),
    peer("cartoon", "GEGL", 405.0),
    peer("coherent", "OpenCV, sample", 500.0),
];

/// The peer of what was measured, where there is one.
pub fn of(subject: &str, size: (u32, u32)) -> Option<&'static Peer> {
    PEERS.iter().find(|p| p.subject == subject && size == SIZE)
}
