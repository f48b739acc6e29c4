//! Writing a mesh as a Gmsh file.

use std::collections::{BTreeSet, HashMap};
use std::fmt::Debug;
use std::path::Path;

use mesh::{Aabb, Point, SimplexMesh, Tag, VertexId};

use super::elements::{Kind, edges};
use super::file::GmshVersion;
use crate::Error;
use crate::files::write_whole;

/// Format of a file that is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GmshFormat {
    /// Version.
    pub version: GmshVersion,
    /// Whether numbers are written in binary.
    pub is_binary: bool,
}

/// Writes a mesh with its tags as physical groups. Elements have order 2 if `edge_nodes` is not empty, else 1.
///
/// The mesh is read again with the same bits.
///
/// # Errors
/// [`Error::Write`].
pub fn write<const D: usize>(
    path: &Path,
    mesh: &SimplexMesh<D>,
    edge_nodes: &HashMap<[VertexId; 2], Point<D>>,
    format: GmshFormat,
) -> Result<(), Error> {
    write_whole(path, &text(mesh, edge_nodes, format))
}

/// Elements of one dimension in one group.
struct EntityBlock {
    dimension: usize,
    /// Number of the physical group; 0 for none.
    group: usize,
    /// Nodes of each element; the first node has the number 1.
    elements: Vec<Vec<usize>>,
}

/// Returns the bytes of a file.
fn text<const D: usize>(
    mesh: &SimplexMesh<D>,
    edge_nodes: &HashMap<[VertexId; 2], Point<D>>,
    format: GmshFormat,
) -> Vec<u8> {
    let mut points: Vec<Point<D>> = mesh.vertices().to_vec();
    let mut node_on: HashMap<[VertexId; 2], usize> = HashMap::new();
    let mut nodes_of = |corners: &[VertexId], dimension: usize| {
        let mut nodes: Vec<usize> = corners.iter().map(|vertex| vertex.index() + 1).collect();
        if !edge_nodes.is_empty() {
            for ends in edges(dimension) {
                let [a, b] = ends.map(|k| corners[k]);
                let ends = [a.min(b), a.max(b)];
                let middle = || (mesh.vertex(a) + mesh.vertex(b)) * 0.5;
                nodes.push(*node_on.entry(ends).or_insert_with(|| {
                    points.push(edge_nodes.get(&ends).copied().unwrap_or_else(middle));
                    points.len()
                }));
            }
        }
        nodes
    };
    let cells = mesh.cells().map(|cell| (mesh.cell_tag(cell), nodes_of(mesh.cell(cell), D)));
    let mut blocks = blocks(D, cells);
    let tagged = mesh.facets().filter(|facet| mesh.facet_tag(*facet).is_some());
    blocks.extend(self::blocks(D - 1, tagged.map(|facet| (mesh.facet_tag(facet), nodes_of(mesh.facet(facet), D - 1)))));

    let order = if edge_nodes.is_empty() { 1 } else { 2 };
    let mut out = Out { bytes: Vec::new(), is_binary: format.is_binary };
    out.line(&format!("$MeshFormat\n{} {} 8", format.version, u8::from(format.is_binary)));
    if format.is_binary {
        out.ints([1]);
        out.end_entry();
    }
    out.line("$EndMeshFormat");
    let groups: BTreeSet<(usize, usize)> =
        blocks.iter().filter(|b| b.group > 0).map(|b| (b.dimension, b.group)).collect();
    if !groups.is_empty() {
        out.line(&format!("$PhysicalNames\n{}", groups.len()));
        for (dimension, group) in &groups {
            out.line(&format!("{dimension} {group} \"{}\"", mesh.tag_names()[group - 1]));
        }
        out.line("$EndPhysicalNames");
    }
    match format.version {
        GmshVersion::V22 => out.lists(&points, &blocks, order),
        GmshVersion::V41 => out.blocks(&points, &blocks, order),
    }
    out.bytes
}

/// Collects elements by their groups, in the order in which the groups appear.
fn blocks(dimension: usize, elements: impl Iterator<Item = (Option<Tag>, Vec<usize>)>) -> Vec<EntityBlock> {
    let mut blocks: Vec<EntityBlock> = Vec::new();
    for (tag, nodes) in elements {
        // Groups are numbered from 1.
        let group = tag.map_or(0, |tag| tag.index() + 1);
        match blocks.last_mut() {
            // The order of the elements is kept. A group has several blocks if elements of others are between.
            Some(block) if block.group == group => block.elements.push(nodes),
            _ => blocks.push(EntityBlock { dimension, group, elements: vec![nodes] }),
        }
    }
    blocks
}

/// Bytes of a file.
struct Out {
    bytes: Vec<u8>,
    is_binary: bool,
}

impl Out {
    fn line(&mut self, line: &str) {
        self.bytes.extend(line.as_bytes());
        self.bytes.push(b'\n');
    }

