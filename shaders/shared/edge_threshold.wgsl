#import shared/coverage

// From the response of a difference of Gaussians to an edge image: 1 is paper, 0 is line.
// Twin of kernels/shared/edge_threshold.rs.

// Kinds: 0 the response itself; 1 binary (4.6); 2 tanh (4.8); 3 smoothstep.
fn edge_threshold(u: f32, kind: u32, epsilon: f32, phi: f32) -> f32 {
    if kind == 0u {
        return u;
    }
    if u >= epsilon {
        return 1.0;
    }
    // Far down both curves are 0; the bound keeps tanh finite on every driver.
    let x = max(phi * (u - epsilon), -20.0);
    if kind == 1u {
        return 0.0;
    }
    if kind == 2u {
        return 1.0 + tanh(x);
    }
    let t = max(x * 0.25 + 0.5, 0.0);
    return 2.0 * t * t * (3.0 - 2.0 * t);
}

// An edge image through whose lines a share of the paper shows; the same to the bit for none.
fn fainter(edge: f32, faintness: f32) -> f32 {
    return edge + (1.0 - edge) * faintness;
}

// The edge image of response u, its lines as faint as they are to be.
fn edge_of_response(u: f32, kind: u32, epsilon: f32, phi: f32, faintness: f32) -> f32 {
    let edge = edge_threshold(u, kind, epsilon, phi);
    return select(fainter(edge, faintness), edge, kind == 0u);
}

// The edge image where no covered pixel contributes: paper.
fn edge_uncovered(kind: u32) -> f32 {
    return select(1.0, 0.0, kind == 0u);
}

// The edge image of a weighted sum of (u alpha, alpha); paper where no covered pixel contributes.
fn edge_of_sum(sum: vec2f, kind: u32, epsilon: f32, phi: f32, faintness: f32) -> f32 {
    if sum.y > LEAST_COVERAGE {
        return edge_of_response(sum.x / sum.y, kind, epsilon, phi, faintness);
    }
    return edge_uncovered(kind);
}

// D = base G_sigma + edge (G_sigma - G_k sigma) (4.9) of two weighted sums of (L alpha, alpha); 0 where no
// covered pixel contributes. Dividing by the weighted coverage normalises the weights too.
fn dog_of_sums(narrow: vec2f, wide: vec2f, base: f32, edge: f32) -> f32 {
    if min(narrow.y, wide.y) > LEAST_COVERAGE {
        let mean = narrow.x / narrow.y;
        return base * mean + edge * (mean - wide.x / wide.y);
    }
    return 0.0;
}
