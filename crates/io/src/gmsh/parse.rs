//! Sections of a file, of version 2.2 or 4.1, as text or in binary.

use std::collections::HashMap;
use std::path::Path;

use super::elements::Kind;
use super::file::{Elements, GmshFile, GmshVersion};
use super::scan::{Encoding, Scan};
use crate::Error;
use crate::files::read;

/// Largest number of tags of an element or entity.
const MOST_TAGS: usize = 1 << 20;

/// Physical groups of an entity: number of the first one, 0 for none, and whether there are others.
type Groups = (i32, bool);

impl GmshFile {
    /// Reads a file.
    ///
    /// # Errors
    /// [`Error::Read`]; [`Error::MeshFile`] with line or byte, cause and remedy.
    pub fn read(path: &Path) -> Result<Self, Error> {
        Self::parse(&read(path)?).map_err(|problem| Error::MeshFile { path: path.to_owned(), problem })
    }

    /// Reads the bytes of a file.
    ///
    /// # Errors
    /// A text with line or byte, cause and remedy.
    pub fn parse(bytes: &[u8]) -> Result<Self, String> {
        if bytes.trim_ascii().is_empty() {
            return Err("the file is empty; save the mesh again".to_owned());
        }
        let mut scan = Scan::new(bytes);
        let version = format(&mut scan)?;
        let mut file = GmshFile {
            version,
            points: Vec::new(),
            elements: std::array::from_fn(|_| Elements::default()),
            names: HashMap::new(),
        };
        let mut numbers: HashMap<u64, usize> = HashMap::new();
        let mut entities: HashMap<(i32, i32), Groups> = HashMap::new();
        while let Some(line) = scan.line() {
            let Some(name) = line.strip_prefix(b"$") else { continue };
            let name = std::str::from_utf8(name).map_err(|_| scan.fail("the name of this section is not UTF-8"))?;
            match (name, version) {
                ("PhysicalNames", _) => names(&mut scan, &mut file.names)?,
                ("Entities", GmshVersion::V41) => read_entities(&mut scan, &mut entities)?,
                ("PartitionedEntities", _) => {
                    return Err(scan.fail("the mesh is divided into partitions; save it without them"));
                }
                ("Nodes", GmshVersion::V22) => listed_nodes(&mut scan, &mut file.points, &mut numbers)?,
                ("Nodes", GmshVersion::V41) => node_blocks(&mut scan, &mut file.points, &mut numbers)?,
                ("Elements", GmshVersion::V22) => listed_elements(&mut scan, &mut file.elements, &numbers)?,
                ("Elements", GmshVersion::V41) => element_blocks(&mut scan, &mut file.elements, &numbers, &entities)?,
                (name, _) if name.starts_with("End") => {
                    return Err(scan.fail(format!("`${name}` ends a section that did not begin")));
                }
                _ => {
                    scan.skip_section(name)?;
                    continue;
                }
            }
            scan.end_section(name)?;
        }
        if file.points.is_empty() {
            return Err("the file has no nodes; make the mesh before it is saved".to_owned());
        }
        Ok(file)
    }
}

fn format(scan: &mut Scan<'_>) -> Result<GmshVersion, String> {
    if scan.line() != Some(b"$MeshFormat") {
        return Err(scan.fail("this is not a Gmsh file, which begins with `$MeshFormat`"));
    }
    let line = scan.text_line()?;
    let words: Vec<&str> = line.split_whitespace().collect();
    let &[version, kind, size] = &words[..] else {
        return Err(scan.fail(format!("`{line}` is not a version, 0 or 1 for text or binary, and 8")));
    };
    let version = match version {
        "2.2" => GmshVersion::V22,
        "4.1" => GmshVersion::V41,
        _ => {
            let message = format!("version {version} is not read; save the mesh as 4.1 or 2.2 (`gmsh -format msh41`)");
            return Err(scan.fail(message));
        }
    };
    if size != "8" {
        return Err(scan.fail(format!("numbers of {size} bytes are not read; save the mesh with 8 bytes")));
    }
    match kind {
        "0" => {}
        "1" => scan.byte_order()?,
        _ => return Err(scan.fail(format!("`{kind}` is neither 0 for text nor 1 for binary"))),
    }
    scan.end_section("MeshFormat")?;
    Ok(version)
}

