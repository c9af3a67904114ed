//! Which of the meshes on a skeleton are the body: hair, eyes and what is worn are not.

use garnet_knn::Surface;
use garnet_mesh::{Bounds, Point3, TriMesh};

/// Why a mesh on the skeleton is no part of the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum LeftOut {
    /// Its name is that of hair or a beard.
    Hair,
    /// Its name is that of eyes, brows or lashes.
    Eyes,
    /// Its name is that of teeth, tongue or gums.
    Mouth,
    /// Its name is that of something that is worn or carried.
    Accessory,
    /// It is a coarser level of detail of another one.
    Coarser,
    /// It lies inside the rest of the body.
    Inside,
    /// It was not asked for.
    NotChosen,
    /// It follows another skeleton, or none.
    OtherSkeleton,
    /// It is made of points or lines, without faces.
    NoFaces,
    /// It is read as it is at first: an animation changes its shape, frame by frame.
    LaterShapes,
}

impl LeftOut {
    /// The reason in a word or two.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hair => "hair",
            Self::Eyes => "eyes",
            Self::Mouth => "mouth",
            Self::Accessory => "worn or carried",
            Self::Coarser => "a coarser level of detail",
            Self::Inside => "inside the body",
            Self::NotChosen => "not chosen",
            Self::OtherSkeleton => "not on this skeleton",
            Self::NoFaces => "points or lines",
            Self::LaterShapes => "its shapes in later frames",
        }
    }
}

/// A mesh of a rig file, and whether it is of the body.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct RigPart {
    /// Its name: that of its node, and of its material if that is more than the name.
    pub name: String,
    /// How many faces it has.
    pub num_faces: usize,
    /// Why it is left out, if it is.
    pub left_out: Option<LeftOut>,
}

impl RigPart {
    /// Adds points or lines of a mesh, once a name.
    pub(super) fn add_faceless(parts: &mut Vec<Self>, name: Option<&String>) {
        Self::add_left_out(parts, name, LeftOut::NoFaces);
    }

    pub(super) fn add_left_out(parts: &mut Vec<Self>, name: Option<&String>, why: LeftOut) {
        let part = Self {
            name: name.cloned().unwrap_or_else(|| "unnamed".to_owned()),
            num_faces: 0,
            left_out: Some(why),
        };
        if !parts.contains(&part) {
            parts.push(part);
        }
    }
}

/// A primitive on the skeleton, as shown.
#[derive(Debug)]
pub(super) struct Candidate<'a> {
    /// Names of node and mesh, and of the material.
    pub names: [Vec<&'a str>; 2],
    pub faces: &'a [[u32; 3]],
}

const HAIR: &[&str] = &[
    "hair",
    "hairs",
    "hairstyle",
    "bangs",
    "ponytail",
    "beard",
    "moustache",
    "mustache",
    "fur",
];
const EYES: &[&str] = &[
    "eye",
    "eyes",
    "eyeball",
    "eyeballs",
    "eyeleft",
    "eyeright",
    "lefteye",
    "righteye",
    "iris",
    "cornea",
    "pupil",
    "sclera",
    "eyewhite",
    "eyeao",
    "tearline",
    "eyelash",
    "eyelashes",
    "lash",
    "lashes",
    "eyebrow",
    "eyebrows",
    "brow",
    "brows",
    "eyeline",
    "eyelines",
    "eyeshadow",
    "eyeocclusion",
    "occlusion",
];
const MOUTH: &[&str] = &["teeth", "tooth", "tongue", "gum", "gums", "mouth"];
const WORN: &[&str] = &[
    "glasses",
    "sunglasses",
    "eyewear",
    "facewear",
    "headwear",
    "hat",
    "cap",
    "helmet",
    "earring",
    "earrings",
    "necklace",
    "jewelry",
    "jewellery",
    "watch",
    "bag",
    "backpack",
    "sword",
    "weapon",
    "gun",
    "shield",
    "accessory",
    "accessories",
    "prop",
    "props",
    "ribbon",
];
/// What is called so is skin, whatever else its name says.
const SKIN: &[&str] = &["body", "skin", "torso"];

/// Parts as small as this over the body are eyes and teeth, which look out of it.
const SMALL: f32 = 0.06;

/// Vertices of a part that are tested for being inside.
const NUM_TESTED: usize = 150;

