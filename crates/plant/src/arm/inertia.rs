//! Inertia tensor of a rigid body.

use nalgebra::Matrix3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An inertia tensor in kg m^2: diagonal entries, and the off-diagonal ones as they stand in the
/// tensor (as in URDF). What is not given is 0; all zeros are a point mass.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Inertia {
    /// Entry (x, x).
    pub ixx: f64,
    /// Entry (y, y).
    pub iyy: f64,
    /// Entry (z, z).
    pub izz: f64,
    /// Entry (x, y).
    pub ixy: f64,
    /// Entry (x, z).
    pub ixz: f64,
    /// Entry (y, z).
    pub iyz: f64,
}

impl Inertia {
    /// The tensor as a matrix.
    #[must_use]
    pub fn matrix(&self) -> Matrix3<f64> {
        let Self {
            ixx,
            iyy,
            izz,
            ixy,
            ixz,
            iyz,
        } = *self;
        Matrix3::new(ixx, ixy, ixz, ixy, iyy, iyz, ixz, iyz, izz)
    }

    /// The tensor of the same body in a frame from which its own is turned by a rotation matrix R,
    /// given row by row: R I R^T.
    #[must_use]
    pub fn turned(&self, rotation: &[[f64; 3]; 3]) -> Self {
        let tensor = self.matrix();
        let entry = |i: usize, j: usize| {
            let pairs = (0..3).flat_map(|k| (0..3).map(move |l| (k, l)));
            let terms = pairs.map(|(k, l)| rotation[i][k] * tensor[(k, l)] * rotation[j][l]);
            terms.sum()
        };
        Self {
            ixx: entry(0, 0),
            iyy: entry(1, 1),
            izz: entry(2, 2),
            ixy: entry(0, 1),
            ixz: entry(0, 2),
            iyz: entry(1, 2),
        }
    }

    /// Principal moments in kg m^2, rising.
    #[must_use]
    pub fn principal_moments(&self) -> [f64; 3] {
        let mut moments: [f64; 3] = self.matrix().symmetric_eigenvalues().into();
        moments.sort_by(f64::total_cmp);
        moments
    }

    /// The entries, xx, yy, zz, xy, xz, yz.
    pub(crate) fn entries(&self) -> [f64; 6] {
        [self.ixx, self.iyy, self.izz, self.ixy, self.ixz, self.iyz]
    }
}