/// Reads the names of physical groups. They are text also in binary files.
fn names(scan: &mut Scan<'_>, names: &mut HashMap<(usize, i32), String>) -> Result<(), String> {
    for _ in 0..stated(scan)? {
        let line = scan.text_line()?;
        let parts = line.split_once(char::is_whitespace).and_then(|(dimension, rest)| {
            let (number, name) = rest.trim_start().split_once(char::is_whitespace)?;
            let name = name.trim().strip_prefix('"')?.strip_suffix('"')?;
            Some(((dimension.parse().ok()?, number.parse().ok()?), name.to_owned()))
        });
        let shown: String = line.chars().take(60).collect();
        let (group, name) = parts.ok_or_else(|| {
            scan.fail(format!("`{shown}` is not a dimension, a number, and a name between quotation marks"))
        })?;
        names.insert(group, name);
    }
    Ok(())
}

/// Reads a line with the number of entries. It is text also in binary files.
fn stated(scan: &mut Scan<'_>) -> Result<usize, String> {
    let line = scan.text_line()?;
    let shown: String = line.chars().take(40).collect();
    let n = line.parse().map_err(|_| scan.fail(format!("`{shown}` is not a number of entries")))?;
    scan.count(n)
}

fn read_entities(scan: &mut Scan<'_>, entities: &mut HashMap<(i32, i32), Groups>) -> Result<(), String> {
    let mut counts = [0; 4];
    for n in &mut counts {
        let stated = scan.size()?;
        *n = scan.count(stated)?;
    }
    for (dimension, n) in (0..).zip(counts) {
        for _ in 0..n {
            let tag = scan.int()?;
            let n_coordinates = if dimension == 0 { 3 } else { 6 };
            for _ in 0..n_coordinates {
                scan.real()?;
            }
            let groups = tags(scan)?;
            if let Some(first) = groups.first() {
                // The sign of a group is the orientation of the entity.
                entities.insert((dimension, tag), (first.saturating_abs(), groups.len() > 1));
            }
            if dimension > 0 {
                tags(scan)?;
            }
        }
    }
    Ok(())
}

fn tags(scan: &mut Scan<'_>) -> Result<Vec<i32>, String> {
    let stated = scan.size()?;
    let n = scan.count(stated)?;
    (0..n).map(|_| scan.int()).collect()
}

fn push_node(
    scan: &Scan<'_>,
    number: u64,
    x: [f64; 3],
    points: &mut Vec<[f64; 3]>,
    numbers: &mut HashMap<u64, usize>,
) -> Result<(), String> {
    if numbers.insert(number, points.len()).is_some() {
        return Err(scan.fail(format!("there are two nodes with the number {number}")));
    }
    points.push(x);
    Ok(())
}

fn coordinates(scan: &mut Scan<'_>) -> Result<[f64; 3], String> {
    Ok([scan.real()?, scan.real()?, scan.real()?])
}

/// Reads nodes of version 2.2.
fn listed_nodes(
    scan: &mut Scan<'_>,
    points: &mut Vec<[f64; 3]>,
    numbers: &mut HashMap<u64, usize>,
) -> Result<(), String> {
    for _ in 0..stated(scan)? {
        let number = node_number(scan)?;
        let x = coordinates(scan)?;
        push_node(scan, number, x, points, numbers)?;
    }
    Ok(())
}

/// Reads nodes of version 4.1.
fn node_blocks(
    scan: &mut Scan<'_>,
    points: &mut Vec<[f64; 3]>,
    numbers: &mut HashMap<u64, usize>,
) -> Result<(), String> {
    let (n_blocks, n_nodes) = blocks(scan)?;
    for _ in 0..n_blocks {
        let (dimension, _entity, parametric) = (scan.int()?, scan.int()?, scan.int()?);
        let stated = scan.size()?;
        let n = scan.count(stated)?;
        let of_block = (0..n).map(|_| scan.size()).collect::<Result<Vec<_>, _>>()?;
        let n_parameters = if parametric == 0 { 0 } else { dimension.clamp(0, 3) };
        for number in of_block {
            let x = coordinates(scan)?;
            for _ in 0..n_parameters {
                scan.real()?;
            }
            push_node(scan, number, x, points, numbers)?;
        }
    }
    check_total(scan, "nodes", n_nodes, points.len())
}

/// Reads the first line of a section: numbers of blocks and entries, smallest and largest identifier. Returns the
/// numbers of blocks and entries.
fn blocks(scan: &mut Scan<'_>) -> Result<(usize, u64), String> {
    let (n_blocks, n_entries) = (scan.size()?, scan.size()?);
    for _ in 0..2 {
        scan.size()?;
    }
    Ok((scan.count(n_blocks)?, n_entries))
}

