//! The polygons of a COLLADA mesh, cut into triangles.

use anyhow::{Context, Result, bail};
use dae_parser::{ArrayElement, InputList, LocalMap, Primitive, Semantic, Source, Vertices};
use glam::Vec3;

/// Three vertices, and the normals there if the file has them.
type Corners = ([Vec3; 3], Option<[Vec3; 3]>);

/// A `<triangles>` or `<polylist>` element.
pub struct Polygons<'a> {
    /// The symbol of the material, which each use of the mesh binds to a material.
    pub material: Option<&'a str>,
    inputs: &'a InputList,
    /// The number of corners of each polygon; `None` if all are triangles.
    counts: Option<&'a [u32]>,
    /// For each corner, one index per input.
    indices: &'a [u32],
}

impl<'a> Polygons<'a> {
    /// Returns the polygons of a part of a mesh; `None` if its kind is not supported.
    pub fn new(part: &'a Primitive) -> Option<Self> {
        match part {
            Primitive::Triangles(part) => Some(Self {
                material: part.material.as_deref(),
                inputs: &part.inputs,
                counts: None,
                indices: part.data.prim.as_deref().unwrap_or_default(),
            }),
            Primitive::PolyList(part) => Some(Self {
                material: part.material.as_deref(),
                inputs: &part.inputs,
                counts: Some(&part.data.vcount),
                indices: &part.data.prim,
            }),
            _ => None,
        }
    }

    /// Returns the polygons as fans of triangles.
    ///
    /// # Errors
    ///
    /// If the mesh lacks positions, or an index names nothing.
    pub fn triangles(
        &self,
        vertices: &LocalMap<'a, Vertices>,
        sources: &LocalMap<'a, Source>,
    ) -> Result<impl Iterator<Item = Result<Corners>>> {
        let mut positions = None;
        let mut normals = None;
        for input in self.inputs.iter() {
            let offset = input.offset as usize;
            match input.semantic {
                Semantic::Vertex => {
                    let vertex = vertices.get(input.source_as_vertices());
                    for input in &vertex.context("a mesh has no vertices")?.inputs {
                        let column = Column::new(sources.get_raw(&input.source), offset);
                        match input.semantic {
                            Semantic::Position => positions = Some(column?),
                            Semantic::Normal => normals = Some(column?),
                            _ => {}
                        }
                    }
                }
                Semantic::Normal => {
                    normals = Some(Column::new(sources.get_raw(&input.source), offset)?);
                }
                _ => {}
            }
        }
        let positions = positions.context("a mesh has no positions")?;

        let stride = self.inputs.stride.max(1);
        let corners: Vec<&[u32]> = self.indices.chunks_exact(stride).collect();
        let triangles = fans(self.counts, corners.len());
        Ok(triangles.map(move |triangle| {
            let [a, b, c] = triangle.map(|corner| corners.get(corner).copied().unwrap_or_default());
            let points = positions.read([a, b, c]);
            let normals = normals.as_ref().and_then(|normals| normals.read([a, b, c]));
            Ok((points.context("a polygon names a vertex that is not there")?, normals))
        }))
    }
}

/// Returns the triangles of all polygons as positions in the list of corners.
///
/// Polygon (p, q, r, s, ...) becomes the triangles (p, q, r), (p, r, s), ...
fn fans(counts: Option<&[u32]>, corners: usize) -> impl Iterator<Item = [usize; 3]> {
    let counts = match counts {
        Some(counts) => counts.iter().map(|&count| count as usize).collect(),
        None => vec![3; corners / 3],
    };
    let mut next = 0;
    counts.into_iter().flat_map(move |count| {
        let first = next;
        next += count;
        (2..count).map(move |i| [first, first + i - 1, first + i])
    })
}

/// A source of vectors, and the place of its index among a corner's indices.
struct Column<'a> {
    values: &'a [f32],
    start: usize,
    stride: usize,
    offset: usize,
}

impl<'a> Column<'a> {
    fn new(source: Option<&'a Source>, offset: usize) -> Result<Self> {
        let source = source.context("a mesh names a source that is not there")?;
        let Some(ArrayElement::Float(array)) = &source.array else {
            bail!("a source of vectors has no array of numbers");
        };
        let (start, stride) = (source.accessor.offset, source.accessor.stride);
        Ok(Self { values: &array.val, start, stride, offset })
    }

    fn read(&self, corners: [&[u32]; 3]) -> Option<[Vec3; 3]> {
        let [a, b, c] = corners.map(|corner| {
            let index = *corner.get(self.offset)? as usize;
            let first = index.checked_mul(self.stride)?.checked_add(self.start)?;
            Some(Vec3::from_slice(self.values.get(first..)?.get(..3)?))
        });
        Some([a?, b?, c?])
    }
}
