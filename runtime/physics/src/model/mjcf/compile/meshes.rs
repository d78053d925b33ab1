//! Meshes and height fields: assets that geoms show.

use super::Compiler;
use super::tree::Frame;
use crate::model::mjcf::document::{Element, Origin};
use crate::model::mjcf::error::ModelError;
use crate::model::mjcf::mesh::{self, Method, Source, SupportShape, measure};
use crate::model::{HeightField, Hull, Mesh, rotation};
use nalgebra::Vector3;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Numbers in a list of an asset at most.
const MOST_NUMBERS: usize = 3_000_000;
/// Samples of a height field along each side at most.
const MOST_SAMPLES: i64 = 10_000;

/// A mesh that was read.
#[derive(Debug)]
pub(super) struct Asset {
    /// In the frame of the source, scaled.
    source: Source,
    /// What it weighs.
    pub solid: SupportShape,
}

impl Compiler<'_> {
    /// The mesh that a geom names, read at its first use.
    pub(super) fn mesh(&mut self, geom: &Element) -> Result<Rc<Asset>, ModelError> {
        let name = geom.required("mesh")?;
        if let Some(mesh) = self.meshes.get(name) {
            return Ok(mesh.clone());
        }
        let asset = self.asset("mesh", name).ok_or_else(|| unknown(geom, "mesh", name))?;
        let asset = self.defaults.resolve(asset, None)?;
        let mut source = self.source(&asset)?;
        let reference = asset.vector_or("refpos", Vector3::zeros())?;
        let turn = asset.numbers::<4>("refquat")?.unwrap_or(rotation::IDENTITY);
        let turn = rotation::normalized(turn).ok_or_else(|| asset.invalid("`refquat` has no direction"))?;
        source.transform(reference, turn, asset.vector_or("scale", Vector3::repeat(1.0))?);
        if source.triangles.is_empty() {
            let hull = Hull::of(&source.vertices).ok_or_else(|| flat(&asset))?;
            source = Source { triangles: hull.triangles(), vertices: hull.vertices };
        }
        let solid = weigh(&asset, &source)?;
        let mesh = Rc::new(Asset { source, solid });
        self.meshes.insert(name.to_owned(), mesh.clone());
        Ok(mesh)
    }

    /// The mesh of a geom that collides, as an asset of the model: its index, and its frame in that of the source.
    pub(super) fn shown_mesh(&mut self, geom: &Element) -> Result<(usize, Frame), ModelError> {
        let name = geom.required("mesh")?.to_owned();
        let asset = self.mesh(geom)?;
        let frame = Frame { position: asset.solid.centre, orientation: asset.solid.axes };
        if let Some(index) = self.model.meshes.iter().position(|mesh| mesh.name == name) {
            return Ok((index, frame));
        }
        let axes = rotation::matrix(frame.orientation);
        // MuJoCo keeps meshes in single precision.
        let rounded = |vertex: &Vector3<f64>| axes.tr_mul(&(vertex - frame.position)).map(|x| f64::from(x as f32));
        let vertices: Vec<_> = asset.source.vertices.iter().map(rounded).collect();
        let hull = Hull::of(&vertices).ok_or_else(|| flat(geom))?;
        let triangles = asset.source.triangles.clone();
        let Frame { position, orientation } = frame;
        self.model.meshes.push(Mesh { name, vertices, triangles, hull, position, orientation });
        Ok((self.model.meshes.len() - 1, frame))
    }

    /// The height field that a geom names, as an asset of the model.
    pub(super) fn height_field(&mut self, geom: &Element) -> Result<usize, ModelError> {
        let name = geom.required("hfield")?;
        if let Some(index) = self.model.height_fields.iter().position(|field| field.name == name) {
            return Ok(index);
        }
        let asset = self.asset("hfield", name).ok_or_else(|| unknown(geom, "hfield", name))?;
        let size = asset.numbers::<4>("size")?.ok_or_else(|| asset.invalid("`hfield` needs the attribute `size`"))?;
        if size.iter().any(|extent| *extent <= 0.0) {
            return Err(asset.invalid("`size` of a height field takes four positive numbers: half x, half y, height, base"));
        }
        let (rows, columns, samples) = self.samples(asset)?;
        let [x, y, elevation, base] = size;
        let name = name.to_owned();
        self.model.height_fields.push(HeightField { name, rows, columns, radius: [x, y], elevation, base, samples });
        Ok(self.model.height_fields.len() - 1)
    }

    /// Rows, columns and samples of a height field from 0 to 1, row after row from small y.
    fn samples(&self, asset: &Element) -> Result<(usize, usize, Vec<f64>), ModelError> {
        let [rows, columns] = [asset.integer_or("nrow", 0, 0, MOST_SAMPLES)?, asset.integer_or("ncol", 0, 0, MOST_SAMPLES)?];
        let (rows, columns, mut samples) = if asset.text("file").is_some() {
            if rows != 0 || columns != 0 || asset.text("elevation").is_some() {
                return Err(asset.invalid("a height field takes either a `file` or `nrow`, `ncol` and `elevation`"));
            }
            let (origin, path) = self.asset_path(asset)?;
            if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
                let message = "heights are not read from pictures: write them as `nrow`, `ncol` and `elevation`, or as \
                    MuJoCo's binary file (two int32 counts, then float32 samples)";
                return Err(asset.invalid(message));
            }
            let wrong =
                || ModelError::File { path: path.clone(), reason: "not a file of two counts and that many samples".to_owned() };
            binary_samples(&origin.read(&path)?).ok_or_else(wrong)?
        } else {
            let (rows, columns) = (rows as usize, columns as usize);
            let given = asset.list("elevation", rows * columns)?;
            let flipped = match given {
                None => vec![0.0; rows * columns],
                Some(given) if given.len() == rows * columns => given.chunks(columns.max(1)).rev().flatten().copied().collect(),
                Some(given) => {
                    let (wanted, found) = (rows * columns, given.len());
                    return Err(asset.invalid(format!("`elevation` expects nrow * ncol = {wanted} numbers, found {found}")));
                }
            };
            (rows, columns, flipped.into_iter().map(|sample| sample as f32).collect())
        };
        if rows < 2 || columns < 2 {
            return Err(asset.invalid("a height field needs at least 2 rows and 2 columns"));
        }
        // In single precision, as MuJoCo keeps them.
        let (low, high) = samples
            .iter()
            .fold((f32::MAX, f32::MIN), |(low, high), &x| (if x < low { x } else { low }, if x > high { x } else { high }));
        for sample in &mut samples {
            *sample -= low;
            if high > low {
                *sample /= high - low;
            }
        }
        Ok((rows, columns, samples.into_iter().map(f64::from).collect()))
    }

    /// The asset of a kind with a name.
    fn asset(&self, kind: &str, name: &str) -> Option<&Element> {
        super::section(&self.document.root, "asset").find(|asset| asset.tag == kind && asset_name(asset) == Some(name))
    }

    /// Corners and triangles of a mesh, from its file or its own lists.
    fn source(&self, asset: &Element) -> Result<Source, ModelError> {
        if asset.text("file").is_some() {
            if asset.text("vertex").is_some() {
                return Err(asset.invalid("a mesh takes either a `file` or `vertex`, not both"));
            }
            let (origin, path) = self.asset_path(asset)?;
            return mesh::read(&path, &origin.read(&path)?);
        }
        asset.required("vertex")?;
        let numbers = asset.list("vertex", MOST_NUMBERS)?.unwrap_or_default();
        let vertices = numbers.chunks_exact(3).map(|v| Vector3::new(v[0], v[1], v[2]).map(|x| f64::from(x as f32))).collect();
        let indices = asset.list("face", MOST_NUMBERS)?.unwrap_or_default();
        let whole = |index: &f64| index.fract() == 0.0 && (0.0..numbers.len() as f64 / 3.0).contains(index);
        if numbers.len() % 3 != 0 || indices.len() % 3 != 0 || !indices.iter().all(whole) {
            return Err(asset.invalid("`vertex` takes three numbers for each corner, `face` three indices of corners"));
        }
        let triangles = indices.chunks_exact(3).map(|t| [t[0] as usize, t[1] as usize, t[2] as usize]).collect();
        Ok(Source { vertices, triangles })
    }

    /// Where an asset's file is.
    fn asset_path(&self, asset: &Element) -> Result<(&Origin<'_>, PathBuf), ModelError> {
        let origin = self.document.origin.as_ref();
        let origin = origin.ok_or_else(|| asset.invalid("text without a file cannot load meshes or height fields"))?;
        let file = Path::new(asset.required("file")?);
        let file = if self.settings.strip_paths { Path::new(file.file_name().unwrap_or_default()) } else { file };
        let path = origin.folder.join(self.settings.mesh_folder.as_deref().unwrap_or("")).join(file);
        Ok((origin, path))
    }
}