/// Why each of the candidates is left out, if it is; never all of them.
pub(super) fn left_out(candidates: &[Candidate<'_>], shown: &[Point3]) -> Vec<Option<LeftOut>> {
    let mut reasons: Vec<Option<LeftOut>> = candidates.iter().map(by_name).collect();
    let is_chosen = |reason: &Option<LeftOut>| reason.is_none();
    let largest = (0..candidates.len()).max_by(|&a, &b| {
        let size = |index: usize| extent(candidates[index].faces, shown);
        size(a).total_cmp(&size(b)).then(b.cmp(&a))
    });
    if let Some(largest) = largest.filter(|_| !reasons.iter().any(is_chosen)) {
        reasons[largest] = None;
    }
    by_detail(candidates, &mut reasons);
    by_place(candidates, shown, &mut reasons);
    reasons
}

fn by_name(candidate: &Candidate<'_>) -> Option<LeftOut> {
    let [object, material] = &candidate.names;
    let words_of =
        |names: &[&str]| -> Vec<String> { names.iter().flat_map(|name| words(name)).collect() };
    let reason = |words: &[String]| {
        let has = |list: &[&str]| words.iter().any(|word| list.contains(&word.as_str()));
        let pairs: Vec<String> = words.windows(2).map(<[String]>::concat).collect();
        let has_pair = |list: &[&str]| pairs.iter().any(|pair| list.contains(&pair.as_str()));
        if has(SKIN) {
            return None;
        }
        if has(WORN) || has_pair(WORN) {
            return Some(LeftOut::Accessory);
        }
        if has(HAIR) {
            return Some(LeftOut::Hair);
        }
        if has(EYES) || has_pair(EYES) {
            return Some(LeftOut::Eyes);
        }
        has(MOUTH).then_some(LeftOut::Mouth)
    };
    reason(&words_of(object)).or_else(|| reason(&words_of(material)))
}

/// Leaves out all levels of detail but the finest.
fn by_detail(candidates: &[Candidate<'_>], reasons: &mut [Option<LeftOut>]) {
    let level = |candidate: &Candidate<'_>| {
        let words: Vec<String> = candidate.names[0]
            .iter()
            .flat_map(|name| words_with_numbers(name))
            .collect();
        let level = words.iter().enumerate().find_map(|(place, word)| {
            let number = word.strip_prefix("lod")?;
            match number {
                "" => words.get(place + 1)?.parse().ok(),
                number => number.parse::<u32>().ok(),
            }
        })?;
        let stem: Vec<String> = words
            .into_iter()
            .filter(|word| !word.starts_with("lod"))
            .collect();
        let stem: Vec<String> = stem
            .into_iter()
            .filter(|word| word.parse::<u32>().is_err())
            .collect();
        Some((stem, level))
    };
    let levels: Vec<Option<(Vec<String>, u32)>> = candidates.iter().map(level).collect();
    for (index, own) in levels.iter().enumerate() {
        let Some((stem, number)) = own else { continue };
        let mut others = levels.iter().flatten();
        if others.any(|(other, level)| other == stem && level < number) && reasons[index].is_none()
        {
            reasons[index] = Some(LeftOut::Coarser);
        }
    }
}

/// Leaves out what lies inside of all other parts together.
fn by_place(candidates: &[Candidate<'_>], shown: &[Point3], reasons: &mut [Option<LeftOut>]) {
    let kept: Vec<usize> = (0..candidates.len())
        .filter(|&index| reasons[index].is_none())
        .collect();
    if kept.len() < 2 {
        return;
    }
    let sizes: Vec<f32> = candidates
        .iter()
        .map(|candidate| extent(candidate.faces, shown))
        .collect();
    let mut by_size = kept.clone();
    by_size.sort_by(|&a, &b| sizes[a].total_cmp(&sizes[b]));
    let largest = by_size.last().map_or(0.0, |&index| sizes[index]);
    for &index in &by_size {
        let others = kept
            .iter()
            .filter(|&&other| other != index && reasons[other].is_none());
        let faces: Vec<[u32; 3]> = others
            .flat_map(|&other| candidates[other].faces)
            .copied()
            .collect();
        let Ok(mesh) = TriMesh::new(shown.to_vec(), faces) else {
            continue;
        };
        let mut vertices: Vec<u32> = candidates[index].faces.as_flattened().to_vec();
        vertices.sort_unstable();
        vertices.dedup();
        let step = vertices.len().div_ceil(NUM_TESTED).max(1);
        let tested: Vec<Point3> = vertices
            .iter()
            .step_by(step)
            .map(|&vertex| shown[vertex as usize])
            .collect();
        if tested.is_empty() || mesh.faces().is_empty() {
            continue;
        }
        let surface = Surface::new(&mesh);
        let sign = if garnet_mesh::is_inside_out(mesh.positions(), mesh.faces()) {
            -1.0
        } else {
            1.0
        };
        let is_inside = |point: &&Point3| sign * surface.generalized_winding_number(**point) > 0.5;
        let num_inside = tested.iter().filter(is_inside).count();
        let least = if sizes[index] < SMALL * largest {
            0.4
        } else {
            0.9
        };
        if num_inside as f32 >= least * tested.len() as f32 {
            reasons[index] = Some(LeftOut::Inside);
        }
    }
}

fn extent(faces: &[[u32; 3]], shown: &[Point3]) -> f32 {
    Bounds::of_faces(shown, faces).map_or(0.0, |bounds| bounds.diagonal())
}

/// The words of a name in small letters, without numbers.
fn words(name: &str) -> Vec<String> {
    let words = words_with_numbers(name).into_iter();
    let bare = words.map(|word| {
        word.trim_end_matches(|letter: char| letter.is_ascii_digit())
            .to_owned()
    });
    bare.filter(|word| !word.is_empty()).collect()
}

fn words_with_numbers(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut was_small = false;
    for letter in name.chars().take(128) {
        let is_start = letter.is_uppercase() && was_small;
        if !letter.is_alphanumeric() || is_start {
            words.push(String::new());
        }
        if letter.is_alphanumeric() {
            let word = words.pop().unwrap_or_default();
            words.push(word + &letter.to_lowercase().to_string());
        }
        was_small = letter.is_lowercase() || letter.is_ascii_digit();
    }
    words.retain(|word| !word.is_empty());
    words
}