/// Checks that the blocks of a section have as many entries as its first line states.
fn check_total(scan: &Scan<'_>, what: &str, stated: u64, found: usize) -> Result<(), String> {
    if stated == found as u64 {
        return Ok(());
    }
    Err(scan.fail(format!("the section states {stated} {what}, and its blocks have {found}; save the mesh again")))
}

fn node_number(scan: &mut Scan<'_>) -> Result<u64, String> {
    let number = scan.int()?;
    u64::try_from(number).map_err(|_| scan.fail(format!("the number {number} is negative")))
}

/// Reads elements of version 2.2.
fn listed_elements(
    scan: &mut Scan<'_>,
    elements: &mut [Elements; 4],
    numbers: &HashMap<u64, usize>,
) -> Result<(), String> {
    let n = stated(scan)?;
    let mut read = 0;
    while read < n {
        // Text has a header for each element, binary data for each block of elements of one kind.
        let (number, kind, of_block, n_tags) = match scan.encoding {
            Encoding::Text => (Some(scan.int()?), scan.int()?, 1, scan.int()?),
            Encoding::Binary { .. } => (None, scan.int()?, scan.int()?, scan.int()?),
        };
        let kind = Kind::with_number(kind).map_err(|message| scan.fail(message))?;
        let of_block = usize::try_from(of_block).ok().filter(|block| (1..=n - read).contains(block));
        let of_block = of_block.ok_or_else(|| scan.fail("a block has more elements than the section"))?;
        let n_tags = usize::try_from(n_tags).ok().filter(|n| *n <= MOST_TAGS);
        let n_tags = n_tags.ok_or_else(|| scan.fail("the number of tags of this element is invalid"))?;
        for _ in 0..of_block {
            let number = match number {
                Some(number) => number,
                None => scan.int()?,
            };
            let mut group = 0;
            for k in 0..n_tags {
                let tag = scan.int()?;
                group = if k == 0 { tag.saturating_abs() } else { group };
            }
            let number = u64::from(number.unsigned_abs());
            push_element(scan, kind, number, (group, false), elements, |scan| {
                find(scan, numbers, number, node_number)
            })?;
        }
        read += of_block;
    }
    Ok(())
}

/// Reads elements of version 4.1.
fn element_blocks(
    scan: &mut Scan<'_>,
    elements: &mut [Elements; 4],
    numbers: &HashMap<u64, usize>,
    entities: &HashMap<(i32, i32), Groups>,
) -> Result<(), String> {
    let ((n_blocks, n_elements), mut n_read) = (blocks(scan)?, 0);
    for _ in 0..n_blocks {
        let (dimension, entity, kind) = (scan.int()?, scan.int()?, scan.int()?);
        let stated = scan.size()?;
        let n = scan.count(stated)?;
        let kind = Kind::with_number(kind).map_err(|message| scan.fail(message))?;
        let groups = entities.get(&(dimension, entity)).copied().unwrap_or_default();
        for _ in 0..n {
            let number = scan.size()?;
            push_element(scan, kind, number, groups, elements, |scan| find(scan, numbers, number, Scan::size))?;
        }
        n_read += n;
    }
    check_total(scan, "elements", n_elements, n_read)
}

/// Reads the number of a node of an element, and returns the index of the node.
fn find<'b>(
    scan: &mut Scan<'b>,
    numbers: &HashMap<u64, usize>,
    element: u64,
    read: impl Fn(&mut Scan<'b>) -> Result<u64, String>,
) -> Result<usize, String> {
    let node = read(scan)?;
    let missing = || scan.fail(format!("element {element} has the node {node}, which is not in `$Nodes`"));
    numbers.get(&node).copied().ok_or_else(missing)
}

fn push_element<'b>(
    scan: &mut Scan<'b>,
    kind: Kind,
    number: u64,
    (group, has_others): Groups,
    elements: &mut [Elements; 4],
    node: impl Fn(&mut Scan<'b>) -> Result<usize, String>,
) -> Result<(), String> {
    let of_dimension = &mut elements[kind.dimension];
    if of_dimension.order != 0 && of_dimension.order != kind.order {
        let message = format!("element {number} has another order than those before it; make all of one order");
        return Err(scan.fail(message));
    }
    of_dimension.order = kind.order;
    for _ in 0..kind.n_nodes {
        of_dimension.nodes.push(node(scan)?);
    }
    of_dimension.numbers.push(number);
    of_dimension.groups.push(group);
    of_dimension.n_ambiguous += usize::from(has_others);
    Ok(())
}
