//! Euler poles: rotations of the sphere, and the best one for a hand.
//!
//! The counterpart of [`super::rigid`] on the sphere. Places are unit vectors, rotations turn counter-clockwise about
//! their pole seen from outside.
//!
//! Fingers that lie close together say well where the ground goes and badly how it spins about them: the error of the
//! spin grows with the inverse of their distance. Below [`CLOSE`] a *former* spin therefore counts as a witness too,
//! the more the closer the fingers are; for a single finger it is the only one.

use glam::{DMat3, DQuat, DVec3};

/// Two fingers nearer to each other than this do not tell the spin alone, radians.
pub const CLOSE: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// Most sweeps of the eigenvalue solver; four are enough in practice.
const SWEEPS: usize = 30;

/// The angular velocity that explains the velocities of the given places best, in radians per unit of time:
/// (Σ I − p pᵀ) ω = Σ p × v. Of the `former` angular velocity only the spin about the middle of the places is looked at,
/// and only where they lie closer than [`CLOSE`]. One place keeps that spin and goes with its velocity; no places give
/// the former angular velocity back.
pub fn rate(places: &[DVec3], velocities: &[DVec3], former: DVec3) -> DVec3 {
    assert_eq!(places.len(), velocities.len(), "each place has a velocity");
    if places.is_empty() {
        return former;
    }
    let mut matrix = DMat3::ZERO;
    let mut moment = DVec3::ZERO;
    for (&p, &v) in places.iter().zip(velocities) {
        matrix += DMat3::IDENTITY - outer(p, p);
        moment += p.cross(v);
    }
    if let Some((middle, weight)) = witness(places) {
        matrix += outer(middle, middle) * weight;
        moment += middle * (weight * former.dot(middle));
    }
    let inverse = matrix.inverse();
    let rough = inverse * moment;
    // One step of refinement wins back the digits that the inverse has lost.
    rough + inverse * (moment - matrix * rough)
}

/// The rotation that takes `from` to `to` best, in the sense of least squares (Horn 1987: the quaternion is the
/// eigenvector of a symmetric 4 × 4 matrix, so it is never a reflection). Where the places lie closer than [`CLOSE`] the
/// spin of the `former` rotation vector about their middle counts too; one place keeps it. No places give the identity.
pub fn rotation(from: &[DVec3], to: &[DVec3], former: DVec3) -> DQuat {
    assert_eq!(from.len(), to.len(), "arrows have two ends");
    if from.is_empty() {
        return DQuat::IDENTITY;
    }
    let pairs = from.iter().zip(to);
    let mut sum = pairs.fold(DMat3::ZERO, |sum, (&p, &q)| sum + outer(p, q));
    if let Some((middle, weight)) = witness(from) {
        let sides = from.iter().zip(to).map(|(p, &q)| q * p.dot(middle).signum());
        let goal = sides.sum::<DVec3>().normalize_or(middle);
        let carried =
            DQuat::from_rotation_arc(middle, goal) * DQuat::from_axis_angle(middle, former.dot(middle));
        let (a, b) = middle.any_orthonormal_pair();
        for side in [a, b] {
            sum += outer(side, carried * side) * (weight / 2.0);
        }
    }
    let s = |row: usize, column: usize| sum.col(column)[row];
    let skew = DVec3::new(s(1, 2) - s(2, 1), s(2, 0) - s(0, 2), s(0, 1) - s(1, 0));
    let trace = s(0, 0) + s(1, 1) + s(2, 2);
    let both = |i, j| s(i, j) + s(j, i);
    let [w, x, y, z] = principal([
        [trace, skew.x, skew.y, skew.z],
        [skew.x, 2.0 * s(0, 0) - trace, both(0, 1), both(2, 0)],
        [skew.y, both(0, 1), 2.0 * s(1, 1) - trace, both(1, 2)],
        [skew.z, both(2, 0), both(1, 2), 2.0 * s(2, 2) - trace],
    ]);
    DQuat::from_xyzw(x, y, z, w).normalize()
}

/// The rotation vector of a rotation: its pole times its angle in radians, at most π.
pub fn rotation_vector(rotation: DQuat) -> DVec3 {
    // Of the two quaternions of a rotation, the one of the short way.
    let short = if rotation.w < 0.0 { -rotation } else { rotation };
    short.to_scaled_axis()
}

/// The line through the centre that places too close to it tell no spin about, and how much the former spin counts
/// there. It counts as much as they lack to two fingers at distance [`CLOSE`].
fn witness(places: &[DVec3]) -> Option<(DVec3, f64)> {
    let scatter = places
        .iter()
        .fold(DMat3::ZERO, |scatter, &p| scatter + outer(p, p));
    let [a, b, c] = scatter.to_cols_array_2d();
    let [x, y, z, _] = principal([
        [a[0], a[1], a[2], 0.0],
        [b[0], b[1], b[2], 0.0],
        [c[0], c[1], c[2], 0.0],
        [0.0; 4],
    ]);
    let middle = DVec3::new(x, y, z).try_normalize()?;
    let told: f64 = places.iter().map(|p| p.cross(middle).length_squared()).sum();
    let wanted = 2.0 * (CLOSE / 2.0).sin().powi(2);
    (told < wanted).then_some((middle, wanted - told))
}

/// a bᵀ.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// The eigenvector of the greatest eigenvalue of a symmetric matrix, by Jacobi rotations.
fn principal(mut matrix: [[f64; 4]; 4]) -> [f64; 4] {
    const PAIRS: [(usize, usize); 6] = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];
    // Rows are the eigenvectors found so far.
    let mut vectors = [[0.0; 4]; 4];
    for (i, row) in vectors.iter_mut().enumerate() {
        row[i] = 1.0;
    }
    for _ in 0..SWEEPS {
        let mut turned = false;
        for (p, q) in PAIRS {
            let (app, aqq, apq) = (matrix[p][p], matrix[q][q], matrix[p][q]);
            if apq.abs() <= f64::EPSILON * f64::EPSILON * (app.abs() + aqq.abs()) {
                continue;
            }
            turned = true;
            let cot = (aqq - app) / (2.0 * apq);
            let tan = cot.signum() / (cot.abs() + cot.hypot(1.0));
            let cos = tan.hypot(1.0).recip();
            let sin = tan * cos;
            for row in &mut matrix {
                (row[p], row[q]) = (cos * row[p] - sin * row[q], sin * row[p] + cos * row[q]);
            }
            for rows in [&mut matrix, &mut vectors] {
                let (a, b) = (rows[p], rows[q]);
                rows[p] = std::array::from_fn(|column| cos * a[column] - sin * b[column]);
                rows[q] = std::array::from_fn(|column| sin * a[column] + cos * b[column]);
            }
        }
        if !turned {
            break;
        }
    }
    let greatest = (1..4).fold(0, |best, i| {
        if matrix[i][i] > matrix[best][best] {
            i
        } else {
            best
        }
    });
    vectors[greatest]
}