    /// Appends the line break that ends a line of text, or the numbers of a section in binary.
    fn end_entry(&mut self) {
        self.bytes.push(b'\n');
    }

    /// Appends a line of numbers to a text, or their bytes by `append` to a binary file.
    fn numbers<T: Copy + Debug>(&mut self, numbers: impl IntoIterator<Item = T>, append: impl Fn(&mut Vec<u8>, T)) {
        for number in numbers {
            if self.is_binary {
                append(&mut self.bytes, number);
            } else {
                self.bytes.extend(format!("{number:?} ").as_bytes());
            }
        }
        if !self.is_binary {
            self.end_entry();
        }
    }

    fn ints(&mut self, numbers: impl IntoIterator<Item = usize>) {
        self.numbers(numbers, |bytes, number| bytes.extend((number as i32).to_le_bytes()));
    }

    fn sizes(&mut self, numbers: impl IntoIterator<Item = usize>) {
        self.numbers(numbers, |bytes, number| bytes.extend((number as u64).to_le_bytes()));
    }

    fn reals(&mut self, numbers: impl IntoIterator<Item = f64>) {
        self.numbers(numbers, |bytes, number| bytes.extend(number.to_le_bytes()));
    }

    /// Ends a section.
    fn end(&mut self, name: &str) {
        if self.is_binary {
            self.end_entry();
        }
        self.line(&format!("$End{name}"));
    }

    /// Appends nodes and elements of version 2.2.
    fn lists<const D: usize>(&mut self, points: &[Point<D>], blocks: &[EntityBlock], order: usize) {
        self.line(&format!("$Nodes\n{}", points.len()));
        for (k, x) in points.iter().enumerate() {
            self.ints([k + 1]);
            self.reals(spatial(x));
        }
        self.end("Nodes");
        self.line(&format!("$Elements\n{}", blocks.iter().map(|block| block.elements.len()).sum::<usize>()));
        let mut number = 0;
        for block in blocks {
            let kind = kind(block, order);
            if self.is_binary {
                self.ints([kind, block.elements.len(), 2]);
            }
            for nodes in &block.elements {
                number += 1;
                let header: &[usize] = if self.is_binary { &[number] } else { &[number, kind, 2] };
                // Physical group and entity.
                self.ints(header.iter().chain(&[block.group, block.group + 1]).chain(nodes).copied());
            }
        }
        self.end("Elements");
    }

    /// Appends entities, nodes and elements of version 4.1.
    fn blocks<const D: usize>(&mut self, points: &[Point<D>], blocks: &[EntityBlock], order: usize) {
        let entities: BTreeSet<(usize, usize)> = blocks.iter().map(|block| (block.dimension, block.group)).collect();
        let n_entities = |dimension: usize| entities.iter().filter(|(found, _)| *found == dimension).count();
        let bounds = Aabb::of_points(points);
        self.line("$Entities");
        self.sizes((0..4).map(n_entities));
        for (_, group) in &entities {
            self.ints([group + 1]);
            self.reals(spatial(&bounds.low).into_iter().chain(spatial(&bounds.high)));
            let of_entity = if *group > 0 { vec![*group] } else { Vec::new() };
            self.sizes([of_entity.len()]);
            self.ints(of_entity);
            // Entities on the boundary of this one.
            self.sizes([0]);
        }
        self.end("Entities");
        self.line("$Nodes");
        self.sizes([1, points.len(), 1, points.len()]);
        // Dimension and number of an entity, and whether there are parameters.
        let (dimension, group) = blocks.first().map_or((D, 0), |block| (block.dimension, block.group));
        self.ints([dimension, group + 1, 0]);
        self.sizes([points.len()]);
        self.sizes(1..=points.len());
        points.iter().for_each(|x| self.reals(spatial(x)));
        self.end("Nodes");
        let n_elements: usize = blocks.iter().map(|block| block.elements.len()).sum();
        self.line("$Elements");
        self.sizes([blocks.len(), n_elements, 1, n_elements]);
        let mut number = 0;
        for block in blocks {
            self.ints([block.dimension, block.group + 1, kind(block, order)]);
            self.sizes([block.elements.len()]);
            for nodes in &block.elements {
                number += 1;
                self.sizes([number].into_iter().chain(nodes.iter().copied()));
            }
        }
        self.end("Elements");
    }
}

/// Returns the coordinates of a point in space.
fn spatial<const D: usize>(x: &Point<D>) -> [f64; 3] {
    std::array::from_fn(|axis| x.get(axis).copied().unwrap_or(0.0))
}

/// Returns the number of the kind of the elements of a block.
fn kind(block: &EntityBlock, order: usize) -> usize {
    Kind::of(block.dimension, order).map_or(0, |kind| kind.number as usize)
}
