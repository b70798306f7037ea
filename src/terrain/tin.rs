//! The triangulated irregular network (TIN): nodes, their Delaunay neighbours, and their Voronoi cells.

use glam::DVec2;
use spade::handles::FixedVertexHandle;
use spade::{DelaunayTriangulation, InsertionError, Point2, Triangulation};

use super::hilbert::{hilbert_order, in_two_passes};
use super::sampling::{Samples, poisson_disc, saturated, saturated_at_most};
use super::voronoi::cell_areas;
use crate::units::Extent;

/// Fewest nodes of [`Tin::poisson`]: twelve along the border and some inside.
pub const MIN_POISSON_NODES: usize = 16;

/// Most nodes of a TIN. Four million take about 2 GiB while they are triangulated.
pub const MAX_NODES: usize = 4_000_000;

/// Smallest distance between two nodes, as a share of the longer side: below it slopes lose their digits.
const MIN_SPACING: f64 = 1e-9;

/// A node of a [`Tin`], by its place in all per-node slices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub struct NodeId(pub u32);

impl NodeId {
    /// The handle of place `index` (below [`MAX_NODES`]).
    pub fn new(index: usize) -> Self {
        Self(index as u32)
    }

    /// Place in per-node slices.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A neighbour of a node and how near it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// The neighbour.
    pub to: NodeId,
    /// One over the horizontal distance, 1/m. Single precision: it only ranks slopes.
    pub inverse_distance: f32,
}

/// Which nodes let water leave the land.
#[derive(Clone, Copy, Debug)]
pub enum Border<'a> {
    /// The nodes on the convex hull.
    Hull,
    /// One flag per node; at least one is true.
    Flags(&'a [bool]),
}

/// Why nodes do not make a TIN.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TinError {
    /// The rectangle is empty, infinite or NaN.
    #[error("land of {width} × {height} m: both sides must be positive and finite")]
    BadExtent {
        /// West–east size, metres.
        width: f64,
        /// South–north size, metres.
        height: f64,
    },
    /// Too few nodes for a triangulation, or for a sampled rectangle.
    #[error("{found} nodes: at least {expected} are needed")]
    TooFewNodes {
        /// How many there are.
        found: usize,
        /// How many are needed.
        expected: usize,
    },
    /// More nodes than [`MAX_NODES`].
    #[error("{found} nodes: at most {MAX_NODES} are possible")]
    TooManyNodes {
        /// How many there are.
        found: usize,
    },
    /// A coordinate that is NaN, infinite or too tiny to compute with.
    #[error("node {index}: a coordinate is not a usable number ({reason})")]
    BadCoordinate {
        /// Place of the node in the input.
        index: usize,
        /// What is wrong with it.
        reason: InsertionError,
    },
    /// A node outside the rectangle.
    #[error("node {index} at ({x}, {y}) m lies outside the land")]
    OutsideExtent {
        /// Place of the node in the input.
        index: usize,
        /// Its x, metres.
        x: f64,
        /// Its y, metres.
        y: f64,
    },
    /// Two nodes at the same place, or nearly so.
    #[error("nodes {first} and {second} lie at the same place")]
    Coincident {
        /// Place of one node in the input.
        first: usize,
        /// Place of the other.
        second: usize,
    },
    /// All nodes on one line.
    #[error("all nodes lie on one line: there is no triangle")]
    Collinear,
    /// Border flags that do not match the nodes.
    #[error("{found} border flags for {expected} nodes")]
    BorderLength {
        /// How many flags there are.
        found: usize,
        /// How many nodes there are.
        expected: usize,
    },
    /// No node lets water leave.
    #[error("no node is on the border: water needs at least one way out")]
    NoBorder,
}

/// A triangulated irregular network over a rectangle of land.
///
/// Nodes are in the plan frame, metres. [`Tin::poisson`] numbers them along a Hilbert curve, so that neighbours are
/// near in memory too; [`Tin::from_nodes`] keeps the order given. A node's links run counter-clockwise; those of a
/// hull node begin at the hull, so that consecutive links always span a triangle.
#[derive(Clone, Debug, PartialEq)]
pub struct Tin {
    extent: Extent,
    positions: Vec<DVec2>,
    /// Node i's links are `links[first_link[i]..first_link[i + 1]]`.
    first_link: Vec<u32>,
    links: Vec<Link>,
    areas: Vec<f64>,
    triangles: Vec<[u32; 3]>,
    border: Vec<bool>,
}

