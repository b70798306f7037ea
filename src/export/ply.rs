//! `terrain.ply`: the mesh with what the simulation knows at each vertex (Turk 1994, binary little-endian).

use std::io::{self, Write};

use super::{Mesh, check_mesh, invalid};

/// What the simulation knows at each vertex: parallel slices.
#[derive(Clone, Copy, Debug)]
pub struct NodeValues<'a> {
    /// Drainage area, m².
    pub drainage: &'a [f64],
    /// Uplift rate, m/yr.
    pub uplift: &'a [f64],
    /// The vertex each one drains to; an outlet drains to itself, and is written as −1.
    pub receivers: &'a [u32],
    /// Rock layer at the surface.
    pub layers: &'a [u32],
    /// Erodibility *k* of the stream power law.
    pub erodibility: &'a [f64],
}

/// Writes the mesh in metres: x east, y north, z up, origin in the south-west corner; `float` properties `x y z
/// area_m2 uplift k`, `int` properties `receiver layer`, faces counter-clockwise seen from above.
///
/// # Errors
/// Where slices are not parallel, or `out` fails.
pub fn write(mut out: impl Write, mesh: Mesh<'_>, values: NodeValues<'_>) -> io::Result<()> {
    check_mesh(mesh)?;
    let count = mesh.positions.len();
    for (what, length) in [
        ("drainage", values.drainage.len()),
        ("uplift", values.uplift.len()),
        ("receivers", values.receivers.len()),
        ("layers", values.layers.len()),
        ("erodibility", values.erodibility.len()),
    ] {
        if length != count {
            return Err(invalid(format!(
                "PLY: {count} vertices but {length} values of {what}"
            )));
        }
    }
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\n\
         comment metres, x east, y north, z up, origin south-west corner\n\
         comment area_m2: drainage area; uplift: m/yr; receiver: vertex it drains to, -1 at outlets\n\
         element vertex {count}\n\
         property float x\nproperty float y\nproperty float z\n\
         property float area_m2\nproperty float uplift\nproperty int receiver\nproperty int layer\n\
         property float k\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.triangles.len()
    )?;
    for i in 0..count {
        for value in [
            mesh.positions[i].x,
            mesh.positions[i].y,
            mesh.heights[i],
            values.drainage[i],
            values.uplift[i],
        ] {
            out.write_all(&(value as f32).to_le_bytes())?;
        }
        let receiver = values.receivers[i];
        let receiver = if receiver as usize == i {
            -1
        } else {
            receiver as i32
        };
        out.write_all(&receiver.to_le_bytes())?;
        out.write_all(&(values.layers[i] as i32).to_le_bytes())?;
        out.write_all(&(values.erodibility[i] as f32).to_le_bytes())?;
    }
    for corners in mesh.triangles {
        out.write_all(&[3])?;
        for &corner in corners {
            out.write_all(&(corner as i32).to_le_bytes())?;
        }
    }
    Ok(())
}