/// Mass properties by the method that the asset asks for.
fn weigh(asset: &Element, source: &Source) -> Result<SupportShape, ModelError> {
    let triangles: Vec<_> = source.corners().collect();
    let solid = match asset.keyword("inertia", &["legacy", "convex", "exact", "shell"])? {
        Some(1) => {
            let hull = Hull::of(&source.vertices).ok_or_else(|| flat(asset))?;
            let triangles: Vec<_> =
                hull.triangles().into_iter().map(|triangle| triangle.map(|corner| hull.vertices[corner])).collect();
            measure(&triangles, Method::Signed)
        }
        Some(2) => measure(&triangles, Method::Signed),
        Some(3) => measure(&triangles, Method::Shell),
        _ => measure(&triangles, Method::Legacy),
    };
    solid.ok_or_else(|| flat(asset))
}

/// A mesh without volume.
fn flat(element: &Element) -> ModelError {
    element.invalid("the mesh encloses no volume: give it thickness, or close and orient its surface")
}

fn unknown(geom: &Element, kind: &str, name: &str) -> ModelError {
    geom.invalid(format!("`{kind}` names the {kind} `{name}`, which does not exist"))
}

/// An asset's name: given, or the file's without its folder and extension.
fn asset_name(asset: &Element) -> Option<&str> {
    asset.text("name").or_else(|| Path::new(asset.text("file")?).file_stem()?.to_str())
}

/// Two counts and that many samples.
fn binary_samples(bytes: &[u8]) -> Option<(usize, usize, Vec<f32>)> {
    let word = |index: usize| <[u8; 4]>::try_from(bytes.get(4 * index..4 * index + 4)?).ok();
    let count = |index: usize| usize::try_from(i32::from_le_bytes(word(index)?)).ok();
    let (rows, columns) = (count(0)?, count(1)?);
    let length = rows.checked_mul(columns)?;
    if bytes.len() != length.checked_add(2)?.checked_mul(4)? {
        return None;
    }
    let sample = |index: usize| Some(f32::from_le_bytes(word(index + 2)?)).filter(|sample| sample.is_finite());
    Some((rows, columns, (0..length).map(sample).collect::<Option<_>>()?))
}