/// The triangulation under construction. Vertices are numbered as they are inserted.
type Triangles = DelaunayTriangulation<Point2<f64>>;

impl Tin {
    /// A TIN of exactly `nodes` Poisson-disc samples of `extent`, a pure function of its arguments.
    ///
    /// Corners and sides carry nodes at the spacing of the interior, so the triangles cover the rectangle exactly;
    /// these are the border nodes.
    ///
    /// # Errors
    /// [`TinError`] when `nodes` is outside [`MIN_POISSON_NODES`]`..=`[`MAX_NODES`] or the extent is no rectangle.
    pub fn poisson(extent: Extent, nodes: usize, seed: u64) -> Result<Self, TinError> {
        check_extent(extent)?;
        Self::check_nodes(nodes)?;
        Self::of_samples(extent, &poisson_disc(extent, nodes, seed))
    }

    /// Checks whether [`Self::poisson`] can lay so many nodes.
    ///
    /// # Errors
    /// [`TinError`] when `nodes` is outside [`MIN_POISSON_NODES`]`..=`[`MAX_NODES`].
    pub fn check_nodes(nodes: usize) -> Result<(), TinError> {
        if nodes < MIN_POISSON_NODES {
            return Err(TinError::TooFewNodes {
                found: nodes,
                expected: MIN_POISSON_NODES,
            });
        }
        if nodes > MAX_NODES {
            return Err(TinError::TooManyNodes { found: nodes });
        }
        Ok(())
    }

    /// The same nodes, of which those of `border` let water leave the land.
    ///
    /// # Errors
    /// [`TinError`] when there is not one flag per node, or none is true.
    pub fn with_border(self, border: Vec<bool>) -> Result<Self, TinError> {
        if border.len() != self.len() {
            return Err(TinError::BorderLength {
                found: border.len(),
                expected: self.len(),
            });
        }
        if !border.contains(&true) {
            return Err(TinError::NoBorder);
        }
        Ok(Self { border, ..self })
    }

    /// A TIN of Poisson-disc samples of `extent` that leave no room for another: nodes are at least `radius` metres
    /// apart, and no place is farther than that from all of them, so that no triangle has a side above two radii. The
    /// border is sampled as in [`Tin::poisson`].
    ///
    /// # Errors
    /// [`TinError`] when the extent is no rectangle, or `radius` so small that more than [`MAX_NODES`] might fit.
    pub fn saturated(extent: Extent, radius: f64, seed: u64) -> Result<Self, TinError> {
        check_extent(extent)?;
        // No disc is larger than the land; NaN and what is not above zero leave room for endless many.
        let radius = radius.min(extent.width).min(extent.height);
        let found = if radius > 0.0 {
            saturated_at_most(extent, radius)
        } else {
            f64::INFINITY
        };
        if found > MAX_NODES as f64 {
            return Err(TinError::TooManyNodes {
                found: found as usize,
            });
        }
        Self::of_samples(extent, &saturated(extent, radius, seed))
    }

    /// Numbers samples along a Hilbert curve and triangulates them.
    fn of_samples(extent: Extent, samples: &Samples) -> Result<Self, TinError> {
        let order = hilbert_order(extent, &samples.positions);
        let positions: Vec<DVec2> = order.iter().map(|&k| samples.positions[k as usize]).collect();
        let border = order.iter().map(|&k| (k as usize) < samples.border).collect();
        let along_curve: Vec<u32> = (0..positions.len() as u32).collect();
        Self::triangulate(extent, positions, Some(border), &along_curve)
    }

    /// A TIN of the given nodes, in the given order.
    ///
    /// The triangles cover the convex hull of the nodes; Voronoi cells are clipped to `extent`, and their areas
    /// sum to its area whatever the hull.
    ///
    /// # Errors
    /// [`TinError`] for fewer than three nodes, more than [`MAX_NODES`], nodes on one line, at the same place,
    /// outside the rectangle or not finite, and for border flags that leave water no way out.
    pub fn from_nodes(extent: Extent, nodes: &[DVec2], border: Border<'_>) -> Result<Self, TinError> {
        check_extent(extent)?;
        if nodes.len() < 3 {
            return Err(TinError::TooFewNodes {
                found: nodes.len(),
                expected: 3,
            });
        }
        if nodes.len() > MAX_NODES {
            return Err(TinError::TooManyNodes { found: nodes.len() });
        }
        for (index, &p) in nodes.iter().enumerate() {
            spade::validate_vertex(&Point2::new(p.x, p.y))
                .map_err(|reason| TinError::BadCoordinate { index, reason })?;
            if !extent.contains(p) {
                return Err(TinError::OutsideExtent {
                    index,
                    x: p.x,
                    y: p.y,
                });
            }
        }
        let flags = match border {
            Border::Hull => None,
            Border::Flags(flags) if flags.len() != nodes.len() => {
                return Err(TinError::BorderLength {
                    found: flags.len(),
                    expected: nodes.len(),
                });
            }
            Border::Flags(flags) if !flags.contains(&true) => return Err(TinError::NoBorder),
            Border::Flags(flags) => Some(flags.to_vec()),
        };
        Self::triangulate(extent, nodes.to_vec(), flags, &hilbert_order(extent, nodes))
    }

    /// Triangulates checked positions, inserting them [`in_two_passes`] along the curve: each insertion starts its search
    /// at the node before, a step or two away.
    fn triangulate(
        extent: Extent,
        positions: Vec<DVec2>,
        border: Option<Vec<bool>>,
        along_curve: &[u32],
    ) -> Result<Self, TinError> {
        let n = positions.len();
        let order = in_two_passes(along_curve);
        // Three edges and two triangles per node.
        let mut delaunay = Triangles::with_capacity(n, 3 * n, 2 * n);
        let mut hint = None;
        for (inserted, &node) in order.iter().enumerate() {
            let p = positions[node as usize];
            let vertex = Point2::new(p.x, p.y);
            let handle = match hint {
                None => delaunay.insert(vertex),
                Some(before) => delaunay.insert_with_hint(vertex, before),
            }
            .map_err(|reason| TinError::BadCoordinate {
                index: node as usize,
                reason,
            })?;
            // A node on top of another replaces it, and gets its handle.
            if handle.index() != inserted {
                let first = order[handle.index()];
                return Err(coincident(first, node));
            }
            hint = Some(handle);
        }
        if delaunay.num_inner_faces() == 0 {
            return Err(TinError::Collinear);
        }
        let mut tin = Self {
            extent,
            first_link: Vec::with_capacity(n + 1),
            links: Vec::with_capacity(2 * delaunay.num_undirected_edges()),
            areas: Vec::new(),
            triangles: Vec::with_capacity(delaunay.num_inner_faces()),
            border: border.unwrap_or_default(),
            positions,
        };
        let hull = tin.read_links(&delaunay, &order)?;
        drop(delaunay);
        tin.areas = cell_areas(&tin, &hull);
        if tin.border.is_empty() {
            tin.border = hull;
        }
        Ok(tin)
    }

    /// Takes links and triangles from the triangulation, whose vertices are the nodes in this `order`; returns which nodes
    /// are on its hull.
    fn read_links(&mut self, delaunay: &Triangles, order: &[u32]) -> Result<Vec<bool>, TinError> {
        let n = self.positions.len();
        let mut hull = Vec::with_capacity(n);
        let mut vertex_of = vec![0_u32; n];
        for (vertex, &node) in order.iter().enumerate() {
            vertex_of[node as usize] = vertex as u32;
        }
        let min_spacing = MIN_SPACING * self.extent.width.max(self.extent.height);
        // Neighbours of one node counter-clockwise, each with whether a triangle follows it.
        let mut ring: Vec<(u32, bool)> = Vec::with_capacity(16);
        self.first_link.push(0);
        for node in 0..n as u32 {
            let vertex = FixedVertexHandle::from_index(vertex_of[node as usize] as usize);
            ring.clear();
            let ways_out = delaunay.vertex(vertex).out_edges();
            ring.extend(ways_out.map(|edge| (order[edge.to().index()], !edge.is_outer_edge())));
            let gap = ring.iter().position(|&(_, triangle)| !triangle);
            let start = gap.map_or_else(
                || (0..ring.len()).min_by_key(|&k| ring[k].0).unwrap_or(0),
                |gap| (gap + 1) % ring.len(),
            );
            ring.rotate_left(start);
            hull.push(gap.is_some());
            for (k, &(to, triangle)) in ring.iter().enumerate() {
                let distance = self.positions[node as usize].distance(self.positions[to as usize]);
                if distance < min_spacing {
                    return Err(coincident(node, to));
                }
                self.links.push(Link {
                    to: NodeId(to),
                    inverse_distance: (1.0 / distance) as f32,
                });
                let next = ring[(k + 1) % ring.len()].0;
                if triangle && node < to && node < next {
                    self.triangles.push([node, to, next]);
                }
            }
            self.first_link.push(self.links.len() as u32);
        }
        Ok(hull)
    }

    /// The land it covers.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// False: a TIN has at least three nodes.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// All nodes, in order.
    pub fn nodes(&self) -> impl ExactSizeIterator<Item = NodeId> + use<> {
        (0..self.len() as u32).map(NodeId)
    }

    /// Node positions in the plan frame, metres.
    pub fn positions(&self) -> &[DVec2] {
        &self.positions
    }

    /// Position of one node, metres.
    pub fn position(&self, node: NodeId) -> DVec2 {
        self.positions[node.index()]
    }

    /// Neighbours of a node with their nearness, counter-clockwise.
    pub fn links(&self, node: NodeId) -> &[Link] {
        let i = node.index();
        &self.links[self.first_link[i] as usize..self.first_link[i + 1] as usize]
    }

    /// Neighbours of a node, counter-clockwise.
    pub fn neighbours(&self, node: NodeId) -> impl ExactSizeIterator<Item = NodeId> + '_ {
        self.links(node).iter().map(|link| link.to)
    }

    /// Horizontal distance between two nodes, metres.
    pub fn distance(&self, a: NodeId, b: NodeId) -> f64 {
        self.position(a).distance(self.position(b))
    }

    /// Voronoi cell areas clipped to the rectangle, m²; they sum to the rectangle's area.
    pub fn areas(&self) -> &[f64] {
        &self.areas
    }

    /// Triangles as counter-clockwise node indices, each beginning with its smallest.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// True for the nodes where water may leave the land.
    pub fn border(&self) -> &[bool] {
        &self.border
    }

    /// True if water may leave the land at this node.
    pub fn is_border(&self, node: NodeId) -> bool {
        self.border[node.index()]
    }

    /// Mean side of a Voronoi cell, metres: the length that nodes resolve.
    pub fn spacing(&self) -> f64 {
        (self.extent.area() / self.len() as f64).sqrt()
    }

    /// Checks every invariant of the type; for tests, after each way of making one.
    ///
    /// # Errors
    /// What is broken, in words.
    pub fn sanity_check(&self) -> Result<(), String> {
        let n = self.len();
        if self.first_link.len() != n + 1 || self.areas.len() != n || self.border.len() != n {
            return Err(format!("slices do not match {n} nodes"));
        }
        if !self.border.contains(&true) {
            return Err("no border node".into());
        }
        for node in self.nodes() {
            let mut seen = Vec::new();
            for link in self.links(node) {
                if link.to == node || seen.contains(&link.to) {
                    return Err(format!("{node:?} links to {:?} twice or to itself", link.to));
                }
                seen.push(link.to);
                if !self.neighbours(link.to).any(|back| back == node) {
                    return Err(format!("{node:?} → {:?} has no way back", link.to));
                }
                let exact = 1.0 / self.distance(node, link.to);
                if (f64::from(link.inverse_distance) / exact - 1.0).abs() > 1e-6 {
                    return Err(format!("{node:?} → {:?} has a wrong distance", link.to));
                }
            }
            if self.areas[node.index()] < 0.0 {
                return Err(format!("{node:?} has a negative area"));
            }
        }
        let total: f64 = self.areas.iter().sum();
        if (total / self.extent.area() - 1.0).abs() > 1e-9 {
            return Err(format!("cells cover {total} m² of {}", self.extent.area()));
        }
        for &[a, b, c] in &self.triangles {
            let [a, b, c] = [a, b, c].map(|k| self.positions[k as usize]);
            // Orientation was exact when the triangle was made; here a needle may round to a line.
            if (b - a).perp_dot(c - a) <= -1e-12 * (b - a).length() * (c - a).length() {
                return Err(format!("triangle {a} {b} {c} is not counter-clockwise"));
            }
        }
        // Euler: with h hull nodes there are 2n − h − 2 triangles and 3n − h − 3 edges.
        if self.links.len() / 2 + 1 != n + self.triangles.len() {
            return Err("nodes, edges and triangles do not satisfy Euler's formula".into());
        }
        Ok(())
    }
}

fn check_extent(extent: Extent) -> Result<(), TinError> {
    let Extent { width, height } = extent;
    let usable = |side: f64| side.is_finite() && side > 0.0;
    if usable(width) && usable(height) {
        Ok(())
    } else {
        Err(TinError::BadExtent { width, height })
    }
}

fn coincident(a: u32, b: u32) -> TinError {
    TinError::Coincident {
        first: a.min(b) as usize,
        second: a.max(b) as usize,
    }
}
